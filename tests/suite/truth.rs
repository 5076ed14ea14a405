//! Every accelerator against the exact records of the stiff catalogue.
//!
//! The records are an archive beside the project, `shared/spec/stability-truth.tar.zst`, or a folder of its files named
//! by `SKIPGRID_TRUTH`. Without either the test says so and passes.

use skipgrid::oracle::Oracle;
use skipgrid::scene::raw;
use skipgrid::{Ray, Triangle};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

/// Half a unit in the last place of the f32 nearest to `t`.
fn half_ulp(t: f64) -> f64 {
    let near = (t.abs() as f32).min(f32::MAX);
    (f64::from(near.next_up().min(f32::MAX)) - f64::from(near)).max(f64::from(near) - f64::from(near.next_down())) / 2.0
}

/// The folder of the records, unpacked once; `None` with a message if they are not at hand.
fn folder() -> Option<&'static Path> {
    static FOLDER: OnceLock<Option<PathBuf>> = OnceLock::new();
    FOLDER
        .get_or_init(|| {
            if let Some(folder) = std::env::var_os("SKIPGRID_TRUTH") {
                return Some(folder.into());
            }
            let archive = crate::shared("spec/stability-truth.tar.zst")?;
            let folder = crate::folder("truth", "records");
            let status = Command::new("tar").arg("--zstd").arg("-xf").arg(&archive).arg("-C").arg(&folder).status();
            match status {
                Ok(status) if status.success() => Some(folder),
                other => {
                    eprintln!("skipped: `tar --zstd` could not unpack {}: {other:?}", archive.display());
                    None
                }
            }
        })
        .as_deref()
}

/// The files of records, in order; none if they are not at hand.
fn cases() -> Vec<PathBuf> {
    let Some(folder) = folder() else { return Vec::new() };
    let mut cases: Vec<PathBuf> = std::fs::read_dir(folder)
        .expect("the folder of records can be read")
        .map(|entry| entry.expect("an entry of the folder can be read").path())
        .filter(|path| path.extension().is_some_and(|e| e == "truth"))
        .collect();
    cases.sort();
    assert!(!cases.is_empty(), "no record in {}", folder.display());
    cases
}

/// A file of records, its rays and its triangles.
struct Case {
    name: String,
    answers: Vec<raw::Answer>,
    rays: Vec<Ray>,
    triangles: Vec<Triangle>,
}

impl Case {
    fn read(path: &Path) -> Self {
        let name = path.file_stem().expect("a file has a name").to_string_lossy().into_owned();
        let answers = raw::read_truth(path).expect("records are well-formed").answers;
        let rays = raw::read_rays(path.with_extension("rays")).expect("rays are well-formed");
        let triangles = raw::read_triangles(path.with_extension("tri")).expect("triangles are well-formed");
        assert_eq!(answers.len(), rays.len(), "{name}");
        Self { name, answers, rays, triangles }
    }
}

/// Every record of the catalogue against the accelerator that `spec` names: the hit, the primitive and the parameter.
pub fn check(spec: &str) {
    for case in cases() {
        check_case(spec, &Case::read(&case));
    }
}

/// A ray and what the record says of it.
fn show(ray: &Ray, answer: &raw::Answer) -> String {
    let bits = [ray.origin.to_array(), ray.direction.to_array()].map(|v| v.map(f32::to_bits));
    let range = [ray.t_min, ray.t_max].map(f32::to_bits);
    format!("{ray:?}, bits {bits:08x?} {range:08x?}, exact {answer:?}")
}

fn check_case(spec: &str, case: &Case) {
    let Case { name, answers, rays, triangles } = case;
    let accel = crate::conformance::triangles(triangles).accel(spec).expect("the accelerator can be built");
    let (mut hits, mut ties, mut worst) = (0, 0, 0.0f64);
    for (i, (ray, answer)) in rays.iter().zip(answers).enumerate() {
        let place = || format!("{spec}: {name}, ray {i}: {}", show(ray, answer));
        let found = accel.closest_hit(ray);
        assert_eq!(found.is_some(), answer.hit, "{}", place());
        assert_eq!(accel.any_hit(ray), answer.hit, "any hit: {}", place());
        let Some(found) = found else { continue };
        hits += 1;
        ties += usize::from(answer.prims.len() > 1);
        assert_eq!(Some(&found.prim), answer.prims.iter().min(), "{}", place());
        if answer.t.abs() >= f64::from(f32::MAX) {
            assert_eq!(found.t, answer.t as f32, "{}", place());
            continue;
        }
        // The recorded parameter is itself rounded, to f64.
        let error = (f64::from(found.t) - answer.t).abs() / (2.0 * half_ulp(answer.t));
        worst = worst.max(error);
        assert!(error <= 0.5 + 1e-8, "{error} ulp at {}: {}", found.t, place());
    }
    println!("{spec:12} {name:24} {:5} rays {hits:5} hits {ties:5} ties, t within {worst:.3} ulp", rays.len());
}

#[test]
fn the_oracle_agrees_with_every_record() {
    let (mut records, mut ties) = (0, 0);
    for path in cases() {
        let Case { name, answers, rays, triangles } = Case::read(&path);
        let oracle = Oracle::of_triangles(&triangles);
        for (i, (ray, answer)) in rays.iter().zip(&answers).enumerate() {
            let found = oracle.closest(ray);
            let place = || format!("{name}, ray {i}: {found:?} for {}", show(ray, answer));
            assert_eq!(found.as_ref().map_or(&[][..], |f| &f.prims), answer.prims, "{}", place());
            if let Some(found) = &found {
                // The recorded parameter is within half a unit of f64, and so is the one found.
                let near = [answer.t.next_down(), answer.t, answer.t.next_up()].contains(&found.t);
                assert!(near, "{}", place());
                ties += usize::from(found.prims.len() > 1);
            }
        }
        records += rays.len();
    }
    println!("{records} records, {ties} ties");
    assert!(records == 0 || (records > 80_000 && ties > 5_000), "{records} records, {ties} ties");
}

#[test]
fn brute_force_answers_exactly() {
    check("brute");
}

#[test]
fn grids_answer_exactly() {
    check("grid");
    check("grid:density=20,mailbox=on");
}

#[test]
fn skip_methods_answer_exactly() {
    for name in ["clouds", "dsz", "dual", "dsz24", "chessboard", "octant"] {
        check(&format!("grid-{name}"));
        check(&format!("grid-{name}:density=20,threshold=1"));
        check(&format!("grid-{name}:density=20,distances=log2"));
    }
    check("grid:density=20,step=branchless");
    check("grid:density=20,step=integer");
}

#[test]
fn trees_answer_exactly() {
    for options in ["listing=interval", "listing=segment", "listing=midpoint", "walk=retraverse", "walk=climb"] {
        check(&format!("bsp:{options}"));
        check(&format!("bsp:{options},leaf=1,depth=45"));
    }
    for planes in ["sah", "oblique"] {
        check(&format!("bsp:planes={planes}"));
        check(&format!("bsp:planes={planes},listing=segment,leaf=1"));
    }
}

#[test]
fn nested_grids_answer_exactly() {
    for quality in ["fast", "default", "best"] {
        check(&format!("nested:quality={quality}"));
    }
}

#[cfg(feature = "obvhs")]
#[test]
fn obvhs_with_the_exact_test_answers_exactly() {
    check("obvhs-bvh2");
    check("obvhs-cwbvh");
}
