//! The scenes of Haines' Standard Procedural Databases (SPD), generated from their published numbers.
//!
//! Source: E. Haines, "A Proposal for Standard Graphics Environments", IEEE Computer Graphics & Applications 7(11), 1987,
//! and the readme and file headers of SPD 3.14 (2005), which is in the public domain. Option `n` is SPD's size factor;
//! left out, the size is the standard one, under 10 000 primitives. Coordinates, counts, camera, lights and background
//! are SPD's own, right-handed. What differs:
//!
//! - Cones and cylinders are meshes of `2 * sides` triangles with smooth normals, inscribed and without caps. 16 sides
//!   are what SPD itself writes where it tessellates. Polygons are cut into triangles. Spheres stay spheres.
//! - SPD's surfaces scatter (Kd) and mirror (Ks) at once. Here a surface is a mirror of reflectance colour * Ks if Ks is
//!   at least Kd, else Lambert of albedo colour * Kd. Transparent ones are clear glass of the same index of refraction.
//! - SPD's lights do not weaken with distance. Here each weakens with the square of it, and gives a surface at the point
//!   looked at what it gives in SPD, with SPD's recommended intensity `sqrt(L) / 2L` for each of `L` lights. There is no
//!   ambient term; the background is an environment, which lights the scene where the integrator lets it.
//!
//! SPD's NURBS test, `nurbtst`, is left out: a single surface without anything for an accelerator to do.

pub(super) mod balls;
pub(super) mod gears;
pub(super) mod jacks;
pub(super) mod lattice;
pub(super) mod mount;
pub(super) mod rings;
mod setting;
pub(super) mod shells;
pub(super) mod sombrero;
pub(super) mod teapot;
pub(super) mod tetra;
pub(super) mod tree;
mod tube;

use super::{Body, Entry, Mesh, Options, Stage};
use crate::error::{Error, Result};
use crate::ray::Ray;
use crate::scene::Camera;
use glam::Vec3;

/// A scene of SPD at its standard size, with what is published of it.
#[derive(Clone, Copy, Debug)]
pub struct Published {
    /// Name in [`super::ENTRIES`]; also the specification of the standard size.
    pub name: &'static str,
    /// Primitives as SPD counts them: cones, cylinders, and polygons of any number of corners are one each.
    pub primitives: u32,
    /// Those of [`eye_rays`] that hit something, after the readme of SPD 3.14.
    pub hits_haines: Option<u32>,
    /// The same after Havran & Sixta, "Comparison of Hierarchical Grids", Ray Tracing News 12(1), 1999.
    pub hits_havran: Option<u32>,
}

/// All scenes in alphabetical order.
pub const SCENES: &[Published] = &[
    published("spd-balls", 7382, Some(263_169), Some(263_169)),
    published("spd-gears", 9345, Some(245_086), Some(245_332)),
    published("spd-jacks", 9, None, None),
    published("spd-lattice", 8281, None, Some(261_170)),
    published("spd-mount", 8196, Some(173_125), Some(173_685)),
    published("spd-rings", 8401, Some(263_169), Some(263_169)),
    published("spd-shells", 5761, None, None),
    published("spd-sombrero", 1922, None, None),
    published("spd-teapot", 9264, Some(161_120), Some(161_546)),
    published("spd-tetra", 4096, Some(49_788), Some(49_950)),
    published("spd-tree", 8191, Some(169_836), Some(169_907)),
];

const fn published(
    name: &'static str,
    primitives: u32,
    hits_haines: Option<u32>,
    hits_havran: Option<u32>,
) -> Published {
    Published { name, primitives, hits_haines, hits_havran }
}

/// Pixels on a side of SPD's pictures, whose corners [`eye_rays`] go through.
pub const PIXELS: u32 = 512;

/// SPD's eye rays: one through each of the 513 x 513 corners of the pixels of a 512 x 512 picture, row by row from the
/// top left, directions of unit length.
///
/// ```
/// use skipgrid::scene::{LoadOptions, load, procedural::spd};
/// let scene = load("spd-tetra:n=1", &LoadOptions::default())?;
/// let accel = scene.accel("brute")?;
/// let hits = spd::eye_rays(&scene.camera).iter().filter(|ray| accel.any_hit(ray)).count();
/// assert!(hits > 0 && hits < 513 * 513);
/// # Ok::<(), skipgrid::Error>(())
/// ```
pub fn eye_rays(camera: &Camera) -> Vec<Ray> {
    let origin = camera.origin.as_vec3();
    let corners = (0..=PIXELS).flat_map(|y| (0..=PIXELS).map(move |x| (f64::from(x), f64::from(y))));
    corners.map(|(x, y)| Ray::new(origin, camera.direction(x, y, PIXELS, PIXELS).as_vec3())).collect()
}

/// Most primitives of a scene, so that no size factor asks for more memory than there is.
const MOST: u64 = 5_000_000;

impl Options {
    /// Refuses sizes that run away; `count` is the number of triangles and spheres, saturated.
    fn limit_size(&self, count: u64) -> Result<()> {
        if count > MOST {
            return Err(Error::invalid(format!("{count} primitives, at most {MOST} are made")));
        }
        self.limit(count)
    }
}

/// A flat quadrilateral of two triangles; its front has the corners counter-clockwise.
fn quad(name: &str, corners: [[f64; 3]; 4]) -> Mesh {
    Mesh {
        name: name.into(),
        positions: corners.map(|[x, y, z]| Vec3::new(x as f32, y as f32, z as f32)).to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::procedural;

    #[test]
    fn every_scene_is_an_entry_and_the_other_way_round() {
        let entries = procedural::ENTRIES.iter().map(|e| e.name).filter(|name| name.starts_with("spd-"));
        assert_eq!(entries.collect::<Vec<_>>(), SCENES.iter().map(|s| s.name).collect::<Vec<_>>());
    }

    #[test]
    fn sizes_that_run_away_are_refused_before_anything_is_made() {
        for scene in SCENES {
            for n in ["1000000", "18446744073709551615"] {
                let error = procedural::parse(&format!("{}:n={n}", scene.name)).expect_err(scene.name).to_string();
                assert!(error.contains(scene.name) && error.contains(n), "{error}");
            }
            assert!(procedural::parse(&format!("{}:n=0", scene.name)).is_err(), "{}", scene.name);
        }
        for (spec, cause) in [
            ("spd-gears:n=21", "5297294 primitives, at most 5000000 are made"),
            ("spd-tree:n=17", "8650721 primitives, at most"),
            ("spd-tree:n=16,sides=64", "at most 5000000"),
            ("spd-mount:n=11", "n=11 is not within 1 to 10"),
            ("spd-lattice:sides=2", "sides=2 is not within 3 to 256"),
        ] {
            let error = procedural::parse(spec).expect_err(spec).to_string();
            assert!(error.contains(cause), "{error}");
        }
    }

    #[test]
    fn eye_rays_go_through_the_corners_of_the_picture() {
        let camera = procedural::parse("spd-balls").expect("a scene").camera.expect("a camera");
        let rays = eye_rays(&camera);
        assert_eq!(rays.len(), 263_169);
        let [forward, right, up] = camera.basis();
        let tan = 22.5_f64.to_radians().tan();
        for (i, x, y) in [(0, -1.0, 1.0), (512, 1.0, 1.0), (131_584, 0.0, 0.0), (263_168, 1.0, -1.0)] {
            let d = rays[i].direction.as_dvec3();
            let (dx, dy) = (d.dot(right) / d.dot(forward) / tan, d.dot(up) / d.dot(forward) / tan);
            // Half an f32 ulp of each component, seen through the tangent.
            assert!((dx - x).abs() < 1e-6 && (dy - y).abs() < 1e-6, "{i}: {dx} {dy}");
        }
    }
}
