//! The digest of a scene as it was loaded: what a change of would change the picture, wherever it came from.
//!
//! Everything that the renderer reads goes in, bit by bit: meshes, spheres, voxels, patches, materials, texels, lights,
//! environment, camera. Names, warnings, and what the file asks of the renderer, which the command line states, stay
//! out; so do the files themselves: a comment that changed in one of them makes no other picture.

use super::hex;
use crate::geometry::Geometry;
use crate::scene::{Bsdf, Camera, Filter, Light, Material, Mesh, Scene, SceneGeometry, Texture};
use glam::{DVec3, Vec3};
use sha2::{Digest, Sha256};

/// SHA-256 of the scene as it was loaded, 64 hexadecimal digits.
pub fn scene_digest(scene: &Scene) -> String {
    // What is added to a scene must be thought of here.
    let Scene {
        name: _,
        geometry,
        meshes,
        mesh_offsets: _,
        spheres,
        sphere_materials,
        patch_materials,
        materials,
        textures,
        lights,
        environment,
        camera,
        defaults: _,
        warnings: _,
        notes: _,
    } = scene;
    let mut hash = Hash::default();
    match geometry {
        SceneGeometry::Voxels(voxels) => {
            hash.numbers(voxels.resolution());
            hash.bytes(voxels.materials());
            hash.point(voxels.origin());
            hash.f32s([voxels.edge()]);
        }
        SceneGeometry::Patches(patches) => {
            hash.length(Geometry::len(patches));
            (0..Geometry::len(patches)).for_each(|i| patches.points(i).iter().flatten().for_each(|p| hash.point(*p)));
        }
        // Made of the meshes and spheres below.
        SceneGeometry::Triangles(_) | SceneGeometry::Spheres(_) | SceneGeometry::Mixed(_) => {}
    }
    hash.list(meshes, mesh);
    hash.list(spheres, |hash, sphere| {
        hash.point(sphere.centre);
        hash.f32s([sphere.radius]);
    });
    hash.list(sphere_materials, |hash, &m| hash.numbers([m]));
    hash.list(patch_materials, |hash, &m| hash.numbers([m]));
    hash.list(materials, material);
    hash.list(textures, texture);
    hash.list(lights, light);
    hash.point(*environment);
    let Camera { origin, target, up, yfov, source: _ } = camera;
    [origin, target, up].into_iter().for_each(|p| hash.far_point(*p));
    hash.f64s([*yfov]);
    hash.finish()
}

fn mesh(hash: &mut Hash, mesh: &Mesh) {
    let Mesh { name: _, positions, triangles, normals, uvs, material } = mesh;
    hash.list(positions, |hash, p| hash.point(*p));
    hash.list(triangles, |hash, t| hash.numbers(*t));
    hash.list(normals, |hash, n| hash.point(*n));
    hash.list(uvs, |hash, uv| hash.f32s(uv.to_array()));
    hash.numbers([*material]);
}

fn material(hash: &mut Hash, material: &Material) {
    let Material { name: _, bsdf, emission } = material;
    hash.point(*emission);
    match bsdf {
        Bsdf::Lambert { albedo, texture } => {
            hash.numbers([0, u32::from(texture.is_some()), texture.unwrap_or(0)]);
            hash.point(*albedo);
        }
        Bsdf::Mirror { reflectance } => {
            hash.numbers([1]);
            hash.point(*reflectance);
        }
        Bsdf::Dielectric { ior } => {
            hash.numbers([2]);
            hash.f32s([*ior]);
        }
        Bsdf::Conductor { eta, k, reflectance, alpha } => {
            hash.numbers([3]);
            [eta, k, reflectance].into_iter().for_each(|c| hash.point(*c));
            hash.f32s([*alpha]);
        }
    }
}

fn texture(hash: &mut Hash, texture: &Texture) {
    let Texture { name: _, width, height, texels, srgb: _, filter } = texture;
    let filter = match filter {
        Filter::Nearest => 0,
        Filter::Bilinear => 1,
    };
    hash.numbers([*width, *height, filter]);
    hash.list(texels, |hash, texel| hash.point(*texel));
}

fn light(hash: &mut Hash, light: &Light) {
    match light {
        Light::Point { position, intensity } => {
            hash.numbers([0]);
            hash.far_point(*position);
            hash.point(*intensity);
        }
        Light::Spot { position, direction, intensity, cutoff, beam_width } => {
            hash.numbers([1]);
            hash.far_point(*position);
            hash.far_point(*direction);
            hash.point(*intensity);
            hash.f64s([*cutoff, *beam_width]);
        }
        Light::Directional { direction, irradiance } => {
            hash.numbers([2]);
            hash.far_point(*direction);
            hash.point(*irradiance);
        }
    }
}

/// SHA-256 of numbers in little endian; lists begin with their length, so that no two scenes give the same bytes.
#[derive(Default)]
struct Hash {
    inner: Sha256,
    /// What the next call of `update` will take: one call for each number is slow.
    waiting: Vec<u8>,
}

impl Hash {
    fn bytes(&mut self, bytes: &[u8]) {
        self.waiting.extend_from_slice(bytes);
        if self.waiting.len() >= 1 << 16 {
            self.inner.update(&self.waiting);
            self.waiting.clear();
        }
    }

    fn length(&mut self, length: impl Into<u64>) {
        self.bytes(&length.into().to_le_bytes());
    }

    fn list<T>(&mut self, items: &[T], each: impl Fn(&mut Self, &T)) {
        self.length(items.len() as u64);
        items.iter().for_each(|item| each(self, item));
    }

    fn numbers(&mut self, numbers: impl IntoIterator<Item = u32>) {
        numbers.into_iter().for_each(|n| self.bytes(&n.to_le_bytes()));
    }

    fn f32s(&mut self, values: impl IntoIterator<Item = f32>) {
        values.into_iter().for_each(|v| self.bytes(&v.to_le_bytes()));
    }

    fn f64s(&mut self, values: impl IntoIterator<Item = f64>) {
        values.into_iter().for_each(|v| self.bytes(&v.to_le_bytes()));
    }

    fn point(&mut self, point: Vec3) {
        self.f32s(point.to_array());
    }

    fn far_point(&mut self, point: DVec3) {
        self.f64s(point.to_array());
    }

    fn finish(mut self) -> String {
        self.inner.update(&self.waiting);
        hex(&self.inner.finalize())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::load;
    use std::collections::HashSet;

    #[test]
    fn what_changes_the_picture_changes_the_digest_and_a_name_does_not() {
        let scene = load("cornell", &Default::default()).expect("made by formula");
        let first = scene_digest(&scene);
        let named = Scene { name: "other".into(), notes: vec!["a note".into()], ..scene.clone() };
        assert_eq!(first, scene_digest(&named));
        type Change = fn(&mut Scene);
        let changes: [Change; 9] = [
            |s| s.meshes[0].positions[0].x = s.meshes[0].positions[0].x.next_up(),
            |s| s.meshes[0].triangles[0].rotate_left(1),
            |s| s.meshes[0].normals = vec![Vec3::Y; s.meshes[0].positions.len()],
            |s| s.meshes[0].material += 1,
            |s| s.materials[0].emission.x += 1.0,
            |s| s.materials[0].bsdf = Bsdf::Mirror { reflectance: Vec3::ONE },
            |s| s.lights.push(Light::Point { position: DVec3::ONE, intensity: Vec3::ONE }),
            |s| s.environment.z = 0.5,
            |s| s.camera.yfov = s.camera.yfov.next_up(),
        ];
        let mut seen = HashSet::from([first]);
        for (i, change) in changes.iter().enumerate() {
            let mut other = scene.clone();
            change(&mut other);
            assert!(seen.insert(scene_digest(&other)), "change {i}");
        }
        for name in ["voxel-terrain", "teapot-patches", "flakes", "random:n=100", "random:n=100,seed=2"] {
            let other = load(name, &Default::default()).expect("made by formula");
            assert!(seen.insert(scene_digest(&other)), "{name}");
        }
    }
}
