//! Grids with one voxel along some axes, or with very many along one. Only grids have a resolution; others are tested
//! with the same rays.

use super::draw::{inwards, pick, sign};
use super::lattice::{border, in_plane};
use super::shapes::{CITY, city, triangles};
use super::{Case, Stage};
use crate::random::Random;
use crate::ray::Ray;
use glam::Vec3;

pub(super) const CASES: &[Case] = &[
    Case::new("res_1x1x1", "60 boxes with whole corners in one voxel", boxes).resolution("1x1x1"),
    Case::new("res_1xNx1", "the boxes in slabs: 1 x 64 x 1 voxels", boxes).resolution("1x64x1"),
    Case::new("res_Nx1x1", "the boxes in 64 x 1 x 1 voxels", boxes).resolution("64x1x1"),
    Case::new("res_NxNx1", "the boxes in columns: 64 x 64 x 1 voxels", boxes).resolution("64x64x1"),
    Case::new("res_17x17x17", "the boxes in voxels about as large as the lattice's cells", boxes)
        .resolution("17x17x17"),
    Case::new("res_1x4096x1", "the boxes in 4096 slabs", boxes).resolution("1x4096x1"),
    Case::new("res_2x3x4096", "the boxes in 2 x 3 x 4096 voxels", boxes).resolution("2x3x4096"),
];

/// Rays of all kinds of the family `lattice`.
fn boxes(random: &mut Random) -> Stage {
    let shoot = |random: &mut Random| match random.below(4) {
        0 => in_plane(random),
        1 => {
            let direction = Vec3::new(sign(random), sign(random), sign(random));
            let ray = in_plane(random);
            Ray::new(ray.origin - 16.0 * direction, direction)
        }
        2 => {
            let ray = border(random);
            let to = (ray.origin + ray.direction).round();
            // Along an axis through the corner.
            let mut direction = Vec3::ZERO;
            direction[random.below(3)] = sign(random);
            Ray::new(to - direction * pick(random, &[20.0, 0.5, 3.0]), direction)
        }
        _ => border(random),
    };
    Stage::new(triangles(city(random)), shoot, |random| inwards(random, CITY.0, CITY.1))
}
