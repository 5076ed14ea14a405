//! Bare triangles, spheres and rays: `.tri`, `.sph`, `.rays`, `.truth`.
//!
//! All four are little-endian: a magic number, a count, then records without padding.
//!
//! | file | magic | record |
//! | --- | --- | --- |
//! | `.tri` | `TRI1` | 9 f32: three corners |
//! | `.sph` | `SPH1` | 4 f32: centre, radius |
//! | `.rays` | `RAY1` | 8 f32: origin, `t_min`, direction, `t_max` |
//! | `.truth` | `TRU1` | see [`Answer`]; a u32 of flags stands between count and records |
//!
//! Values are taken bit for bit; NaN and infinities too.

use crate::error::{Error, Result};
use crate::geometry::{Sphere, Triangle};
use crate::ray::Ray;
use glam::Vec3;
use std::path::Path;

/// The exact answer for one ray.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// True if the ray hits something within its closed range.
    pub hit: bool,
    /// What a test with rounding may answer.
    pub tolerated: Tolerated,
    /// The least exact parameter rounded to f64; `inf` without a hit.
    pub t: f64,
    /// All primitives hit exactly at the least parameter, ascending.
    pub prims: Vec<u32>,
    /// Hits acceptable within the tolerance: primitive, least and greatest parameter. Empty where none were recorded.
    pub acceptable: Vec<(u32, f64, f64)>,
}

/// The verdict on a test that may be wrong by a few units in the last place of its inputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tolerated {
    /// It must report a miss.
    Miss,
    /// It must report a hit.
    Hit,
    /// The ray grazes something: either will do.
    Either,
}

/// The exact answers for a file of rays.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Truth {
    /// True if every ray is known to hit, so that a miss is a leak.
    pub all_hit: bool,
    /// One answer for each ray, in order.
    pub answers: Vec<Answer>,
}

/// Reads a `.tri` file.
///
/// # Errors
/// The file cannot be read, has another magic number, or is not as long as its count says.
pub fn read_triangles(path: impl AsRef<Path>) -> Result<Vec<Triangle>> {
    read_floats(path.as_ref(), b"TRI1", |f: &[f32; 9]| {
        [Vec3::new(f[0], f[1], f[2]), Vec3::new(f[3], f[4], f[5]), Vec3::new(f[6], f[7], f[8])]
    })
}

/// Reads a `.sph` file.
///
/// # Errors
/// As [`read_triangles`].
pub fn read_spheres(path: impl AsRef<Path>) -> Result<Vec<Sphere>> {
    read_floats(path.as_ref(), b"SPH1", |f: &[f32; 4]| Sphere { centre: Vec3::new(f[0], f[1], f[2]), radius: f[3] })
}

/// Reads a `.rays` file.
///
/// # Errors
/// As [`read_triangles`].
pub fn read_rays(path: impl AsRef<Path>) -> Result<Vec<Ray>> {
    read_floats(path.as_ref(), b"RAY1", |f: &[f32; 8]| Ray {
        origin: Vec3::new(f[0], f[1], f[2]),
        t_min: f[3],
        direction: Vec3::new(f[4], f[5], f[6]),
        t_max: f[7],
    })
}

/// Writes a `.tri` file.
///
/// # Errors
/// The file cannot be written, or there are more than 2^32 - 1 triangles.
pub fn write_triangles(path: impl AsRef<Path>, triangles: &[Triangle]) -> Result<()> {
    write_floats(path.as_ref(), b"TRI1", triangles, |t| t.iter().flat_map(|p| p.to_array()).collect())
}

/// Writes a `.sph` file.
///
/// # Errors
/// As [`write_triangles`].
pub fn write_spheres(path: impl AsRef<Path>, spheres: &[Sphere]) -> Result<()> {
    write_floats(path.as_ref(), b"SPH1", spheres, |s| s.centre.extend(s.radius).to_array().to_vec())
}

/// Writes a `.rays` file.
///
/// # Errors
/// As [`write_triangles`].
pub fn write_rays(path: impl AsRef<Path>, rays: &[Ray]) -> Result<()> {
    write_floats(path.as_ref(), b"RAY1", rays, |r| {
        [r.origin.extend(r.t_min).to_array(), r.direction.extend(r.t_max).to_array()].concat()
    })
}

/// Reads a `.truth` file.
///
/// # Errors
/// As [`read_triangles`]; or a record is not as [`Answer`] describes.
pub fn read_truth(path: impl AsRef<Path>) -> Result<Truth> {
    let path = path.as_ref();
    let bytes = std::fs::read(path).map_err(|e| Error::io(path, e))?;
    let mut input = Input::open(path, &bytes, b"TRU1")?;
    let count = input.u32("count of records")?;
    let all_hit = input.u32("flags")? & 1 == 1;
    // A record has 24 bytes at least.
    let mut answers = reserve(path, u64::from(count), 24, input.rest.len())?;
    for i in 0..count {
        let hit = match input.u32("hit")? {
            0 => false,
            1 => true,
            other => return Err(Error::malformed(path, format!("record {i}: hit is {other}, not 0 or 1"))),
        };
        let tolerated = match input.u32("tolerated verdict")? {
            0 => Tolerated::Miss,
            1 => Tolerated::Hit,
            2 => Tolerated::Either,
            other => return Err(Error::malformed(path, format!("record {i}: verdict is {other}, not 0, 1 or 2"))),
        };
        let t = input.f64("parameter")?;
        let n = input.u32("count of primitives")?;
        let mut prims = reserve(path, u64::from(n), 4, input.rest.len())?;
        for _ in 0..n {
            prims.push(input.u32("primitive")?);
        }
        let n = input.u32("count of acceptable hits")?;
        let mut acceptable = reserve(path, u64::from(n), 20, input.rest.len())?;
        for _ in 0..n {
            acceptable.push((input.u32("primitive")?, input.f64("parameter")?, input.f64("parameter")?));
        }
        if hit == prims.is_empty() {
            return Err(Error::malformed(path, format!("record {i}: hit is {hit} with {} primitives", prims.len())));
        }
        answers.push(Answer { hit, tolerated, t, prims, acceptable });
    }
    input.end()?;
    Ok(Truth { all_hit, answers })
}

/// A vector with room for `count` items of `least` bytes each in the file, refused if `left` bytes cannot hold them.
fn reserve<T>(path: &Path, count: u64, least: u64, left: usize) -> Result<Vec<T>> {
    let wanted = count * least; // below 2^32 * 2^6
    if wanted > left as u64 {
        let cause = format!("{count} items take at least {wanted} bytes, {left} are left");
        return Err(Error::malformed(path, cause));
    }
    let mut items = Vec::new();
    items.try_reserve_exact(count as usize).map_err(|_| Error::TooLarge {
        what: format!("{}: {count} items", path.display()),
        wanted: count * size_of::<T>() as u64,
        allowed: 0,
    })?;
    Ok(items)
}

fn read_floats<T, const N: usize>(path: &Path, magic: &[u8; 4], make: impl Fn(&[f32; N]) -> T) -> Result<Vec<T>> {
    let bytes = std::fs::read(path).map_err(|e| Error::io(path, e))?;
    let mut input = Input::open(path, &bytes, magic)?;
    let count = input.u32("count of records")?;
    let mut items = reserve(path, u64::from(count), 4 * N as u64, input.rest.len())?;
    for _ in 0..count {
        let mut record = [0.0; N];
        for value in &mut record {
            *value = f32::from_le_bytes(input.take("record")?);
        }
        items.push(make(&record));
    }
    input.end()?;
    Ok(items)
}

fn write_floats<T>(path: &Path, magic: &[u8; 4], items: &[T], floats: impl Fn(&T) -> Vec<f32>) -> Result<()> {
    let count = u32::try_from(items.len()).map_err(|_| {
        Error::invalid(format!("{}: {} records, at most {} fit", path.display(), items.len(), u32::MAX))
    })?;
    let mut bytes = Vec::from(magic);
    bytes.extend(count.to_le_bytes());
    for item in items {
        floats(item).iter().for_each(|x| bytes.extend(x.to_le_bytes()));
    }
    std::fs::write(path, bytes).map_err(|e| Error::io(path, e))
}

/// The bytes of a file not yet read.
struct Input<'a> {
    path: &'a Path,
    length: usize,
    rest: &'a [u8],
}

impl<'a> Input<'a> {
    fn open(path: &'a Path, bytes: &'a [u8], magic: &[u8; 4]) -> Result<Self> {
        let mut input = Self { path, length: bytes.len(), rest: bytes };
        let found: [u8; 4] = input.take("magic number")?;
        if found != *magic {
            let cause = format!("starts with `{}`, not `{}`", found.escape_ascii(), magic.escape_ascii());
            return Err(Error::malformed(path, cause));
        }
        Ok(input)
    }

    fn take<const N: usize>(&mut self, what: &str) -> Result<[u8; N]> {
        let Some((head, rest)) = self.rest.split_first_chunk() else {
            let cause = format!("ends at byte {} within the {what} that starts at {}", self.length, self.at());
            return Err(Error::malformed(self.path, cause));
        };
        self.rest = rest;
        Ok(*head)
    }

    fn u32(&mut self, what: &str) -> Result<u32> {
        Ok(u32::from_le_bytes(self.take(what)?))
    }

    fn f64(&mut self, what: &str) -> Result<f64> {
        Ok(f64::from_le_bytes(self.take(what)?))
    }

    fn at(&self) -> usize {
        self.length - self.rest.len()
    }

    fn end(&self) -> Result<()> {
        if self.rest.is_empty() {
            return Ok(());
        }
        Err(Error::malformed(
            self.path,
            format!("{} bytes follow the last record at byte {}", self.rest.len(), self.at()),
        ))
    }
}
