//! What the paper claims, judged by the measured numbers.

use super::Sweep;
use crate::papers::report::{Claim, Verdict, significant};

/// All claims that are measured, in the paper's order.
pub(super) fn judge(sweeps: &[Sweep]) -> Vec<Claim> {
    vec![fall_and_rise(sweeps), growing_gain(sweeps), naive_share(sweeps)]
}

/// Two figures that are this near are the same.
const TIE: f64 = 0.01;

fn fall_and_rise(sweeps: &[Sweep]) -> Claim {
    let best = |sweep: &Sweep| {
        let times = sweep.points.iter().map(|p| p.off.seconds).enumerate();
        times.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(i, _)| i)
    };
    let enough = sweeps.iter().all(|s| s.points.len() >= 3);
    let holds = sweeps.iter().all(|s| (1..s.points.len() - 1).contains(&best(s)));
    let numbers: Vec<String> = sweeps
        .iter()
        .map(|s| {
            let at = best(s);
            let [first, least, last] = [0, at, s.points.len() - 1].map(|i| significant(s.points[i].off.seconds));
            format!("{}: {first} s, least {least} s at {}, {last} s", s.published.scene, s.points[at].subdivision)
        })
        .collect();
    Claim {
        id: "A13",
        claim: "execution time plummets and then rises as the grid is refined",
        rule: "on each scene the least time is at neither end of the sweep",
        verdict: if enough { Verdict::of(holds) } else { Verdict::NotMeasured },
        numbers: numbers.join("; "),
    }
}

fn growing_gain(sweeps: &[Sweep]) -> Claim {
    let grows = |s: &Sweep| s.points.windows(2).all(|w| w[1].gain() >= w[0].gain() * (1.0 - TIE));
    let several = sweeps.iter().all(|s| s.points.len() >= 2);
    let numbers: Vec<String> = sweeps
        .iter()
        .map(|s| {
            let gains: Vec<String> =
                s.points.iter().map(|p| format!("{} at {}", significant(p.gain()), p.subdivision)).collect();
            format!("{}: {}", s.published.scene, gains.join(", "))
        })
        .collect();
    Claim {
        id: "A14",
        claim: "the gain from rayID grows with the subdivision",
        rule: "on each scene tests without rayID over tests with it fall by no more than 1 % from any subdivision to \
               the next finer one",
        verdict: if several { Verdict::of(sweeps.iter().all(grows)) } else { Verdict::NotMeasured },
        numbers: numbers.join("; "),
    }
}

fn naive_share(sweeps: &[Sweep]) -> Claim {
    let numbers: Vec<String> = sweeps
        .iter()
        .map(|s| format!("{} %: {} objects", significant(100.0 * s.tracing_share()), s.published.objects))
        .collect();
    Claim {
        id: "A15",
        claim: "intersection takes up to 95 % of the time of naive ray tracing",
        rule: "on some scene tracing by brute force takes at least 95 % of the time of the whole render",
        verdict: Verdict::of(sweeps.iter().any(|s| s.tracing_share() >= 0.95)),
        numbers: numbers.join("; "),
    }
}
