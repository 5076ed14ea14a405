//! What peers are given: triangles and rays that none of them chokes on.

use crate::error::{Error, Result};
use crate::geometry::{Geometry, Triangle};
use crate::ray::{Aabb, Ray};
use glam::Vec3;

/// Coordinates of triangles and rays are at most this large: the root of the greatest f32.
///
/// Embree documents that it ignores triangles beyond it; obvhs' `CwBvh` panics when it builds over some, and Embree with
/// assertions ends the process when a ray is beyond it.
pub const LIMIT: f32 = 1.844e18;

/// The triangles of a geometry that peers can take, in its order.
#[derive(Clone, Debug)]
pub struct Soup {
    /// Corners, world units, none beyond [`LIMIT`].
    pub triangles: Vec<Triangle>,
    /// What the peer's answers mean.
    pub labels: Labels,
}

/// The primitives behind the triangles of a [`Soup`].
#[derive(Clone, Debug)]
pub struct Labels {
    /// Primitive of each triangle; empty if triangle `i` is primitive `i`.
    prims: Vec<u32>,
    /// Around all primitives that a ray can hit, even those that the peer does not have.
    pub bounds: Aabb,
    /// Primitives left out, as they are not finite or reach beyond [`LIMIT`].
    pub ignored: u32,
}

impl Soup {
    /// The triangles of `geometry`.
    ///
    /// # Errors
    /// A primitive is no triangle, or there are more than 2^32 / 3 triangles, or memory does not suffice for them.
    pub fn of<G: Geometry + ?Sized>(geometry: &G) -> Result<Self> {
        // Peers number corners by u32.
        const MOST: u32 = u32::MAX / 3;
        let (len, mut bounds, mut prims) = (geometry.len(), Aabb::EMPTY, Vec::new());
        let mut triangles: Vec<Triangle> = Vec::new();
        let wanted = u64::from(len) * (size_of::<Triangle>() + size_of::<u32>()) as u64;
        let room = triangles.try_reserve_exact(len as usize).is_ok() && prims.try_reserve_exact(len as usize).is_ok();
        if len > MOST || !room {
            let allowed = u64::from(MOST) * size_of::<Triangle>() as u64;
            return Err(Error::TooLarge { what: format!("{len} triangles for another library"), wanted, allowed });
        }
        for prim in 0..len {
            let Some(triangle) = geometry.triangle(prim) else {
                return Err(Error::invalid(format!(
                    "needs a scene of triangles alone, but primitive {prim} of {len} is none"
                )));
            };
            bounds = bounds.union(&geometry.bounds(prim));
            if triangle.iter().all(|&corner| within_limit(corner)) {
                triangles.push(triangle);
                prims.push(prim);
            }
        }
        let ignored = len - prims.len() as u32;
        let prims = if ignored == 0 { Vec::new() } else { prims };
        Ok(Self { triangles, labels: Labels { prims, bounds, ignored } })
    }
}

impl Labels {
    /// The primitive of triangle `index`.
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
#[inline]
pub fn forwards(ray: &Ray) -> Option<Ray> {
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
pub fn guarded<T>(name: &str, triangles: usize, build: impl FnOnce() -> T) -> Result<T> {
    std::panic::catch_unwind(std::panic::AssertUnwindSafe(build))
        .map_err(|_| Error::invalid(format!("{name} panics while it builds over {triangles} triangles")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Sphere;

    #[test]
    fn what_peers_cannot_take_is_left_out() {
        let good = [Vec3::ZERO, Vec3::X, Vec3::Y];
        let far = [Vec3::ZERO, Vec3::X, Vec3::splat(1e19)];
        let soup = Soup::of(&vec![[Vec3::NAN; 3], good, far, good]).expect("triangles");
        assert_eq!((soup.triangles.len(), soup.labels.ignored), (2, 2));
        assert_eq!([0, 1].map(|i| soup.labels.prim(i)), [1, 3]);
        assert_eq!(soup.labels.bounds.max, Vec3::splat(1e19), "it can be hit, if not by the peer");
        let soup = Soup::of(&vec![good, good]).expect("triangles");
        assert_eq!([0, 1].map(|i| soup.labels.prim(i)), [0, 1]);
        assert!(soup.labels.describe("x") == "x");
        let Err(error) = Soup::of(&vec![Sphere { centre: Vec3::ZERO, radius: 1.0 }]) else { panic!("a sphere") };
        assert!(error.to_string().contains("primitive 0 of 1 is none"), "{error}");
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
        assert!(error.to_string().contains("it panics while it builds over 3 triangles"), "{error}");
        assert_eq!(guarded("it", 3, || 7).ok(), Some(7));
    }
}
