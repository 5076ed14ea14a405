//! Mount: a fractal mountain after Carpenter, four glass balls above it.

use super::super::icosphere;
use super::super::patch::{Edge, patch};
use super::setting::{Setting, glass, surface};
use super::{Body, Entry, Mesh, Options, Stage};
use crate::error::Result;
use crate::geometry::Sphere;
use glam::{DQuat, DVec3};
use std::f64::consts::{SQRT_2, TAU};

pub(in super::super) const ENTRY: Entry = Entry {
    name: "spd-mount",
    summary: "SPD mount: a fractal mountain of 8192 triangles and four glass balls; z up",
    options: "n: size factor, halvings of the edge (6); balls: triangles instead of spheres, halvings of an icosahedron's \
              edges",
    slots: "0 mountain, 1 balls",
    source: "Haines 1987, SPD 3.14 mount, with the faulty hash that is kept for comparison",
    keys: &["n", "balls"],
    body,
    stage,
};

/// Of the surface; decides how rough it is.
const FRACTAL_DIMENSION: f64 = 2.2;
/// Number of this mountain among its kind.
const SEED: u64 = 21;
const BALL_RADIUS: f64 = 0.17;
const BALLS_CENTRE: DVec3 = DVec3::new(-0.8, 0.8, 1.0);

fn body(options: &Options) -> Result<Body> {
    let n = options.n(6, 1..=10)?;
    let level = options.balls()?;
    options.limit_size((2_u64 << (2 * n)) + level.map_or(4, |level| 4 * icosphere::triangles(level)))?;
    let steps = 1 << n;
    let coordinate = |u: f64| 2.0 * u - 1.0;
    let mut mesh = patch("mountain", (steps, Edge::Open), (steps, Edge::Open), |u, v| {
        (DVec3::new(coordinate(u), coordinate(v), 0.0), DVec3::ZERO)
    });
    mesh.normals = Vec::new();
    // Samples of a patch run along u first, as the heights along x.
    mesh.positions.iter_mut().zip(heights(n)).for_each(|(p, z)| p.z = z as f32);
    let balls = balls().map(|centre| Sphere { centre: centre.as_vec3(), radius: BALL_RADIUS as f32 });
    let Some(level) = level else {
        return Ok(Body { meshes: vec![mesh], spheres: balls.map(|ball| (ball, 1)).to_vec(), ..Body::default() });
    };
    let unit = icosphere::unit(level);
    let balls = balls.map(|ball| Mesh { material: 1, ..icosphere::placed(&unit, &ball) });
    Ok(Body { meshes: std::iter::once(mesh).chain(balls).collect(), ..Body::default() })
}

/// Heights of the (2^n + 1)^2 grid points, x first, by halving squares.
fn heights(n: u32) -> Vec<f64> {
    let ratio = 2.0 / 2_f64.powf(1.0 / (FRACTAL_DIMENSION - 1.0));
    let roughness = (ratio * ratio - 1.0).sqrt();
    let size = 1_usize << n;
    let mut z = vec![0.0; (size + 1) * (size + 1)];
    let at = |x: usize, y: usize| y * (size + 1) + x;
    let mut width = size;
    while width > 1 {
        let half = width / 2;
        // The side of a new square in world units, as a bound on how far a midpoint is moved.
        let rise = half as f64 * 2.0 / size as f64 * roughness;
        let gauss = |x: usize, y: usize| rise * gauss(SEED + hash(x as u64, y as u64, n));
        for y in (0..size).step_by(width) {
            for x in (0..size).step_by(width) {
                let (xm, xr, ym, yu) = (x + half, x + width, y + half, y + width);
                let [ll, lr, ur, ul] = [z[at(x, y)], z[at(xr, y)], z[at(xr, yu)], z[at(x, yu)]];
                // Squares that share an edge agree on its midpoint.
                z[at(xm, y)] = (ll + lr) / 2.0 + gauss(xm, y);
                z[at(xr, ym)] = (lr + ur) / 2.0 + gauss(xr, ym);
                z[at(xm, yu)] = (ur + ul) / 2.0 + gauss(xm, yu);
                z[at(x, ym)] = (ul + ll) / 2.0 + gauss(x, ym);
                z[at(xm, ym)] = (ll + lr + ur + ul) / 4.0 + SQRT_2 * gauss(xm, ym);
            }
        }
        width = half;
    }
    z
}

/// SPD's hash of a grid point at size `n`, 1 to 15; 16 bits, and not a good one.
///
/// Beyond 7 SPD shifts by less than nothing, which C leaves open; here that is a shift to the right.
fn hash(x: u64, y: u64, n: u32) -> u64 {
    let last = if n <= 7 { x << (7 - n) } else { x >> (n - 7) };
    ((x << (23 - n)) + (y << (15 - n)) + last) & 0xffff
}

/// A normally distributed number by the polar method, from SPD's linear congruential generator.
fn gauss(seed: u64) -> f64 {
    let mut state = seed;
    let mut uniform = || {
        state = (28_411 + 8_121 * state) % 134_456;
        2.0 * state as f64 / 134_456.0 - 1.0
    };
    loop {
        let (a, b) = (uniform(), uniform());
        let r = a * a + b * b;
        // The generator has full period, so a pair in the disc comes.
        if r > 0.0 && r < 1.0 {
            return a * (-2.0 * r.ln() / r).sqrt();
        }
    }
}

/// Centres of four balls that touch, a tetrahedron that stands on a face.
fn balls() -> [DVec3; 4] {
    let top = DVec3::new(0.0, 0.0, BALL_RADIUS * 1.5_f64.sqrt());
    let axis = DVec3::new(1.0, 1.0, 0.0).normalize();
    let low = DQuat::from_axis_angle(axis, (-1.0_f64 / 3.0).acos()) * top;
    let foot = |third: f64| BALLS_CENTRE + DQuat::from_rotation_z(third * TAU / 3.0) * low;
    [BALLS_CENTRE + top, foot(0.0), foot(1.0), foot(2.0)]
}

fn stage(_: &Options) -> Stage {
    let setting = Setting { from: [-1.6, 1.6, 1.7], lights: &[[-100.0, -100.0, 100.0]], ..Setting::USUAL };
    setting.stage(vec![surface("rock", [0.5, 0.45, 0.35], 1.0, 0.0), glass(1.5)], Vec::new())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn standard_size_has_the_original_count_and_sum() {
        let made = body(&Options::default()).expect("the standard size");
        let mesh = &made.meshes[0];
        assert_eq!((mesh.triangles.len(), made.spheres.len()), (8192, 4));
        let z = |i: &u32| f64::from(mesh.positions[*i as usize].z);
        // Over the corners of all triangles; the original prints six digits each.
        let sum: f64 = mesh.triangles.iter().flatten().map(z).sum();
        assert!((sum - 4884.7346).abs() < 2e-2, "{sum}");
        let low = mesh.positions.iter().map(|p| p.z).fold(f32::MAX, f32::min);
        let high = mesh.positions.iter().map(|p| p.z).fold(f32::MIN, f32::max);
        assert!((low + 0.70295).abs() < 1e-5 && (high - 0.92314).abs() < 1e-5, "{low} {high}");
    }

    #[test]
    fn balls_touch_each_other() {
        let balls = balls();
        for i in 0..4 {
            for j in 0..i {
                assert!((balls[i].distance(balls[j]) - 2.0 * BALL_RADIUS).abs() < 1e-12);
            }
        }
        let feet = balls[1].z;
        assert!(balls[1..].iter().all(|b| (b.z - feet).abs() < 1e-12) && feet < balls[0].z);
    }
}
