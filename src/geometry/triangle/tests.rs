//! The filters against the last stage alone.

use super::*;
use crate::geometry::tests::Random;

/// Rays next to corners and edges, at every scale, from near and far.
fn stiff(random: &mut Random) -> (Ray, [Triangle; 2]) {
    let unit = |random: &mut Random| Vec3::from_array(random.vector(1 << 24).map(|x| x as f32 / (1 << 24) as f32));
    let power = |random: &mut Random, n: i128| 2f32.powi(random.within(n) as i32);
    let scale = 2f32.powi([0, 0, -147, -120, -70, 63, 124, 126][random.next() as usize % 8]);
    let place = unit(random) * [0.0, 1.0, 1e3, 1e7][random.next() as usize % 4];
    // Axes of very different lengths make slivers.
    let stretch = Vec3::new(power(random, 12), 1.0, power(random, 3));
    let mut corner = || (place + unit(random) * stretch) * scale;
    let corners = [corner(), corner(), corner(), corner()];
    let triangles = [[corners[0], corners[1], corners[2]], [corners[2], corners[1], corners[3]]];
    let (a, b) = (corners[random.next() as usize % 4], corners[random.next() as usize % 4]);
    let target = a + (b - a) * [0.0, 0.5, 1.0, 0.3][random.next() as usize % 4];
    let origin = match random.next() % 5 {
        0 => Vec3::ZERO,
        1 => target + unit(random) * scale,
        2 => target + unit(random) * scale * 1e5,
        3 => corners[3],
        _ => Vec3::from_array([(); 3].map(|()| f32::from_bits(random.next() as u32))),
    };
    let direction = match random.next() % 4 {
        0 => target - origin,
        1 => (target - origin) * power(random, 140),
        2 => (target - origin).signum(),
        _ => (target - origin).normalize_or(Vec3::X),
    };
    (
        Ray::new(origin, direction).with_range([0.0, f32::NEG_INFINITY][random.next() as usize % 2], f32::INFINITY),
        triangles,
    )
}

#[test]
fn the_filter_decides_as_the_last_stage_does() {
    let mut random = Random::new(17);
    let (mut tested, mut hits, mut rejected) = (0, 0, 0);
    for _ in 0..60_000 {
        let (ray, set) = stiff(&mut random);
        let Some(ray) = ray.intake() else { continue };
        tested += 1;
        let exact = |prim: u32| {
            let crossing = Crossing::of_triangle(&ray, &set[prim as usize], [0; 3]);
            crossing.map(|(crossing, _)| crossing).filter(|c| c.in_range(&ray))
        };
        let expected = match (exact(0), exact(1)) {
            (Some(a), Some(b)) if a.cmp_crossing(&b).is_gt() => Some((1, b.round())),
            (Some(a), _) => Some((0, a.round())),
            (None, b) => b.map(|b| (1, b.round())),
        };
        for order in [[0, 1], [1, 0]] {
            let (prep, mut best) = (TrianglePrep::new(&ray), Best::NONE);
            for prim in order {
                set[..].test(prim, &ray, &prep, &mut best);
                rejected += usize::from(prep.misses(ray.origin, &set[prim as usize]));
            }
            let found = best.prim().map(|prim| (prim, set[..].round(&ray, &best)));
            assert_eq!(found, expected, "{ray:?} {set:?}");
        }
        hits += usize::from(expected.is_some());
    }
    assert!(tested > 30_000 && hits > 5_000 && rejected > 20_000, "{tested} rays, {hits} hits, {rejected} rejected");
}
