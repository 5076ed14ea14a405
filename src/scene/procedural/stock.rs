//! What several scenes by formula are made of: materials, lights, cameras, a floor, boxes.

use super::Stage;
use crate::scene::{Bsdf, Camera, CameraSource, Light, Material, Mesh, RenderDefaults};
use glam::{DVec3, Vec3};

pub(super) fn lambert(name: &str, r: f32, g: f32, b: f32) -> Material {
    let bsdf = Bsdf::Lambert { albedo: Vec3::new(r, g, b), texture: None };
    Material { name: name.into(), bsdf, emission: Vec3::ZERO }
}

pub(super) fn mirror(name: &str, share: f32) -> Material {
    let bsdf = Bsdf::Mirror { reflectance: Vec3::splat(share) };
    Material { name: name.into(), bsdf, emission: Vec3::ZERO }
}

/// White light that travels along (x, y, z).
pub(super) fn sun(x: f64, y: f64, z: f64, irradiance: f32) -> Light {
    Light::Directional { direction: DVec3::new(x, y, z).normalize(), irradiance: Vec3::splat(irradiance) }
}

pub(super) fn look(origin: [f64; 3], target: [f64; 3], up: DVec3, yfov: f64) -> Option<Camera> {
    let (origin, target) = (DVec3::from_array(origin), DVec3::from_array(target));
    Some(Camera { origin, target, up, yfov, source: CameraSource::File })
}

/// Daylight for a body that is seen by itself: a sun over the left shoulder and a dim sky; the camera is framed.
pub(super) fn daylight(palette: Vec<Material>) -> Stage {
    Stage {
        palette,
        props: Vec::new(),
        lights: vec![sun(-0.3, -0.8, -0.5, 2.0)],
        environment: Vec3::splat(0.3),
        camera: None,
        defaults: RenderDefaults::default(),
    }
}

/// A square at the given height, `half` to each side of (x, z) = (0, 0); its front looks up.
pub(super) fn floor(y: f32, half: f32) -> Mesh {
    Mesh {
        name: "floor".into(),
        positions: vec![
            Vec3::new(-half, y, half),
            Vec3::new(half, y, half),
            Vec3::new(half, y, -half),
            Vec3::new(-half, y, -half),
        ],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    }
}

/// The six outward quads of a box whose corner `i` is `corner(i & 1, i >> 1 & 1, i >> 2)`, two triangles each.
pub(super) fn box_mesh(name: &str, corner: impl Fn(bool, bool, bool) -> DVec3) -> Mesh {
    let positions = (0..8_u8).map(|i| corner(i & 1 != 0, i & 2 != 0, i & 4 != 0).as_vec3()).collect();
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Mesh { name: name.into(), positions, triangles, ..Mesh::default() }
}
