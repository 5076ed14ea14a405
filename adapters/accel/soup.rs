//! What peers are given: triangles, spheres and rays that none of them chokes on.

use crate::error::{Error, Result};
use crate::geometry::{Geometry, Sphere, Triangle};
use crate::ray::{Aabb, Ray};
use glam::Vec3;

/// Coordinates of triangles, spheres and rays are at most this large: the root of the greatest f32.
///
/// Embree documents that it ignores triangles beyond it; obvhs' `CwBvh` panics when it builds over some, and Embree with
/// assertions ends the process when a ray is beyond it.
pub const LIMIT: f32 = 1.844e18;

/// The triangles, or the spheres, of a geometry that peers can take, in its order.
#[derive(Clone, Debug)]
pub struct Soup<T = Triangle> {
    /// World units, no coordinate beyond [`LIMIT`].
    pub shapes: Vec<T>,
    /// What the peer's answers mean.
    pub labels: Labels,
}

/// What those peers are given that take spheres too.
#[derive(Clone, Debug)]
pub enum Given {
    /// Triangles alone, or nothing at all.
    Triangles(Soup),
    /// Spheres alone.
    Spheres(Soup<Sphere>),
}

impl Given {
    /// The triangles or the spheres of `geometry`.
    ///
    /// # Errors
    /// It has both or others; else as [`Soup::of`].
    pub fn of<G: Geometry + ?Sized>(geometry: &G) -> Result<Self> {
        if geometry.len() > 0 && geometry.sphere(0).is_some() {
            let fits = |s: &Sphere| within_limit(s.centre) && s.radius > 0.0 && s.radius <= LIMIT;
            let spheres = gather(geometry, |prim| geometry.sphere(prim), fits, "spheres alone")?;
            return Ok(Given::Spheres(spheres));
        }
        Ok(Given::Triangles(Soup::of(geometry)?))
    }
}

/// The primitives behind the shapes of a [`Soup`].
#[derive(Clone, Debug)]
pub struct Labels {
    /// Primitive of each shape; empty if shape `i` is primitive `i`.
    prims: Vec<u32>,
    /// Around all primitives that a ray can hit, even those that the peer does not have.
    pub bounds: Aabb,
    /// Primitives left out, as they are not finite, reach beyond [`LIMIT`] or are spheres of no radius above 0.
    pub ignored: u32,
}

impl Soup {
    /// The triangles of `geometry`.
    ///
    /// # Errors
    /// A primitive is no triangle, or there are more than 2^32 / 3 triangles, or memory does not suffice for them.
    pub fn of<G: Geometry + ?Sized>(geometry: &G) -> Result<Self> {
        let fits = |triangle: &Triangle| triangle.iter().all(|&corner| within_limit(corner));
        gather(geometry, |prim| geometry.triangle(prim), fits, "triangles alone")
    }
}

/// Primitives as `shape` has them, but for those that do not fit.
fn gather<T, G: Geometry + ?Sized>(
    geometry: &G,
    shape: impl Fn(u32) -> Option<T>,
    fits: impl Fn(&T) -> bool,
    what: &str,
) -> Result<Soup<T>> {
    // Peers number corners by u32.
    const MOST: u32 = u32::MAX / 3;
    let (len, mut bounds, mut prims) = (geometry.len(), Aabb::EMPTY, Vec::new());
    let mut shapes: Vec<T> = Vec::new();
    let each = (size_of::<T>() + size_of::<u32>()) as u64;
    let wanted = u64::from(len) * each;
    let room = shapes.try_reserve_exact(len as usize).is_ok() && prims.try_reserve_exact(len as usize).is_ok();
    if len > MOST || !room {
        let allowed = u64::from(MOST) * each;
        return Err(Error::TooLarge { what: format!("{len} primitives for another library"), wanted, allowed });
    }
    for prim in 0..len {
        let Some(shape) = shape(prim) else {
            return Err(Error::invalid(format!("needs a scene of {what}, but primitive {prim} of {len} is none")));
        };
        bounds = bounds.union(&geometry.bounds(prim));
        if fits(&shape) {
            shapes.push(shape);
            prims.push(prim);
        }
    }
    let ignored = len - prims.len() as u32;
    let prims = if ignored == 0 { Vec::new() } else { prims };
    Ok(Soup { shapes, labels: Labels { prims, bounds, ignored } })
}

impl Labels {
    /// The primitive of shape `index`.
    #[inline]
    pub fn prim(&self, index: u32) -> u32 {
        self.prims.get(index as usize).copied().unwrap_or(index)
    }

    /// `line`, and what was left out.
    pub fn describe(&self, line: &str) -> String {
        match self.ignored {
            0 => line.to_string(),
            n => format!("{line}, {n} primitives left out that are not finite or reach beyond {LIMIT:e}"),
        }
    }
}

/// False for a NaN.
fn within_limit(v: Vec3) -> bool {
    v.abs().cmple(Vec3::splat(LIMIT)).all()
}

/// The ray that a peer is given, or `None` if it is taken to miss.
///
/// What [`Ray::intake`] refuses misses, and so does a ray with an origin or a direction beyond [`LIMIT`]. Peers look forwards
/// only: a negative `t_min` becomes 0.
#[allow(dead_code, reason = "no peer may be compiled in")]
#[inline]
pub(super) fn forwards(ray: &Ray) -> Option<Ray> {
    let ray = ray.intake()?;
    let usable = within_limit(ray.origin) && within_limit(ray.direction) && ray.t_max >= 0.0;
    usable.then(|| ray.with_range(ray.t_min.max(0.0), ray.t_max))
}

/// `build()`, or an error if that panics; `name` is whose code it is.
///
/// Some peers panic over triangles that they cannot handle; the panic's own message goes wherever such messages go.
///
/// # Errors
/// It panics.
#[allow(dead_code, reason = "no peer may be compiled in")]
pub(super) fn guarded<T>(name: &str, shapes: usize, build: impl FnOnce() -> T) -> Result<T> {
    std::panic::catch_unwind(std::panic::AssertUnwindSafe(build))
        .map_err(|_| Error::invalid(format!("{name} panics while it builds over {shapes} primitives")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_peers_cannot_take_is_left_out() {
        let good = [Vec3::ZERO, Vec3::X, Vec3::Y];
        let far = [Vec3::ZERO, Vec3::X, Vec3::splat(1e19)];
        let soup = Soup::of(&vec![[Vec3::NAN; 3], good, far, good]).expect("triangles");
        assert_eq!((soup.shapes.len(), soup.labels.ignored), (2, 2));
        assert_eq!([0, 1].map(|i| soup.labels.prim(i)), [1, 3]);
        assert_eq!(soup.labels.bounds.max, Vec3::splat(1e19), "it can be hit, if not by the peer");
        let soup = Soup::of(&vec![good, good]).expect("triangles");
        assert_eq!([0, 1].map(|i| soup.labels.prim(i)), [0, 1]);
        assert!(soup.labels.describe("x") == "x");
        let Err(error) = Soup::of(&vec![Sphere { centre: Vec3::ZERO, radius: 1.0 }]) else { panic!("a sphere") };
        assert!(error.to_string().contains("primitive 0 of 1 is none"), "{error}");
    }

    #[test]
    fn spheres_are_given_without_those_that_peers_cannot_take() {
        let sphere = |radius| Sphere { centre: Vec3::ONE, radius };
        let far = Sphere { centre: Vec3::splat(1e19), radius: 1.0 };
        let Ok(Given::Spheres(soup)) = Given::of(&vec![sphere(0.0), sphere(2.0), far, sphere(f32::NAN), sphere(3.0)])
        else {
            panic!("spheres")
        };
        assert_eq!(
            (soup.shapes.iter().map(|s| s.radius).collect::<Vec<_>>(), soup.labels.ignored),
            (vec![2.0, 3.0], 3)
        );
        assert_eq!([0, 1].map(|i| soup.labels.prim(i)), [1, 4]);
        let nothing: Vec<Sphere> = Vec::new();
        assert!(matches!(Given::of(&nothing), Ok(Given::Triangles(soup)) if soup.shapes.is_empty()));
    }

    #[test]
    fn rays_that_peers_cannot_take_miss() {
        let ray = Ray::new(Vec3::ONE, Vec3::X);
        assert_eq!(forwards(&ray.with_range(-2.0, 5.0)), Some(ray.with_range(0.0, 5.0)));
        assert_eq!(forwards(&ray.with_range(-2.0, -1.0)), None);
        assert_eq!(forwards(&Ray::new(Vec3::splat(1e19), Vec3::X)), None);
        assert_eq!(forwards(&Ray::new(Vec3::ONE, Vec3::X * 1e19)), None);
    }

    #[test]
    fn a_panic_becomes_an_error() {
        let Err(error) = guarded("it", 3, || assert_eq!(1, 2)) else { panic!("no error") };
        assert!(error.to_string().contains("it panics while it builds over 3 primitives"), "{error}");
        assert_eq!(guarded("it", 3, || 7).ok(), Some(7));
    }
}
