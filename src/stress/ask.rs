//! Asks an accelerator everything about a list of rays, on all cores, and survives what it does.

use crate::accel::{Accel, Counts, Hit};
use crate::ray::Ray;
use rayon::prelude::*;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// What an accelerator says about one ray, by each of its four methods.
#[derive(Clone, Copy, Debug)]
pub(super) struct Answer {
    pub closest: Option<Hit>,
    pub any: bool,
    pub counted: Option<Hit>,
    pub any_counted: bool,
    /// Work of the counted closest hit.
    pub counts: Counts,
}

/// How a question ended.
#[derive(Clone, Debug)]
pub(super) enum Asked {
    Answered(Answer),
    /// It panicked, with this message.
    Panicked(String),
    /// The time was up before it was asked.
    Left,
}

/// Runs `f` and gives the message of its panic, if it panics.
pub(super) fn survive<T>(f: impl FnOnce() -> T) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(f)).map_err(|cause| {
        let text = cause.downcast_ref::<String>().map(String::as_str);
        text.or_else(|| cause.downcast_ref::<&str>().copied()).unwrap_or("a panic without a message").to_string()
    })
}

/// Asks about every ray, in order of the rays, until `patience` is over.
pub(super) fn ask(accel: &dyn Accel, rays: &[Ray], patience: Duration) -> Vec<Asked> {
    let (start, late) = (Instant::now(), AtomicBool::new(false));
    let one = |(i, ray): (usize, &Ray)| {
        if i % 16 == 0 && start.elapsed() > patience {
            late.store(true, Ordering::Relaxed);
        }
        if late.load(Ordering::Relaxed) {
            return Asked::Left;
        }
        let answer = survive(|| {
            let mut counts = Counts::default();
            let (closest, any) = (accel.closest_hit(ray), accel.any_hit(ray));
            let counted = accel.closest_hit_counted(ray, &mut counts);
            let any_counted = accel.any_hit_counted(ray, &mut Counts::default());
            Answer { closest, any, counted, any_counted, counts }
        });
        answer.map_or_else(Asked::Panicked, Asked::Answered)
    };
    rays.par_iter().enumerate().with_min_len(8).map(one).collect()
}
