//! What a ray hits in exact arithmetic: the judge of all accelerators.
//!
//! The inputs are the bits of the coordinates; nothing is rounded until the answer is written down. A ray is the set `origin + t
//! direction` for `t_min <= t <= t_max`, both ends included. Triangles are closed and two-sided; a triangle whose plane holds the
//! ray's direction, whose corners lie on a line or are not finite is never hit. A sphere is a surface, a radius of 0 a point; one
//! with a negative radius, with a number that is not finite or with a part beyond the greatest f32 is never hit. A ray that is
//! not finite, has no direction, a NaN for a bound or `t_min > t_max` hits nothing.
//!
//! Every primitive is first looked at in f64 with a bound on the error; those that may be the closest one are then computed
//! in whole numbers, after scaling by a common power of two. Roots are never taken: parameters are compared by squaring.
//!
//! This module shares no code with the intersection tests and the accelerators that it judges.

mod line;
mod sphere;
mod surd;
mod triangle;
pub mod voxels;
mod whole;

use crate::ray::Ray;
use glam::Vec3;
use line::{Estimate, Line};
use std::cmp::Ordering;
use std::collections::HashMap;
use surd::Surd;

/// Something to hit, world units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Primitive {
    /// Three corners.
    Triangle([Vec3; 3]),
    /// The surface of a ball.
    Sphere {
        /// Centre, world units.
        centre: Vec3,
        /// Radius, world units.
        radius: f32,
    },
}

/// Exact answers for a list of primitives, by their indices in it.
///
/// Equal primitives are looked at once for each ray. A ray takes a few nanoseconds for each distinct primitive, and a few
/// microseconds for each that may be the closest.
///
/// ```
/// use glam::Vec3;
/// use skipgrid::Ray;
/// use skipgrid::oracle::Oracle;
///
/// let right = [Vec3::ZERO, Vec3::X, Vec3::Y];
/// let oracle = Oracle::of_triangles(&[right, right]);
/// let truth = oracle.closest(&Ray::new(Vec3::new(0.5, 0.5, 3.0), Vec3::new(0.0, 0.0, -9.0))).expect("on its edge");
/// assert_eq!(truth.prims, [0, 1]);
/// assert_eq!((truth.t, truth.nearest), (1.0 / 3.0, 1.0 / 3.0));
/// assert!(truth.ulps(1.0 / 3.0) < 0.5);
/// ```
#[derive(Debug)]
pub struct Oracle {
    groups: Vec<Group>,
}

/// Equal primitives that can be hit.
#[derive(Debug)]
struct Group {
    shape: Shape,
    /// Ascending.
    prims: Vec<u32>,
}

#[derive(Debug)]
enum Shape {
    Triangle(Box<triangle::Triangle>),
    Sphere(sphere::Sphere),
}

impl Shape {
    fn new(primitive: &Primitive) -> Option<Self> {
        match *primitive {
            Primitive::Triangle(corners) => triangle::Triangle::new(corners).map(Box::new).map(Self::Triangle),
            Primitive::Sphere { centre, radius } => sphere::Sphere::new(centre, radius).map(Self::Sphere),
        }
    }

    fn estimate(&self, line: &Line) -> Option<Estimate> {
        match self {
            Self::Triangle(triangle) => triangle.estimate(line),
            Self::Sphere(sphere) => sphere.estimate(line),
        }
    }

    fn exact(&self, line: &Line) -> Option<Surd> {
        match self {
            Self::Triangle(triangle) => triangle.exact(line),
            Self::Sphere(sphere) => sphere.exact(line),
        }
    }
}

/// The bits of a primitive, zeros of both signs alike. A sphere has no coordinate beyond its fourth.
fn key(primitive: &Primitive) -> (bool, [u32; 9]) {
    let mut bits = [0; 9];
    let values: Vec<f32> = match primitive {
        Primitive::Triangle(corners) => corners.iter().flat_map(|v| v.to_array()).collect(),
        Primitive::Sphere { centre, radius } => [centre.x, centre.y, centre.z, *radius].into(),
    };
    bits.iter_mut().zip(values).for_each(|(bit, x)| *bit = (x + 0.0).to_bits());
    (matches!(primitive, Primitive::Sphere { .. }), bits)
}

impl Oracle {
    /// Prepares the primitives. Those beyond the 2^32nd have no index and are left out.
    pub fn new(primitives: Vec<Primitive>) -> Self {
        let mut groups: Vec<Group> = Vec::new();
        // Where the group is; `None` if the primitive can never be hit.
        let mut known: HashMap<(bool, [u32; 9]), Option<usize>> = HashMap::new();
        for (prim, primitive) in (0..=u32::MAX).zip(&primitives) {
            let group = known.entry(key(primitive)).or_insert_with(|| {
                let shape = Shape::new(primitive)?;
                groups.push(Group { shape, prims: Vec::new() });
                Some(groups.len() - 1)
            });
            if let Some(group) = group {
                groups[*group].prims.push(prim);
            }
        }
        Self { groups }
    }

    /// The oracle of triangles alone.
    pub fn of_triangles(triangles: &[[Vec3; 3]]) -> Self {
        Self::new(triangles.iter().copied().map(Primitive::Triangle).collect())
    }

    /// What `ray` hits first within its range, both ends included; `None` if it hits nothing. Any bits have an answer.
    pub fn closest(&self, ray: &Ray) -> Option<Truth> {
        let line = Line::new(ray)?;
        let mut limit = f64::INFINITY;
        let mut candidates: Vec<(f64, &Group)> = Vec::new();
        for group in &self.groups {
            let Some(estimate) = group.shape.estimate(&line) else { continue };
            if estimate.least > limit {
                continue;
            }
            if estimate.certain {
                limit = limit.min(estimate.most);
            }
            candidates.push((estimate.least, group));
        }
        candidates.retain(|(least, _)| *least <= limit);
        self.first(&line, candidates.into_iter().map(|(_, group)| group))
    }

    /// The exact winner among `groups`.
    fn first<'a>(&self, line: &Line, groups: impl Iterator<Item = &'a Group>) -> Option<Truth> {
        let mut best: Option<Surd> = None;
        let mut winners: Vec<&Group> = Vec::new();
        for group in groups {
            let Some(t) = group.shape.exact(line) else { continue };
            match best.as_ref().map_or(Ordering::Less, |best| t.order(best)) {
                Ordering::Less => {
                    best = Some(t);
                    winners.clear();
                    winners.push(group);
                }
                Ordering::Equal => winners.push(group),
                Ordering::Greater => {}
            }
        }
        let t = best?;
        let mut prims: Vec<u32> = winners.iter().flat_map(|group| &group.prims).copied().collect();
        prims.sort_unstable();
        Some(Truth { t: t.to_f64(), nearest: t.to_f32(), prims })
    }
}

/// The exact answer for a ray that hits something.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    /// The least parameter, the f64 nearest to it; infinite beyond the greatest f64.
    pub t: f64,
    /// The f32 nearest to the least parameter, ties to even; infinite from half a unit beyond the greatest f32 on.
    pub nearest: f32,
    /// All primitives that are hit at exactly that parameter, ascending. Never empty.
    pub prims: Vec<u32>,
}

impl Truth {
    /// How far `t` is from the exact parameter, in units in the last place that f32 has there; beyond its greatest number, that
    /// it would have. Infinite for a NaN, and for an infinite `t` that is not [`Truth::nearest`].
    ///
    /// Exact to 2^-28 units: [`Truth::t`] is rounded.
    pub fn ulps(&self, t: f32) -> f64 {
        if t.is_nan() {
            return f64::INFINITY;
        }
        if !(t.is_finite() && self.t.is_finite()) {
            return if t == self.nearest { 0.0 } else { f64::INFINITY };
        }
        // The binade of the exact parameter; subnormal f32 share the least one.
        let field = (self.t.to_bits() >> 52 & 0x7ff) as i64;
        let unit = field.max(1023 - 126) - 23;
        (f64::from(t) - self.t).abs() / f64::from_bits((unit as u64) << 52)
    }
}

#[cfg(test)]
mod tests;
