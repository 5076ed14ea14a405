//! Ranges of the parameter that end at a hit or next to it, and rays that are none.

use super::draw::{in_cube, pick, unit};
use super::shapes::{Mesh, triangles};
use super::{Case, Stage};
use crate::random::Random;
use crate::ray::Ray;
use glam::{DVec3, Vec3};

pub(super) const CASES: &[Case] = &[
    Case::new("trange", "planes at z = 1 to 8; ranges that end at a hit, an ulp beside, are empty or negative", |_| {
        range()
    }),
    Case::new("ray_naninf", "the bumpy sphere; rays with NaN, infinities, no direction or an empty range", no_rays)
        .bad_input(),
];

fn range() -> Stage {
    let square = |z: i32| {
        let [a, b, c, d] = [(-8.0, -8.0), (8.0, -8.0), (8.0, 8.0), (-8.0, 8.0)].map(|(x, y)| Vec3::new(x, y, z as f32));
        [[a, b, c], [a, c, d]]
    };
    let ray = |random: &mut Random| {
        let from = in_cube(random) * 3.0;
        Ray::new(from.with_z(0.0), pick(random, &[Vec3::Z, Vec3::new(0.25, 0.5, 1.0), Vec3::new(0.1, -0.3, 1.0)]))
    };
    let shoot = move |random: &mut Random| {
        let t = (1 + random.below(8)) as f32;
        let other = (1 + random.below(8)) as f32;
        let (low, high) = match random.below(14) {
            0 => (t, f32::INFINITY),
            1 => (t.next_up(), f32::INFINITY),
            2 => (t.next_down(), f32::INFINITY),
            3 => (0.0, t),
            4 => (0.0, t.next_up()),
            5 => (0.0, t.next_down()),
            6 => (t, t),
            7 => (t, other),
            8 => (t.next_up(), t),
            9 => (-t, f32::INFINITY),
            10 => (f32::NEG_INFINITY, t),
            11 => (f32::NEG_INFINITY, f32::INFINITY),
            12 => (-f32::MAX, f32::MAX),
            _ => (pick(random, &[-0.0, 0.0, f32::MIN_POSITIVE]), f32::MAX),
        };
        let ray = ray(random).with_range(low, high);
        // Half of the rays begin above the planes or among them, so that hits lie at negative parameters.
        match random.below(2) {
            0 => ray,
            _ => Ray { origin: ray.origin + Vec3::Z * (1 + random.below(8)) as f32, ..ray },
        }
    };
    Stage::new(triangles((1..=8).flat_map(square).collect()), shoot, ray)
}

fn no_rays(random: &mut Random) -> Stage {
    let mesh = Mesh::sphere(16, 24, DVec3::ZERO, || random.within(1.0, 1.2));
    let good = |random: &mut Random| Ray::new(in_cube(random) * 0.25, unit(random));
    let shoot = move |random: &mut Random| {
        let bad = pick(random, &[f32::NAN, f32::INFINITY, f32::NEG_INFINITY]);
        let k = random.below(3);
        let mut ray = good(random);
        match random.below(6) {
            0 => ray.origin[k] = bad,
            1 => ray.direction[k] = bad,
            2 => {
                ray.origin[k] = bad;
                ray.direction[(k + 1) % 3] = bad;
            }
            3 => ray.direction = Vec3::from([(); 3].map(|()| pick(random, &[0.0, -0.0]))),
            4 => match random.below(2) {
                0 => ray.t_min = f32::NAN,
                _ => ray.t_max = f32::NAN,
            },
            _ => (ray.t_min, ray.t_max) = pick(random, &[(2.0, 1.0), (f32::INFINITY, 0.0), (1.0f32.next_up(), 1.0)]),
        }
        ray
    };
    Stage::new(triangles(mesh.triangles()), shoot, good)
}
