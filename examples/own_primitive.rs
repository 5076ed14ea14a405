//! A primitive of one's own, discs, in every accelerator.

use glam::{DVec3, Vec3};
use skipgrid::geometry::Best;
use skipgrid::{Aabb, Accel, Geometry, Ray, registry};

/// A flat disc.
struct Disc {
    centre: Vec3,
    /// Unit normal.
    normal: Vec3,
    radius: f32,
}

/// A set of discs.
struct Discs(Vec<Disc>);

impl Geometry for Discs {
    /// The tests of one ray share nothing.
    type Prep = ();

    fn len(&self) -> u32 {
        self.0.len() as u32
    }

    fn bounds(&self, prim: u32) -> Aabb {
        let disc = &self.0[prim as usize];
        // A box around the ball is not the least one, but certainly contains the disc and all rounding.
        let reach = Vec3::splat(disc.radius * 1.001);
        Aabb { min: disc.centre - reach, max: disc.centre + reach }
    }

    fn prepare(&self, _: &Ray) {}

    fn test(&self, prim: u32, ray: &Ray, (): &(), best: &mut Best) {
        let Disc { centre, normal, radius } = self.0[prim as usize];
        let [origin, direction, centre, normal] = [ray.origin, ray.direction, centre, normal].map(|v| v.as_dvec3());
        // A ray within the plane divides by zero: the NaN or infinity that comes out is no hit.
        let t = (centre - origin).dot(normal) / direction.dot(normal);
        if (origin + t * direction).distance_squared(centre) <= f64::from(radius).powi(2) {
            best.offer(ray, t, prim);
        }
    }
}

fn main() -> skipgrid::Result<()> {
    // Directions on a spiral, as even as can be; discs on a sphere, facing outwards.
    let spiral = |i: u32, n: u32| {
        let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(n);
        let (sin, cos) = (2.399_963 * f64::from(i)).sin_cos();
        DVec3::new(cos * (1.0 - z * z).sqrt(), sin * (1.0 - z * z).sqrt(), z).as_vec3()
    };
    let disc = |normal: Vec3| Disc { centre: normal * 10.0, normal, radius: 0.2 };
    let discs = Discs((0..2000).map(|i| disc(spiral(i, 2000))).collect());
    let rays: Vec<Ray> = (0..10_000).map(|i| Ray::new(Vec3::new(1.0, 2.0, 3.0), spiral(i, 10_000))).collect();

    let mut answers = Vec::new();
    for entry in registry::ENTRIES.iter().filter(|entry| entry.suits(&discs)) {
        let accel = registry::build(entry.name, &discs)?;
        let hits: Vec<_> = rays.iter().map(|ray| accel.closest_hit(ray)).collect();
        println!("{:<12} {} of {} rays hit a disc", entry.name, hits.iter().flatten().count(), rays.len());
        answers.push(hits);
    }
    assert!(answers.iter().all(|hits| *hits == answers[0]), "all accelerators give the same answers");
    Ok(())
}
