//! Hits in exact rational arithmetic: the root lies within half a unit in the last place of the answer.

use super::{brute, teapot};
use crate::random::Random;
use glam::Vec3;
use num_bigint::BigInt;
use skipgrid::Ray;
use skipgrid::geometry::BezierPatches;

/// Numbers are integers times 2^-SHIFT: every f32 of the scene, and f64 parameters, are such numbers.
const SHIFT: usize = 120;

fn of(x: f64) -> BigInt {
    let bits = x.to_bits();
    let (exponent, fraction) = ((bits >> 52 & 0x7ff) as i64, bits & ((1 << 52) - 1));
    let (mantissa, power) = if exponent == 0 { (fraction, -1074) } else { (fraction | 1 << 52, exponent - 1075) };
    let shift = power + SHIFT as i64;
    let whole = if shift >= 0 { BigInt::from(mantissa) << shift } else { BigInt::from(mantissa) >> -shift };
    assert!(shift >= 0 || (&whole << -shift) == BigInt::from(mantissa), "{x:e} needs more digits");
    if x < 0.0 { -whole } else { whole }
}

/// A cubic at `t` times 2^(4 SHIFT), from control values and `t` times 2^SHIFT.
fn cubic(c: &[BigInt; 4], t: &BigInt) -> BigInt {
    let s = (BigInt::from(1) << SHIFT) - t;
    let three = BigInt::from(3);
    &c[0] * &s * &s * &s + &three * &c[1] * &s * &s * t + &three * &c[2] * &s * t * t + &c[3] * t * t * t
}

/// Coordinates of the patch at (u, v), times 2^(7 SHIFT).
fn surface(points: &[[Vec3; 4]; 4], u: f64, v: f64) -> [BigInt; 3] {
    let (u, v) = (of(u), of(v));
    [0, 1, 2].map(|axis| {
        let row = |j: usize| cubic(&points[j].map(|p| of(f64::from(p[axis]))), &u);
        cubic(&[row(0), row(1), row(2), row(3)], &v)
    })
}

/// The residuals `(s_i - o_i) d_k - (s_k - o_k) d_i` at (u, v), times 2^(8 SHIFT).
fn residuals(points: &[[Vec3; 4]; 4], ray: &Ray, axis: usize, u: f64, v: f64) -> [BigInt; 2] {
    let s = surface(points, u, v);
    let o = ray.origin.to_array().map(|x| of(f64::from(x)) << (6 * SHIFT));
    let d = ray.direction.to_array().map(|x| of(f64::from(x)));
    [1, 2].map(|n| {
        let i = (axis + n) % 3;
        (&s[i] - &o[i]) * &d[axis] - (&s[axis] - &o[axis]) * &d[i]
    })
}

fn positive(x: &BigInt) -> bool {
    *x > BigInt::from(0)
}

#[test]
fn answers_are_the_exact_ones_rounded() {
    let points = teapot();
    let patches = BezierPatches::new(points.iter().copied());
    let accel = brute(&patches);
    let mut random = Random::new(51);
    let mut checked = 0;
    while checked < 200 {
        let origin = Vec3::new(0.0, 1.5, 0.0) + 6.0 * random.in_cube().normalize_or(Vec3::X);
        let ray = Ray::new(origin, Vec3::new(0.0, 1.5, 0.0) + 2.0 * random.in_cube() - origin);
        let Some(hit) = accel.closest_hit(&ray) else { continue };
        let (u, v) = patches.locate(hit.prim, &ray, hit.t).expect("a hit");
        let control = &points[hit.prim as usize];
        let axis = (0..3).max_by(|&a, &b| ray.direction[a].abs().total_cmp(&ray.direction[b].abs())).expect("three");
        let round = |x: f64| (x * 2f64.powi(56)).round() / 2f64.powi(56);
        let (u, v) = (round(u), round(v));
        // The Jacobian of the residuals, from exact differences.
        let step = 2f64.powi(-30);
        if !(step..1.0 - step).contains(&u) || !(step..1.0 - step).contains(&v) {
            continue;
        }
        let value = |x: &BigInt| {
            // To f64 through the leading bits.
            let bits = x.bits().saturating_sub(60);
            (x >> bits).to_string().parse::<f64>().expect("digits") * 2f64.powi(bits as i32 - 8 * SHIFT as i32)
        };
        let at = |u, v| residuals(control, &ray, axis, u, v);
        let difference = |a: [BigInt; 2], b: [BigInt; 2]| [0, 1].map(|i| value(&(&a[i] - &b[i])) / (2.0 * step));
        let along_u = difference(at(u + step, v), at(u - step, v));
        let along_v = difference(at(u, v + step), at(u, v - step));
        let determinant = along_u[0] * along_v[1] - along_u[1] * along_v[0];
        let size = (along_u[0].hypot(along_u[1])) * (along_v[0].hypot(along_v[1]));
        if determinant.abs() < 0.05 * size {
            continue; // grazing: the box below would have to be larger
        }
        // A box around (u, v), turned by the Jacobian: the combinations of the residuals that are du and dv change their
        // signs between its opposite sides, so the exact root lies within (Miranda).
        let half = 2f64.powi(-48);
        let turned = |[f, g]: [BigInt; 2]| {
            let scaled = |x: f64| of((x / determinant.signum() * 2f64.powi(20)).round());
            let (a, b, c, d) = (scaled(along_v[1]), scaled(along_v[0]), scaled(along_u[1]), scaled(along_u[0]));
            [a * &f - b * &g, d * &g - c * &f]
        };
        for along in [-half, 0.0, half] {
            let [low, high] = [turned(at(u - half, v + along)), turned(at(u + half, v + along))];
            assert!(!positive(&low[0]) && positive(&high[0]), "{ray:?} {hit:?}");
            let [low, high] = [turned(at(u + along, v - half)), turned(at(u + along, v + half))];
            assert!(!positive(&low[1]) && positive(&high[1]), "{ray:?} {hit:?}");
        }
        // Over the box the depth changes by less than 2^-42: the answer is within that of half a unit in the last place.
        let depth =
            value(&((&surface(control, u, v)[axis] - (of(f64::from(ray.origin[axis])) << (6 * SHIFT))) << SHIFT));
        let t = depth / f64::from(ray.direction[axis]);
        let ulp = f64::from(hit.t.next_up() - hit.t);
        assert!((t - f64::from(hit.t)).abs() <= 0.5 * ulp + 2f64.powi(-42), "{ray:?} {hit:?} {t}");
        checked += 1;
    }
}
