//! Spheres alone: tangents, tiny and huge radii, far centres, origins inside and on the surface.

use super::draw::{in_box, in_cube, inwards, pick, sign, unit};
use super::shapes::spheres;
use super::{Case, Stage};
use crate::geometry::Sphere;
use crate::random::Random;
use crate::ray::Ray;
use glam::{DVec3, Vec3};

pub(super) const CASES: &[Case] = &[
    Case::new("sph_ordinary", "200 spheres of radius 0.1 to 1, rays at them", |r| at_targets(r, 1.0, |_| DVec3::ZERO)),
    Case::new("sph_tangent_1e-5", "200 spheres, rays that pass their surfaces within 10^-5", |r| tangent(r, 1e-5)),
    Case::new("sph_tangent_2e-7", "200 spheres, rays that pass their surfaces within 2 10^-7", |r| tangent(r, 2e-7)),
    Case::new("sph_small_1e3", "200 spheres of radius 10^-3 from 10^3 away", |r| small(r, 1e3)),
    Case::new("sph_small_1e6", "200 spheres of radius 10^-3 from 10^6 away", |r| small(r, 1e6)),
    Case::new("sph_large_1e6", "a sphere of radius 10^6 from 1 above it, 20 ordinary ones on it", |r| large(r, 1e6)),
    Case::new("sph_large_1e9", "a sphere of radius 10^9 from 1 above it, 20 ordinary ones on it", |r| large(r, 1e9)),
    Case::new(
        "sph_centre_1e6",
        "200 spheres of radius 1 to 10 around a point 10^6 away from the zero, rays near them",
        |r| at_targets(r, 10.0, |_| DVec3::new(1e6, -7e5, 1.1e6)),
    ),
    Case::new("sph_inside", "40 spheres inside each other, rays from within", inside),
    Case::new("sph_surface", "200 spheres, rays from their surfaces; parameters near zero are not judged", surface),
    Case::new("sph_dir_1e-20", "200 spheres, directions of length 10^-20", |r| lengths(r, 1e-20)),
    Case::new("sph_dir_1e20", "200 spheres, directions of length 10^20", |r| lengths(r, 1e20)),
    Case::new("sph_r_1e-20", "200 spheres of radius 10^-20 in a space of 10^-18", |r| tiny(r, 1e-20)),
];

/// Spheres of radius 0.1 to 1 with centres in the cube from 0 to 10, times `scale`, moved.
fn set(random: &mut Random, scale: f64, offset: DVec3) -> Vec<Sphere> {
    (0..200)
        .map(|_| {
            let centre = (in_box(random, 0.0, 10.0).as_dvec3() * scale + offset).as_vec3();
            Sphere { centre, radius: (random.within(0.1, 1.0) * scale) as f32 }
        })
        .collect()
}

/// An ordinary ray towards the spheres of [`set`].
fn ordinary(random: &mut Random, scale: f64, offset: DVec3) -> Ray {
    let ray = inwards(random, Vec3::splat(5.0), 12.0);
    Ray::new((ray.origin.as_dvec3() * scale + offset).as_vec3(), ray.direction)
}

/// Rays that meet one of the spheres unless another is before it.
fn at_targets(random: &mut Random, scale: f64, offset: impl Fn(&mut Random) -> DVec3) -> Stage {
    let offset = offset(random);
    let list = set(random, scale, offset);
    let targets = list.clone();
    let shoot = move |random: &mut Random| {
        let target = pick(random, &targets);
        let origin = (target.centre.as_dvec3() + random.direction() * (15.0 * scale)).as_vec3();
        let at = target.centre + unit(random) * target.radius * random.unit() as f32;
        Ray::new(origin, at - origin)
    };
    Stage::new(spheres(list), shoot, move |random| ordinary(random, scale, offset))
}

/// A ray from `distance` away that passes `target`'s centre at the radius times `1 + slip`.
fn passing(random: &mut Random, target: &Sphere, distance: f64, slip: f64) -> Ray {
    let (centre, radius) = (target.centre.as_dvec3(), f64::from(target.radius));
    let origin = (centre + random.direction() * distance).as_vec3();
    let axis = (centre - origin.as_dvec3()).normalize();
    let side = axis.cross(random.direction()).normalize_or(axis.any_orthonormal_vector());
    // The point of the circle of tangents, seen from the origin.
    let (away, r) = ((centre - origin.as_dvec3()).length(), radius * (1.0 + slip));
    let sin = (r / away).min(1.0);
    let cos = (1.0 - sin * sin).sqrt();
    let direction = axis * cos + side * sin;
    Ray::new(origin, direction.as_vec3())
}

fn tangent(random: &mut Random, slip: f64) -> Stage {
    let list = set(random, 1.0, DVec3::ZERO);
    let targets = list.clone();
    let shoot = move |random: &mut Random| {
        let (target, slip) = (pick(random, &targets), random.within(-slip, slip));
        passing(random, &target, 15.0, slip)
    };
    Stage::new(spheres(list), shoot, |random| ordinary(random, 1.0, DVec3::ZERO))
}

fn small(random: &mut Random, distance: f64) -> Stage {
    let list: Vec<Sphere> = (0..200).map(|_| Sphere { centre: in_box(random, 0.0, 1.0), radius: 1e-3 }).collect();
    let targets = list.clone();
    let shoot = move |random: &mut Random| {
        let target = pick(random, &targets);
        if random.below(4) == 0 {
            let origin = (target.centre.as_dvec3() + random.direction() * distance).as_vec3();
            return Ray::new(origin, target.centre + unit(random) * target.radius - origin);
        }
        // Nearly along an axis f32 can aim well enough to hit such spheres, but for their rims.
        let k = random.below(3);
        let mut origin = in_cube(random);
        origin[k] = distance as f32 * sign(random);
        Ray::new(origin, target.centre + unit(random) * target.radius - origin)
    };
    Stage::new(spheres(list), shoot, |random| inwards(random, Vec3::splat(0.5), 1.0))
}

fn large(random: &mut Random, radius: f32) -> Stage {
    let mut list = vec![Sphere { centre: Vec3::new(0.0, 0.0, -radius), radius }];
    list.extend(
        (0..20)
            .map(|_| Sphere { centre: (in_cube(random) * 10.0).with_z(0.0), radius: random.within(0.1, 1.0) as f32 }),
    );
    let from = |random: &mut Random| (in_cube(random) * 10.0).with_z(1.0);
    let shoot =
        move |random: &mut Random| Ray::new(from(random), unit(random).with_z(random.within(-0.1, 0.01) as f32));
    Stage::new(spheres(list), shoot, move |random| {
        let origin = from(random);
        Ray::new(origin, (in_cube(random) * 10.0).with_z(0.0) - origin)
    })
}

fn inside(random: &mut Random) -> Stage {
    let list = (0..40)
        .map(|i| Sphere { centre: in_cube(random) * 0.1, radius: 1.0 + 0.1 * i as f32 + 1e-6 * sign(random) })
        .collect();
    Stage::new(
        spheres(list),
        |random| Ray::new(unit(random) * random.within(0.0, 5.0) as f32, unit(random)),
        |random| inwards(random, Vec3::ZERO, 6.0),
    )
}

fn surface(random: &mut Random) -> Stage {
    let list = set(random, 1.0, DVec3::ZERO);
    let targets = list.clone();
    let shoot = move |random: &mut Random| {
        let target = pick(random, &targets);
        // Along an axis the point is on the surface to the bit more often than not.
        let out = if random.below(4) == 0 { super::draw::axis(random) } else { unit(random) };
        let origin = (target.centre.as_dvec3() + out.as_dvec3() * f64::from(target.radius)).as_vec3();
        let direction = match random.below(3) {
            0 => unit(random),
            1 => out.cross(unit(random)),
            _ => target.centre - origin,
        };
        Ray::new(origin, if direction == Vec3::ZERO { out } else { direction })
    };
    Stage::new(spheres(list), shoot, |random| ordinary(random, 1.0, DVec3::ZERO))
}

fn lengths(random: &mut Random, length: f64) -> Stage {
    let list = set(random, 1.0, DVec3::ZERO);
    let targets = list.clone();
    let shoot = move |random: &mut Random| {
        let (target, slip) = (pick(random, &targets), pick(random, &[-0.9, -0.5, -1e-3, -1e-5, 1e-5]));
        let ray = passing(random, &target, 15.0, slip);
        Ray::new(ray.origin, (ray.direction.as_dvec3() * length).as_vec3())
    };
    Stage::new(spheres(list), shoot, |random| ordinary(random, 1.0, DVec3::ZERO))
}

fn tiny(random: &mut Random, radius: f64) -> Stage {
    let scale = 10.0 * radius;
    let list = set(random, scale, DVec3::ZERO);
    let targets = list.clone();
    let shoot = move |random: &mut Random| {
        let (target, slip) = (pick(random, &targets), random.within(-1.0, 0.01));
        passing(random, &target, 15.0 * scale, slip)
    };
    Stage::new(spheres(list), shoot, move |random| ordinary(random, scale, DVec3::ZERO))
}
