//! Time per ray of a case against that of ordinary rays.

use super::ask::survive;
use super::cases::Stage;
use crate::accel::Accel;
use crate::measure::rounds::in_turns;
use crate::ray::Ray;
use std::hint::black_box;
use std::time::{Duration, Instant};

/// Medians of interleaved rounds, closest hits, one thread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Times {
    /// A ray of the case, nanoseconds.
    pub case: f64,
    /// An ordinary ray, nanoseconds.
    pub ordinary: f64,
}

impl Times {
    /// How many ordinary rays one of the case costs.
    pub fn ratio(&self) -> f64 {
        self.case / self.ordinary
    }
}

/// Rays of a pass, if they are ordinary ones.
const MOST: u64 = 500;
/// A pass of the rays of the case takes about this long at most.
const PASS: Duration = Duration::from_millis(40);

/// Times `accel` on the first rays of the case and `other` on ordinary ones; `None` if there is nothing to time or if a
/// ray makes it panic.
pub(super) fn times(stage: &Stage, accel: &dyn Accel, other: &dyn Accel, rays: u64, rounds: u32) -> Option<Times> {
    survive(|| {
        let most = rays.min(MOST);
        let (mut hard, start) = (Vec::<Ray>::new(), Instant::now());
        while (hard.len() as u64) < most && start.elapsed() < PASS {
            let ray = stage.ray(hard.len() as u64);
            black_box(accel.closest_hit(&ray));
            hard.push(ray);
        }
        let good: Vec<Ray> = (0..most).map(|i| stage.good_ray(i)).collect();
        if hard.is_empty() || rounds == 0 {
            return None;
        }
        let trace = |accel: &dyn Accel, rays: &[Ray]| rays.iter().for_each(|ray| _ = black_box(accel.closest_hit(ray)));
        let paces = in_turns(2, rounds, |i| if i == 0 { trace(accel, &hard) } else { trace(other, &good) });
        let each = |i: usize, rays: &[Ray]| 1e9 / paces[i].per_second / rays.len() as f64;
        Some(Times { case: each(0, &hard), ordinary: each(1, &good) })
    })
    .ok()
    .flatten()
}
