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

use super::load::read_bytes;
use crate::error::{Error, Result};
use crate::geometry::{Sphere, Triangle};
use crate::picture::io::replace_file;
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
    let bytes = read_bytes(path)?;
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
    let bytes = read_bytes(path)?;
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
    replace_file(path, &bytes)
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A file of the given bytes that is removed at the end.
    struct Temporary(std::path::PathBuf);

    impl Temporary {
        fn new(name: &str, bytes: &[u8]) -> Self {
            let path = std::env::temp_dir().join(format!("skipgrid-raw-{}-{name}", std::process::id()));
            std::fs::write(&path, bytes).expect("the folder for temporary files can be written");
            Self(path)
        }
    }

    impl Drop for Temporary {
        fn drop(&mut self) {
            let _ = std::fs::remove_file(&self.0);
        }
    }

    #[test]
    fn what_is_written_is_read_to_the_bit() {
        let file = Temporary::new("round-trip", b"");
        let v = |i: u32| Vec3::new(i as f32, -0.0, f32::from_bits(i));
        let triangles = [[v(1), v(2), v(3)], [v(4), v(5), v(6)]];
        write_triangles(&file.0, &triangles).expect("written");
        assert_eq!(read_triangles(&file.0).expect("read"), triangles);
        let spheres = [Sphere { centre: v(7), radius: 0.5 }];
        write_spheres(&file.0, &spheres).expect("written");
        assert_eq!(read_spheres(&file.0).expect("read"), spheres);
        let rays = [Ray::new(v(8), v(9)).with_range(f32::NEG_INFINITY, 3.0)];
        write_rays(&file.0, &rays).expect("written");
        assert_eq!(read_rays(&file.0).expect("read"), rays);
        write_rays(&file.0, &[]).expect("written");
        assert_eq!(read_rays(&file.0).expect("read"), []);
    }

    #[test]
    fn malformed_files_say_what_is_wrong() {
        let cases: [(&str, &[u8], &str); 5] = [
            ("short", b"TR", "ends at byte 2 within the magic number that starts at 0"),
            ("magic", b"RAY1\0\0\0\0", "starts with `RAY1`, not `TRI1`"),
            ("count", b"TRI1\x01\0\0\0abcd", "1 items take at least 36 bytes, 4 are left"),
            ("huge", b"TRI1\xff\xff\xff\xff", "4294967295 items take at least 154618822620 bytes, 0 are left"),
            ("trailing", b"TRI1\0\0\0\0ab", "2 bytes follow the last record at byte 8"),
        ];
        for (name, bytes, expected) in cases {
            let file = Temporary::new(name, bytes);
            let error = read_triangles(&file.0).expect_err(name).to_string();
            assert!(error.ends_with(expected) && error.contains(name), "{name}: {error}");
        }
        assert!(read_rays("/no/such/file").expect_err("no file").to_string().starts_with("/no/such/file: "));
    }

    #[test]
    fn records_are_checked() {
        let words = |w: &[u32]| w.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
        // Magic, count, flags; hit, verdict, t = 1.0 in two words, two primitives, no acceptable hit.
        let good = [0x3155_5254, 1, 1, 1, 2, 0, 0x3ff0_0000, 2, 4, 9, 0];
        let truth = read_truth(&Temporary::new("good", &words(&good)).0).expect("read");
        let answer =
            Answer { hit: true, tolerated: Tolerated::Either, t: 1.0, prims: vec![4, 9], acceptable: Vec::new() };
        assert_eq!(truth, Truth { all_hit: true, answers: vec![answer] });
        for (at, value, expected) in [
            (1, 2, "2 items take at least 48 bytes, 32 are left"),
            (3, 7, "record 0: hit is 7, not 0 or 1"),
            (3, 0, "record 0: hit is false with 2 primitives"),
            (4, 3, "record 0: verdict is 3, not 0, 1 or 2"),
            (7, 9, "9 items take at least 36 bytes, 12 are left"),
            (7, 3, "ends at byte 44 within the count of acceptable hits that starts at 44"),
            (10, u32::MAX, "4294967295 items take at least 85899345900 bytes, 0 are left"),
        ] {
            let mut bad = good;
            bad[at] = value;
            let error = read_truth(&Temporary::new("bad", &words(&bad)).0).expect_err(expected).to_string();
            assert!(error.ends_with(expected), "{error}");
        }
    }
}
