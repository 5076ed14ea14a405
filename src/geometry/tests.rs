//! Every set against integers: small lattices, where ties, edges, tangents and parallels are common.

use super::*;
use glam::Vec3;

type V = [i128; 3];

/// Seeded numbers (xorshift64*), for tests that need no feature.
pub(crate) struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }
    pub fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 8
    }
    /// Uniform in `0 <= x < 1`, 24 bits.
    pub fn unit(&mut self) -> f32 {
        (self.next() >> 32) as f32 / 16_777_216.0
    }
    /// Uniform in the cube from -1 to 1.
    pub fn in_cube(&mut self) -> Vec3 {
        Vec3::from([(); 3].map(|()| self.unit() * 2.0 - 1.0))
    }
    /// Uniform in `-n..=n`.
    pub fn within(&mut self, n: i128) -> i128 {
        i128::from(self.next()) % (2 * n + 1) - n
    }
    /// Triangles about middles that are uniform in the cube, with corners no further away than `size` along an axis.
    pub fn soup(&mut self, count: usize, size: f32) -> Vec<Triangle> {
        let mut triangle = || {
            let p = self.in_cube();
            [p, p + size * self.in_cube(), p + size * self.in_cube()]
        };
        (0..count).map(|_| triangle()).collect()
    }
    pub fn vector(&mut self, n: i128) -> V {
        [(); 3].map(|()| self.within(n))
    }
}

fn dot(a: V, b: V) -> i128 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
fn cross(a: V, b: V) -> V {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
fn minus(a: V, b: V) -> V {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}
/// The lattice point times a power of two: exact.
fn float(v: V, scale: f32) -> Vec3 {
    Vec3::from_array(v.map(|x| x as f32 * scale))
}

/// The exact parameter as a fraction with positive denominator, by the triangle's definition.
fn crossing(o: V, d: V, corners: [V; 3]) -> Option<(i128, i128)> {
    let [a, b, c] = corners.map(|p| minus(p, o));
    let [u, v, w] = [(c, b), (a, c), (b, a)].map(|(p, q)| dot(d, cross(p, q)).signum());
    let n = cross(minus(b, a), minus(c, a));
    let (num, den) = (dot(a, n), dot(d, n));
    let sides = [u, v, w];
    (den != 0 && !(sides.contains(&1) && sides.contains(&-1))).then_some((num * den.signum(), den.abs()))
}

fn closest<G: Geometry>(set: &G, ray: &Ray, order: impl Iterator<Item = u32>) -> Option<(u32, f32)> {
    let ray = ray.intake()?;
    let (prep, mut best) = (set.prepare(&ray), Best::NONE);
    for prim in order {
        set.test(prim, &ray, &prep, &mut best);
        let before = best;
        set.test(prim, &ray, &prep, &mut best);
        assert_eq!(best, before, "testing {prim} twice changed the winner");
    }
    best.prim().map(|prim| (prim, set.round(&ray, &best)))
}

#[test]
fn triangles_agree_with_integers() {
    let mut random = Random(3);
    let (mut hits, mut ties) = (0, 0);
    for round in 0..20_000 {
        // World and direction are scaled apart: t by their quotient. 2^-149 and 2^123 reach the ends of f32.
        let (world, along) = [(0, 0), (-149, 0), (-149, -149), (123, 123), (60, -60), (-60, 60), (0, -149)][round % 7];
        let (world, along) = (2f64.powi(world), 2f64.powi(along));
        let n = [2, 4, 12][round % 3];
        let (o, d) = (random.vector(n), random.vector(n));
        // Few corners: triangles share them, and edges, and sometimes all.
        let corners: Vec<V> = (0..6).map(|_| random.vector(n)).collect();
        let lattice: Vec<[V; 3]> =
            (0..6).map(|_| [(); 3].map(|()| corners[random.next() as usize % corners.len()])).collect();
        let set: Vec<Triangle> = lattice.iter().map(|t| t.map(|p| float(p, world as f32))).collect();
        // Bounds in halves, often exactly at a hit.
        let (mut low, mut high) = (random.within(6), random.within(6));
        if world < along && world < 1e-40 {
            (low, high) = (2 * low, 2 * high); // half of the least f32 is none
        }
        let unit = world / along / 2.0;
        let ray = Ray::new(float(o, world as f32), float(d, along as f32))
            .with_range((low as f64 * unit) as f32, (high as f64 * unit) as f32);
        // A bound that leaves f32 becomes infinite or zero.
        let bound = |x: f32, halves: i128, (num, den): (i128, i128)| {
            if x.is_infinite() {
                0f32.total_cmp(&x)
            } else if x == 0.0 {
                num.cmp(&0)
            } else {
                (2 * num).cmp(&(halves * den))
            }
        };
        let expected = lattice
            .iter()
            .enumerate()
            .filter_map(|(i, t)| Some((crossing(o, d, *t)?, i as u32)))
            .filter(|(t, _)| {
                ray.t_min <= ray.t_max && bound(ray.t_min, low, *t).is_ge() && bound(ray.t_max, high, *t).is_le()
            })
            .min_by(|((n1, d1), _), ((n2, d2), _)| (n1 * d2).cmp(&(n2 * d1)));
        let found = closest(&set, &ray, 0..6);
        assert_eq!(found, closest(&set, &ray, (0..6).rev()), "round {round}: {ray:?} {set:?}");
        assert_eq!(found.map(|(prim, _)| prim), expected.map(|(_, i)| i), "round {round}: {ray:?} {set:?}");
        if let (Some((_, t)), Some(((num, den), i))) = (found, expected) {
            // The quotient of small integers is never within 2^-53 of a middle without being one.
            assert_eq!(t, (num as f64 / den as f64 * (world / along)) as f32, "round {round}: {ray:?}");
            hits += 1;
            let ties_with = |t: &[V; 3]| crossing(o, d, *t).is_some_and(|(n, d)| n * den == num * d);
            ties += usize::from(lattice[i as usize + 1..].iter().any(ties_with));
        }
    }
    assert!(hits > 1000 && ties > 100, "{hits} hits, {ties} ties");
}

#[test]
fn bad_triangles_are_never_hit() {
    let good = [Vec3::new(-1.0, -1.0, 1.0), Vec3::new(1.0, -1.0, 1.0), Vec3::new(0.0, 1.0, 1.0)];
    let ray = Ray::new(Vec3::ZERO, Vec3::Z);
    assert_eq!(closest(&vec![good], &ray, 0..1), Some((0, 1.0)));
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for i in 0..9 {
            let mut bad = good;
            bad[i / 3][i % 3] = value;
            assert_eq!(closest(&vec![bad], &ray, 0..1), None, "{bad:?}");
            assert!([bad].bounds(0).is_empty());
        }
    }
    let flat = [good[0], good[1], (good[0] + good[1]) / 2.0];
    for degenerate in [[good[0]; 3], [good[0], good[0], good[1]], flat] {
        for target in degenerate {
            assert_eq!(closest(&vec![degenerate], &Ray::new(Vec3::ZERO, target), 0..1), None, "{degenerate:?}");
        }
    }
}

/// Greatest integer whose square is not above `x`.
fn root(x: i128) -> i128 {
    let mut r = (x as f64).sqrt() as i128;
    while r * r > x {
        r -= 1;
    }
    while (r + 1) * (r + 1) <= x {
        r += 1;
    }
    r
}

/// What integers say of a sphere's least parameter at or above 0: least and greatest value that it may have.
fn sphere_parameter(o: V, d: V, centre: V, r: i128) -> Option<(f64, f64)> {
    let f = minus(o, centre);
    let (a, b, c) = (dot(d, d), -dot(f, d), dot(f, f) - r * r);
    let discriminant = b * b - a * c;
    if discriminant < 0 {
        return None;
    }
    let bits = ((126 - discriminant.max(1).ilog2().min(126)) / 2).min(40);
    let s = root(discriminant << (2 * bits));
    let parameter = |x: i128| x as f64 / a as f64 / 2f64.powi(bits as i32);
    // The near root is at or above 0 if b >= 0 and b^2 >= discriminant, which is c >= 0; else the far one if c <= 0 or
    // b >= 0.
    if b >= 0 && c >= 0 {
        Some((parameter((b << bits) - s - 1), parameter((b << bits) - s)))
    } else if c <= 0 {
        Some((parameter((b << bits) + s), parameter((b << bits) + s + 1)))
    } else {
        None
    }
}

#[test]
fn spheres_agree_with_integers() {
    let mut random = Random(5);
    // Name, radius, greatest distance of the point aimed at from the centre, steps back to the origin, direction.
    let cases: [(&str, i128, i128, i128, i128); 9] = [
        ("lattice", 3, 5, 2, 3),
        ("ordinary", 1000, 1200, 30, 100),
        ("inside", 100_000, 50_000, 5, 1000),
        ("far", 3, 4, 1 << 18, 4),
        ("very far", 1, 1, 1 << 20, 3),
        ("tangent", 1 << 18, -1, 1000, 256),
        ("tangent far", 100, -1, 1 << 17, 6),
        ("above a great one", 1 << 20, -2, 1, 5),
        ("point", 0, 1, 4, 4),
    ];
    for (name, r, reach, steps, n) in cases {
        let (mut hits, mut grazes) = (0, 0);
        for round in 0..4000 {
            let d = random.vector(n);
            if d == [0; 3] {
                continue;
            }
            let centre = random.vector(3);
            let aim = if reach >= 0 {
                random.vector(reach)
            } else {
                // Next to the silhouette: across the direction, as long as the radius.
                let across = cross(d, random.vector(50)).map(|x| x as f64);
                let length = across.iter().map(|x| x * x).sum::<f64>().sqrt().max(1.0);
                across.map(|x| (x / length * r as f64).round() as i128 + random.within(-reach - 1))
            };
            let target = [0, 1, 2].map(|k| centre[k] + aim[k]);
            let back = random.within(steps);
            let o = [0, 1, 2].map(|k| target[k] - back * d[k]);
            let (world, along) = [(0, 0), (-130, 0), (90, 90), (-60, 60)][round % 4];
            let (world, along) = (2f64.powi(world), 2f64.powi(along));
            let set = vec![Sphere { centre: float(centre, world as f32), radius: r as f32 * world as f32 }];
            let ray = Ray::new(float(o, world as f32), float(d, along as f32));
            let expected = sphere_parameter(o, d, centre, r);
            let found = closest(&set, &ray, 0..1);
            assert_eq!(found.is_some(), expected.is_some(), "{name} {round}: {ray:?} {set:?} {expected:?}");
            let (Some((_, t)), Some((low, high))) = (found, expected) else { continue };
            hits += 1;
            let f = minus(o, centre);
            grazes += usize::from(dot(f, f) == r * r);
            let (low, high) = (low * (world / along), high * (world / along));
            let (t, ulp) = (f64::from(t), f64::from(t.next_up()) - f64::from(t));
            assert!(
                t >= low - ulp && t <= high + ulp,
                "{name} {round}: {t:e}, not {low:e} to {high:e}: {ray:?} {set:?}"
            );
        }
        assert!(hits > 60, "{name}: {hits} hits, {grazes} from the surface");
    }
}

#[test]
fn a_sphere_is_its_surface() {
    let set = vec![Sphere { centre: Vec3::new(1.0, 2.0, 3.0), radius: 2.0 }];
    let cell = |min: [f64; 3], max: [f64; 3]| Cell { min: min.into(), max: max.into() };
    assert!(!set.overlaps(0, &cell([0.5, 1.5, 2.5], [1.5, 2.5, 3.5])), "strictly inside");
    assert!(!set.overlaps(0, &cell([2.3, 3.3, 4.3], [3.0, 4.0, 5.0])), "a corner of the bounds");
    assert!(set.overlaps(0, &cell([3.0, 2.0, 3.0], [4.0, 3.0, 4.0])), "touches in a point");
    assert!(set.overlaps(0, &cell([-9.0, -9.0, -9.0], [9.0, 9.0, 9.0])), "contains it");
    assert!(set.overlaps(0, &cell([1.0, 2.0, 3.0], [1.0, 2.0, 5.0])), "a segment from the centre to the surface");
    assert_eq!(set.bounds(0), Aabb { min: Vec3::new(-1.0, 0.0, 1.0), max: Vec3::new(3.0, 4.0, 5.0) });
    // 1 - 2^-30 lies between f32 values, 1 - 2^-100 between f64 values.
    for radius in [2f32.powi(-30), 2f32.powi(-100)] {
        let set = vec![Sphere { centre: Vec3::ONE, radius }];
        assert_eq!(set.bounds(0), Aabb { min: Vec3::splat(1f32.next_down()), max: Vec3::splat(1f32.next_up()) });
    }
    for (centre, radius) in [
        (Vec3::NAN, 1.0),
        (Vec3::ZERO, f32::NAN),
        (Vec3::ZERO, -1.0),
        (Vec3::ZERO, f32::INFINITY),
        (Vec3::MAX, f32::MAX),
    ] {
        let set = vec![Sphere { centre, radius }];
        assert!(set.bounds(0).is_empty(), "{set:?}");
        assert_eq!(closest(&set, &Ray::new(Vec3::ZERO, Vec3::X), 0..1), None, "{set:?}");
    }
}

#[test]
fn rays_from_the_surface_start_at_zero() {
    let set = vec![Sphere { centre: Vec3::ZERO, radius: 5.0 }];
    let at = |o: Vec3, d: Vec3| closest(&set, &Ray::new(o, d), 0..1);
    assert_eq!(at(Vec3::new(3.0, 4.0, 0.0), Vec3::X), Some((0, 0.0)));
    assert_eq!(at(Vec3::new(3.0, 4.0, 0.0), Vec3::NEG_X), Some((0, 0.0)));
    assert_eq!(at(Vec3::new(3.0, 4.0, 0.0), Vec3::new(4.0, -3.0, 0.0)), Some((0, 0.0)), "tangent");
    let past = Ray::new(Vec3::new(3.0, 4.0, 0.0), Vec3::NEG_X).with_range(1e-30, f32::INFINITY);
    assert_eq!(closest(&set, &past, 0..1), Some((0, 6.0)));
}

#[test]
fn triangles_and_spheres_have_one_order() {
    let mut random = Random(9);
    let (mut both, mut ties) = (0, 0);
    for round in 0..20_000 {
        let n = 3;
        let (o, d) = (random.vector(n), random.vector(n));
        let lattice: Vec<[V; 3]> = (0..4).map(|_| [(); 3].map(|()| random.vector(n))).collect();
        let set = Mixed {
            triangles: lattice.iter().map(|t| t.map(|p| float(p, 1.0))).collect(),
            spheres: (0..3)
                .map(|_| Sphere { centre: float(random.vector(n), 1.0), radius: random.within(n) as f32 })
                .collect(),
        };
        let ray = Ray::new(float(o, 1.0), float(d, 1.0));
        let found = closest(&set, &ray, 0..7);
        for start in 0..7 {
            assert_eq!(
                found,
                closest(&set, &ray, (0..7).map(|i| (5 * i + start) % 7)),
                "round {round}: {ray:?} {set:?}"
            );
        }
        let triangle = closest(&set.triangles, &ray, 0..4);
        let sphere = closest(&set.spheres, &ray, 0..3);
        let Some(((p, t), (s, u))) = triangle.zip(sphere) else {
            assert_eq!(found, triangle.or(sphere.map(|(s, t)| (s + 4, t))));
            continue;
        };
        both += 1;
        // Parameters of such small numbers are equal or far apart in f32 too. Where they are equal, the side to which
        // the sphere's f64 is rounded decides.
        ties += usize::from(t == u);
        let first = [(p, t), (s + 4, u)];
        let expected = if t == u {
            found == Some(first[0]) || found == Some(first[1])
        } else {
            found == Some(first[usize::from(u < t)])
        };
        assert!(expected, "round {round}: {found:?} of {first:?}: {ray:?} {set:?}");
    }
    assert!(both > 1000 && ties > 20, "{both} rays meet both, {ties} at once");

    // Exactly at the same place: the triangle has the lesser index.
    let corner = |x, y| Vec3::new(x, y, 1.0);
    let set = Mixed {
        triangles: vec![[corner(-1.0, -1.0), corner(2.0, -1.0), corner(-1.0, 2.0)]],
        spheres: vec![Sphere { centre: Vec3::new(0.0, 0.0, 3.0), radius: 2.0 }],
    };
    let ray = Ray::new(Vec3::ZERO, Vec3::Z);
    assert_eq!(closest(&set, &ray, [0, 1].into_iter()), Some((0, 1.0)));
    assert_eq!(closest(&set, &ray, [1, 0].into_iter()), Some((0, 1.0)));
}
