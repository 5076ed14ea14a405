//! What the note and the reply to it claim, judged by the counts.

use super::regular::{Case, Level};
use crate::bsp::Form;
use crate::papers::report::{Claim, Verdict, significant};

/// Most nodes for each leaf: the note proves a constant and does not give it; six and a little is what complete trees show.
const CONSTANT: f64 = 6.1;

/// Times that are no further apart than this factor show no clear difference.
const CLEAR: f64 = 1.25;

pub(super) fn judge(levels: &[Level], cases: &[Case]) -> Vec<Claim> {
    vec![best_case(cases), leaves(levels, cases), linear(levels), logarithm(levels), no_difference(levels)]
}

/// One phrase for each tree.
fn each(levels: &[Level], phrase: impl Fn(&Level) -> String) -> String {
    levels.iter().map(|l| format!("{} at {}", phrase(l), l.n)).collect::<Vec<_>>().join(", ")
}

fn best_case(cases: &[Case]) -> Claim {
    let path = |n: u32| u64::from(3 * n.ilog2() + 1);
    let best: Vec<&Case> = cases.iter().filter(|c| c.best).collect();
    let of = |form: Form| best.iter().filter(move |c| c.form == form);
    let numbers: Vec<String> = of(Form::Interval).map(|c| format!("{} nodes at {}", c.nodes, c.n)).collect();
    Claim {
        id: "R10",
        claim: "at best, where the first leaf answers the ray, partitioning and re-traversal both take O(log N)",
        rule: "every walk enters exactly 3 log2 N + 1 nodes before its first leaf is answered, at every N",
        verdict: Verdict::of(best.iter().all(|c| c.nodes == path(c.n) && c.leaves == 1)),
        numbers: numbers.join(", "),
    }
}

fn leaves(levels: &[Level], cases: &[Case]) -> Claim {
    let worst = |n: u32| {
        let of_cases = cases.iter().filter(|c| c.n == n).map(|c| c.leaves);
        let of_levels = levels.iter().filter(|l| l.n == n).flat_map(|l| Form::ALL.map(|f| l.of(f.1).most_leaves));
        of_cases.chain(of_levels).max().unwrap_or(0)
    };
    Claim {
        id: "R11a",
        claim: "a ray pierces at most about 3N leaves",
        rule: "no ray of any walk, from corner to corner or at random, meets more than 3N",
        verdict: Verdict::of(levels.iter().all(|l| worst(l.n) <= 3 * u64::from(l.n))),
        numbers: each(levels, |l| format!("{} N", significant(worst(l.n) as f64 / f64::from(l.n)))),
    }
}

fn linear(levels: &[Level]) -> Claim {
    let holds = levels.iter().all(|l| l.of(Form::Interval).most < CONSTANT);
    Claim {
        id: "R11b",
        claim: "the K leaves of a ray in a regular tree have O(K) nodes above them, each entered once: O(N) for a ray",
        rule: "nodes for each leaf stay below 6.1 on every ray, at every N",
        verdict: Verdict::of(holds),
        numbers: each(levels, |l| {
            let w = l.of(Form::Interval);
            format!("{} (most {})", significant(w.nodes_per_leaf), significant(w.most))
        }),
    }
}

fn logarithm(levels: &[Level]) -> Claim {
    let ratio = |l: &Level| l.of(Form::Retraverse).nodes / l.of(Form::Interval).nodes;
    let path = |l: &Level| f64::from(3 * l.n.ilog2() + 1);
    let exact = levels.iter().all(|l| (l.of(Form::Retraverse).nodes_per_leaf - path(l)).abs() < 1e-9 * path(l));
    let rises = levels.windows(2).all(|w| ratio(&w[1]) > ratio(&w[0]));
    Claim {
        id: "R11c",
        claim: "re-traversal from the root takes O(N log N), so the ratio of the two grows as log N",
        rule: "re-traversal enters 3 log2 N + 1 nodes for each leaf, and the ratio of its nodes to those of partitioning \
               rises from each N to the next",
        verdict: if levels.len() < 2 { Verdict::NotMeasured } else { Verdict::of(exact && rises) },
        numbers: each(levels, |l| significant(ratio(l))),
    }
}

fn no_difference(levels: &[Level]) -> Claim {
    // Jansen's rays passed about five cells.
    let near = levels.iter().filter(|l| (3.5..8.0).contains(&l.of(Form::Interval).leaves));
    let time = |l: &Level, form: Form| l.of(form).nanoseconds;
    let ratio = |l: &Level| time(l, Form::Midpoint) / time(l, Form::Retraverse);
    let close = |l: &Level| (1.0 / CLEAR..CLEAR).contains(&ratio(l));
    let numbers: Vec<String> = near
        .clone()
        .map(|l| {
            let [midpoint, retraverse, climb] =
                [Form::Midpoint, Form::Retraverse, Form::Climb].map(|form| significant(time(l, form)));
            let leaves = significant(l.of(Form::Interval).leaves);
            format!(
                "{leaves} leaves a ray at {}: midpoint {midpoint} ns, re-traversal {retraverse} ns, climbing {climb} ns",
                l.n
            )
        })
        .collect();
    Claim {
        id: "R12",
        claim: "at about five cells a ray there is no clear difference between halving the ray and sequential traversal \
                (Jansen)",
        rule: "where rays pass 3.5 to 8 leaves, the time of the midpoint form is between 0.8 and 1.25 of re-traversal's",
        verdict: if numbers.is_empty() { Verdict::NotMeasured } else { Verdict::of(near.clone().all(close)) },
        numbers: numbers.join("; "),
    }
}
