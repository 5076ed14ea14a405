//! The filters against the last stage alone.

use super::*;
use crate::geometry::tests::Random;

/// Rays and spheres that leave much open: tangents, origins on the surface, spheres through a common point, tiny and huge.
fn stiff(random: &mut Random) -> (Ray, [Sphere; 2]) {
    let lattice = |random: &mut Random, n| Vec3::from_array(random.vector(n).map(|x| x as f32));
    let scale = 2f32.powi(random.within(8) as i32 * 12);
    let origin = [Vec3::ZERO, lattice(random, 3), random.in_cube() * 4.0][random.next() as usize % 3];
    let direction = match random.next() % 3 {
        0 => lattice(random, 2),
        1 => Vec3::new(3.0, 4.0, 0.0) * random.unit(),
        _ => random.in_cube(),
    };
    let target = origin + direction * [1.0, 2.0, 0.0, 7.0][random.next() as usize % 4];
    let mut ball = || {
        // A whole distance half of the time.
        let whole =
            [Vec3::new(3.0, 0.0, -4.0), Vec3::new(2.0, 1.0, 2.0), Vec3::new(0.0, -5.0, 0.0), Vec3::new(-2.0, 6.0, 3.0)];
        let offset =
            if random.next().is_multiple_of(2) { whole[random.next() as usize % 4] } else { lattice(random, 3) };
        let centre = target + offset;
        let radius = match random.next() % 4 {
            0 => (target - centre).length(), // through the target
            1 => (centre - origin).cross(direction).length() / direction.length(), // tangent, nearly
            2 => random.within(4).unsigned_abs() as f32,
            _ => random.unit() * 3.0,
        };
        Sphere { centre: centre * scale, radius: radius * scale }
    };
    let balls = [ball(), ball()];
    let range = [(0.0, f32::INFINITY), (f32::NEG_INFINITY, f32::INFINITY), (1.0, 2.0)][random.next() as usize % 3];
    (Ray::new(origin * scale, direction * scale).with_range(range.0, range.1), balls)
}

#[test]
fn the_filter_decides_as_the_last_stage_does() {
    let mut random = Random::new(31);
    let (mut hits, mut ties, mut open) = (0, 0, 0);
    for _ in 0..40_000 {
        let (ray, set) = stiff(&mut random);
        let Some(ray) = ray.intake() else { continue };
        let expected = match (Root::first(&set[0], &ray), Root::first(&set[1], &ray)) {
            (Some(a), Some(b)) => {
                let order = a.cmp_root(&b);
                ties += usize::from(order.is_eq());
                Some(if order.is_gt() { (1, b) } else { (0, a) })
            }
            (a, b) => a.map(|a| (0, a)).or(b.map(|b| (1, b))),
        };
        for order in [[0, 1], [1, 0]] {
            let (prep, mut best) = (SpherePrep::new(&ray), Best::NONE);
            for prim in order {
                set[..].test(prim, &ray, &prep, &mut best);
            }
            assert_eq!(best.prim(), expected.as_ref().map(|e| e.0), "{ray:?} {set:?}");
            let Some((_, root)) = &expected else { continue };
            let (low, high) = (best.t() - best.err(), best.t() + best.err());
            assert!(
                root.cmp_parameter(low).is_ge() && root.cmp_parameter(high).is_le(),
                "not within {low:e}..{high:e}: {ray:?} {set:?}"
            );
            open += usize::from(low as f32 != high as f32);
            hits += 1;
            // Searching from 0 for the nearest would take long: the neighbours tell.
            let found = set[..].round(&ray, &best);
            assert_eq!(found.to_bits(), nearest(found, |t| root.cmp_parameter(t)).to_bits(), "{ray:?} {set:?}");
        }
    }
    assert!(hits > 20_000 && ties > 500 && open > 50, "{hits} hits, {ties} ties, {open} to be rounded exactly");
}
