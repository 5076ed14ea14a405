//! Dense arrays of voxels from NumPy's `.npy` files.
//!
//! An array of three dimensions of `uint8` or `bool`: element `[x, y, z]` is the voxel there, y upwards; anything but 0 is
//! solid, of one grey material. Both orders in memory are read. Voxels have edge 1, the least corner is the origin.

use super::budget::Budget;
use super::load::{read_bytes, stem};
use super::{Material, SceneParts};
use crate::error::{Error, Result};
use crate::geometry::SolidVoxels;
use crate::npy::{Fault, read_header, value};
use glam::Vec3;
use std::path::Path;

/// Bytes for a voxel: in the file and in the scene. The exposed faces are counted before they are kept.
const VOXEL_BYTES: u64 = 2;

/// Reads a file.
///
/// # Errors
/// The file cannot be read, is too large for the memory allowed, holds another kind of array, is shorter or longer than its
/// header says, or has more voxels than [`SolidVoxels::new`] takes.
pub(super) fn read(path: &Path, budget: &Budget) -> Result<SceneParts> {
    let bytes = read_bytes(path)?;
    budget.take(VOXEL_BYTES * bytes.len() as u64, || format!("{}: voxels", path.display()))?;
    let voxels = voxels(&bytes).map_err(|cause| Error::malformed(path, cause))?;
    Ok(SceneParts {
        name: stem(path),
        voxels: Some(voxels),
        materials: vec![Material::grey()],
        ..SceneParts::default()
    })
}

/// The error is the cause.
fn voxels(bytes: &[u8]) -> std::result::Result<SolidVoxels, String> {
    let header = read_header(&mut &bytes[..]).map_err(|fault| match fault {
        Fault::Content(cause) => cause,
        Fault::Io(error) => error.to_string(),
    })?;
    let rest = bytes.get(header.bytes as usize..).unwrap_or_default();
    let descr = value(&header.text, "descr")?;
    if !["|u1", "|b1", "<u1", ">u1"].contains(&descr.trim_matches(['\'', '"'])) {
        return Err(format!("elements are {descr}; voxels are uint8 or bool: save array.astype('u1')"));
    }
    let shape = value(&header.text, "shape")?;
    let wrong = || format!("shape is {shape}; voxels are (nx, ny, nz), each 1 to {}", SolidVoxels::MAX_RESOLUTION);
    let inner = shape.strip_prefix('(').and_then(|s| s.strip_suffix(')')).ok_or_else(wrong)?;
    let sizes: Vec<u32> = inner.split(',').map(|n| n.trim().parse().ok()).collect::<Option<_>>().ok_or_else(wrong)?;
    let [nx, ny, nz] = sizes[..] else { return Err(wrong()) };
    if ![nx, ny, nz].iter().all(|n| (1..=SolidVoxels::MAX_RESOLUTION).contains(n)) {
        return Err(wrong());
    }
    // At most 2^36.
    let count = u64::from(nx) * u64::from(ny) * u64::from(nz);
    if count != rest.len() as u64 {
        return Err(format!("the header promises {count} voxels of a byte, but {} bytes follow", rest.len()));
    }
    // As many as there are in the file.
    let mut materials = Vec::new();
    materials.try_reserve_exact(rest.len()).map_err(|_| format!("no memory for {count} voxels"))?;
    let (x, y, z) = (nx as usize, ny as usize, nz as usize);
    match value(&header.text, "fortran_order")? {
        "True" => materials.extend(rest.iter().map(|&byte| u8::from(byte != 0))),
        "False" => {
            let at = |i: usize| rest[(i % x * y + i / x % y) * z + i / (x * y)];
            materials.extend((0..rest.len()).map(|i| u8::from(at(i) != 0)));
        }
        other => return Err(format!("fortran_order is {other}, neither True nor False")),
    }
    SolidVoxels::new([nx, ny, nz], materials, Vec3::ZERO, 1.0).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(descr: &str, order: &str, shape: &str, data: &[u8]) -> Vec<u8> {
        let header = format!("{{'descr': {descr}, 'fortran_order': {order}, 'shape': {shape}, }}");
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend(data);
        bytes
    }

    #[test]
    fn elements_are_voxels_by_x_y_z_in_both_orders() {
        // a[1, 0, 2] of shape (2, 2, 3) alone: C order puts it at (1 * 2 + 0) * 3 + 2, Fortran order at 1 + 2 (0 + 2 * 2).
        for (order, place) in [("False", 8), ("True", 9)] {
            let mut data = [0; 12];
            data[place] = 200;
            let voxels = voxels(&file("'|u1'", order, "(2, 2, 3)", &data)).expect("an array");
            assert_eq!((voxels.resolution(), voxels.solid_voxels()), ([2, 2, 3], 1));
            assert_eq!(voxels.material([1, 0, 2]), 1, "{order}");
        }
    }

    #[test]
    fn what_is_wrong_is_said() {
        for (bytes, cause) in [
            (b"junk".to_vec(), "ends within the first 8 bytes"),
            (file("'<f4'", "False", "(1, 1, 1)", &[0; 4]), "uint8 or bool"),
            (file("'|u1'", "False", "(1, 1)", &[0]), "shape is (1, 1)"),
            (file("'|u1'", "False", "(0, 1, 1)", &[]), "each 1 to 4096"),
            (file("'|u1'", "False", "(4097, 1, 1)", &[0; 4097]), "each 1 to 4096"),
            (file("'|u1'", "False", "(99999999999, 1, 1)", &[]), "shape is"),
            (file("'|u1'", "False", "(4096, 4096, 4096)", &[0; 4]), "promises 68719476736 voxels"),
            (file("'|u1'", "False", "(2, 2, 2)", &[0; 9]), "9 bytes follow"),
            (file("'|u1'", "maybe", "(1, 1, 1)", &[0]), "neither True nor False"),
        ] {
            let said = voxels(&bytes).expect_err(cause);
            assert!(said.contains(cause), "{said:?} does not say {cause:?}");
        }
    }
}
