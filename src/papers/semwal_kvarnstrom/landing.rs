//! What the printed landing rule gets wrong, where it shows most: boxes that fill single voxels.
//!
//! A leap of D - 1 city-block units can pass over a filled voxel. The answer is wrong only if the primitive that is hit
//! stands in no voxel that is still visited: large primitives hide the fault, boxes of one voxel show all of it.

use super::super::PLAIN;
use super::super::trace::{ask, check};
use crate::error::Result;
use crate::random::Random;
use crate::ray::Ray;
use crate::scene::{Mesh, Scene, SceneParts};
use glam::{DVec3, Vec3};

/// Rays that the printed landing rule answers wrongly.
#[derive(Clone, Debug)]
pub struct Landing {
    /// Name.
    pub scene: String,
    /// Voxels on each axis.
    pub grid: u32,
    /// Specification.
    pub method: String,
    /// All rays.
    pub rays: u64,
    /// Those whose answer differs from the plain grid's.
    pub wrong: u64,
}

/// Voxels on each axis of the boxes' grid.
const COUNT: u32 = 48;

/// Shares of voxels that are filled.
const SHARES: [f64; 2] = [0.001, 0.01];

/// Boxes are drawn in by this much, so that they lie in no other voxel; a voxel is padded by half of it.
const GAP: f32 = 1.0 / 1024.0;

/// How far the outermost boxes stay from the grid's ends: the grid pads its bounds by a 1024th of their extent on each side,
/// so that voxels are of unit size exactly.
const RIM: f32 = COUNT as f32 / 1026.0;

/// Boxes in randomly chosen voxels; `size` squared rays from random points in random directions. Each method with the
/// paper's threshold for leaping and without one.
///
/// # Errors
/// As [`Scene::accel`].
pub fn on_boxes(methods: &[&str], size: u32) -> Result<Vec<Landing>> {
    let mut landings = Vec::new();
    for share in SHARES {
        let mut random = Random::new(1);
        let scene = boxes(share, &mut random)?;
        let rays: Vec<Ray> = (0..size * size).map(|_| ray(&mut random)).collect();
        let plain = scene.accel(&format!("{PLAIN}:resolution={COUNT}"))?;
        let asked = ask(&rays, &*plain);
        for method in methods {
            for rule in ["landing=paper", "landing=paper,threshold=1"] {
                let method = format!("{method}:{rule}");
                let accel = scene.accel(&format!("{method},resolution={COUNT}"))?;
                let wrong = check(&asked, &*accel).1;
                let scene = format!("boxes in {} % of the voxels", 100.0 * share);
                landings.push(Landing { scene, grid: COUNT, method, rays: asked.len() as u64, wrong });
            }
        }
    }
    Ok(landings)
}

/// Unit voxels from 0 to [`COUNT`] on each axis; boxes in opposite corners hold the grid's bounds in place.
fn boxes(share: f64, random: &mut Random) -> Result<Scene> {
    let all = COUNT.pow(3);
    let mut mesh = Mesh { name: "boxes".into(), ..Mesh::default() };
    for voxel in 0..all {
        if voxel == 0 || voxel == all - 1 || random.unit() < share {
            add_box(&mut mesh, [voxel % COUNT, voxel / COUNT % COUNT, voxel / COUNT / COUNT]);
        }
    }
    Scene::new(SceneParts { name: "boxes".into(), meshes: vec![mesh], ..SceneParts::default() })
}

/// The box of a voxel.
fn add_box(mesh: &mut Mesh, voxel: [u32; 3]) {
    let first = mesh.positions.len() as u32;
    let least = voxel.map(|i| (i as f32 + GAP).max(RIM));
    let most = voxel.map(|i| ((i + 1) as f32 - GAP).min(COUNT as f32 - RIM));
    let corner = |i: u32| [0, 1, 2].map(|axis| if i >> axis & 1 == 0 { least[axis] } else { most[axis] });
    mesh.positions.extend((0..8).map(|i| Vec3::from_array(corner(i))));
    for [a, b, c, d] in [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]] {
        mesh.triangles.extend([[a, b, c], [a, c, d]].map(|t| t.map(|i| first + i)));
    }
}

fn ray(random: &mut Random) -> Ray {
    let mut along = || random.within(0.0, f64::from(COUNT));
    let origin = DVec3::new(along(), along(), along());
    Ray::new(origin.as_vec3(), random.direction().as_vec3())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_box_lies_in_one_voxel() {
        let scene = boxes(0.001, &mut Random::new(1)).expect("a valid scene");
        let accel = scene.accel("grid:resolution=48").expect("builds");
        let triangles = u64::from(scene.triangle_count());
        // Four bytes for each triangle in each voxel.
        assert!(triangles > 12 * 60, "{triangles}");
        assert_eq!(accel.memory().references, 4 * triangles);
    }
}
