//! Rays along axes, in planes and along diagonals of whole-number scenes: ties and zeros of both signs everywhere.

use super::draw::{axis, in_cube, inwards, pick, sign, unit, whole, zero};
use super::shapes::{CITY, SOUP, city, soup, triangles};
use super::{Case, Stage};
use crate::random::Random;
use crate::ray::Ray;
use glam::Vec3;

pub(super) const CASES: &[Case] = &[
    Case::new("axis_soup", "1500 random triangles, rays along axes with zeros of both signs", |r| {
        Stage::new(
            triangles(soup(r, 1500)),
            |r| {
                let d = axis(r);
                let across = Vec3::ONE - d.abs();
                Ray::new(across * super::draw::in_box(r, 0.0, 10.0) + d * -10.0 + d.abs() * 5.0, d)
            },
            |r| inwards(r, SOUP.0, SOUP.1),
        )
    }),
    Case::new("axis_lattice", "60 boxes with whole corners, rays along axes through whole and half numbers", |r| {
        in_city(r, |r| {
            let d = axis(r);
            let across = (Vec3::ONE - d.abs()) * half(r);
            Ray::new(across + d * -12.0 + d.abs() * 8.0, d)
        })
    }),
    Case::new("inplane_lattice", "the boxes, rays within planes at whole and half numbers", |r| in_city(r, in_plane)),
    Case::new("diag_lattice", "the boxes, exact diagonals through their corners and the lattice's", |r| {
        in_city(r, |r| {
            let mut d = Vec3::new(sign(r), sign(r), sign(r));
            if r.below(3) == 0 {
                d[r.below(3)] = zero(r);
            }
            Ray::new(half(r) - d * whole(r, 4, 16), d)
        })
    }),
    Case::new("border_hits", "the boxes, rays at corners and points of edges from anywhere", |r| in_city(r, border)),
];

/// A point of whole and half numbers from 0 to 17.
fn half(random: &mut Random) -> Vec3 {
    Vec3::from([(); 3].map(|()| whole(random, 0, 34) / 2.0))
}

pub(super) fn in_plane(random: &mut Random) -> Ray {
    let k = random.below(3);
    let mut d = unit(random);
    d[k] = zero(random);
    Ray::new(half(random), d)
}

/// At a whole corner of the lattice, or a point between two such.
pub(super) fn border(random: &mut Random) -> Ray {
    let corner = Vec3::from([(); 3].map(|()| whole(random, 0, 17)));
    let mut target = corner;
    if random.below(2) == 0 {
        target[random.below(3)] += random.unit() as f32;
    }
    let origin = CITY.0 + in_cube(random) * pick(random, &[8.0, 30.0]);
    Ray::new(origin, target - origin)
}

fn in_city(random: &mut Random, shoot: impl Fn(&mut Random) -> Ray + Send + Sync + 'static) -> Stage {
    Stage::new(triangles(city(random)), shoot, |random| inwards(random, CITY.0, CITY.1))
}
