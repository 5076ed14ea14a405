//! The picture in tiles, on as many threads as are wanted.

use super::film::{Film, RenderStats};
use super::{Crop, Unfinished};
use crate::error::Result;
use glam::DVec3;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Edge of a tile, pixels.
const EDGE: u32 = 16;

/// Sums of the samples of one pixel: values and squares.
pub(super) type Sums = (DVec3, DVec3);

/// Fills a film with `tile(part, pixels)`, which appends the sums of the pixels of `part`, row by row; if it is told to
/// stop, those that are finished.
///
/// # Errors
/// The film does not fit into memory, or the threads cannot be started.
pub(super) fn film(
    area: Crop,
    samples: u32,
    threads: Option<usize>,
    progress: &(dyn Fn(usize, usize) + Sync),
    tile: &(dyn Fn(Crop, &mut Vec<Sums>) -> RenderStats + Sync),
) -> Result<Unfinished> {
    let film = Mutex::new(Film::new(area.width, area.height, samples)?);
    let finished = AtomicU64::new(0);
    let columns = area.width.div_ceil(EDGE) as usize;
    let count = columns * area.height.div_ceil(EDGE) as usize;
    let done = AtomicUsize::new(0);
    let work = |index: usize| {
        let part = part(area, (index % columns) as u32 * EDGE, (index / columns) as u32 * EDGE);
        let mut pixels = Vec::with_capacity((EDGE * EDGE) as usize);
        let stats = tile(part, &mut pixels);
        {
            // A poisoned lock means that another tile panicked, which its own thread reports.
            let mut film = film.lock().unwrap_or_else(PoisonError::into_inner);
            film.stats += stats;
            write(&mut film, area, part, &pixels);
        }
        finished.fetch_add(pixels.len() as u64, Ordering::Relaxed);
        progress(done.fetch_add(1, Ordering::Relaxed) + 1, count);
    };
    run(count, threads, &work)?;
    let film = film.into_inner().unwrap_or_else(PoisonError::into_inner);
    Ok(Unfinished { film, finished: finished.into_inner() })
}

/// The tile at (x, y) of `area`, cut at its edges.
fn part(area: Crop, x: u32, y: u32) -> Crop {
    Crop { x: area.x + x, y: area.y + y, width: EDGE.min(area.width - x), height: EDGE.min(area.height - y) }
}

fn write(film: &mut Film, area: Crop, part: Crop, pixels: &[Sums]) {
    for (row, sums) in pixels.chunks(part.width as usize).enumerate() {
        let start = ((part.y - area.y) as usize + row) * area.width as usize + (part.x - area.x) as usize;
        for (i, &(sum, squares)) in sums.iter().enumerate() {
            film.sum[start + i] = sum;
            film.sum_squares[start + i] = squares;
        }
    }
}

#[cfg(feature = "parallel")]
fn run(count: usize, threads: Option<usize>, work: &(dyn Fn(usize) + Sync)) -> Result<()> {
    use rayon::prelude::*;
    let parallel = || (0..count).into_par_iter().with_max_len(1).for_each(work);
    match threads {
        Some(1) => (0..count).for_each(work),
        None => parallel(),
        Some(n) => rayon::ThreadPoolBuilder::new()
            .num_threads(n.min(count))
            .build()
            .map_err(|e| crate::Error::invalid(format!("{n} threads cannot be started: {e}")))?
            .install(parallel),
    }
    Ok(())
}

#[cfg(not(feature = "parallel"))]
fn run(count: usize, _threads: Option<usize>, work: &(dyn Fn(usize) + Sync)) -> Result<()> {
    (0..count).for_each(work);
    Ok(())
}
