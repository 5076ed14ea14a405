//! All shards of a picture made into its film, or what is wrong with them.

use super::{Cover, Job, Place, cover, label, read};
use crate::error::{Error, Result};
use crate::render::{Crop, Film, Part, join};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Faults that are told of one set of shards; of more than these the number is.
const MOST_FAULTS: usize = 10;

/// What shards came to.
#[derive(Clone, Debug, PartialEq)]
pub enum Merged {
    /// All there: the film of [`Job::area`], equal to the bit to that of one render.
    Whole(Job, Film),
    /// These places have no shard.
    Missing(Job, Vec<Place>),
}

/// Makes one film of the shards in `files`, in any order.
///
/// # Errors
/// There are no files; a file cannot be read or is no whole shard; a shard is of another job than most are; two shards share
/// samples of a pixel, or pixels without being of the same tile; the film does not fit into memory. All faults are named, up
/// to ten.
pub fn merge(files: &[PathBuf]) -> Result<Merged> {
    merge_with(files, &|_, _, _| ())
}

/// As [`merge`]; calls `progress` before each stage with the stages done, all of them, and what comes next: each file is
/// checked, then added.
///
/// # Errors
/// As [`merge`].
pub fn merge_with(files: &[PathBuf], progress: &dyn Fn(usize, usize, &str)) -> Result<Merged> {
    let mut faults = Faults::default();
    let mut there = Vec::new();
    for (done, file) in files.iter().enumerate() {
        progress(done, 2 * files.len(), &format!("checking {}", file.display()));
        match label(file) {
            Ok((job, place)) => there.push((file, job, place)),
            Err(error) => faults.add(error),
        }
    }
    let Some(job) = usual_job(there.iter().map(|(_, job, _)| job)).cloned() else {
        faults.end()?;
        return Err(Error::invalid("no shards to merge"));
    };
    there.retain(|(file, other, _)| match job.difference(other) {
        Some(difference) => {
            faults.add(Error::malformed(file, format!("is of another picture than most: {difference}")));
            false
        }
        None => true,
    });
    let places: Vec<Place> = there.iter().map(|(_, _, place)| place.clone()).collect();
    let Cover { twice, missing } = cover(job.area, job.total, &places);
    for (a, b) in twice {
        let (other, place) = (there[a].0.display(), &places[a]);
        faults.add(Error::malformed(there[b].0, format!("{} overlaps {place} of {other}", places[b])));
    }
    faults.end()?;
    if !missing.is_empty() {
        return Ok(Merged::Missing(job, missing));
    }
    let mut tiles: BTreeMap<_, Vec<&Path>> = BTreeMap::new();
    for (file, _, place) in &there {
        let Crop { x, y, width, height } = place.tile;
        tiles.entry((y, x, height, width)).or_default().push(file);
    }
    let Crop { width, height, .. } = job.area;
    let mut film = Film::new(width, height, job.total)?;
    let mut done = files.len();
    let all = 2 * done;
    for ((y, x, height, width), files) in tiles {
        let tile = Crop { x, y, width, height };
        let mut part = Part::new();
        for file in &files {
            progress(done, all, &format!("adding {}", file.display()));
            done += 1;
            let shard = read(file)?;
            if shard.job != job || shard.place.tile != tile {
                return Err(Error::malformed(file, "has changed while it was merged"));
            }
            part.extend(shard.part);
        }
        let joined = join(job.total, part).map_err(|error| {
            let cause = format!("{error} among the shards of its tile; tiles must be equal or have no pixel in common");
            Error::malformed(files[0], cause)
        })?;
        place(&mut film, &joined, x - job.area.x, y - job.area.y);
    }
    Ok(Merged::Whole(job, film))
}

/// Puts the film of a tile at column `x` and row `y` of `film`, inside which it lies, and adds its rays.
fn place(film: &mut Film, tile: &Film, x: u32, y: u32) {
    let [width, whole] = [tile.width as usize, film.width as usize];
    for row in 0..tile.height as usize {
        let (from, to) = (row * width, (y as usize + row) * whole + x as usize);
        film.sum[to..to + width].copy_from_slice(&tile.sum[from..from + width]);
        film.sum_squares[to..to + width].copy_from_slice(&tile.sum_squares[from..from + width]);
    }
    film.stats += tile.stats;
}

/// The job that most shards are of; of several the one that comes first.
fn usual_job<'a>(jobs: impl Iterator<Item = &'a Job>) -> Option<&'a Job> {
    let mut counts: Vec<(&Job, usize)> = Vec::new();
    for job in jobs {
        match counts.iter_mut().find(|(other, _)| *other == job) {
            Some((_, count)) => *count += 1,
            None => counts.push((job, 1)),
        }
    }
    let most = counts.iter().map(|(_, count)| *count).max()?;
    counts.into_iter().find(|(_, count)| *count == most).map(|(job, _)| job)
}

/// What is wrong with several files, told at once.
#[derive(Default)]
struct Faults {
    first: Vec<Error>,
    more: usize,
}

impl Faults {
    fn add(&mut self, error: Error) {
        if self.first.len() < MOST_FAULTS {
            self.first.push(error);
        } else {
            self.more += 1;
        }
    }

    /// An error if anything was wrong: the only one as it is, so that its exit code stays.
    fn end(&mut self) -> Result<()> {
        match (self.first.len(), self.first.pop()) {
            (_, None) => Ok(()),
            (1, Some(only)) => Err(only),
            (_, Some(last)) => {
                self.first.push(last);
                let mut causes: Vec<String> = self.first.iter().map(Error::to_string).collect();
                causes.extend((self.more > 0).then(|| format!("and {} more", self.more)));
                Err(Error::invalid(causes.join("; ")))
            }
        }
    }
}
