//! Solid voxels, which have a walk of their own.

use super::draw::{axis, in_cube, inwards, pick, sign, unit, whole};
use super::shapes::triangles;
use super::{Case, Stage};
use crate::geometry::SolidVoxels;
use crate::random::Random;
use crate::ray::Ray;
use crate::scene::SceneGeometry;
use glam::Vec3;

pub(super) const CASES: &[Case] = &[
    Case::new(
        "solid_lattice",
        "12 x 12 x 12 voxels of edge 1, one in four solid, rays at corners, along edges, in planes",
        |r| voxels(r, Vec3::ZERO, 1.0),
    ),
    Case::new("solid_offset", "the same with edges of 0.3 at (1000.1, -700.7, 1e4): planes where f32 puts them", |r| {
        voxels(r, Vec3::new(1000.1, -700.7, 1e4), 0.3)
    }),
];

fn voxels(random: &mut Random, least: Vec3, edge: f32) -> Stage {
    let materials = (0..12 * 12 * 12).map(|_| u8::from(random.below(4) == 0)).collect();
    let geometry = match SolidVoxels::new([12; 3], materials, least, edge) {
        Ok(voxels) => SceneGeometry::Voxels(voxels),
        // Not reached: the numbers above are in range. An empty scene would be seen, since nothing is hit.
        Err(_) => triangles(Vec::new()),
    };
    let corner = move |random: &mut Random| {
        // As the voxels compute their planes: in f64, rounded once.
        let steps = [(); 3].map(|()| f64::from(whole(random, 0, 12)));
        let at = |k: usize| (f64::from(least[k]) + steps[k] * f64::from(edge)) as f32;
        Vec3::new(at(0), at(1), at(2))
    };
    let middle = least + 6.0 * edge;
    let shoot = move |random: &mut Random| {
        let (target, mut other) = (corner(random), corner(random));
        match random.below(5) {
            0 => {
                let direction = axis(random);
                Ray::new(target - direction * pick(random, &[15.0, 0.5]) * edge, direction)
            }
            1 => {
                let direction = Vec3::new(sign(random), sign(random), sign(random));
                Ray::new(target - direction * 8.0 * edge, direction)
            }
            2 => {
                // Within a plane between voxels.
                let k = random.below(3);
                other[k] = target[k];
                let direction = target - other;
                Ray::new(other, if direction == Vec3::ZERO { Vec3::X } else { direction })
            }
            3 => {
                let origin = middle + in_cube(random) * 12.0 * edge;
                Ray::new(origin, target - origin)
            }
            _ => Ray::new(middle + in_cube(random) * 6.0 * edge, unit(random)),
        }
    };
    Stage::new(geometry, shoot, move |random| inwards(random, middle, 12.0 * edge))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_voxels_can_be_made() {
        for case in CASES {
            assert!(matches!(case.stage().geometry, SceneGeometry::Voxels(_)), "{}", case.name);
        }
    }
}
