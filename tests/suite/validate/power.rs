//! What the validator finds and what it does not: faults of known size, and renders without any.
//!
//! `SKIPGRID_POWER=all` measures every fault in every scene, with several sets of seeds, and prints the table of
//! `docs/validation.md`; it takes some minutes.

use super::faults::Fault;
use super::{load_scene, reference};
use skipgrid::picture::agreement::{StatisticalLimits, StatisticalVerdict};
use skipgrid::picture::io;
use skipgrid::render::Integrator;
use skipgrid::scene::Scene;
use skipgrid::validate::{Case, Options, Test, Theirs, against, check_case};

/// Every fault of section 8 of the notes on validation.
const FAULTS: [Fault; 8] = [
    Fault::Albedo(0.1),
    Fault::Albedo(0.3),
    Fault::Albedo(1.0),
    Fault::Shift(0.005),
    Fault::Shift(0.1),
    Fault::Shift(0.5),
    Fault::Shadows(1000),
    Fault::Bounce,
];

/// Those that POV-Ray's pictures show in every scene.
const FOUND_EXACTLY: [Fault; 5] =
    [Fault::Albedo(0.1), Fault::Albedo(1.0), Fault::Shift(0.005), Fault::Shift(0.5), Fault::Shadows(1000)];

/// Those that Mitsuba's picture of `cornell` shows.
const FOUND_IN_NOISE: [Fault; 5] =
    [Fault::Albedo(0.3), Fault::Albedo(1.0), Fault::Shift(0.1), Fault::Shift(0.5), Fault::Bounce];

/// A fast accelerator, since pictures do not depend on it.
const FAST: &str = "nested";

/// Whether everything is to be measured.
fn all() -> bool {
    std::env::var_os("SKIPGRID_POWER").is_some_and(|value| value == "all")
}

/// The verdict on a renderer with `fault` (none: without) against POV-Ray's picture alone; the reasons, and whether it passed.
fn exact(case: &Case, scene: &Scene, accel: &dyn skipgrid::Accel, fault: Option<Fault>) -> (bool, String) {
    let mut case = Case { mitsuba: None, ..case.clone() };
    let povray = case.povray.as_mut().expect("a case with a picture of POV-Ray");
    let rows = io::read(&povray.image).expect("a good picture").height;
    let tier = match fault {
        None => check_case(&case, scene, accel, &Options::default()),
        Some(fault) => {
            povray.max_depth = fault.depth(povray.max_depth);
            check_case(&case, &fault.scene(scene, rows), &*fault.accel(accel), &Options::default())
        }
    };
    (tier.passed(), tier.tiers[0].reason())
}

#[test]
fn povray_agrees_and_every_fault_is_found() {
    let Some(manifest) = reference() else { return };
    let cases: Vec<&Case> = manifest.cases.iter().filter(|c| c.povray.is_some()).collect();
    assert!(cases.len() >= 6, "only {} scenes have a picture of POV-Ray", cases.len());
    let faults = if all() { &FAULTS[..] } else { &FOUND_EXACTLY };
    for case in cases {
        // What lies beside the repository was framed, and is small in its picture: no promise of power.
        if case.optional && !case.scene.exists() {
            eprintln!("skipped: {} is not there", case.scene.display());
            continue;
        }
        let scene = load_scene(case);
        let (passed, reason) = exact(case, &scene, &*scene.accel("grid").expect("built"), None);
        assert!(passed, "{}: {reason}", case.name);
        let promised = |fault| FOUND_EXACTLY.contains(&fault) && !case.optional;
        let accel = scene.accel(FAST).expect("built");
        for &fault in faults {
            let (passed, reason) = exact(case, &scene, &*accel, Some(fault));
            eprintln!("{:12} {fault:30} {}: {reason}", case.name, if passed { "not found" } else { "found" });
            assert!(!passed || !promised(fault), "{} passed with {fault}: {reason}", case.name);
            assert!(!reason.is_empty());
        }
    }
}

/// The verdicts of `1 + reseeds` sets of renders with `fault` (none: without) against Mitsuba's picture.
fn in_noise(case: &Case, scene: &Scene, fault: Option<Fault>, reseeds: u32) -> Vec<StatisticalVerdict> {
    let mitsuba = case.mitsuba.as_ref().expect("a case with a picture of Mitsuba");
    let faulty = fault.map_or_else(|| scene.clone(), |fault| fault.scene(scene, mitsuba.height));
    let theirs = Theirs {
        images: vec![mitsuba.image.clone()],
        renders: mitsuba.replicates,
        integrator: Integrator::Path,
        grid: 1,
        max_depth: fault.map_or(mitsuba.max_depth, |fault| fault.depth(mitsuba.max_depth)),
    };
    let options = Options { reseeds, ..Options::default() };
    let report = against(&faulty, &theirs, &[FAST.to_string()], &options).expect("it runs");
    let first = match &report.entries[0].verdict.tiers[0].test {
        Some(Test::Statistical(verdict)) => verdict.clone(),
        other => panic!("{}: {other:?}", case.name),
    };
    std::iter::once(first).chain(report.reseeds.into_iter().map(|r| r.verdict)).collect()
}

/// Whether it would pass with the limits that a single comparison has.
fn passes(verdict: &StatisticalVerdict) -> bool {
    let limits = StatisticalLimits::default();
    verdict.chi2_p >= limits.chi2 && verdict.max_p >= limits.max && verdict.global_p >= limits.global
}

fn least(verdicts: &[StatisticalVerdict], p: fn(&StatisticalVerdict) -> f64) -> f64 {
    verdicts.iter().map(p).fold(f64::INFINITY, f64::min)
}

#[test]
fn mitsuba_agrees_with_all_seeds_and_faults_are_found() {
    let Some(manifest) = reference() else { return };
    let (scenes, faults, reseeds, nulls): (_, &[Fault], _, _) =
        if all() { (&[][..], &FAULTS, 1, 9) } else { (&["cornell".to_string()][..], &FOUND_IN_NOISE, 0, 7) };
    eprintln!("{:12} {:30} {:>9} {:>9} {:>9} {:>9}", "scene", "fault", "found", "chi2", "tile", "mean");
    for case in manifest.select(scenes).expect("scenes of the manifest").into_iter().filter(|c| c.mitsuba.is_some()) {
        if case.optional && !case.scene.exists() {
            continue;
        }
        let scene = load_scene(case);
        for fault in std::iter::once(None).chain(faults.iter().map(|&f| Some(f))) {
            // Every accelerator answers alike, so the shadow rays of one that drops some cannot be asked for by name.
            if matches!(fault, Some(Fault::Shadows(_))) {
                continue;
            }
            let sets = in_noise(case, &scene, fault, if fault.is_none() { nulls } else { reseeds });
            let found = sets.iter().filter(|v| !passes(v)).count();
            let name = fault.map_or("none".to_string(), |fault| fault.to_string());
            let [chi2, tile, mean] =
                [least(&sets, |v| v.chi2_p), least(&sets, |v| v.max_p), least(&sets, |v| v.global_p)];
            let share = format!("{found} of {}", sets.len());
            eprintln!("{:12} {name:30} {share:>9} {chi2:9.1e} {tile:9.1e} {mean:9.1e}", case.name);
            match fault {
                None => assert_eq!(found, 0, "{}: {sets:?}", case.name),
                Some(fault) if case.name == "cornell" && FOUND_IN_NOISE.contains(&fault) => {
                    assert_eq!(found, sets.len(), "cornell passed with {fault}: {sets:?}");
                }
                Some(_) => {}
            }
        }
    }
}
