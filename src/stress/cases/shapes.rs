//! Meshes and sets of triangles that several families share.

use super::draw::{in_box, in_cube, pick, whole};
use crate::geometry::{Mixed, Sphere, Triangle};
use crate::random::Random;
use crate::scene::SceneGeometry;
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// A mesh whose triangles share corners to the bit.
#[derive(Clone, Debug)]
pub(super) struct Mesh {
    pub corners: Vec<Vec3>,
    pub faces: Vec<[usize; 3]>,
}

impl Mesh {
    /// A sphere of `rings` bands, each of `segments` quads but for the caps, about `centre`; `radius` gives the distance
    /// of each corner. It is closed: 2 segments (rings - 1) triangles.
    pub fn sphere(rings: usize, segments: usize, centre: DVec3, mut radius: impl FnMut() -> f64) -> Self {
        let mut corners = vec![(centre + radius() * DVec3::Z).as_vec3()];
        for ring in 1..rings {
            let polar = std::f64::consts::PI * ring as f64 / rings as f64;
            for segment in 0..segments {
                let (sin, cos) = (std::f64::consts::TAU * segment as f64 / segments as f64).sin_cos();
                let direction = DVec3::new(polar.sin() * cos, polar.sin() * sin, polar.cos());
                corners.push((centre + radius() * direction).as_vec3());
            }
        }
        corners.push((centre - radius() * DVec3::Z).as_vec3());
        let (at, last) = (|ring: usize, i: usize| 1 + (ring - 1) * segments + i % segments, corners.len() - 1);
        let mut faces = Vec::new();
        for i in 0..segments {
            faces.push([0, at(1, i), at(1, i + 1)]);
            for ring in 1..rings - 1 {
                let [a, b, c, d] = [at(ring, i), at(ring + 1, i), at(ring + 1, i + 1), at(ring, i + 1)];
                faces.extend([[a, b, c], [a, c, d]]);
            }
            faces.push([last, at(rings - 1, i + 1), at(rings - 1, i)]);
        }
        Self { corners, faces }
    }

    pub fn triangles(&self) -> Vec<Triangle> {
        self.faces.iter().map(|face| face.map(|i| self.corners[i])).collect()
    }

    /// Every corner moved by `place`, computed in f64 and rounded once.
    pub fn moved(&self, place: impl Fn(DVec3) -> DVec3) -> Self {
        Self {
            corners: self.corners.iter().map(|p| place(p.as_dvec3()).as_vec3()).collect(),
            faces: self.faces.clone(),
        }
    }

    /// A random corner.
    pub fn corner(&self, random: &mut Random) -> Vec3 {
        pick(random, &self.corners)
    }

    /// A random point of a random edge, as f32 holds it.
    pub fn edge_point(&self, random: &mut Random) -> Vec3 {
        let (face, k, s) = (pick(random, &self.faces), random.below(3), random.unit());
        let [a, b] = [face[k], face[(k + 1) % 3]].map(|i| self.corners[i].as_dvec3());
        (a + s * (b - a)).as_vec3()
    }
}

/// `n` triangles with corners within 1 of a random point of the cube from 0 to 10.
pub(super) fn soup(random: &mut Random, n: usize) -> Vec<Triangle> {
    (0..n)
        .map(|_| {
            let p = in_box(random, 0.0, 10.0);
            [(); 3].map(|()| p + in_cube(random))
        })
        .collect()
}

/// Middle and size of the box around [`soup`].
pub(super) const SOUP: (Vec3, f32) = (Vec3::splat(5.0), 12.0);

/// The twelve triangles of a box.
pub(super) fn cuboid(min: Vec3, max: Vec3) -> Vec<Triangle> {
    let at = |k: usize| Vec3::new([min.x, max.x][k & 1], [min.y, max.y][k >> 1 & 1], [min.z, max.z][k >> 2 & 1]);
    [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]]
        .iter()
        .flat_map(|&[a, b, c, d]| [[at(a), at(b), at(c)], [at(a), at(c), at(d)]])
        .collect()
}

/// Sixty boxes with whole corners from 0 to 17, many of them touching.
pub(super) fn city(random: &mut Random) -> Vec<Triangle> {
    (0..60)
        .flat_map(|_| {
            let low = Vec3::from([(); 3].map(|()| whole(random, 0, 14)));
            let size = Vec3::from([(); 3].map(|()| whole(random, 1, 3)));
            cuboid(low, low + size)
        })
        .collect()
}

/// Middle and size of the box around [`city`].
pub(super) const CITY: (Vec3, f32) = (Vec3::splat(8.5), 17.0);

/// A set of triangles as scenes have it.
pub(super) fn triangles(list: Vec<Triangle>) -> SceneGeometry {
    SceneGeometry::Triangles(Arc::new(list))
}

/// A set of spheres as scenes have it.
pub(super) fn spheres(list: Vec<Sphere>) -> SceneGeometry {
    SceneGeometry::Spheres(Arc::new(list))
}

/// A set of both as scenes have it.
pub(super) fn mixed(triangles: Vec<Triangle>, spheres: Vec<Sphere>) -> SceneGeometry {
    SceneGeometry::Mixed(Arc::new(Mixed { triangles, spheres }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashMap;

    #[test]
    fn spheres_and_boxes_are_closed() {
        let sphere = Mesh::sphere(16, 24, DVec3::ZERO, || 1.0);
        assert_eq!(sphere.faces.len(), 720);
        for list in [sphere.triangles(), cuboid(Vec3::ZERO, Vec3::ONE)] {
            // Every edge is run through once in each direction.
            let mut edges = HashMap::new();
            for t in &list {
                for k in 0..3 {
                    let [a, b] = [t[k], t[(k + 1) % 3]].map(|p| p.to_array().map(f32::to_bits));
                    *edges.entry((a.min(b), a.max(b))).or_insert(0) += if a < b { 1 } else { -1 };
                }
            }
            assert!(edges.values().all(|&sum| sum == 0));
            assert_eq!(edges.len() * 2, list.len() * 3);
        }
    }
}
