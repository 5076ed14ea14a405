//! What the paper expects of seeds in voxels, judged by the measured numbers.

use super::{Point, Tries};
use crate::papers::report::{Claim, Verdict, significant};

/// That they save iterations, and time.
pub(super) fn judge(points: &[Point]) -> Vec<Claim> {
    vec![fewer_iterations(points), less_time(points)]
}

fn fewer_iterations(points: &[Point]) -> Claim {
    let better = |p: &Point| p.alone[0].mean() < p.alone[1].mean() && p.alone[0].failures <= p.alone[1].failures;
    let numbers: Vec<String> = points
        .iter()
        .map(|p| {
            let words = |t: &Tries| format!("{} ({} % fail)", significant(t.mean()), significant(100.0 * t.failed()));
            format!("{}: {} against {}", p.grid, words(&p.alone[0]), words(&p.alone[1]))
        })
        .collect();
    let measured = points.iter().all(|p| p.alone[0].hits > 0);
    Claim {
        id: "A10",
        claim: "a starting point kept in each voxel saves iterations",
        rule: "at every subdivision Newton's method alone takes fewer iterations from the voxel's seed than from the \
               patch's middle, and fails no more often",
        verdict: if measured { Verdict::of(points.iter().all(better)) } else { Verdict::NotMeasured },
        numbers: numbers.join("; "),
    }
}

fn less_time(points: &[Point]) -> Claim {
    let best = |way: usize| points.iter().map(|p| p.rows[way].cost.seconds).fold(f64::INFINITY, f64::min);
    let rays = points.first().map_or(1, |p| p.rows[0].cost.counts.rays) as f64;
    let nanoseconds = |way: usize| significant(1e9 * best(way) / rays);
    Claim {
        id: "A10 time",
        claim: "and with them time",
        rule: "the fastest grid with seeds in its voxels is faster than the fastest one whose tests begin in the middle",
        verdict: Verdict::of(best(0) < best(1)),
        numbers: format!(
            "{} ns a ray against {}, and {} by subdivision alone",
            nanoseconds(0),
            nanoseconds(1),
            nanoseconds(2)
        ),
    }
}
