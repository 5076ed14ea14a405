//! Properties over random stiff scenes: every exact accelerator answers as the oracle does.
//!
//! The same cases in every run; `PROPTEST_CASES` asks for more. A failure shrinks to a few primitives and one ray, writes the
//! scene to a file and prints a command that traces the ray.

mod stiff;

use crate::conformance::specs;
use glam::Vec3;
use proptest::test_runner::{Config, RngAlgorithm, TestCaseError, TestError, TestRng, TestRunner};
use skipgrid::oracle::{Oracle, Primitive, Truth};
use skipgrid::scene::{SceneGeometry, raw};
use skipgrid::{Hit, Ray, Sphere};
use std::cell::Cell;
use std::path::{Path, PathBuf};
use std::process::Command;
use stiff::{Case, Kind, case};

/// What an accelerator says of a ray: the closest hit, and whether there is any.
type Answer = (Option<Hit>, bool);

fn oracle(case: &Case) -> Oracle {
    let triangles = case.triangles.iter().map(|&corners| Primitive::Triangle(corners));
    let spheres = case.spheres.iter().map(|&Sphere { centre, radius }| Primitive::Sphere { centre, radius });
    Oracle::new(triangles.chain(spheres).collect())
}

/// Brute force, and three more of all that can be built: every one has its turn.
fn chosen(case: &Case, geometry: &SceneGeometry) -> Vec<String> {
    let all = specs(geometry);
    let others = (0..3).map(|i| all[case.choice.wrapping_add(i * 7) % all.len()].clone());
    std::iter::once("brute".to_string()).chain(others).collect()
}

/// What is wrong with an answer, if something is.
fn fault((hit, any): Answer, truth: Option<&Truth>) -> Option<String> {
    if any != truth.is_some() {
        return Some(format!("any hit is {any}"));
    }
    let (hit, truth) = match (hit, truth) {
        (None, None) => return None,
        (None, Some(_)) => return Some("missed".into()),
        (Some(_), None) => return Some("hits nothing".into()),
        (Some(hit), Some(truth)) => (hit, truth),
    };
    if hit.prim != truth.prims[0] {
        return Some("not the first of the closest primitives".into());
    }
    (hit.t != truth.nearest).then(|| format!("not the nearest f32, {} ulps from the parameter", truth.ulps(hit.t)))
}

/// The words of a ray's bits, as `skipgrid trace --ray` reads them.
fn words(ray: &Ray) -> String {
    let Ray { origin: o, direction: d, t_min, t_max } = *ray;
    [o.x, o.y, o.z, d.x, d.y, d.z, t_min, t_max].map(|x| format!("{:#x}", x.to_bits())).join(" ")
}

/// Writes the scene and gives the arguments that trace `ray` through it.
fn command(case: &Case, spec: &str, ray: &Ray, folder: &Path) -> Vec<String> {
    std::fs::create_dir_all(folder).expect("the folder for temporary files can be written");
    let file = |extension: &str| folder.join(format!("scene.{extension}"));
    let path = match case.kind {
        Kind::Triangles => {
            raw::write_triangles(file("tri"), &case.triangles).expect("written");
            file("tri")
        }
        Kind::Spheres => {
            raw::write_spheres(file("sph"), &case.spheres).expect("written");
            file("sph")
        }
        Kind::Mixed => {
            std::fs::write(file("toml"), scene_file(case)).expect("written");
            file("toml")
        }
    };
    ["trace", &path.to_string_lossy(), "--accel", spec, "--ray", &words(ray)].map(String::from).into()
}

/// A scene file with all bits of the coordinates: every f32 is written as the f64 that it is.
fn scene_file(case: &Case) -> String {
    let vector = |v: &Vec3| format!("{:?}", v.to_array().map(f64::from));
    let positions: Vec<String> = case.triangles.as_flattened().iter().map(vector).collect();
    let indices: Vec<[usize; 3]> = (0..case.triangles.len()).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let mut text = format!("[[triangles]]\npositions = [{}]\nindices = {indices:?}\n", positions.join(", "));
    for Sphere { centre, radius } in &case.spheres {
        text += &format!("\n[[sphere]]\ncentre = {}\nradius = {:?}\n", vector(centre), f64::from(*radius));
    }
    text
}

/// All there is to know about a wrong answer.
fn report(case: &Case, spec: &str, ray: &Ray, answer: Answer, truth: Option<&Truth>, folder: &Path) -> String {
    let bits = |v: Vec3| v.to_array().map(|x| format!("{:08x}", x.to_bits())).join(" ");
    let mut text = format!("{spec} answers {answer:?}, exact is {truth:?}\n{ray:?}\nray bits {}\n", words(ray));
    for (i, t) in case.triangles.iter().enumerate() {
        text += &format!("primitive {i}: triangle {t:?}, bits {}\n", t.map(bits).join(", "));
    }
    for (i, s) in (case.triangles.len()..).zip(&case.spheres) {
        let radius = s.radius.to_bits();
        text += &format!("primitive {i}: sphere {} {}, bits {} {radius:08x}\n", s.centre, s.radius, bits(s.centre));
    }
    let words = command(case, spec, ray, folder);
    let quoted: Vec<String> =
        words.iter().map(|w| if w.contains(' ') { format!("'{w}'") } else { w.clone() }).collect();
    text + &format!("cargo run --release -- {}\n", quoted.join(" "))
}

/// Asks an accelerator.
fn ask(geometry: &SceneGeometry, spec: &str, rays: &[Ray]) -> Vec<Answer> {
    let accel = geometry.accel(spec).unwrap_or_else(|e| panic!("{spec}: {e}"));
    rays.iter().map(|ray| (accel.closest_hit(ray), accel.any_hit(ray))).collect()
}

/// Runs the property over cases of a kind with `ask` for the accelerators; the report of the simplest failure, or how many
/// rays hit and how many of these hit several primitives at once.
fn run(
    kind: Kind,
    folder: &Path,
    ask: impl Fn(&SceneGeometry, &str, &[Ray]) -> Vec<Answer>,
) -> Result<(usize, usize), String> {
    let mut config = Config { failure_persistence: None, ..Config::default() };
    if std::env::var_os("PROPTEST_CASES").is_none() {
        config.cases = 300;
    }
    let mut runner = TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha));
    let (hits, ties) = (Cell::new(0), Cell::new(0));
    // The first wrong answer to a case.
    let wrong = |case: &Case| {
        let geometry = case.geometry();
        let oracle = oracle(case);
        let truths: Vec<Option<Truth>> = case.rays.iter().map(|ray| oracle.closest(ray)).collect();
        hits.set(hits.get() + truths.iter().flatten().count());
        ties.set(ties.get() + truths.iter().flatten().filter(|t| t.prims.len() > 1).count());
        chosen(case, &geometry).into_iter().find_map(|spec| {
            let answers = ask(&geometry, &spec, &case.rays);
            let mut each = case.rays.iter().zip(answers).zip(&truths);
            each.find_map(|((ray, answer), truth)| {
                let fault = fault(answer, truth.as_ref())?;
                Some((fault, spec.clone(), *ray, answer, truth.clone()))
            })
        })
    };
    let outcome = runner.run(&case(kind), |case| match wrong(&case) {
        None => Ok(()),
        Some((fault, ..)) => Err(TestCaseError::fail(fault)),
    });
    match outcome {
        Ok(()) => Ok((hits.get(), ties.get())),
        Err(TestError::Abort(reason)) => Err(format!("given up: {reason}")),
        Err(TestError::Fail(reason, simplest)) => {
            let Some((fault, spec, ray, answer, truth)) = wrong(&simplest) else {
                return Err(format!("{reason}: {simplest:?}"));
            };
            let only = Case { rays: vec![ray], ..simplest };
            Err(format!("{fault}: {}", report(&only, &spec, &ray, answer, truth.as_ref(), folder)))
        }
    }
}

/// A folder of the test's own, made when something is written to it.
fn folder(test: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join("property").join(test)
}

fn holds(kind: Kind, name: &str) {
    match run(kind, &folder(name), ask) {
        Ok((hits, ties)) => {
            println!("{name}: {hits} hits, {ties} ties");
            // Scenes and rays that miss each other show nothing.
            assert!(hits > 150 && ties > 10, "{name}: {hits} hits, {ties} ties");
        }
        Err(report) => panic!("{name}: {report}"),
    }
}

#[test]
fn triangles_answer_as_the_oracle() {
    holds(Kind::Triangles, "triangles");
}

#[test]
fn spheres_answer_as_the_oracle() {
    holds(Kind::Spheres, "spheres");
}

#[test]
fn triangles_and_spheres_answer_as_the_oracle() {
    holds(Kind::Mixed, "mixed");
}

/// What random scenes found: the closest of two that are nearer to each other than f64 parameters tell.
#[test]
fn parameters_apart_by_less_than_f64_holds_are_in_order() {
    let bits = |words: [u32; 3]| Vec3::from(words.map(f32::from_bits));
    let sphere = |centre: [u32; 3], radius: u32| Sphere { centre: bits(centre), radius: f32::from_bits(radius) };
    let ray = |o: [u32; 3], d: [u32; 3], range: [u32; 2]| {
        Ray::new(bits(o), bits(d)).with_range(f32::from_bits(range[0]), f32::from_bits(range[1]))
    };
    let cases = [
        Case {
            kind: Kind::Spheres,
            triangles: Vec::new(),
            spheres: vec![
                sphere([0x3fc0_0000, 0xc040_0000, 0xbf80_0000], 0x4081_3e74),
                sphere([0, 0, 0x3e0c_97b0], 0x4000_0000),
            ],
            rays: vec![ray([0, 0x59c0_0000, 0], [0, 0xd9c0_0000, 0x3e0c_97b0], [0x3f80_0000, 0x7f7f_ffff])],
            choice: 0,
        },
        Case {
            kind: Kind::Mixed,
            triangles: vec![[Vec3::ZERO, Vec3::X, Vec3::Y]],
            spheres: vec![sphere([0; 3], 0x3f80_0000)],
            rays: vec![ray(
                [0x3e80_0000, 0xf1b5_0bdc, 0xbf1d_692d],
                [0xbe80_0000, 0x71b5_0bdc, 0x3f1d_692d],
                [0xbf2e_941d, 0x4040_0000],
            )],
            choice: 0,
        },
    ];
    for case in cases {
        let geometry = case.geometry();
        let truth = oracle(&case).closest(&case.rays[0]);
        assert_eq!(truth.as_ref().map(|t| &t.prims[..]), Some(&[1][..]), "{case:?}");
        for spec in ["brute", "grid", "grid-dual", "bsp"] {
            let answer = ask(&geometry, spec, &case.rays)[0];
            let fault = fault(answer, truth.as_ref());
            assert_eq!(fault, None, "{spec} answers {answer:?}, exact is {truth:?}: {case:?}");
        }
    }
}

#[test]
fn faults_are_found_and_shrink_to_one_ray() {
    type Fault = fn(Answer, &Ray) -> Answer;
    let faults: [(&str, &str, Fault); 4] = [
        ("open end", "any hit is false", |(hit, any), ray| {
            let kept = hit.filter(|hit| hit.t < ray.t_max);
            (kept, any && kept.is_some())
        }),
        ("next primitive", "not the first", |(hit, any), _| (hit.map(|h| Hit { prim: h.prim ^ 1, ..h }), any)),
        ("next number", "not the nearest f32", |(hit, any), _| {
            (hit.map(|h| Hit { t: if h.t > 2.0 { h.t.next_up() } else { h.t }, ..h }), any)
        }),
        ("lost behind", "missed", |(hit, any), _| (hit.filter(|h| h.t >= 0.0), any)),
    ];
    for (name, words, fault) in faults {
        // Brute force for all: what is looked at is the search, and that takes many attempts.
        let asked = |geometry: &SceneGeometry, _: &str, rays: &[Ray]| {
            ask(geometry, "brute", rays).into_iter().zip(rays).map(|(answer, ray)| fault(answer, ray)).collect()
        };
        let report = run(Kind::Triangles, &folder(name), asked).expect_err(name);
        assert!(report.starts_with(words), "{name}: {report}");
        assert!(report.contains("primitive 0: triangle") && !report.contains("primitive 2"), "{name}: {report}");
        assert!(report.contains("cargo run --release -- trace"), "{name}: {report}");
    }
}

#[test]
fn printed_commands_trace_the_ray_to_the_bit() {
    let least = f32::from_bits(1);
    let triangles = vec![[Vec3::NEG_ONE, Vec3::X, Vec3::Y], [Vec3::new(0.1, -0.0, least), Vec3::ONE, Vec3::Y * 3e38]];
    let spheres = vec![Sphere { centre: Vec3::new(0.3, 1e-30, -7.0), radius: 7.3 }];
    let origin = Vec3::new(0.1, 0.3, -9.7);
    let rays = [
        Ray::new(origin, Vec3::new(-0.0, least, 0.7)),
        Ray::new(origin, Vec3::new(-0.0, 0.0, -0.7)).with_range(f32::NEG_INFINITY, f32::INFINITY),
        Ray::new(origin, Vec3::new(f32::NAN, 0.0, 1.0)),
        Ray::new(Vec3::new(0.2, 0.25, 5.0), Vec3::new(0.0, 0.0, -1e-20)).with_range(-1.0, f32::MAX),
    ];
    for (kind, name) in [(Kind::Triangles, "t"), (Kind::Spheres, "s"), (Kind::Mixed, "m")] {
        let mut hits = 0;
        for ray in rays {
            let mut case =
                Case { kind, triangles: triangles.clone(), spheres: spheres.clone(), rays: vec![ray], choice: 0 };
            match kind {
                Kind::Triangles => case.spheres.clear(),
                Kind::Spheres => case.triangles.clear(),
                Kind::Mixed => {}
            }
            let args = command(&case, "grid:density=20", &ray, &folder(name));
            let run = Command::new(env!("CARGO_BIN_EXE_skipgrid")).args(&args).output().expect("the program starts");
            let stderr = String::from_utf8_lossy(&run.stderr);
            assert_eq!(run.status.code(), Some(0), "{args:?}: {stderr}");
            let (hit, any) = ask(&case.geometry(), "grid:density=20", &[ray])[0];
            let t = hit.map_or(f32::INFINITY, |h| h.t);
            let prim = hit.map_or("none".into(), |h| h.prim.to_string());
            let expected = format!("t={t} bits={:#010x} prim={prim} any={any}\n", t.to_bits());
            assert_eq!(String::from_utf8_lossy(&run.stdout), expected, "{args:?}");
            hits += usize::from(any);
        }
        assert!(hits > 1, "{name}: {hits} of the rays hit something");
    }
}
