//! The same comparison with other seeds: how often a renderer without a fault is taken for a faulty one.

use super::Options;
use super::replicates::{Measured, Wanted, replicate};
use crate::accel::Accel;
use crate::error::Result;
use crate::picture::agreement::{self, StatisticalLimits, StatisticalVerdict};
use crate::scene::Scene;
use serde::Serialize;

/// One more set of our renders against the same picture.
#[derive(Clone, Debug, Serialize)]
pub struct Reseed {
    /// Name of the scene.
    pub case: String,
    /// The first of its seeds; the others follow.
    pub first_seed: u64,
    /// What was found. Its limits are the usual ones over the number of sets, so that all sets of a scene together fail as
    /// seldom as the one that is judged without reseeding (Bonferroni's inequality, which asks for no independence).
    pub verdict: StatisticalVerdict,
}

/// Renders and compares `options.reseeds` sets, with seeds after those of the first one; `tell` is called before each.
pub(super) fn reseeds(
    case: &str,
    theirs: &Measured,
    wanted: Wanted,
    (scene, accel): (&Scene, &dyn Accel),
    options: &Options,
    tell: &mut dyn FnMut(u32),
) -> Result<Vec<Reseed>> {
    let sets = f64::from(options.reseeds);
    let usual = StatisticalLimits::default();
    let limits = StatisticalLimits { chi2: usual.chi2 / sets, max: usual.max / sets, global: usual.global / sets };
    let mut found = Vec::new();
    for set in 1..=options.reseeds {
        tell(set);
        let first_seed = 1 + u64::from(set) * u64::from(options.replicates);
        let (ours, _) = replicate(wanted, first_seed, scene, accel, options)?;
        if options.stopped() {
            break;
        }
        let verdict = agreement::statistical(ours.estimate(), theirs.estimate(), limits);
        found.push(Reseed { case: case.into(), first_seed, verdict });
    }
    Ok(found)
}
