//! The oracle against other formulations of the truth.

use super::*;
use num_bigint::BigInt;

/// SplitMix64 (Steele, Lea & Flood 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: u64) -> u64 {
        self.next() % n
    }

    fn vector(&mut self, number: impl Fn(&mut Self) -> f32) -> Vec3 {
        Vec3::new(number(self), number(self), number(self))
    }
}

type Number = fn(&mut Random) -> f32;

/// Kinds of numbers, from those that meet all the time to those that never do.
const NUMBERS: [(&str, Number); 6] = [
    ("whole", |r| r.below(7) as f32 - 3.0),
    ("quarters", |r| (r.below(33) as f32 - 16.0) / 4.0),
    ("unit", |r| r.below(1 << 25) as f32 / (1 << 24) as f32 - 1.0),
    ("near", |r| 1.0 + (r.below(5) as f32) * f32::EPSILON),
    ("powers", |r| {
        let x = 2f32.powi(r.below(60) as i32 - 30) * (1.0 + r.below(3) as f32);
        [x, -x, 0.0, -0.0][r.below(4) as usize]
    }),
    ("bits", |r| f32::from_bits(r.next() as u32)),
];

/// All in units of 2^-149.
fn whole(x: f32) -> BigInt {
    assert!(x.is_finite());
    let bits = f64::from(x.abs()).to_bits();
    if bits == 0 {
        return BigInt::ZERO;
    }
    // Every f32 is a normal f64, whose mantissa counts from 2^-201 at least.
    let mantissa = bits & ((1 << 52) - 1) | 1 << 52;
    let m = (BigInt::from(mantissa) << ((bits >> 52) + 201 - 1075)) >> 52u32;
    if x < 0.0 { -m } else { m }
}

/// The sign of a fraction's difference from an f32, which may be infinite.
fn compare((n, d): &(BigInt, BigInt), x: f32) -> Ordering {
    match x {
        f32::INFINITY => Ordering::Less,
        f32::NEG_INFINITY => Ordering::Greater,
        _ => (n << 149u32).cmp(&(whole(x) * d)),
    }
}

/// Möller & Trumbore 1997 in fractions; the denominator is above zero.
fn meets(ray: &Ray, corners: &[Vec3; 3]) -> Option<(BigInt, BigInt)> {
    let vector = |v: Vec3| v.to_array().map(whole);
    let minus = |a: &[BigInt; 3], b: &[BigInt; 3]| [0, 1, 2].map(|i| &a[i] - &b[i]);
    let dot = |a: &[BigInt; 3], b: &[BigInt; 3]| (0..3).map(|i| &a[i] * &b[i]).sum::<BigInt>();
    let cross = |a: &[BigInt; 3], b: &[BigInt; 3]| {
        [0, 1, 2].map(|i| &a[(i + 1) % 3] * &b[(i + 2) % 3] - &a[(i + 2) % 3] * &b[(i + 1) % 3])
    };
    if !corners.iter().all(|v| v.is_finite()) {
        return None;
    }
    let [v0, v1, v2] = corners.map(vector);
    let (o, d) = (vector(ray.origin), vector(ray.direction));
    let (e1, e2) = (minus(&v1, &v0), minus(&v2, &v0));
    let p = cross(&d, &e2);
    let det = dot(&e1, &p);
    let s = minus(&o, &v0);
    let q = cross(&s, &e1);
    let (mut u, mut v, mut t, mut det_size) = (dot(&s, &p), dot(&d, &q), dot(&e2, &q), det);
    let zero = BigInt::ZERO;
    if det_size < zero {
        (u, v, t, det_size) = (-u, -v, -t, -det_size);
    }
    let hit = det_size > zero && u >= zero && v >= zero && u + v <= det_size;
    let t = (t, det_size);
    let within = hit && compare(&t, ray.t_min).is_ge() && compare(&t, ray.t_max).is_le();
    (within && ray.t_min != f32::INFINITY && ray.t_max != f32::NEG_INFINITY).then_some(t)
}

/// The least fraction and who has it.
fn closest(ray: &Ray, triangles: &[[Vec3; 3]]) -> Option<((BigInt, BigInt), Vec<u32>)> {
    let finite = ray.origin.is_finite() && ray.direction.is_finite();
    if !finite || ray.direction == Vec3::ZERO || ray.t_min.is_nan() || ray.t_max.is_nan() {
        return None;
    }
    let mut best: Option<((BigInt, BigInt), Vec<u32>)> = None;
    for (prim, corners) in (0..).zip(triangles) {
        let Some((n, d)) = meets(ray, corners) else { continue };
        match &mut best {
            Some(((bn, bd), _)) if &n * &*bd > &*bn * &d => {}
            Some(((bn, bd), prims)) if &n * &*bd == &*bn * &d => prims.push(prim),
            _ => best = Some(((n, d), vec![prim])),
        }
    }
    best
}

/// Whether no other f32 is nearer to the fraction, nor as near and even.
fn is_nearest(t: &(BigInt, BigInt), x: f32) -> bool {
    if x.is_infinite() {
        // From half a unit, 2^103, beyond the greatest one on.
        let limit = whole(f32::MAX) + (BigInt::from(1) << (103 + 149));
        let size = if x > 0.0 { t.0.clone() } else { -&t.0 };
        return size << 149u32 >= limit * &t.1;
    }
    let distance = |y: f32| {
        let difference = (&t.0 << 149u32) - whole(y) * &t.1;
        if difference < BigInt::ZERO { -difference } else { difference }
    };
    let mine = distance(x);
    [x.next_up(), x.next_down()].into_iter().filter(|y| y.is_finite()).all(|y| {
        let other = distance(y);
        mine < other || (mine == other && x.to_bits() & 1 == 0)
    })
}

fn bits(ray: &Ray, triangles: &[[Vec3; 3]]) -> String {
    let of = |v: Vec3| v.to_array().map(|x| format!("{:08x}", x.to_bits())).join(" ");
    let corners: Vec<String> = triangles.iter().map(|t| t.map(of).join(", ")).collect();
    format!("{ray:?} = {} {}; {}", of(ray.origin), of(ray.direction), corners.join("; "))
}

#[test]
fn triangles_are_hit_as_in_fractions() {
    let mut random = Random(1);
    for (name, number) in NUMBERS {
        let (mut hits, mut ties) = (0, 0);
        for i in 0..2500 {
            let count = 1 + random.below(4) as usize;
            let shared = random.vector(number);
            let mut triangles: Vec<[Vec3; 3]> = (0..count)
                .map(|_| [(); 3].map(|()| if random.below(3) == 0 { shared } else { random.vector(number) }))
                .collect();
            if random.below(3) == 0 {
                triangles.push([triangles[0][1], triangles[0][2], triangles[0][0]]);
            }
            let origin = random.vector(number);
            let mut direction = random.vector(number);
            if random.below(2) == 0 {
                let target = triangles[0];
                direction = [target[0], (target[0] + target[1]) * 0.5, (target[0] + target[1] + target[2]) / 3.0]
                    [random.below(3) as usize]
                    - origin;
            }
            let mut ray = Ray::new(origin, direction);
            if i % 3 == 0 {
                ray = ray.with_range(number(&mut random), number(&mut random));
            } else if i % 3 == 1 {
                ray = ray.with_range(f32::NEG_INFINITY, f32::INFINITY);
            }
            let found = Oracle::of_triangles(&triangles).closest(&ray);
            let expected = closest(&ray, &triangles);
            let place = || format!("{name}: {}", bits(&ray, &triangles));
            assert_eq!(found.as_ref().map(|f| &f.prims), expected.as_ref().map(|e| &e.1), "{}", place());
            let (Some(found), Some((t, prims))) = (found, expected) else { continue };
            hits += 1;
            ties += usize::from(prims.len() > 1);
            assert!(is_nearest(&t, found.nearest), "{found:?}, {}", place());
            assert!(found.nearest.is_infinite() || found.ulps(found.nearest) <= 0.5, "{found:?}, {}", place());
            assert!(found.t as f32 == found.nearest || found.ulps(found.nearest) > 0.49, "{found:?}, {}", place());
        }
        // Random bits rarely meet, but where a ray is aimed they do.
        assert!(hits > 50 && (ties > 30 || name == "unit" || name == "bits"), "{name}: {hits} hits, {ties} ties");
    }
}

#[test]
fn closed_ends_hit_and_open_neighbours_do_not() {
    let plane = |z: f32| [Vec3::new(-9.0, -9.0, z), Vec3::new(9.0, -9.0, z), Vec3::new(0.0, 9.0, z)];
    let oracle = Oracle::of_triangles(&[plane(1.0), plane(2.0), plane(3.0)]);
    let prim = |t_min: f32, t_max: f32| {
        oracle.closest(&Ray::new(Vec3::ZERO, Vec3::Z).with_range(t_min, t_max)).map(|t| t.prims)
    };
    assert_eq!(prim(1.0, 1.0), Some(vec![0]));
    assert_eq!(prim(1f32.next_up(), 2.0), Some(vec![1]));
    assert_eq!(prim(1f32.next_up(), 2f32.next_down()), None);
    assert_eq!(prim(2.0, 1.0), None);
    assert_eq!(prim(f32::NEG_INFINITY, f32::MAX), Some(vec![0]));
    for (t_min, t_max) in
        [(f32::NAN, 9.0), (0.0, f32::NAN), (f32::INFINITY, f32::INFINITY), (f32::NEG_INFINITY, f32::NEG_INFINITY)]
    {
        assert_eq!(prim(t_min, t_max), None);
    }
    // Behind the origin, the farthest is the first.
    let back = oracle.closest(&Ray::new(Vec3::ZERO, -Vec3::Z).with_range(f32::NEG_INFINITY, 0.0)).expect("behind");
    assert_eq!((back.t, back.prims), (-3.0, vec![2]));
}

/// Whole vectors of whole length.
const QUADRUPLES: [([f32; 3], f32); 6] = [
    ([1.0, 2.0, 2.0], 3.0),
    ([2.0, 3.0, 6.0], 7.0),
    ([4.0, 4.0, 7.0], 9.0),
    ([1.0, 4.0, 8.0], 9.0),
    ([2.0, 6.0, 9.0], 11.0),
    ([0.0, 0.0, 1.0], 1.0),
];

#[test]
fn spheres_are_hit_where_they_were_cut() {
    let mut random = Random(2);
    let permuted = |random: &mut Random, v: [f32; 3]| {
        let (i, flip) = (random.below(3) as usize, random.below(2) == 0);
        let v = if flip { [v[1], v[0], v[2]] } else { v };
        let sign = |random: &mut Random, x: f32| if random.below(2) == 0 { x } else { -x };
        Vec3::new(sign(random, v[i]), sign(random, v[(i + 1) % 3]), sign(random, v[(i + 2) % 3]))
    };
    for i in 0..4000 {
        let (from_centre, radius) = QUADRUPLES[random.below(6) as usize];
        let centre = random.vector(|r| r.below(41) as f32 - 20.0);
        let (p, q) = (centre + permuted(&mut random, from_centre), centre + permuted(&mut random, from_centre));
        if p == q {
            continue;
        }
        // Two points of the sphere, and a line through them at whole parameters.
        let scale = 2f32.powi(random.below(80) as i32 - 40);
        let near = random.below(9) as f32 - 4.0;
        let direction = q - p;
        let origin = p - near * direction;
        let sphere = Primitive::Sphere { centre: centre * scale, radius: radius * scale };
        // A triangle through the first of them, and another sphere that touches the first there.
        let corner = random.vector(|r| r.below(41) as f32 - 20.0);
        let touching = Primitive::Triangle([p * scale, (2.0 * p - q) * scale, (p + corner) * scale]);
        let twice = Primitive::Sphere { centre: (2.0 * p - centre) * scale, radius: radius * scale };
        let oracle = Oracle::new(vec![twice, sphere, touching]);
        let alone = Oracle::new(vec![sphere]);
        let ray = Ray::new(origin * scale, direction * scale);
        let place = format!("{i}: {ray:?} {sphere:?} near {near}");
        for (range, expected) in [
            ((near, near + 1.0), Some(near)),
            ((near, near), Some(near)),
            ((near.next_up(), near + 1.0), Some(near + 1.0)),
            ((near.next_up(), (near + 1.0).next_down()), None),
            ((f32::NEG_INFINITY, near.next_down()), None),
            ((near + 1.0, f32::INFINITY), Some(near + 1.0)),
        ] {
            let found = alone.closest(&ray.with_range(range.0, range.1));
            assert_eq!(found.as_ref().map(|f| (f.t, f.nearest)), expected.map(|t| (t.into(), t)), "{range:?} {place}");
        }
        // The touching sphere is beyond p or before it, by the side on which the line enters it; at p alone both meet.
        let both = oracle.closest(&ray.with_range(near, near)).expect("at p");
        let flat = (p + corner - p).cross(direction) == Vec3::ZERO;
        let edge_on = (p - q).cross(corner).dot(direction) == 0.0;
        assert!(flat || edge_on, "the triangle holds the line: {place}");
        assert_eq!(both.prims, [0, 1], "{place}");
    }
}

/// The side of a sphere on which the ray is at `n / 2^150`: `Greater` is outside.
fn side(ray: &Ray, centre: Vec3, radius: f32, n: &BigInt) -> Ordering {
    let square = |x: BigInt| &x * &x;
    let sum: BigInt = (0..3)
        .map(|i| {
            let f = whole(ray.origin[i]) - whole(centre[i]);
            square((f << 150u32) + n * whole(ray.direction[i]))
        })
        .sum();
    sum.cmp(&square(whole(radius) << 150u32))
}

#[test]
fn the_polynomial_changes_its_sign_at_the_parameter() {
    let mut random = Random(3);
    for (name, number) in NUMBERS {
        let (mut hits, mut inside) = (0, 0);
        for _ in 0..2500 {
            let (centre, radius) = (random.vector(number), number(&mut random).abs());
            let origin = random.vector(number);
            let mut direction = random.vector(number);
            if random.below(2) == 0 {
                direction = centre + random.vector(|r| r.below(3) as f32 - 1.0) * radius * 0.5 - origin;
            }
            let ray = Ray::new(origin, direction);
            let Some(truth) = Oracle::new(vec![Primitive::Sphere { centre, radius }]).closest(&ray) else {
                continue;
            };
            if truth.nearest >= f32::MAX {
                continue;
            }
            hits += 1;
            let place = format!("{name}: {ray:?}, centre {centre}, radius {radius}, {truth:?}");
            // Halfway to the neighbours, in units of 2^-150: the sign differs, or the root is one of the two.
            let x = truth.nearest;
            let half = |y: f32| whole(x) + whole(y);
            let at = |y: f32| side(&ray, centre, radius, &half(y));
            let (below, above) = (at(x.next_down()), at(x.next_up()));
            inside += usize::from(above.is_gt() && below.is_lt());
            let tangent = below.is_gt() && above.is_gt();
            assert!(below != above || below.is_eq() || tangent, "{below:?} {above:?}, {place}");
            if tangent {
                // Two roots in a unit, or one: the line passes within half a unit of the surface's least distance.
                assert!(truth.ulps(x) <= 0.5, "{place}");
            }
        }
        assert!(hits > 100, "{name}: {hits} hits, {inside} of them from inside");
    }
}

#[test]
fn bounds_never_hide_the_winner() {
    let mut random = Random(4);
    let mut hits = 0;
    for (name, number) in NUMBERS {
        for _ in 0..1200 {
            let mut primitives: Vec<Primitive> = Vec::new();
            for _ in 0..1 + random.below(8) {
                primitives.push(if random.below(2) == 0 {
                    Primitive::Sphere { centre: random.vector(number), radius: number(&mut random).abs() }
                } else {
                    Primitive::Triangle([(); 3].map(|()| random.vector(number)))
                });
            }
            let oracle = Oracle::new(primitives.clone());
            let mut ray = Ray::new(random.vector(number), random.vector(number));
            if random.below(2) == 0 {
                ray = ray.with_range(number(&mut random), number(&mut random));
            }
            let expected = Line::new(&ray).and_then(|line| oracle.first(&line, oracle.groups.iter()));
            assert_eq!(oracle.closest(&ray), expected, "{name}: {ray:?} {primitives:?}");
            hits += usize::from(expected.is_some());
        }
    }
    assert!(hits > 1000, "{hits}");
}

#[test]
fn what_is_no_primitive_is_never_hit() {
    let far = Primitive::Sphere { centre: Vec3::splat(f32::MAX), radius: f32::from_bits(1) };
    let bad = [
        Primitive::Triangle([Vec3::ZERO, Vec3::X, 2.0 * Vec3::X]),
        Primitive::Triangle([Vec3::ONE; 3]),
        Primitive::Triangle([Vec3::ZERO, Vec3::X, Vec3::new(0.0, f32::NAN, 0.0)]),
        Primitive::Sphere { centre: Vec3::ZERO, radius: -1.0 },
        Primitive::Sphere { centre: Vec3::ZERO, radius: f32::INFINITY },
        Primitive::Sphere { centre: Vec3::NAN, radius: 1.0 },
        far,
    ];
    assert!(Oracle::new(bad.to_vec()).groups.is_empty());
    // A point is hit by a ray through it.
    let point = Oracle::new(vec![Primitive::Sphere { centre: Vec3::new(2.0, 4.0, 6.0), radius: 0.0 }]);
    let truth = point.closest(&Ray::new(Vec3::ZERO, Vec3::new(1.0, 2.0, 3.0))).expect("through the point");
    assert_eq!((truth.t, truth.prims), (2.0, vec![0]));
    assert_eq!(point.closest(&Ray::new(Vec3::ZERO, Vec3::new(1.0, 2.0, 3f32.next_up()))), None);
    for direction in [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY] {
        assert_eq!(point.closest(&Ray::new(Vec3::ZERO, direction)), None);
    }
}

#[test]
fn duplicates_tie_and_are_looked_at_once() {
    let triangle = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let turned = [Vec3::Y, Vec3::new(-0.0, 0.0, -0.0), Vec3::X];
    let mut triangles = vec![triangle; 100_000];
    triangles[5] = turned;
    triangles[7] = triangle.map(|p| p + Vec3::Z);
    let oracle = Oracle::of_triangles(&triangles);
    assert_eq!(oracle.groups.len(), 3);
    let truth = oracle.closest(&Ray::new(Vec3::new(0.25, 0.25, -1.0), Vec3::Z)).expect("a hit");
    assert_eq!(truth.prims, (0..100_000).filter(|&i| i != 7).collect::<Vec<_>>());
}

#[test]
fn errors_are_counted_in_the_units_of_f32() {
    let truth = |t: f64| Truth { t, nearest: t as f32, prims: vec![0] };
    assert_eq!(truth(1.0).ulps(1f32.next_up()), 1.0);
    assert_eq!(truth(1.0).ulps(1f32.next_down()), 0.5);
    assert_eq!(truth(-3.0).ulps((-3f32).next_down()), 1.0);
    assert_eq!(truth(0.0).ulps(f32::from_bits(3)), 3.0);
    assert_eq!(truth(1e-40).ulps((1e-40f64 as f32).next_up()).round(), 1.0);
    assert_eq!(truth(1e300).ulps(f32::INFINITY), 0.0);
    assert_eq!(truth(1.0).ulps(f32::INFINITY), f64::INFINITY);
    assert_eq!(truth(1.0).ulps(f32::NAN), f64::INFINITY);
    assert_eq!(truth(f64::INFINITY).ulps(f32::MAX), f64::INFINITY);
}
