//! Far origins, and small things in huge scenes.

use super::draw::{aim, in_cube, inwards, pick, unit};
use super::shapes::{Mesh, SOUP, cuboid, soup, triangles};
use super::{Case, Stage};
use crate::geometry::Triangle;
use crate::random::Random;
use crate::ray::Ray;
use glam::{DVec3, Vec3};

pub(super) const CASES: &[Case] = &[
    Case::new("far_1e4", "1500 random triangles from 10^4 extents away, aimed near corners", |r| far(r, 1e4)),
    Case::new("far_1e6", "1500 random triangles from 10^6 extents away, aimed near corners", |r| far(r, 1e6)),
    Case::new("far_1e8", "1500 random triangles from 10^8 extents away, aimed near corners", |r| far(r, 1e8)),
    Case::new("teapot_stadium_1e4", "720 triangles 2 high in a box of half width 10^4", |r| stadium(r, 1e4)),
    Case::new("teapot_stadium_1e8", "720 triangles 2 high in a box of half width 10^8", |r| stadium(r, 1e8)),
    Case::new("small_far_embree", "triangles of size 1 from 10^6 away, aimed at their centroids", small_far),
    Case::new("size_ratio_1e8", "spheres of 240 triangles from 10^-4 to 10^4 in size around each other", ratio),
];

fn far(random: &mut Random, extents: f64) -> Stage {
    let list = soup(random, 1500);
    let targets = list.clone();
    let shoot = move |random: &mut Random| {
        let direction = random.direction();
        let origin = (SOUP.0.as_dvec3() + direction * (10.0 * extents)).as_vec3();
        // Within half a triangle of a corner.
        let target = pick(random, &targets)[0] + in_cube(random) * 0.5;
        aim(random, origin, target)
    };
    Stage::new(triangles(list), shoot, |random| inwards(random, SOUP.0, SOUP.1))
}

/// A bumpy sphere on a ground of two triangles between four walls of one triangle each.
fn stadium(random: &mut Random, k: f64) -> Stage {
    let pot = Mesh::sphere(16, 24, DVec3::Z, || random.within(0.9, 1.0));
    let at = |x: f64, y: f64, z: f64| (k * DVec3::new(x, y, z)).as_vec3();
    let mut list = pot.triangles();
    list.extend([
        [at(-1.0, -1.0, 0.0), at(1.0, -1.0, 0.0), at(1.0, 1.0, 0.0)],
        [at(-1.0, -1.0, 0.0), at(1.0, 1.0, 0.0), at(-1.0, 1.0, 0.0)],
        [at(-1.1, -1.0, 0.0), at(-1.1, 1.0, 0.0), at(-1.1, 0.0, 1.0)],
        [at(1.1, -1.0, 0.0), at(1.1, 1.0, 0.0), at(1.1, 0.0, 1.0)],
        [at(-1.0, -1.0, 0.0), at(1.0, -1.0, 0.0), at(0.0, -1.0, 1.0)],
        [at(-1.0, 1.0, 0.0), at(1.0, 1.0, 0.0), at(0.0, 1.0, 1.0)],
    ]);
    let near = |random: &mut Random| Vec3::new(0.0, 0.0, 3.0) + in_cube(random) * 2.5;
    let shoot = move |random: &mut Random| {
        let origin = match random.below(2) {
            0 => near(random),
            _ => (in_cube(random).as_dvec3().with_z(random.within(0.01, 0.5)) * k).as_vec3(),
        };
        let target = match random.below(3) {
            0 => pot.corner(random),
            1 => pot.edge_point(random),
            _ => Vec3::Z + in_cube(random),
        };
        aim(random, origin, target)
    };
    Stage::new(triangles(list), shoot, move |random| {
        let origin = near(random);
        Ray::new(origin, Vec3::Z + in_cube(random) - origin)
    })
}

fn small_far(random: &mut Random) -> Stage {
    let list: Vec<Triangle> = (0..3200)
        .map(|_| {
            let p = in_cube(random) * 20.0;
            [(); 3].map(|()| p + in_cube(random))
        })
        .collect();
    let targets = list.clone();
    let shoot = move |random: &mut Random| {
        let [a, b, c] = pick(random, &targets).map(|p| p.as_dvec3());
        let origin = in_cube(random) * 1e6;
        Ray::new(origin, ((a + b + c) / 3.0).as_vec3() - origin)
    };
    Stage::new(triangles(list), shoot, |random| inwards(random, Vec3::ZERO, 40.0))
}

/// Nine spheres, each ten times as large as the one before and around it, with a gap at the top, and boxes beside them.
fn ratio(random: &mut Random) -> Stage {
    let mut list = Vec::new();
    let mut corners = Vec::new();
    for power in -4..=4 {
        let size = 10f64.powi(power);
        let mesh = Mesh::sphere(11, 12, DVec3::ZERO, || size * random.within(0.9, 1.0));
        // Not closed: the first four triangles are left out, so that rays see through.
        list.extend(mesh.triangles().split_off(4));
        list.extend(cuboid(Vec3::splat(2.0 * size as f32), Vec3::splat(2.5 * size as f32)));
        corners.extend(mesh.corners);
    }
    let shoot = move |random: &mut Random| {
        let size = 10f64.powf(random.within(-5.0, 5.0));
        let origin = (random.direction() * size).as_vec3();
        let target = pick(random, &corners);
        if random.below(4) == 0 { Ray::new(origin, unit(random)) } else { aim(random, origin, target) }
    };
    // At every size too, but at no corner.
    Stage::new(triangles(list), shoot, |random| {
        let mut place = || (random.direction() * 10f64.powf(random.within(-5.0, 5.0))).as_vec3();
        let (origin, target) = (place(), place());
        aim(random, origin, target)
    })
}
