//! Ties at points that f32 holds, decided without roots.
//!
//! Surfaces that a ray meets at one and the same parameter mostly do so by construction, in a point with f32 coordinates: a
//! corner, the point in which a sphere touches a plane, the point through which a crowd of spheres passes. That such a point
//! lies on the ray, on a plane or on a sphere is a matter of a few products of whole numbers ([`super::whole`]), where the
//! order of two roots takes microseconds. What is not proved here is left to [`super::root`].

use super::estimate::Estimate;
use super::sphere::{SpherePrep, roots};
use super::whole::{bits, subtract, triple, whole};
use super::{Best, Geometry, Sphere, Triangle};
use crate::ray::Ray;
use glam::Vec3;

/// A point exactly on a ray's line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Point {
    /// The point.
    pub at: Vec3,
    /// Its parameter.
    t: Estimate,
}

impl Point {
    /// `at` if it lies exactly on the line of `ray`.
    fn new(at: Vec3, ray: &Ray) -> Option<Self> {
        if !at.is_finite() {
            return None;
        }
        let ([p, origin], _) = whole([at, ray.origin])?;
        let ([d], _) = whole([ray.direction])?;
        // Of 62 and 61 bits at most: the products have 123.
        let f = subtract(p, origin);
        let parallel = [(0, 1), (1, 2), (2, 0)]
            .iter()
            .all(|&(i, j)| i128::from(f[i]) * i128::from(d[j]) == i128::from(f[j]) * i128::from(d[i]));
        if !parallel {
            return None;
        }
        Some(Self::proven(at, ray))
    }

    /// `at`, which lies exactly on the line of `ray`.
    pub fn proven(at: Vec3, ray: &Ray) -> Self {
        let axis = ray.direction.abs().max_position();
        let t = (f64::from(at[axis]) - f64::from(ray.origin[axis])) / f64::from(ray.direction[axis]);
        // A difference and a quotient.
        Self { at, t: Estimate::new(t, t.abs() * (2.0 * f64::EPSILON)) }
    }

    /// Where `ray` meets the winner of `best`, if that is such a point.
    pub fn of_winner<G: Geometry + ?Sized>(set: &G, ray: &Ray, best: &Best) -> Option<Self> {
        let at = (ray.origin.as_dvec3() + best.t() * ray.direction.as_dvec3()).as_vec3();
        let point = Self::new(at, ray)?;
        let winner = best.prim()?;
        let found = match (set.triangle(winner), set.sphere(winner)) {
            // A ray that is not parallel to a plane meets it once.
            (Some(corners), _) => point.is_on_plane(&corners),
            (None, Some(sphere)) => {
                let (near, far) = roots(&sphere, ray, &SpherePrep::new(ray))?;
                let winner = Estimate::new(best.t(), best.err());
                let only = |this: &Estimate, other: &Estimate| winner.meets(this) && !winner.meets(other);
                match point.root_of(&sphere, ray, &near, &far)? {
                    Which::Lesser => point.t.meets(&far) || only(&near, &far),
                    Which::Greater => only(&far, &near),
                }
            }
            (None, None) => false,
        };
        found.then_some(point)
    }

    /// True only if the point lies on the plane of a triangle.
    pub fn is_on_plane(&self, corners: &Triangle) -> bool {
        let [a, b, c] = *corners;
        let Some(([p, a, b, c], _)) = whole([self.at, a, b, c]) else { return false };
        let (ap, ab, ac) = (subtract(p, a), subtract(b, a), subtract(c, a));
        bits(&ap) + bits(&ab) + bits(&ac) <= 123 && triple(&ap, &ab, &ac) == 0
    }

    /// Which of the two parameters at which `ray` meets `sphere` is the point's, exactly; `near` and `far` are these
    /// parameters. The lesser one of a tangent. `None` if it is neither, or if that is not known.
    pub fn root_of(&self, sphere: &Sphere, ray: &Ray, near: &Estimate, far: &Estimate) -> Option<Which> {
        let ([p, centre, [r, ..]], _) = whole([self.at, sphere.centre, Vec3::new(sphere.radius, 0.0, 0.0)])?;
        let f = subtract(p, centre);
        // Differences of 62 bits at most: the sum of three products has 126.
        let dot = |a: &[i64; 3], b: &[i64; 3]| (0..3).map(|i| i128::from(a[i]) * i128::from(b[i])).sum::<i128>();
        if dot(&f, &f) != i128::from(r) * i128::from(r) {
            return None;
        }
        match (self.t.meets(near), self.t.meets(far)) {
            (true, false) => Some(Which::Lesser),
            (false, true) => Some(Which::Greater),
            (false, false) => None,
            (true, true) => {
                let ([d], _) = whole([ray.direction])?;
                (dot(&f, &d) == 0).then_some(Which::Lesser)
            }
        }
    }
}

/// One of the two parameters at which a line meets a sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Which {
    Lesser,
    Greater,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Mixed;

    fn best(t: f64, prim: u32) -> Best {
        let mut best = Best::NONE;
        best.replace(t, t.abs() * 1e-15, prim);
        best
    }

    #[test]
    fn points_off_the_line_by_one_unit_are_refused() {
        let ray = Ray::new(Vec3::new(1.0, 2.0, 3.0), Vec3::new(0.5, -0.25, 0.125));
        let on = ray.origin + 6.0 * ray.direction;
        assert!(Point::new(on, &ray).is_some());
        for axis in 0..3 {
            let mut off = on;
            off[axis] = off[axis].next_up();
            assert!(Point::new(off, &ray).is_none(), "{axis}");
        }
        assert!(Point::new(Vec3::NAN, &ray).is_none());
    }

    #[test]
    fn winners_are_met_where_they_are() {
        // The ray runs along x; sphere 0 is met at 3 and 7, the plane of triangle 0 at 3 and that of triangle 1 beyond.
        let beyond = 3f32.next_up();
        let set = Mixed {
            triangles: [3.0, beyond].map(|x| [[x, 0.0, 0.0], [x, 1.0, 0.0], [x, 0.0, 1.0]].map(Vec3::from)).to_vec(),
            spheres: vec![Sphere { centre: Vec3::new(5.0, 0.0, 0.0), radius: 2.0 }],
        };
        let ray = Ray::new(Vec3::ZERO, Vec3::X);
        let three = Point::of_winner(&set, &ray, &best(3.0, 0)).expect("a point of the plane");
        assert_eq!(three.at, Vec3::new(3.0, 0.0, 0.0));
        assert!(three.is_on_plane(&set.triangles[0]) && !three.is_on_plane(&set.triangles[1]));
        assert_eq!(Point::of_winner(&set, &ray, &best(3.0, 2)), Some(three));
        assert_eq!(Point::of_winner(&set, &ray, &best(3.0, 1)), None, "the plane is one unit beyond");

        let (near, far) = roots(&set.spheres[0], &ray, &SpherePrep::new(&ray)).expect("a hit");
        assert_eq!(three.root_of(&set.spheres[0], &ray, &near, &far), Some(Which::Lesser));
        let seven = Point::of_winner(&set, &ray, &best(7.0, 2)).expect("the far side");
        assert_eq!(seven.root_of(&set.spheres[0], &ray, &near, &far), Some(Which::Greater));
        let greater = Sphere { radius: 2f32.next_up(), ..set.spheres[0] };
        let (near, far) = roots(&greater, &ray, &SpherePrep::new(&ray)).expect("a hit");
        assert_eq!(three.root_of(&greater, &ray, &near, &far), None);
    }

    #[test]
    fn tangents_meet_once() {
        let ray = Ray::new(Vec3::ZERO, Vec3::X);
        let point = Point::new(Vec3::new(5.0, 0.0, 0.0), &ray).expect("on the ray");
        let ball = |centre: [f32; 3], radius| Sphere { centre: Vec3::from(centre), radius };
        let found = |ball: Sphere| {
            let (near, far) = roots(&ball, &ray, &SpherePrep::new(&ray)).expect("a hit");
            (near.meets(&far), point.root_of(&ball, &ray, &near, &far))
        };
        assert_eq!(found(ball([5.0, 1.0, 0.0], 1.0)), (true, Some(Which::Lesser)));
        assert_eq!(found(ball([5.0, 1.0, 0.0], 1f32.next_up())), (false, None));
        assert_eq!(found(ball([5.0, 0.0, 0.0], 0.0)), (true, Some(Which::Lesser)));
    }
}
