//! Terrain: hills with caves, of solid voxels.

use super::stock::{daylight, lambert};
use super::{Body, Entry, Options, Stage};
use crate::error::Result;
use crate::geometry::SolidVoxels;
use crate::random::Random;
use glam::{DVec3, Vec3};

pub(super) const ENTRY: Entry = Entry {
    name: "voxel-terrain",
    summary: "hills with caves, of solid voxels",
    options: "n: voxels along x and z, half as many along y (64); seed (1)",
    slots: "0 grass, 1 earth, 2 rock, 3 sand, 4 snow",
    source: "value noise of three octaves for the heights and one for the caves",
    keys: &["n", "seed"],
    body,
    stage,
};

/// `n` x `n / 2` x `n` voxels of edge 1, centred on the y axis, standing on y = 0.
///
/// Heights are between an eighth and seven eighths of `n / 2`. Caves are where a noise of cells of an eighth of `n` is above
/// 0.68, so that nearly a tenth of the ground is hollow.
fn body(options: &Options) -> Result<Body> {
    let n = options.n(64, 4..=512)?;
    let height = (n / 2).max(1);
    let mut random = Random::new(options.seed.unwrap_or(1));
    let (hills, caves) = (random.next(), random.next());
    let (size, tall) = (f64::from(n), f64::from(height));
    let ground = |x: u32, z: u32| {
        let at = DVec3::new(f64::from(x), 0.0, f64::from(z)) / size;
        let octaves = [(3.0, 4.0 / 7.0), (6.0, 2.0 / 7.0), (12.0, 1.0 / 7.0)];
        let sum: f64 = octaves.iter().map(|&(cells, share)| share * noise(at * cells, hills)).sum();
        tall * (0.125 + 0.75 * sum)
    };
    let mut materials = vec![0; (n * n) as usize * height as usize];
    for z in 0..n {
        for x in 0..n {
            let surface = ground(x, z);
            for y in 0..height {
                let level = f64::from(y) + 0.5;
                let at = DVec3::new(f64::from(x), f64::from(y), f64::from(z));
                if level > surface || noise(at * 8.0 / size, caves) > 0.68 {
                    continue;
                }
                let (depth, share) = (surface - level, level / tall);
                let slot = match () {
                    () if depth > 0.08 * tall => 2,
                    () if depth > 1.0 => 1,
                    () if share < 0.4 => 3,
                    () if share > 0.62 => 4,
                    () => 0,
                };
                materials[((z * height + y) * n + x) as usize] = slot + 1;
            }
        }
    }
    let corner = -((n / 2) as f32);
    let voxels = SolidVoxels::new([n, height, n], materials, Vec3::new(corner, 0.0, corner), 1.0)?;
    Ok(Body { voxels: Some(voxels), ..Body::default() })
}

/// Values of 0 to 1 at whole points, smoothly joined.
fn noise(at: DVec3, seed: u64) -> f64 {
    let cell = at.floor();
    let f = at - cell;
    let ease = f * f * (3.0 - 2.0 * f);
    let mut sum = 0.0;
    for corner in 0..8_u8 {
        let side = |bit: u8| f64::from(corner >> bit & 1);
        let offset = DVec3::new(side(0), side(1), side(2));
        let weight = (1.0 - offset - ease + 2.0 * offset * ease).element_product();
        sum += weight * value(cell + offset, seed);
    }
    sum
}

/// A number from 0 to 1 for a whole point.
fn value(point: DVec3, seed: u64) -> f64 {
    // Small whole numbers: the conversion is exact.
    let hash = point.to_array().iter().fold(seed, |hash, &c| {
        let mixed = hash.wrapping_add(c as i64 as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        Random::new(mixed).next()
    });
    Random::new(hash).unit()
}

fn stage(_: &Options) -> Stage {
    daylight(vec![
        lambert("grass", 0.2, 0.45, 0.12),
        lambert("earth", 0.35, 0.22, 0.12),
        lambert("rock", 0.4, 0.4, 0.42),
        lambert("sand", 0.65, 0.55, 0.32),
        lambert("snow", 0.8, 0.82, 0.85),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ground_is_hollow_in_part_and_repeats() {
        let made = |options: Options| body(&options).expect("valid options").voxels.expect("voxels");
        let voxels = made(Options::default());
        assert_eq!(voxels.resolution(), [64, 32, 64]);
        let bytes = voxels.materials();
        assert_eq!(bytes, made(Options { seed: Some(1), ..Options::default() }).materials());
        assert_ne!(bytes, made(Options { seed: Some(2), ..Options::default() }).materials());
        let count = |byte: u8| bytes.iter().filter(|&&b| b == byte).count();
        assert!((0..=5).all(|byte| count(byte) > 50), "{:?}", (0..=5).map(count).collect::<Vec<_>>());
        // Air below ground: empty with something above it in the same column.
        let hollow = (0..bytes.len()).filter(|&i| {
            let above = (1..32 - i / 64 % 32).map(|up| i + 64 * up);
            bytes[i] == 0 && above.clone().any(|j| bytes[j] != 0)
        });
        let share = hollow.count() as f64 / voxels.solid_voxels() as f64;
        assert!(share > 0.02 && share < 0.3, "{share}");
    }
}
