//! A picture in shards: parts that any machine renders by itself, and that make the whole picture, equal to the bit.
//!
//! A shard is a rectangle of the pixels and a range of the samples of each. What is the same for all shards of a picture is
//! its [`Job`]. Absent here: who runs what where. A plan is a list of commands, and any runner of commands will do.
//!
//! ```
//! use skipgrid::picture::io::Attributes;
//! use skipgrid::render::{Crop, Sampler, Settings, render, render_part};
//! use skipgrid::scene::{LoadOptions, load};
//! use skipgrid::shards::{Job, Merged, Shard, merge, places, scene_digest, write};
//!
//! let scene = load("cornell", &LoadOptions::default())?;
//! let accel = scene.accel("grid")?;
//! let settings = Settings { width: 12, height: 8, sampler: Sampler::Sobol(6), ..Settings::default() };
//! let area = Crop { x: 0, y: 0, width: 12, height: 8 };
//! let attributes = Attributes::default().with("scene", "cornell");
//! let job = Job::new(attributes, scene_digest(&scene), area, 6, "cornell".into());
//! # let folder = std::env::temp_dir().join(format!("skipgrid-shards-{}", std::process::id()));
//! # std::fs::create_dir_all(&folder).map_err(|error| skipgrid::Error::io(&folder, error))?;
//!
//! // Tiles of at most 8 x 8 pixels, of each four samples and the other two: any machine can make any of the four.
//! let mut files = Vec::new();
//! for place in places(area, (8, 8), 4, 6)? {
//!     let own = Settings { crop: Some(place.tile), ..settings.clone() };
//!     let part = render_part(&scene, &accel, &own, place.samples.clone(), &|_, _| {})?;
//!     let file = folder.join(place.file_name(&job));
//!     write(&file, &Shard { job: job.clone(), place, part })?;
//!     files.push(file);
//! }
//! let lost = files.pop().expect("four shards");
//! assert!(matches!(merge(&files)?, Merged::Missing(_, places) if places.len() == 1));
//! files.push(lost);
//! let Merged::Whole(_, film) = merge(&files)? else { panic!("all are there") };
//! assert_eq!(film.picture(), render(&scene, &accel, &settings, &|_, _| {})?.picture());
//! # std::fs::remove_dir_all(&folder).map_err(|error| skipgrid::Error::io(&folder, error))?;
//! # Ok::<(), skipgrid::Error>(())
//! ```

mod cover;
mod digest;
mod file;
mod merge;
mod plan;

pub use cover::{Cover, cover};
pub use digest::scene_digest;
pub use file::{EXTENSION, Shard, check_size, label, read, write};
pub use merge::{Merged, merge, merge_with};
pub use plan::{MAX_SHARDS, places};

use crate::picture::io::Attributes;
use crate::render::Crop;
use sha2::{Digest, Sha256};
use std::ops::Range;

/// What all shards of one picture have in common: a shard of another job is refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Job {
    /// What the finished picture says of its making, by name in alphabetical order: renderer and version, scene, accelerator,
    /// settings.
    pub attributes: Attributes,
    /// [`scene_digest`] of the scene.
    pub scene: String,
    /// The part of the picture that is rendered.
    pub area: Crop,
    /// Samples for each pixel.
    pub total: u32,
    /// The words of a command that renders one of these shards, but for its place and name.
    pub arguments: String,
}

impl Job {
    /// A job; `attributes` in any order.
    pub fn new(mut attributes: Attributes, scene: String, area: Crop, total: u32, arguments: String) -> Self {
        attributes.entries.sort();
        Self { attributes, scene, area, total, arguments }
    }

    /// 16 hexadecimal digits that tell this job from others.
    pub fn id(&self) -> String {
        let mut hash = Sha256::new();
        for (name, value) in self.texts() {
            for text in [name, value] {
                hash.update((text.len() as u64).to_le_bytes());
                hash.update(text);
            }
        }
        hex(&hash.finalize()[..8])
    }

    /// The first thing in which `other` differs, in words.
    pub fn difference(&self, other: &Job) -> Option<String> {
        let (ours, theirs) = (self.texts(), other.texts());
        let value = |texts: &[(String, String)], name: &str| {
            texts.iter().find(|(n, _)| n == name).map_or("none".to_string(), |(_, value)| format!("`{value}`"))
        };
        let names = ours.iter().chain(&theirs).map(|(name, _)| name);
        let mut found = names.map(|name| (name, value(&ours, name), value(&theirs, name)));
        let (name, a, b) = found.find(|(_, a, b)| a != b)?;
        Some(format!("{name} is {b}, not {a}"))
    }

    /// Names and values of everything, the scene's digest first.
    fn texts(&self) -> Vec<(String, String)> {
        let own = [
            ("scene digest", self.scene.clone()),
            ("area", text_of(&self.area)),
            ("samples", self.total.to_string()),
            ("command", self.arguments.clone()),
        ];
        let own = own.map(|(name, value)| (name.to_string(), value));
        let (scene, rest) = own.split_first().unwrap_or_else(|| unreachable!("four entries"));
        std::iter::once(scene).chain(&self.attributes.entries).chain(rest).cloned().collect()
    }
}

/// Which pixels and samples a shard has.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The pixels, counted in the whole picture; inside [`Job::area`], not empty.
    pub tile: Crop,
    /// The samples of each, of the numbers below [`Job::total`]; not empty.
    pub samples: Range<u32>,
}

impl Place {
    /// The shard's usual file name: the job, then the place.
    pub fn file_name(&self, job: &Job) -> String {
        let Crop { x, y, width, height } = self.tile;
        let Range { start, end } = self.samples;
        format!("{}-x{x}-y{y}-{width}x{height}-s{start}-{end}.{EXTENSION}", job.id())
    }
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "tile {}, samples {}..{}", text_of(&self.tile), self.samples.start, self.samples.end)
    }
}

/// `X,Y,WIDTH,HEIGHT`.
pub(crate) fn text_of(crop: &Crop) -> String {
    format!("{},{},{},{}", crop.x, crop.y, crop.width, crop.height)
}

/// As [`text_of`] writes it, neither side 0; else `None`.
pub(crate) fn parse_crop(text: &str) -> Option<Crop> {
    let numbers: Option<Vec<u32>> = text.split(',').map(|n| n.trim().parse().ok()).collect();
    match numbers?[..] {
        [x, y, width, height] if width > 0 && height > 0 => Some(Crop { x, y, width, height }),
        _ => None,
    }
}

/// `A..B`, not empty; else `None`.
pub(crate) fn parse_range(text: &str) -> Option<Range<u32>> {
    let (start, end) = text.split_once("..")?;
    let range = start.trim().parse().ok()?..end.trim().parse().ok()?;
    (!range.is_empty()).then_some(range)
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_parsed_or_refused() {
        let crop = Crop { x: 1, y: 2, width: 3, height: 4 };
        assert_eq!(parse_crop(&text_of(&crop)), Some(crop));
        for bad in ["", "1,2,3", "1,2,0,4", "-1,2,3,4", "1,2,3,4,5"] {
            assert_eq!(parse_crop(bad), None, "{bad}");
        }
        assert_eq!(parse_range("4..16"), Some(4..16));
        for bad in ["", "4", "4..4", "5..4", "-1..4", "4...16", "0..4294967296"] {
            assert_eq!(parse_range(bad), None, "{bad}");
        }
    }

    #[test]
    fn jobs_that_differ_have_other_names_and_say_where() {
        let area = Crop { x: 0, y: 0, width: 8, height: 8 };
        let job = |seed: &str, scene: &str, total| {
            let attributes = Attributes::default().with("seed", seed).with("renderer", "r");
            Job::new(attributes, scene.into(), area, total, "cornell".into())
        };
        let one = job("1", "aa", 4);
        assert_eq!(one.difference(&job("1", "aa", 4)), None);
        assert_eq!(one.id(), job("1", "aa", 4).id());
        for (other, words) in [
            (job("2", "aa", 4), "seed is `2`, not `1`"),
            (job("1", "bb", 4), "scene digest is `bb`, not `aa`"),
            (job("1", "aa", 5), "samples is `5`, not `4`"),
        ] {
            assert_eq!(one.difference(&other).as_deref(), Some(words));
            assert_ne!(one.id(), other.id());
        }
    }
}
