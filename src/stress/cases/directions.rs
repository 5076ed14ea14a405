//! Directions whose length or whose smaller components are far from 1.

use super::draw::{in_box, inwards, sign};
use super::shapes::{SOUP, soup, triangles};
use super::{Case, Stage};
use crate::random::Random;
use crate::ray::Ray;
use glam::Vec3;

pub(super) const CASES: &[Case] = &[
    Case::new("dir_denorm_comp", "1500 random triangles, rays along axes with denormal minor components", |r| {
        over_soup(r, |r| nearly_axis(r, |r| r.within(-1e-38, 1e-38)))
    }),
    Case::new("dir_mixed", "1500 random triangles, minor components from 10^-30 to 10^-3", |r| {
        over_soup(r, |r| nearly_axis(r, |r| f64::from(sign(r)) * 10f64.powf(r.within(-30.0, -3.0))))
    }),
    Case::new("dir_scale_1e-20", "1500 random triangles, directions of length 10^-20", |r| lengths(r, 1e-20)),
    Case::new("dir_scale_1e20", "1500 random triangles, directions of length 10^20", |r| lengths(r, 1e20)),
    Case::new("dir_scale_1e-40", "1500 random triangles, directions of length 10^-40: parameters beyond f32", |r| {
        lengths(r, 1e-40)
    }),
];

fn over_soup(random: &mut Random, shoot: impl Fn(&mut Random) -> Ray + Send + Sync + 'static) -> Stage {
    Stage::new(triangles(soup(random, 1500)), shoot, |random| inwards(random, SOUP.0, SOUP.1))
}

/// From 10 before the middle of the scene along an axis, but for minor components of the given sizes.
fn nearly_axis(random: &mut Random, minor: impl Fn(&mut Random) -> f64) -> Ray {
    let k = random.below(3);
    let s = sign(random);
    let mut origin = in_box(random, 0.0, 10.0);
    origin[k] = 5.0 - 10.0 * s;
    let mut direction = Vec3::from([(); 3].map(|()| minor(random) as f32));
    direction[k] = s;
    Ray::new(origin, direction)
}

fn lengths(random: &mut Random, length: f64) -> Stage {
    over_soup(random, move |random| {
        let ray = inwards(random, SOUP.0, SOUP.1);
        Ray::new(ray.origin, (ray.direction.as_dvec3() * length).as_vec3())
    })
}
