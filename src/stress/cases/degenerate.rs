//! Overlapping, flat, degenerate and bad triangles; one triangle; none; and, as a control, nothing special.

use super::draw::{in_box, in_cube, inwards, pick, unit, zero};
use super::shapes::{Mesh, SOUP, soup, triangles};
use super::watertight::any;
use super::{Case, Stage};
use crate::geometry::Triangle;
use crate::random::Random;
use crate::ray::Ray;
use glam::{DVec3, Vec3};

pub(super) const CASES: &[Case] = &[
    Case::new("soup", "2000 random triangles, random rays: the control", |r| {
        Stage::new(triangles(soup(r, 2000)), |r| inwards(r, SOUP.0, SOUP.1), |r| inwards(r, SOUP.0, SOUP.1))
    }),
    Case::new("degenerate_mix", "a closed sphere mixed with 720 points, edges and triples on a line", degenerate)
        .must_hit(),
    Case::new("duplicates", "200 random triangles, each 8 times, in random order", duplicates),
    Case::new("coplanar_stack_ulp", "256 triangles in planes one ulp apart, in random order", stack),
    Case::new("coplanar_overlap", "400 overlapping triangles in one plane", overlap),
    Case::new("flat2d", "600 triangles in the plane y = 0, rays across and within it", flat),
    Case::new("one_prim", "one triangle, rays at its corners and edges and beside them", |_| one()),
    Case::new("empty", "no triangle", |_| {
        let shoot = |random: &mut Random| Ray::new(in_cube(random), unit(random));
        Stage::new(triangles(Vec::new()), shoot, shoot)
    }),
    Case::new("vert_naninf", "1500 random triangles, one in twenty with a NaN or an infinite coordinate", bad)
        .bad_input(),
    Case::new("scene_1e-38", "1000 random triangles in denormal coordinates", |r| tiny(r, 1e-38)),
];

fn degenerate(random: &mut Random) -> Stage {
    let centre = DVec3::splat(5.0);
    let mesh = Mesh::sphere(16, 24, centre, || random.within(3.0, 3.6));
    let mut list = mesh.triangles();
    for i in 0..720 {
        let [a, b, c] = pick(random, &list[..720]);
        let middle = ((a.as_dvec3() + b.as_dvec3()) / 2.0).as_vec3();
        let line = in_box(random, 2.0, 8.0);
        list.push(match i % 4 {
            0 => [a; 3],
            1 => [a, b, b],
            2 => [a, middle, b],
            // Multiples of a direction: on a line but for rounding, exactly so where the multiples are powers of two.
            _ => [line, line + (c - a) * 0.5, line + (c - a)],
        });
    }
    random.shuffle(&mut list);
    let from = |random: &mut Random| in_box(random, 4.0, 6.0);
    Stage::new(
        triangles(list),
        move |random| {
            let origin = from(random);
            any(random, &mesh, origin)
        },
        move |random| Ray::new(from(random), unit(random)),
    )
}

fn duplicates(random: &mut Random) -> Stage {
    let mut list = Vec::new();
    for t in soup(random, 200) {
        let middle = (t[0] + t[1] + t[2]) / 3.0;
        list.extend([t.map(|p| p + (p - middle)); 8]);
    }
    random.shuffle(&mut list);
    let shoot = |random: &mut Random| inwards(random, SOUP.0, SOUP.1);
    Stage::new(triangles(list), shoot, shoot)
}

fn stack(random: &mut Random) -> Stage {
    let mut z = 1.0f32;
    let mut list: Vec<Triangle> = (0..256)
        .map(|_| {
            z = z.next_up();
            [Vec3::new(-1.0, -1.0, z), Vec3::new(1.0, -1.0, z), Vec3::new(0.0, 1.5, z)]
        })
        .collect();
    random.shuffle(&mut list);
    let shoot = |random: &mut Random| {
        let target = (in_cube(random) * 0.25).with_z(1.0);
        let above = random.below(2) == 0;
        let mut origin = (in_cube(random) * 0.25).with_z(if above { 3.0 } else { -random.unit() as f32 - 1.0 });
        if random.below(2) == 0 {
            (origin.x, origin.y) = (target.x, target.y);
        }
        Ray::new(origin, (target - origin).normalize())
    };
    Stage::new(triangles(list), shoot, shoot)
}

fn overlap(random: &mut Random) -> Stage {
    let list = (0..400)
        .map(|_| {
            let p = in_box(random, 0.0, 10.0);
            [(); 3].map(|()| (p + in_cube(random)).with_z(5.0))
        })
        .collect();
    let shoot = |random: &mut Random| {
        let origin = in_box(random, 0.0, 10.0).with_z(random.within(-5.0, 4.0) as f32);
        Ray::new(origin, (in_box(random, 0.0, 10.0).with_z(5.0) - origin).normalize())
    };
    Stage::new(triangles(list), shoot, shoot)
}

fn flat(random: &mut Random) -> Stage {
    let list: Vec<Triangle> = (0..600)
        .map(|_| {
            let p = in_box(random, 0.0, 10.0);
            [(); 3].map(|()| (p + 0.5 * in_cube(random)).with_y(zero(random)))
        })
        .collect();
    let targets = list.clone();
    let across = |random: &mut Random, target: Vec3| {
        let origin = in_box(random, 0.0, 10.0).with_y(random.within(-3.0, 3.0) as f32);
        Ray::new(origin, target - origin)
    };
    let shoot = move |random: &mut Random| match random.below(4) {
        0 => Ray::new(in_box(random, -1.0, 11.0).with_y(zero(random)), unit(random).with_y(zero(random))),
        1 => Ray::new(in_box(random, 0.0, 10.0).with_y(zero(random)), Vec3::new(zero(random), 1.0, zero(random))),
        2 => {
            let [a, b, _] = pick(random, &targets);
            let target = a.lerp(b, random.unit() as f32);
            across(random, target)
        }
        _ => {
            let target = in_box(random, 0.0, 10.0).with_y(0.0);
            across(random, target)
        }
    };
    Stage::new(triangles(list), shoot, move |random| {
        let target = in_box(random, 0.0, 10.0).with_y(0.0);
        across(random, target)
    })
}

fn one() -> Stage {
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let shoot = move |random: &mut Random| {
        let s = random.within(0.0, 1.0) as f32;
        let target = match random.below(5) {
            0 => pick(random, &corners),
            1 => s * Vec3::X,
            // On the long edge to the bit: 1 - s is exact for multiples of 2^-24.
            2 => (s * 16_777_216.0).floor() / 16_777_216.0 * (Vec3::X - Vec3::Y) + Vec3::Y,
            3 => s * Vec3::Y,
            _ => in_box(random, 0.0, 1.25).with_z(0.0),
        };
        let slant =
            if random.below(2) == 0 { Vec3::new(zero(random), zero(random), 0.0) } else { 0.25 * in_cube(random) };
        let origin = Vec3::new(target.x + slant.x, target.y + slant.y, 1.0);
        Ray::new(origin, Vec3::new(-slant.x, -slant.y, -1.0))
    };
    Stage::new(triangles(vec![corners]), shoot, |random| {
        let origin = in_box(random, 0.0, 1.0).with_z(1.0);
        Ray::new(origin, in_box(random, 0.0, 1.0).with_z(0.0) - origin)
    })
}

fn bad(random: &mut Random) -> Stage {
    let good = soup(random, 1500);
    let mut list = good.clone();
    for t in list.iter_mut().step_by(20) {
        t[random.below(3)][random.below(3)] = pick(random, &[f32::NAN, f32::INFINITY, f32::NEG_INFINITY]);
    }
    let shoot = |random: &mut Random| inwards(random, SOUP.0, SOUP.1);
    Stage::new(triangles(list), shoot, shoot).against(triangles(good))
}

fn tiny(random: &mut Random, scale: f32) -> Stage {
    let list = soup(random, 1000).iter().map(|t| t.map(|p| p * scale)).collect();
    let shoot = move |random: &mut Random| {
        let ray = inwards(random, SOUP.0, SOUP.1);
        Ray::new(ray.origin * scale, ray.direction)
    };
    Stage::new(triangles(list), shoot, shoot)
}
