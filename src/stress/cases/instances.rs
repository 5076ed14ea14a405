//! Instances of a closed mesh: affine transforms in f64, corners rounded to f32 once, as loaders bake them.
//!
//! Corners that triangles of one instance share stay equal to the bit, so every instance is closed; rays from inside hit.

use super::draw::{aim, axis, in_cube, inwards};
use super::shapes::{Mesh, triangles};
use super::{Case, Stage};
use crate::random::Random;
use crate::ray::Ray;
use glam::{DAffine3, DMat3, DQuat, DVec3, Vec3};

pub(super) const CASES: &[Case] = &[
    Case::new("instances_mirrored", "27 turned and mirrored copies of a bumpy sphere, rays from within them", |r| {
        copies(r, |r, at| {
            let signs = DVec3::from([(); 3].map(|()| if r.below(2) == 0 { -1.0 } else { 1.0 }));
            DAffine3::from_scale_rotation_translation(signs * r.within(0.5, 1.0), rotation(r), at * 3.0)
        })
    })
    .must_hit(),
    Case::new("instances_sheared", "27 copies sheared by up to 30 times their size, rays from within them", |r| {
        copies(r, |r, at| {
            let shear = DMat3::from_cols(
                DVec3::new(1.0, r.within(-30.0, 30.0), 0.0),
                DVec3::new(0.0, 1.0, r.within(-30.0, 30.0)),
                DVec3::new(r.within(-0.1, 0.1), 0.0, 1.0),
            );
            DAffine3 { matrix3: DMat3::from_quat(rotation(r)) * shear, translation: at * 20.0 }
        })
    })
    .must_hit(),
    Case::new(
        "instances_tiny",
        "27 copies 10^-5 in size, one apart, and one of 10^-12 at the zero; rays from within",
        |r| {
            let sized = |r: &mut Random, size: f64, at| {
                DAffine3::from_scale_rotation_translation(DVec3::splat(size), rotation(r), at)
            };
            let tiny = copies(r, |r, at| sized(r, if at == DVec3::ZERO { 1e-12 } else { 1e-5 }, at));
            // A ray that passes 27 dots costs next to nothing: times are compared with copies that rays meet.
            tiny.against(copies(r, |r, at| sized(r, 0.4, at)).geometry)
        },
    )
    .must_hit(),
];

fn rotation(random: &mut Random) -> DQuat {
    DQuat::from_axis_angle(random.direction(), random.within(0.0, std::f64::consts::TAU))
}

/// 3 x 3 x 3 copies; `place` gives the transform of the one at a point of whole numbers from -1 to 1.
fn copies(random: &mut Random, place: impl Fn(&mut Random, DVec3) -> DAffine3) -> Stage {
    let base = Mesh::sphere(8, 12, DVec3::ZERO, || random.within(1.0, 1.4));
    let steps = (0..27).map(|n| DVec3::new(f64::from(n % 3), f64::from(n / 3 % 3), f64::from(n / 9)) - 1.0);
    let made: Vec<(DAffine3, Mesh)> = steps
        .map(|at| {
            let transform = place(random, at);
            (transform, base.moved(|p| transform.transform_point3(p)))
        })
        .collect();
    let all: Vec<_> = made.iter().flat_map(|(_, mesh)| mesh.triangles()).collect();
    let size = all.iter().flatten().fold(0.0f32, |size, p| size.max(p.abs().max_element()));
    let shoot = move |random: &mut Random| {
        let (transform, mesh) = &made[random.below(made.len())];
        let within = in_cube(random).as_dvec3() * 0.3;
        let origin = transform.transform_point3(within).as_vec3();
        match random.below(4) {
            0 => {
                let corner = mesh.corner(random);
                aim(random, origin, corner)
            }
            1 | 2 => {
                let point = mesh.edge_point(random);
                aim(random, origin, point)
            }
            _ => Ray::new(origin, axis(random)),
        }
    };
    Stage::new(triangles(all), shoot, move |random| inwards(random, Vec3::ZERO, 2.0 * size))
}
