//! Closed surfaces seen from inside, and a plane seen from above: every ray hits, so a miss is a leak.

use super::draw::{aim, axis, in_cube, pick, sign, unit, whole};
use super::shapes::{Mesh, cuboid, triangles};
use super::{Case, Stage};
use crate::random::Random;
use crate::ray::Ray;
use glam::{DVec3, Vec3};

pub(super) const CASES: &[Case] = &[
    Case::new("wt_sphere_rand", "bumpy sphere 16 x 24, radius 1 to 1.4, random rays from within 0.4", |r| {
        ball(r, |r, m, o| aimed(r, m, o, At::Anything))
    })
    .must_hit(),
    Case::new("wt_sphere_vertex", "the bumpy sphere, rays at its corners", |r| {
        ball(r, |r, m, o| aimed(r, m, o, At::Corner))
    })
    .must_hit(),
    Case::new("wt_sphere_edge", "the bumpy sphere, rays at points of its edges", |r| {
        ball(r, |r, m, o| aimed(r, m, o, At::Edge))
    })
    .must_hit(),
    Case::new("wt_spiky", "sphere 16 x 24 of radius 1 to 6, random rays, at corners, at edges and along axes", |r| {
        closed(sphere(r, 16, 24, DVec3::ZERO, (1.0, 6.0)), DVec3::ZERO, 0.4, any)
    })
    .must_hit(),
    Case::new("wt_embree_pos", "sphere 32 x 48 of radius 2 where Embree tests watertightness", |r| {
        closed(sphere(r, 32, 48, EMBREE, (2.0, 2.0)), EMBREE, 1.0, |r, _, o| Ray::new(o, in_cube(r)))
    })
    .must_hit(),
    Case::new("wt_plane_embree", "plane of 30 x 30 quads at Embree's distance, from 3 above", |_| plane()).must_hit(),
    Case::new("wt_offset_1e3", "sphere of radius 2 at (1.1, -0.7, 1) 10^3", |r| offset(r, 1e3, 2.0)).must_hit(),
    Case::new("wt_offset_1e5", "sphere of radius 2 at (1.1, -0.7, 1) 10^5", |r| offset(r, 1e5, 2.0)).must_hit(),
    Case::new("wt_offset_1e7", "sphere of radius 60 at (1.1, -0.7, 1) 10^7", |r| offset(r, 1e7, 60.0)).must_hit(),
    Case::new("wt_box_lattice", "box of side 16, 8 x 8 quads a face, whole origins and directions", |_| lattice())
        .must_hit(),
    Case::new("wt_box_diag", "box of side 2, diagonals and those of its faces, exact and at unit length", |_| {
        diagonals()
    })
    .must_hit(),
    Case::new("wt_scale_1e-20", "the bumpy sphere times 10^-20", |r| scaled(r, 1e-20)).must_hit(),
    Case::new("wt_scale_1e-12", "the bumpy sphere times 10^-12", |r| scaled(r, 1e-12)).must_hit(),
    Case::new("wt_scale_1e12", "the bumpy sphere times 10^12", |r| scaled(r, 1e12)).must_hit(),
    Case::new("wt_scale_1e18", "the bumpy sphere times 10^18", |r| scaled(r, 1e18)).must_hit(),
    Case::new("wt_scale_1e20", "the bumpy sphere times 10^20", |r| scaled(r, 1e20)).must_hit(),
];

/// Where Embree's own test of watertightness has its sphere.
const EMBREE: DVec3 = DVec3::new(148_376.0, 1234.0, -223_423.0);

/// What a ray is aimed at.
#[derive(Clone, Copy)]
pub(super) enum At {
    Anything,
    Corner,
    Edge,
    Axis,
}

/// A ray from `origin` inside `mesh`.
pub(super) fn aimed(random: &mut Random, mesh: &Mesh, origin: Vec3, at: At) -> Ray {
    match at {
        At::Anything => Ray::new(origin, unit(random)),
        At::Corner => {
            let corner = mesh.corner(random);
            aim(random, origin, corner)
        }
        At::Edge => {
            let point = mesh.edge_point(random);
            aim(random, origin, point)
        }
        At::Axis => Ray::new(origin, axis(random)),
    }
}

/// A ray of any of the four kinds.
pub(super) fn any(random: &mut Random, mesh: &Mesh, origin: Vec3) -> Ray {
    let at = pick(random, &[At::Anything, At::Corner, At::Edge, At::Axis]);
    aimed(random, mesh, origin, at)
}

fn sphere(random: &mut Random, rings: usize, segments: usize, centre: DVec3, (low, high): (f64, f64)) -> Mesh {
    Mesh::sphere(rings, segments, centre, || random.within(low, high))
}

/// Rays from the cube of half width `room` about `centre`, within the closed `mesh`.
fn closed(
    mesh: Mesh,
    centre: DVec3,
    room: f64,
    shoot: impl Fn(&mut Random, &Mesh, Vec3) -> Ray + Send + Sync + 'static,
) -> Stage {
    let list = triangles(mesh.triangles());
    let origin = move |random: &mut Random| {
        let within = DVec3::from([(); 3].map(|()| random.within(-room, room)));
        (centre + within).as_vec3()
    };
    Stage::new(
        list,
        move |random| {
            let from = origin(random);
            shoot(random, &mesh, from)
        },
        move |random| Ray::new(origin(random), unit(random)),
    )
}

fn ball(random: &mut Random, shoot: impl Fn(&mut Random, &Mesh, Vec3) -> Ray + Send + Sync + 'static) -> Stage {
    closed(sphere(random, 16, 24, DVec3::ZERO, (1.0, 1.4)), DVec3::ZERO, 0.4, shoot)
}

fn offset(random: &mut Random, distance: f64, radius: f64) -> Stage {
    let centre = DVec3::new(1.1, -0.7, 1.0) * distance;
    closed(sphere(random, 16, 24, centre, (radius, 1.2 * radius)), centre, 0.4 * radius, any)
}

fn scaled(random: &mut Random, scale: f64) -> Stage {
    closed(sphere(random, 16, 24, DVec3::ZERO, (scale, 1.4 * scale)), DVec3::ZERO, 0.4 * scale, any)
}

fn plane() -> Stage {
    let x = EMBREE.x as f32;
    let at = |i: usize, j: usize| Vec3::new(x, i as f32 * 0.4 - 6.0, j as f32 * 0.4 - 6.0);
    let quads = (0..900).map(|q| (q / 30, q % 30));
    let list = quads.flat_map(|(i, j)| {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    let shoot = move |random: &mut Random| {
        let d = in_cube(random);
        Ray::new(Vec3::new(x - 3.0, 0.0, 0.0), Vec3::new(1.0, d.y, d.z))
    };
    Stage::new(triangles(list.collect()), shoot, shoot)
}

fn lattice() -> Stage {
    let mut list = Vec::new();
    for axis in 0..3 {
        for side in [-8.0, 8.0] {
            for (i, j) in (0..64).map(|q| (q / 8, q % 8)) {
                let at = |u: i32, v: i32| {
                    let mut p = Vec3::splat(side);
                    p[(axis + 1) % 3] = (2 * u - 8) as f32;
                    p[(axis + 2) % 3] = (2 * v - 8) as f32;
                    p
                };
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                list.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    let whole3 = |random: &mut Random| Vec3::from([(); 3].map(|()| whole(random, -4, 4)));
    let shoot = move |random: &mut Random| {
        let origin = whole3(random);
        let direction = whole3(random);
        Ray::new(origin, if direction == Vec3::ZERO { Vec3::ONE } else { direction })
    };
    Stage::new(triangles(list), shoot, |random| Ray::new(in_cube(random) * 4.0, unit(random)))
}

fn diagonals() -> Stage {
    let shoot = |random: &mut Random| {
        let signs = Vec3::new(sign(random), sign(random), sign(random));
        let origin = signs * random.within(-1.0, 1.0) as f32 * 0.9;
        let mut direction = signs * sign(random);
        if random.below(2) == 0 {
            direction[random.below(3)] = pick(random, &[0.0, -0.0]);
        }
        Ray::new(origin, if random.below(2) == 0 { direction } else { direction.normalize() })
    };
    Stage::new(triangles(cuboid(Vec3::NEG_ONE, Vec3::ONE)), shoot, |random| {
        Ray::new(in_cube(random) * 0.9, unit(random))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lattice_boxes_have_the_stated_size() {
        assert_eq!(crate::scene::with_geometry!(lattice().geometry, g => crate::Geometry::len(g)), 768);
        assert_eq!(crate::scene::with_geometry!(plane().geometry, g => crate::Geometry::len(g)), 1800);
    }
}
