//! NumPy's `.npy` files: rays in, hits out.
//!
//! Rays are an N x 8 array of little-endian f32 in C order, one ray a row: ox, oy, oz, tmin, dx, dy, dz, tmax. Hits are N
//! records of f32 `t` and u32 `prim`.

use crate::accel::Hit;
use crate::error::{Error, Result};
use crate::npy::{Fault, MAGIC, fill, read_header, value};
use crate::ray::Ray;
use glam::Vec3;
use std::fs::File;
use std::io::{BufReader, Read, Write};
use std::path::Path;

/// Numbers in a ray.
const FIELDS: usize = 8;

/// Bytes of a ray.
const RAY_BYTES: u64 = 4 * FIELDS as u64;

/// Reads rays. Any bits are rays: those that are not finite hit nothing.
///
/// # Errors
/// The file cannot be read, is no `.npy` file, holds something else than N x 8 little-endian f32 in C order, or is
/// shorter or longer than its header says. Nothing is allocated before the file's length has been checked.
pub fn read_rays(path: &Path) -> Result<Vec<Ray>> {
    let io = |source| Error::io(path, source);
    // Asked before opening: opening a pipe would wait for a writer.
    let meta = std::fs::metadata(path).map_err(io)?;
    if !meta.is_file() {
        return Err(Error::malformed(path, "not a regular file"));
    }
    let file = File::open(path).map_err(io)?;
    read_rays_from(&mut BufReader::new(file), meta.len()).map_err(|fault| match fault {
        Fault::Io(source) => Error::io(path, source),
        Fault::Content(cause) => Error::malformed(path, cause),
    })
}

/// `length`: bytes of the whole file.
fn read_rays_from(source: &mut impl Read, length: u64) -> std::result::Result<Vec<Ray>, Fault> {
    let header = read_header(source)?;
    let count = ray_count(&header.text)?;

    let rest = length.saturating_sub(header.bytes);
    if count.checked_mul(RAY_BYTES) != Some(rest) {
        return Err(format!("the header promises {count} rays of {RAY_BYTES} bytes, but {rest} bytes follow").into());
    }
    let mut rays = Vec::new();
    // Within usize: the file is that long, and a ray in memory is as large as in the file.
    rays.try_reserve_exact(count as usize).map_err(|_| format!("no memory for {count} rays"))?;
    let mut bytes = [0; RAY_BYTES as usize];
    for _ in 0..count {
        fill(source, &mut bytes, "rays")?;
        rays.push(ray(&bytes));
    }
    Ok(rays)
}

fn ray(bytes: &[u8; RAY_BYTES as usize]) -> Ray {
    let f = |i: usize| f32::from_le_bytes([bytes[4 * i], bytes[4 * i + 1], bytes[4 * i + 2], bytes[4 * i + 3]]);
    Ray { origin: Vec3::new(f(0), f(1), f(2)), t_min: f(3), direction: Vec3::new(f(4), f(5), f(6)), t_max: f(7) }
}

/// Number of rays that the header's dictionary promises.
fn ray_count(header: &str) -> std::result::Result<u64, String> {
    let descr = value(header, "descr")?;
    match descr.trim_matches(['\'', '"']) {
        "<f4" => {}
        "<f8" | ">f8" | ">f4" | "<f2" => {
            return Err(format!("numbers are {descr}; rays are little-endian f32: save rays.astype('<f4')"));
        }
        _ => return Err(format!("numbers are {descr}; rays are little-endian f32, '<f4'")),
    }
    match value(header, "fortran_order")? {
        "False" => {}
        "True" => return Err("Fortran order; save numpy.ascontiguousarray(rays)".into()),
        other => return Err(format!("fortran_order is {other}, neither True nor False")),
    }
    let shape = value(header, "shape")?;
    let wrong = || format!("shape is {shape}; rays are (N, {FIELDS})");
    let inner = shape.strip_prefix('(').and_then(|s| s.strip_suffix(')')).ok_or_else(wrong)?;
    let mut sizes = inner.trim().trim_end_matches(',').split(',').map(|s| s.trim().parse::<u64>());
    match (sizes.next(), sizes.next(), sizes.next()) {
        (Some(Ok(n)), Some(Ok(8)), None) => Ok(n),
        _ => Err(wrong()),
    }
}

/// Writes an N x 8 array of f32: what [`read_rays`] reads, to the bit.
///
/// # Errors
/// Those of `out`.
pub fn write_rays(out: &mut impl Write, rays: &[Ray]) -> std::io::Result<()> {
    write_header(out, "'<f4'", &format!("({}, {FIELDS})", rays.len()))?;
    for r in rays {
        let [o, d] = [r.origin, r.direction];
        for x in [o.x, o.y, o.z, r.t_min, d.x, d.y, d.z, r.t_max] {
            out.write_all(&x.to_le_bytes())?;
        }
    }
    Ok(())
}

/// Writes N records of f32 `t` and u32 `prim`; a miss is `inf` and 0xffffffff.
///
/// # Errors
/// Those of `out`.
pub fn write_hits(out: &mut impl Write, hits: &[Option<Hit>]) -> std::io::Result<()> {
    write_header(out, "[('t', '<f4'), ('prim', '<u4')]", &format!("({},)", hits.len()))?;
    for hit in hits {
        let Hit { t, prim } = hit.unwrap_or(Hit { t: f32::INFINITY, prim: u32::MAX });
        out.write_all(&t.to_le_bytes())?;
        out.write_all(&prim.to_le_bytes())?;
    }
    Ok(())
}

/// Writes N bytes, 1 where something is hit.
///
/// # Errors
/// Those of `out`.
pub fn write_flags(out: &mut impl Write, flags: &[bool]) -> std::io::Result<()> {
    write_header(out, "'|u1'", &format!("({},)", flags.len()))?;
    flags.iter().try_for_each(|&flag| out.write_all(&[u8::from(flag)]))
}

/// Version 1.0, padded so that the array starts at a multiple of 64 bytes.
fn write_header(out: &mut impl Write, descr: &str, shape: &str) -> std::io::Result<()> {
    let dictionary = format!("{{'descr': {descr}, 'fortran_order': False, 'shape': {shape}, }}");
    let total = (MAGIC.len() + 4 + dictionary.len() + 1).next_multiple_of(64);
    let length = (total - MAGIC.len() - 4) as u16;
    out.write_all(MAGIC)?;
    out.write_all(&[1, 0])?;
    out.write_all(&length.to_le_bytes())?;
    writeln!(out, "{dictionary:<width$}", width = usize::from(length) - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(bytes: &[u8]) -> std::result::Result<Vec<Ray>, String> {
        read_rays_from(&mut &bytes[..], bytes.len() as u64).map_err(|fault| match fault {
            Fault::Io(error) => panic!("a slice cannot fail: {error}"),
            Fault::Content(cause) => cause,
        })
    }

    fn file(version: u8, header: &str, data: &[u8]) -> Vec<u8> {
        let mut bytes = [MAGIC.as_slice(), &[version, 0]].concat();
        let length = (header.len() as u32).to_le_bytes();
        bytes.extend(&length[..if version == 1 { 2 } else { 4 }]);
        bytes.extend(header.as_bytes());
        bytes.extend(data);
        bytes
    }

    #[test]
    fn rays_come_back_to_the_bit() {
        let rays = [
            Ray::new(Vec3::new(1.0, -0.0, 3.5), Vec3::new(0.0, 1e-40, -2.0)).with_range(0.25, f32::INFINITY),
            Ray::new(Vec3::splat(7.0), Vec3::NEG_X).with_range(f32::NEG_INFINITY, 9.0),
        ];
        let mut bytes = Vec::new();
        write_rays(&mut bytes, &rays).expect("a vector takes everything");
        assert_eq!((bytes.len() - 64) % 64, 0, "the array is aligned and padded");
        let back = read(&bytes).expect("own output is readable");
        // Debug shows -0.0 apart from 0.0.
        assert_eq!(format!("{back:?}"), format!("{rays:?}"));
    }

    #[test]
    fn headers_as_numpy_writes_them() {
        // numpy.lib.format: spaces, order and the trailing comma vary between versions.
        for (version, header) in [
            (1, "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 8), }      \n"),
            (2, "{\"shape\": (1,8), 'fortran_order':False,'descr':\"<f4\"}\n"),
            (3, "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 8,)}\n"),
        ] {
            assert_eq!(read(&file(version, header, &[0; 32])).expect(header).len(), 1);
        }
        let mut hits = Vec::new();
        write_hits(&mut hits, &[None]).expect("a vector takes everything");
        // numpy.save of numpy.zeros(1, [('t','<f4'),('prim','<u4')]) writes this header, padded to 128 bytes in all.
        let expected = b"\x93NUMPY\x01\x00\x76\x00{'descr': [('t', '<f4'), ('prim', '<u4')], 'fortran_order': False, 'shape': (1,), }";
        assert_eq!(&hits[..expected.len()], expected);
        assert_eq!(&hits[128..], [0, 0, 0x80, 0x7f, 0xff, 0xff, 0xff, 0xff]);
    }

    #[test]
    fn what_is_wrong_is_said() {
        let good = "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 8), }";
        for (bytes, cause) in [
            (b"solid cube".to_vec(), "no .npy file"),
            (MAGIC.to_vec(), "ends within the first 8 bytes"),
            (file(9, good, &[0; 32]), "format version 9.0"),
            (file(1, good, &[0; 31]), "promises 1 rays of 32 bytes, but 31 bytes follow"),
            (file(1, good, &[0; 33]), "but 33 bytes follow"),
            (file(1, &good.replace("(1,", "(18446744073709551615,"), &[0; 32]), "promises 18446744073709551615"),
            (file(1, &good.replace("(1,", "(99999999999999999999,"), &[0; 32]), "shape is"),
            (file(1, &good.replace("(1, 8)", "(8,)"), &[0; 32]), "shape is (8,); rays are (N, 8)"),
            (file(1, &good.replace("(1, 8)", "(1, 8, 1)"), &[0; 32]), "rays are (N, 8)"),
            (file(1, &good.replace("<f4", "<f8"), &[0; 64]), "astype('<f4')"),
            (file(1, &good.replace("<f4", ">f4"), &[0; 32]), "little-endian"),
            (file(1, &good.replace("'<f4'", "[('x', '<f4'), ('y', '<f4')]"), &[0; 32]), "numbers are [('x'"),
            (file(1, &good.replace("False", "True"), &[0; 32]), "Fortran order"),
            (file(1, "{'descr': '<f4', 'shape': (1, 8", &[0; 32]), "the header has no `fortran_order`"),
            (file(2, "", &[]), "the header has no `descr`"),
            ([MAGIC.as_slice(), &[2, 0, 0xff, 0xff, 0xff, 0xff]].concat(), "header of 4294967295 bytes"),
        ] {
            let said = read(&bytes).expect_err(cause);
            assert!(said.contains(cause), "{said:?} does not say {cause:?}");
        }
    }
}
