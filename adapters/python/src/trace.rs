//! Rays over threads, without Python's lock, in pieces between which Ctrl-C is seen.

use crate::arrays::View;
use crate::errors::invalid;
use pyo3::prelude::*;
use rayon::prelude::*;
use skipgrid::Ray;
use std::time::{Duration, Instant};

/// More threads than any machine has use for.
const MOST_THREADS: usize = 1024;

/// Threads that share work: all of the machine's if no number is said, started once; else so many, started for one call.
pub struct Threads(Option<rayon::ThreadPool>);

impl Threads {
    /// Starts them.
    pub fn new(threads: Option<usize>) -> PyResult<Self> {
        match threads {
            None => Ok(Self(None)),
            Some(threads @ 1..=MOST_THREADS) => {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
                let pool = pool.map_err(|error| invalid(format!("threads: {threads} cannot be started: {error}")))?;
                Ok(Self(Some(pool)))
            }
            Some(other) => Err(invalid(format!("threads: {other}, where 1 to {MOST_THREADS} are possible"))),
        }
    }

    /// Runs `work` there.
    pub fn run<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        match &self.0 {
            Some(pool) => pool.install(work),
            None => work(),
        }
    }
}

/// A piece shall take about as long: Ctrl-C is seen soon, and pieces cost nothing.
const PIECE: Duration = Duration::from_millis(100);

/// `answer` of each ray, in their order.
pub fn each_ray<R: Send>(
    py: Python<'_>,
    threads: Option<usize>,
    rays: &View<'_>,
    answer: impl Fn(Ray) -> R + Sync + Send,
) -> PyResult<Vec<R>> {
    let mut answers = Vec::new();
    let none = |_| invalid(format!("{} rays: no memory for their answers", rays.len()));
    answers.try_reserve_exact(rays.len()).map_err(none)?;
    // One thread is this one: nothing is started and waited for.
    let alone = threads == Some(1);
    let threads = if alone { Threads(None) } else { Threads::new(threads)? };
    py.detach(|| {
        let mut size = 1 << 12;
        while answers.len() < rays.len() {
            let (begin, start) = (answers.len(), Instant::now());
            let end = rays.len().min(begin + size);
            if alone {
                answers.extend((begin..end).map(|i| answer(rays.ray(i))));
            } else {
                threads.run(|| answers.par_extend((begin..end).into_par_iter().map(|i| answer(rays.ray(i)))));
            }
            match start.elapsed() {
                time if time < PIECE / 2 => size *= 2,
                time if time > PIECE * 2 => size = (size / 2).max(16),
                _ => {}
            }
            // Python sees signals on its main thread only: this one, if it is that.
            Python::attach(|py| py.check_signals())?;
        }
        Ok(answers)
    })
}
