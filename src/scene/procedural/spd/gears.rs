//! Gears: meshed toothed wheels whose faces are concave polygons, some of glass.

use super::setting::{Setting, glass, surface};
use super::{Body, Entry, Mesh, Options, Stage, quad};
use crate::error::Result;
use crate::scene::Material;
use glam::DVec3;

pub(in super::super) const ENTRY: Entry = Entry {
    name: "spd-gears",
    summary: "SPD gears: 64 meshed gears of 572 triangles, a fifth of them glass, and a floor; z up",
    options: "n: size factor, gears along an edge (4)",
    slots: "gear x + n (y + n z) has that slot",
    source: "Haines 1987, SPD 3.14 gears",
    keys: &["n"],
    body,
    stage,
};

const TEETH: u32 = 36;
/// Teeth reach from this share of the pitch radius ..
const INNER: f64 = 0.9;
/// .. to this one; the rest is a gap, so that meshed gears do not touch.
const OUTER: f64 = 0.995;

/// Two faces of 144 corners and 144 side walls, in triangles.
const TRIANGLES: u64 = 2 * (4 * TEETH as u64 - 2) + 2 * 4 * TEETH as u64;

fn body(options: &Options) -> Result<Body> {
    let n = options.n(4, 1..=1000)?;
    options.limit_size(TRIANGLES * u64::from(n).pow(3) + 2)?;
    let size = f64::from(n);
    let radius = 1.0 / (size - (size - 1.0) * (1.0 - INNER) / 2.0);
    let place = |i: u32| radius - 1.0 + f64::from(i) * radius * (1.0 + INNER);
    let thickness = (1.0 / (2.0 * size)).min(0.1);
    let mut meshes = Vec::new();
    for [x, y, z] in gears(n) {
        let centre = DVec3::new(place(x), place(y), 1.0 - f64::from(z) / size);
        // Neighbours are turned by half a tooth.
        let phase = if (x + y + z) % 2 == 1 { 0.5 } else { 0.0 };
        let mut mesh = gear(centre, radius, phase, thickness);
        mesh.material = x + n * (y + n * z);
        meshes.push(mesh);
    }
    Ok(Body { meshes, ..Body::default() })
}

/// Column, row and layer of all gears, columns first.
fn gears(n: u32) -> impl Iterator<Item = [u32; 3]> {
    (0..n).flat_map(move |z| (0..n).flat_map(move |y| (0..n).map(move |x| [x, y, z])))
}

/// A gear about the vertical through `centre`, its top at `centre`; `phase` in teeth.
fn gear(centre: DVec3, radius: f64, phase: f64, thickness: f64) -> Mesh {
    let mut mesh = Mesh { name: "gear".into(), ..Mesh::default() };
    let corners = 4 * TEETH;
    for depth in [0.0, thickness] {
        for tooth in 0..TEETH {
            for (turn, share) in [(-0.19, OUTER), (0.19, OUTER), (0.3, INNER), (0.7, INNER)] {
                let angle = (360.0 / f64::from(TEETH) * (f64::from(tooth) + turn + phase)).to_radians();
                let out = DVec3::new(angle.cos(), angle.sin(), 0.0) * share * radius;
                mesh.positions.push((centre + out - depth * DVec3::Z).as_vec3());
            }
        }
    }
    let top = face();
    for i in 0..corners {
        let next = (i + 1) % corners;
        mesh.triangles.extend([[i, i + corners, next + corners], [i, next + corners, next]]);
    }
    mesh.triangles.extend(top.iter().map(|&[a, b, c]| [a + corners, c + corners, b + corners]));
    mesh.triangles.extend(top);
    mesh
}

/// The triangles of the upper face: two for each tooth, and the polygon of the teeth's feet, which is convex.
fn face() -> Vec<[u32; 3]> {
    let mut triangles = Vec::new();
    let corners = 4 * TEETH;
    for first in (0..corners).step_by(4) {
        let foot = (first + corners - 1) % corners;
        triangles.extend([[foot, first, first + 1], [foot, first + 1, first + 2]]);
    }
    let mut ring: Vec<u32> = (0..corners).filter(|i| i % 4 > 1).collect();
    // Cut off every other corner, again and again.
    while ring.len() > 2 {
        let next = |i: usize| ring[(i + 1) % ring.len()];
        triangles.extend((1..ring.len()).step_by(2).map(|i| [ring[i - 1], ring[i], next(i)]));
        ring = ring.into_iter().step_by(2).collect();
    }
    triangles
}

/// SPD's "pseudo-random" colours, the greatest channel 1; every fifth or so is glass.
fn material([x, y, z]: [u32; 3]) -> Material {
    if (4 * x + 2 * y + z) % 5 == 0 {
        return glass(1.1);
    }
    // The fraction of i * k / 7, in exact sevenths.
    let channel = |i: u32, k: u32| 0.01 + (i * k % 7) as f32 / 7.0;
    let colour =
        [channel(3 * x + 2 * y + z + 1, 5), channel(3 * y + 2 * z + x + 1, 3), channel(3 * z + 2 * x + y + 1, 2)];
    let most = colour.into_iter().fold(0.0, f32::max);
    surface("gear", colour.map(|c| c / most), 1.0, 0.0)
}

fn stage(options: &Options) -> Stage {
    let setting = Setting {
        from: [-1.1, -2.1, 2.6],
        lights: &[
            [2.0, 4.0, 4.0],
            [-2.0, 4.0, 3.0],
            [2.0, -2.5, 2.5],
            [-1.0, -4.0, 2.0],
            // Just behind the eye.
            [-1.111, -2.121, 2.626],
        ],
        ..Setting::USUAL
    };
    let ground = quad("ground", [[2.0, 2.0, 0.0], [-2.0, 2.0, 0.0], [-2.0, -2.0, 0.0], [2.0, -2.0, 0.0]]);
    let ground = (ground, surface("ground", [1.0, 0.85, 0.7], 0.3, 0.6));
    // The body has refused a size that is out of range.
    let n = options.n(4, 1..=1000).unwrap_or(1);
    setting.stage(gears(n).map(material).collect(), vec![ground])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn standard_size_has_the_original_count_and_sum() {
        let meshes = body(&Options::default()).expect("the standard size").meshes;
        // 2 faces and 144 walls for each gear, and the ground: 9345.
        assert_eq!(meshes.len() * (2 + 144) + 1, 9345);
        let mut sum = 0.0;
        for mesh in &meshes {
            assert_eq!((mesh.positions.len(), mesh.triangles.len()), (288, 572));
            // Each corner belongs to a face and two walls.
            sum += 3.0 * mesh.positions.iter().map(|p| f64::from(p.z)).sum::<f64>();
        }
        // 55296 roundings of f32 values below 1, and the four digits of the sum.
        assert!((sum - 31795.2).abs() < 2e-2, "{sum}");
        let far = meshes.iter().flat_map(|m| &m.positions).fold(0.0, |far: f32, p| far.max(p.x.abs()).max(p.y.abs()));
        assert!(far < 1.0, "{far}");
    }

    #[test]
    fn faces_are_cut_without_overlap() {
        let mesh = gear(DVec3::ZERO, 1.0, 0.0, 0.1);
        let area2 = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| mesh.positions[i as usize].as_dvec3());
            (b - a).cross(c - a).z
        };
        let face = face();
        assert_eq!(face.len(), 142);
        assert!(face.iter().all(|t| area2(t) > 0.0));
        // Shoelace formula over the outline; triangles of positive area that add up to it do not overlap.
        let corner = |i: usize| mesh.positions[i % 144].as_dvec3();
        let outline: f64 = (0..144).map(|i| corner(i).cross(corner(i + 1)).z).sum();
        assert!((face.iter().map(area2).sum::<f64>() - outline).abs() < 1e-9, "{outline}");
    }

    #[test]
    fn one_gear_of_five_is_glass_and_colours_reach_one() {
        let materials: Vec<_> = gears(4).map(material).collect();
        // (4 x + 2 y + z) mod 5 is 0 for 13 of the 64 gears of four layers.
        assert_eq!(materials.iter().filter(|m| m.name == "glass").count(), 13);
        for m in materials.iter().filter(|m| m.name != "glass") {
            let crate::scene::Bsdf::Lambert { albedo, .. } = m.bsdf else { panic!("{m:?}") };
            assert_eq!(albedo.max_element(), 1.0);
        }
    }
}
