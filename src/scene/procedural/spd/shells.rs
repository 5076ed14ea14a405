//! Shells: a sea shell after Pickover, thousands of spheres that overlap, pathological on purpose.

use super::setting::{Setting, surface};
use super::{Body, Entry, Options, Stage};
use crate::error::Result;
use crate::geometry::Sphere;
use glam::DVec3;
use std::f64::consts::PI;

pub(in super::super) const ENTRY: Entry = Entry {
    name: "spd-shells",
    summary: "SPD shells: a spiral of 5761 spheres that overlap heavily; z up",
    options: "n: size factor, doublings of the number of spheres (5)",
    slots: "all have slot 0",
    source: "Pickover 1989; SPD 3.14 shells",
    keys: &["n"],
    body,
    stage,
};

fn body(options: &Options) -> Result<Body> {
    let n = options.n(5, 1..=50)?;
    let steps = 180_u64 << n;
    options.limit_size(steps + 1)?;
    let sphere = |i: u64| {
        // From -12 pi to 6 pi.
        let angle = 18.0 * PI * (i as f64 / steps as f64 - 2.0 / 3.0);
        let radius = (0.15 * angle).exp();
        let centre = radius * DVec3::new(angle.sin(), angle.cos(), -2.0);
        (Sphere { centre: centre.as_vec3(), radius: radius as f32 }, 0)
    };
    Ok(Body { spheres: (0..=steps).map(sphere).collect(), ..Body::default() })
}

fn stage(_: &Options) -> Stage {
    let setting = Setting {
        from: [-6.0, -60.0, 35.0],
        at: [0.0, 8.0, -15.0],
        lights: &[[-100.0, -100.0, 100.0]],
        ..Setting::USUAL
    };
    setting.stage(vec![surface("shell", [1.0, 0.8, 0.4], 0.8, 0.2)], Vec::new())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn standard_size_has_the_original_count_and_ends() {
        let spheres = body(&Options::default()).expect("the standard size").spheres;
        assert_eq!(spheres.len(), 5761);
        // Angles from -12 pi to 6 pi: the spiral ends on the y axis.
        for (i, angle) in [(0, -12.0 * PI), (3840, 0.0), (5760, 6.0 * PI)] {
            let (sphere, radius) = (spheres[i].0, (0.15 * angle).exp() as f32);
            assert!((sphere.radius / radius - 1.0).abs() < 1e-6, "{sphere:?}");
            assert!((sphere.centre / radius - glam::Vec3::new(0.0, 1.0, -2.0)).length() < 1e-6, "{sphere:?}");
        }
    }
}
