//! A shard as an EXR file: exact sums in channels of u32, what they are in attributes, and a digest of the whole file.
//!
//! For each node `A..B` of the shard's samples there are twelve channels, `A-B.sum.R.high` and so on: the f64 sums of
//! the samples and of their squares, in R, G and B, as the high and the low half of their bits. docs/shards.md has the
//! whole form.

use super::{Job, Place, hex, parse_crop, parse_range, text_of};
use crate::error::{Error, Result};
use crate::picture::io::{Attributes, MAX_DECODED_BYTES, Words, decode_words, encode_words, read_bytes, replace_file};
use crate::render::{Crop, Film, Part, RenderStats, nodes};
use glam::DVec3;
use sha2::{Digest, Sha256};
use std::ops::Range;
use std::path::Path;

/// How the names of shards end.
pub const EXTENSION: &str = "shard.exr";

/// Raised when the form changes.
const VERSION: &str = "1";

/// Attributes of the shard itself, which the picture does not have.
const VERSION_NAME: &str = "shardVersion";
const SCENE: &str = "shardScene";
const AREA: &str = "shardArea";
const TILE: &str = "shardTile";
const SAMPLES: &str = "shardSamples";
const RAYS: &str = "shardRays";
const ARGUMENTS: &str = "shardArguments";
const DIGEST: &str = "shardDigest";
const OWN: [&str; 8] = [VERSION_NAME, SCENE, AREA, TILE, SAMPLES, RAYS, ARGUMENTS, DIGEST];

/// Sums and their halves, in the order of the numbers of a pixel.
const KINDS: [&str; 2] = ["sum", "squares"];
const COLOURS: [&str; 3] = ["R", "G", "B"];

/// Twelve words for each pixel and node, held twice while a file is decoded, and what the reader allows for a picture.
const PIXEL_BYTES: u64 = 2 * 48 + 12;

/// A part of a picture, and of which one.
#[derive(Clone, Debug, PartialEq)]
pub struct Shard {
    /// The picture.
    pub job: Job,
    /// The part.
    pub place: Place,
    /// The sums: as [`crate::render::render_part`] gives them for the place.
    pub part: Part,
}

/// Finds out whether the file of a shard at `place`, of `total` samples for each pixel, could be read again.
///
/// # Errors
/// It would take more memory than pictures may.
pub fn check_size(place: &Place, total: u32) -> Result<()> {
    let films = nodes(place.samples.clone(), total).len();
    let pixels = u64::from(place.tile.width) * u64::from(place.tile.height);
    let wanted = pixels.saturating_mul(PIXEL_BYTES).saturating_mul(films as u64);
    if wanted > MAX_DECODED_BYTES {
        let what = format!("shard of {place} ({films} sums for each pixel); smaller tiles take less");
        return Err(Error::TooLarge { what, wanted, allowed: MAX_DECODED_BYTES });
    }
    Ok(())
}

/// Writes a shard: whole or not at all. The same shard gives the same bytes.
///
/// # Errors
/// The file cannot be written.
pub fn write(path: impl AsRef<Path>, shard: &Shard) -> Result<()> {
    let path = path.as_ref();
    let Shard { job, place, part } = shard;
    let mut rays = RenderStats::default();
    part.iter().for_each(|(_, film)| rays += film.stats);
    let RenderStats { camera, shadow, bounce, spared, shortened, discarded } = rays;
    let own = [
        (VERSION_NAME, VERSION.to_string()),
        (SCENE, job.scene.clone()),
        (AREA, text_of(&job.area)),
        (TILE, text_of(&place.tile)),
        (SAMPLES, format!("{}..{} of {}", place.samples.start, place.samples.end, job.total)),
        (RAYS, [camera, shadow, bounce, spared, shortened, discarded].map(|n| n.to_string()).join(" ")),
        (ARGUMENTS, job.arguments.clone()),
        (DIGEST, BLANK.to_string()),
    ];
    let attributes = own.into_iter().fold(job.attributes.clone(), |all, (name, value)| all.with(name, value));
    let mut channels = Vec::new();
    for (node, film) in part {
        for (kind, sums) in KINDS.iter().zip([&film.sum, &film.sum_squares]) {
            for (c, colour) in COLOURS.iter().enumerate() {
                let bits = || sums.iter().map(|sum| sum[c].to_bits());
                let name = |half| channel_name(node, kind, colour, half);
                channels.push((name("high"), bits().map(|b| (b >> 32) as u32).collect()));
                channels.push((name("low"), bits().map(|b| b as u32).collect()));
            }
        }
    }
    let Crop { x, y, width, height } = job.area;
    let tile = place.tile;
    let words = Words {
        whole: [x.saturating_add(width), y.saturating_add(height)],
        corner: [tile.x, tile.y],
        size: [tile.width, tile.height],
        channels,
    };
    let mut bytes = encode_words(path, words, &attributes)?;
    let Some(place) = digest_place(&bytes) else { unreachable!("the attribute was just written") };
    let digest = hex(&Sha256::digest(&bytes));
    bytes[place].copy_from_slice(digest.as_bytes());
    replace_file(path, &bytes)
}

/// Reads a shard whose digest is right.
///
/// # Errors
/// The file cannot be read, is no shard, or is damaged.
pub fn read(path: impl AsRef<Path>) -> Result<Shard> {
    let path = path.as_ref();
    let (words, attributes) = decode_words(path, &checked_bytes(path)?)?;
    let (job, place, rays) = labels(path, attributes)?;
    let tile = place.tile;
    if (words.corner, words.size) != ([tile.x, tile.y], [tile.width, tile.height]) {
        let cause = format!("has pixels at {:?}, {:?} of them, instead of {place}", words.corner, words.size);
        return Err(Error::malformed(path, cause));
    }
    let mut part = Vec::new();
    for node in nodes(place.samples.clone(), job.total) {
        let mut film = Film::new(tile.width, tile.height, node.end - node.start)?;
        for (kind, sums) in KINDS.iter().zip([&mut film.sum, &mut film.sum_squares]) {
            for (c, colour) in COLOURS.iter().enumerate() {
                let words = |half| words_of(path, &words, &channel_name(&node, kind, colour, half));
                for ((sum, high), low) in sums.iter_mut().zip(words("high")?).zip(words("low")?) {
                    sum[c] = f64::from_bits(u64::from(*high) << 32 | u64::from(*low));
                }
            }
        }
        let unusable = |sums: &DVec3| sums.is_nan();
        if film.sum.iter().chain(&film.sum_squares).any(unusable) {
            return Err(Error::malformed(path, format!("a sum of samples {}..{} is no number", node.start, node.end)));
        }
        part.push((node, film));
    }
    if let Some((_, film)) = part.first_mut() {
        film.stats = rays;
    }
    Ok(Shard { job, place, part })
}

/// What a shard whose digest is right is of; its pixels are not decoded.
///
/// # Errors
/// As [`read`].
pub fn label(path: impl AsRef<Path>) -> Result<(Job, Place)> {
    let path = path.as_ref();
    let attributes = crate::picture::io::attributes_of(path, &checked_bytes(path)?)?;
    labels(path, attributes).map(|(job, place, _)| (job, place))
}

fn channel_name(node: &Range<u32>, kind: &str, colour: &str, half: &str) -> String {
    format!("{}-{}.{kind}.{colour}.{half}", node.start, node.end)
}

fn words_of<'a>(path: &Path, words: &'a Words, name: &str) -> Result<&'a [u32]> {
    let found = words.channels.iter().find(|(n, _)| n == name);
    found.map(|(_, values)| values.as_slice()).ok_or_else(|| Error::malformed(path, format!("has no channel `{name}`")))
}

/// What stands in the place of the digest while it is computed.
const BLANK: &str = "0000000000000000000000000000000000000000000000000000000000000000";

/// Where in the file the digest stands: after the name, the type and the length of its attribute (OpenEXR file layout,
/// "Attribute layout").
fn digest_place(bytes: &[u8]) -> Option<Range<usize>> {
    let mut head = DIGEST.as_bytes().to_vec();
    head.extend(b"\0string\0");
    head.extend((BLANK.len() as u32).to_le_bytes());
    let start = bytes.windows(head.len()).position(|window| window == head)? + head.len();
    let place = start..start + BLANK.len();
    bytes.get(place.clone()).map(|_| place)
}

/// The bytes of a file whose digest is right.
fn checked_bytes(path: &Path) -> Result<Vec<u8>> {
    let mut bytes = read_bytes(path)?;
    let place = digest_place(&bytes)
        .ok_or_else(|| Error::malformed(path, "is no shard, or not a whole one: there is no digest in it"))?;
    let stated = bytes[place.clone()].to_vec();
    bytes[place.clone()].copy_from_slice(BLANK.as_bytes());
    let found = hex(&Sha256::digest(&bytes));
    if stated != found.as_bytes() {
        let stated = String::from_utf8_lossy(&stated).into_owned();
        return Err(Error::malformed(path, format!("damaged: its digest is {found:.16}.., it says {stated:.16}..")));
    }
    bytes[place].copy_from_slice(&stated);
    Ok(bytes)
}

/// What the attributes say: the job, the place in it, and the rays that it took.
fn labels(path: &Path, attributes: Attributes) -> Result<(Job, Place, RenderStats)> {
    let value = |name: &str| {
        attributes.get(name).ok_or_else(|| Error::malformed(path, format!("is no shard: has no attribute `{name}`")))
    };
    let unclear = |name: &str| {
        let value = attributes.get(name).unwrap_or_default();
        Error::malformed(path, format!("attribute `{name}` is `{value}`, which makes no sense"))
    };
    let version = value(VERSION_NAME)?;
    if version != VERSION {
        let cause = format!("is a shard of form {version}, this program has form {VERSION}");
        return Err(Error::malformed(path, cause));
    }
    let area = parse_crop(value(AREA)?).ok_or_else(|| unclear(AREA))?;
    let tile = parse_crop(value(TILE)?).ok_or_else(|| unclear(TILE))?;
    let samples = value(SAMPLES)?.split_once(" of ").and_then(|(range, total)| {
        let (range, total) = (parse_range(range)?, total.parse().ok()?);
        (range.end <= total).then_some((range, total))
    });
    let (samples, total) = samples.ok_or_else(|| unclear(SAMPLES))?;
    let end = |crop: &Crop| Some((crop.x.checked_add(crop.width)?, crop.y.checked_add(crop.height)?));
    let inside = match (end(&tile), end(&area)) {
        (Some(tile_end), Some(area_end)) => {
            tile.x >= area.x && tile.y >= area.y && tile_end.0 <= area_end.0 && tile_end.1 <= area_end.1
        }
        _ => false,
    };
    if !inside {
        return Err(unclear(TILE));
    }
    let rays: Option<Vec<u64>> = value(RAYS)?.split(' ').map(|n| n.parse().ok()).collect();
    let Some(&[camera, shadow, bounce, spared, shortened, discarded]) = rays.as_deref() else {
        return Err(unclear(RAYS));
    };
    let (scene, arguments) = (value(SCENE)?.to_string(), value(ARGUMENTS)?.to_string());
    let mut picture = attributes;
    picture.entries.retain(|(name, _)| !OWN.contains(&name.as_str()));
    let job = Job::new(picture, scene, area, total, arguments);
    let rays = RenderStats { camera, shadow, bounce, spared, shortened, discarded };
    Ok((job, Place { tile, samples }, rays))
}
