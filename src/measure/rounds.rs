//! How anything is timed here: contenders in turns, medians of the rounds.

use super::clock::{process_seconds, thread_seconds, wall_seconds};
use crate::accel::{Accel, Hit};
use crate::error::Result;

/// Speed of one contender.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pace {
    /// Passes in a second: median of the rounds.
    pub per_second: f64,
    /// Half the distance between the fastest and the slowest round, as a share of the median.
    pub spread: f64,
}

/// Times `pass(i)` for each contender `i`, in turns, by the wall clock: passes may use several threads.
///
/// Short passes are repeated for each reading, so that a reading takes milliseconds; a first pass of each, which is not
/// a reading, tells how often. The contender that goes first changes from round to round. `rounds` is at least 1.
#[cfg(any(test, feature = "cli"))]
pub(crate) fn in_turns(contenders: usize, rounds: u32, pass: impl Fn(usize)) -> Vec<Pace> {
    paces(readings(contenders, rounds, pass))
}

/// As [`in_turns`], for passes that keep to this thread: by the processor time that it gets, so that other programs matter
/// less.
pub(crate) fn in_turns_alone(contenders: usize, rounds: u32, pass: impl Fn(usize)) -> Vec<Pace> {
    paces(readings_by(thread_seconds, contenders, rounds, pass))
}

fn paces(readings: Vec<Vec<f64>>) -> Vec<Pace> {
    let pace = |mut rates: Vec<f64>| {
        let per_second = median(&mut rates);
        // `median` has sorted them; there is at least one.
        let spread = rates.last().zip(rates.first()).map_or(0.0, |(max, min)| (max - min) / 2.0 / per_second);
        Pace { per_second, spread }
    };
    readings.into_iter().map(pace).collect()
}

/// As [`in_turns`], but gives the passes in a second of each contender in each round, in the order of the rounds.
#[cfg(any(test, feature = "cli"))]
pub(crate) fn readings(contenders: usize, rounds: u32, pass: impl Fn(usize)) -> Vec<Vec<f64>> {
    readings_by(wall_seconds, contenders, rounds, pass)
}

fn readings_by(clock: fn() -> f64, contenders: usize, rounds: u32, pass: impl Fn(usize)) -> Vec<Vec<f64>> {
    const READING: f64 = 2e-3;
    let seconds = |contender: usize, repeats: u32| {
        let start = clock();
        (0..repeats).for_each(|_| pass(contender));
        (clock() - start).max(1e-9)
    };
    let repeats: Vec<u32> =
        (0..contenders).map(|i| (READING / seconds(i, 1)).ceil().clamp(1.0, 10_000.0) as u32).collect();
    let mut readings = vec![Vec::new(); contenders];
    for round in 0..rounds as usize {
        for turn in 0..contenders {
            let i = (round + turn) % contenders;
            readings[i].push(f64::from(repeats[i]) / seconds(i, repeats[i]));
        }
    }
    readings
}

/// Builds once, and twice more if that is quick; gives the median in milliseconds of wall time.
#[cfg(feature = "cli")]
pub(crate) fn build(scene: &crate::scene::Scene, spec: &str) -> Result<(Box<dyn Accel>, f64)> {
    let (accel, time) = timed_build(|| scene.accel(spec))?;
    Ok((accel, time.wall))
}

/// What a build takes, milliseconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BuildTime {
    /// From beginning to end.
    pub wall: f64,
    /// Computed by all threads together.
    pub cpu: f64,
}

/// Builds once, and twice more if that is quick; gives medians.
pub(crate) fn timed_build(make: impl Fn() -> Result<Box<dyn Accel>>) -> Result<(Box<dyn Accel>, BuildTime)> {
    const QUICK_MS: f64 = 200.0;
    let (mut wall, mut cpu) = (Vec::new(), Vec::new());
    loop {
        let (start, cpu_start) = (wall_seconds(), process_seconds());
        let accel = make()?;
        let last = (wall_seconds() - start) * 1e3;
        cpu.push((process_seconds() - cpu_start) * 1e3);
        wall.push(last);
        if last > QUICK_MS || wall.len() == 3 {
            return Ok((accel, BuildTime { wall: median(&mut wall), cpu: median(&mut cpu) }));
        }
    }
}

/// Equal to the bit.
pub(crate) fn same(a: Option<Hit>, b: Option<Hit>) -> bool {
    a.map(|h| (h.prim, h.t.to_bits())) == b.map(|h| (h.prim, h.t.to_bits()))
}

/// Sorts, and gives the middle or the mean of the two in the middle; NaN if there is none.
pub(crate) fn median(values: &mut [f64]) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    let n = values.len();
    match n {
        0 => f64::NAN,
        _ if n % 2 == 1 => values[n / 2],
        _ => (values[n / 2 - 1] + values[n / 2]) / 2.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians() {
        assert_eq!(median(&mut [3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(&mut [4.0, 1.0, 2.0, 3.0]), 2.5);
        assert!(median(&mut []).is_nan());
    }

    #[test]
    fn every_contender_gets_a_pace() {
        assert!(in_turns_alone(1, 1, |_| ())[0].per_second > 0.0);
        let paces = in_turns(3, 2, |_| ());
        assert_eq!(paces.len(), 3);
        assert!(paces.iter().all(|p| p.per_second > 0.0 && p.spread >= 0.0), "{paces:?}");
        assert!(in_turns(0, 2, |_| ()).is_empty());
    }
}
