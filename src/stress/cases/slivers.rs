//! Needles, strips of needles, and fans with thousands of triangles in one corner.

use super::draw::{aim, in_box, in_cube, pick, unit};
use super::shapes::triangles;
use super::{Case, Stage};
use crate::random::Random;
use crate::ray::Ray;
use glam::{DVec3, Vec3};

pub(super) const CASES: &[Case] = &[
    Case::new("wt_slivers_1e4", "strip of 600 needles 1 long and 10^-4 wide, rays at seams and at random", |r| {
        strip(r, 1e-4)
    })
    .must_hit(),
    Case::new("wt_slivers_1e8", "strip of 600 needles 1 long and 10^-8 wide, rays at seams and at random", |r| {
        strip(r, 1e-8)
    })
    .must_hit(),
    Case::new(
        "wt_fan_2000",
        "double cone of 2 x 2000 triangles, rays 10^-5 beside an apex and at it but for rounding",
        |_| fan(|r| if r.below(100) == 0 { at_apex(r) } else { near_apex(r) }),
    )
    .must_hit(),
    Case::new("wt_fan_apex", "the double cone, rays that meet 2000 triangles in an apex", |_| fan(at_apex))
        .must_hit()
        .at_most(300, "the exact answer compares 2000 triangles for each ray"),
    Case::new("needles_1e8", "1500 triangles about 10 long and 10^-8 to 10^-1 wide", needles),
];

/// Two rows of corners `width` apart, nearly in a plane.
fn strip(random: &mut Random, width: f64) -> Stage {
    let mut row = |y: f64| -> Vec<Vec3> {
        (0..=300).map(|i| DVec3::new(width * f64::from(i), y, 0.1 * width * random.unit()).as_vec3()).collect()
    };
    let (low, high) = (row(0.0), row(1.0));
    let list = (0..300).flat_map(|i| [[low[i], low[i + 1], high[i + 1]], [low[i], high[i + 1], high[i]]]).collect();
    // Targets keep a tenth from the border, far more than a rounded direction strays.
    let from = move |random: &mut Random| {
        let x = 300.0 * width * random.within(0.1, 0.9);
        DVec3::new(x, random.within(0.1, 0.9), random.within(0.5, 2.0)).as_vec3()
    };
    let anywhere = move |random: &mut Random| {
        let x = 300.0 * width * random.within(0.1, 0.9);
        DVec3::new(x, random.within(0.1, 0.9), 0.0).as_vec3()
    };
    let shoot = move |random: &mut Random| {
        let origin = from(random);
        let i = 30 + random.below(240);
        let seam = match random.below(3) {
            0 => anywhere(random),
            1 => low[i].lerp(high[i], random.within(0.1, 0.9) as f32),
            _ => low[i].lerp(high[i + 1], random.within(0.1, 0.9) as f32),
        };
        Ray::new(origin, seam - origin)
    };
    Stage::new(triangles(list), shoot, move |random| {
        let origin = from(random);
        Ray::new(origin, anywhere(random) - origin)
    })
}

fn fan(shoot: impl Fn(&mut Random) -> Ray + Send + Sync + 'static) -> Stage {
    let rim = |i: usize| {
        let (sin, cos) = (std::f64::consts::TAU * (i % 2000) as f64 / 2000.0).sin_cos();
        DVec3::new(cos, sin, 0.0).as_vec3()
    };
    let list = APEXES.into_iter().flat_map(|apex| (0..2000).map(move |i| [apex, rim(i), rim(i + 1)]));
    // Into the crowd around an apex, not at it: what many triangles in one place cost is not what exactness costs.
    Stage::new(triangles(list.collect()), shoot, |random| {
        let (origin, apex) = (in_cube(random) * 0.25, pick(random, &APEXES));
        let target = apex + in_cube(random) * 0.01;
        aim(random, origin, target)
    })
}

const APEXES: [Vec3; 2] = [Vec3::Z, Vec3::NEG_Z];

/// Origins are multiples of 2^-10: the difference is exact, and so is the hit.
fn at_apex(random: &mut Random) -> Ray {
    let origin = (in_cube(random) * 256.0).round() / 1024.0;
    Ray::new(origin, pick(random, &APEXES) - origin)
}

fn near_apex(random: &mut Random) -> Ray {
    let (origin, apex) = (in_cube(random) * 0.25, pick(random, &APEXES));
    let target = if random.below(2) == 0 { apex } else { apex + 1e-5 * unit(random) };
    aim(random, origin, target)
}

fn needles(random: &mut Random) -> Stage {
    let list: Vec<_> = (0..1500)
        .map(|_| {
            let (p, along, across) = (in_box(random, 0.0, 10.0), unit(random), unit(random));
            let (long, wide) = (random.within(5.0, 10.0), 10f64.powf(random.within(-8.0, -1.0)));
            [p, p + along * long as f32, p + across * wide as f32]
        })
        .collect();
    let targets = list.clone();
    let origin = |random: &mut Random| Vec3::splat(5.0) + unit(random) * 15.0;
    let shoot = move |random: &mut Random| {
        let [a, b, c] = pick(random, &targets).map(|p| p.as_dvec3());
        let (s, t) = (random.unit(), random.unit());
        let target = (a + (1.0 - s) * ((b - a) + t * (c - b))).as_vec3();
        let from = origin(random);
        aim(random, from, target)
    };
    Stage::new(triangles(list), shoot, move |random| {
        let from = origin(random);
        Ray::new(from, in_box(random, 0.0, 10.0) - from)
    })
}
