//! Seeds and ranges of one patch; what rays see of patches is tested through the accelerators.

use super::*;

fn bowl() -> BezierPatches {
    // z = x^2 + y^2 over the unit square: x = u, y = v, control heights i (i - 1) / 6 + j (j - 1) / 6.
    let height = |i: usize| (i * i.saturating_sub(1)) as f32 / 6.0;
    let points = std::array::from_fn(|j| {
        std::array::from_fn(|i| Vec3::new(i as f32 / 3.0, j as f32 / 3.0, height(i) + height(j)))
    });
    BezierPatches::new([points])
}

#[test]
fn seeds_cover_what_is_in_the_box() {
    let patches = bowl();
    for (min, max) in [(0.2, 0.4), (0.0, 0.1), (0.5, 1.0)] {
        let cell = Cell { min: DVec3::new(min, min, -1.0), max: DVec3::new(max, max, 3.0) };
        let hint = patches.seed(0, &cell).expect("the patch is in the box").hint();
        assert!(hint.rect.u.0 <= min && hint.rect.u.1 >= max.min(1.0) - 1e-6, "{hint:?}");
        assert!(hint.rect.u.0 >= min - 0.15 && hint.rect.u.1 <= max + 0.15, "{hint:?}");
        assert!(hint.rect.contains(hint.start, 0.0));
    }
    let beside = Cell { min: DVec3::splat(1.5), max: DVec3::splat(1.9) };
    assert!(patches.seed(0, &beside).is_none() && !patches.overlaps(0, &beside));
}

#[test]
fn tests_count_what_they_do() {
    let watch = Arc::new(Watch::default());
    let patches = bowl().watched(watch.clone());
    let ray = Ray::new(Vec3::new(0.3, 0.6, 5.0), Vec3::NEG_Z);
    let mut best = Best::NONE;
    patches.test(0, &ray, &patches.prepare(&ray), &mut best);
    assert!((best.t() - (5.0 - 0.45)).abs() < 1e-6, "{best:?}");
    let tally = watch.tally();
    assert_eq!((tally.tests, tally.failures), (1, 0));
    assert!(tally.runs == 1 && (1..6).contains(&tally.iterations), "{tally:?}");
    let (u, v) = patches.locate(0, &ray, best.t() as f32).expect("it is a hit");
    assert!((u - f64::from(0.3_f32)).abs() < 1e-6 && (v - f64::from(0.6_f32)).abs() < 1e-6);
}
