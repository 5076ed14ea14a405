//! The validator passes what is right and fails what is tampered with.

mod faults;
mod power;
mod report;
mod theirs;

use skipgrid::picture::Picture;
use skipgrid::picture::io::{self, Attributes};
use skipgrid::render::{Integrator, Sampler, Settings, render};
use skipgrid::scene::{LoadOptions, Scene, load};
use skipgrid::validate::{self, Case, Manifest, Options, check_case, sha256};
use std::path::{Path, PathBuf};

fn folder(test: &str) -> PathBuf {
    crate::folder("validate", test)
}

/// The committed pictures of other programs.
fn reference() -> Option<Manifest> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("reference/manifest.toml");
    if !path.exists() {
        eprintln!("skipped: {} is absent", path.display());
        return None;
    }
    Some(Manifest::read(path).expect("a good manifest"))
}

fn load_scene(case: &Case) -> Scene {
    load(case.scene.to_str().expect("text"), &LoadOptions::default()).expect("a good scene")
}

const SCENE: &str = r#"
name = "small"
environment = [0.1, 0.1, 0.1]
[camera]
origin = [0.0, 3.0, 8.0]
target = [0.0, 0.5, 0.0]
yfov = 40.0
[[material]]
name = "floor"
type = "lambert"
albedo = [0.5, 0.4, 0.3]
[[quad]]
corner = [-5.0, 0.0, 5.0]
u = [10.0, 0.0, 0.0]
v = [0.0, 0.0, -10.0]
material = "floor"
[[sphere]]
centre = [0.0, 1.1, 0.0]
radius = 1.0
material = "floor"
[[light]]
type = "point"
position = [3.0, 6.0, 3.0]
intensity = [40.0, 40.0, 40.0]
"#;

/// A reference folder whose pictures are made by brute force: says nothing about truth, only whether the validator
/// sees what happens to pictures and files.
fn own_reference(test: &str) -> PathBuf {
    let folder = folder(test);
    let scene_file = folder.join("small.toml");
    std::fs::write(&scene_file, SCENE).expect("written");
    let scene = load(scene_file.to_str().expect("text"), &LoadOptions::default()).expect("a good scene");
    let accel = scene.accel("brute").expect("built");
    let settings = Settings {
        integrator: Integrator::Whitted,
        width: 24,
        height: 16,
        sampler: Sampler::Regular(2),
        max_depth: 3,
        ..Settings::default()
    };
    let whitted = render(&scene, &*accel, &settings, &|_, _| {}).expect("rendered").picture();
    io::write(folder.join("pov.exr"), &whitted, &Attributes::default()).expect("written");
    let pictures: Vec<Picture> = (100..108)
        .map(|seed| {
            let sampler = Sampler::Sobol(16);
            let settings = Settings { integrator: Integrator::Path, sampler, seed, ..settings.clone() };
            render(&scene, &*accel, &settings, &|_, _| {}).expect("rendered").picture()
        })
        .collect();
    let (mut mean, mut variance) = (Picture::new(24, 16), Picture::new(24, 16));
    for i in 0..mean.pixels.len() {
        for c in 0..3 {
            let values = pictures.iter().map(|p| f64::from(p.pixels[i][c]));
            let average = values.clone().sum::<f64>() / 8.0;
            mean.pixels[i][c] = average as f32;
            variance.pixels[i][c] = (values.map(|v| (v - average).powi(2)).sum::<f64>() / 56.0) as f32;
        }
    }
    io::write_with_variance(folder.join("mitsuba.exr"), &mean, &variance, &Attributes::default()).expect("written");
    let manifest = format!(
        r#"[[case]]
name = "small"
scene = "small.toml"
[case.povray]
image = "pov.exr"
grid = 2
max_depth = 3
version = "none"
command = "none <&>"
seconds = 0.5
sha256 = "{}"
out1_floor = 0.0
[case.mitsuba]
image = "mitsuba.exr"
replicates = 8
spp = 16
max_depth = 3
width = 24
height = 16
version = "none"
command = "none"
seconds = 0.5
sha256 = "{}"
variance_sha256 = "{}"
"#,
        sha256::of_pixels(&whitted),
        sha256::of_pixels(&mean),
        sha256::of_pixels(&variance)
    );
    std::fs::write(folder.join("manifest.toml"), manifest).expect("written");
    folder.join("manifest.toml")
}

#[test]
fn reports_say_what_was_found() {
    let manifest = own_reference("reports");
    let options = Options { keep_pictures: true, ..Options::default() };
    let accels = ["brute".to_string(), "grid".to_string()];
    let options = Options { reseeds: 3, ..options };
    let report = validate::run(&manifest, &[], &accels, &options).expect("it runs");
    assert!(report.passed(), "{report}");
    assert_eq!((report.entries.len(), report.equal_pictures), (2, 2));
    let text = report.to_string();
    assert!(text.contains("4 of 4 comparisons passed; 2 of 2 pictures equal the first accelerator's to the bit\n"));
    // Three further sets of eight renders, for the first accelerator alone; their limits are a third of the usual ones.
    assert!(text.contains("small reseeded: 3 of 3 sets passed; least p of chi-squared "), "{text}");
    assert_eq!(report.reseeds.iter().map(|r| r.first_seed).collect::<Vec<_>>(), [9, 17, 25]);
    let found: Vec<f64> = report.reseeds.iter().map(|r| r.verdict.chi2).collect();
    assert!(found[0] != found[1] && found[1] != found[2], "other seeds, other noise: {found:?}");
    assert!(report.reseeds.iter().all(|r| r.verdict.limits.max == 1e-3 / 3.0));
    assert_eq!(report.csv().lines().count(), 5);
    assert!(report.csv().lines().skip(1).all(|line| line.starts_with("small,") && line.contains(",true,24,16,")));
    let json = serde_json::to_value(&report).expect("serialised");
    assert_eq!(json["entries"][1]["verdict"]["tiers"][0]["renderer"], "povray");
    assert_eq!(json["entries"][0]["verdict"]["tiers"][0]["test"]["kind"], "deterministic");
    let out = folder("reports-pictures");
    assert_eq!(report.write_pictures(&out).expect("written"), 6);
    assert!(io::read(out.join("small-povray-brute-ours.exr")).is_ok());
}

#[test]
fn scenes_that_are_not_here_are_left_out_only_where_that_is_allowed() {
    let manifest = own_reference("left-out");
    let text = std::fs::read_to_string(&manifest).expect("just written");
    let absent = text.replace("small", "absent");
    let run = |more: &str| {
        std::fs::write(&manifest, format!("{text}{more}")).expect("written");
        validate::run(&manifest, &[], &["brute".to_string()], &Options::default())
    };
    let error = run(&absent).expect_err("absent.toml").to_string();
    assert!(error.contains("absent.toml"), "{error}");
    let report = run(&absent.replace("[case.povray]", "optional = true\n[case.povray]")).expect("it runs");
    assert!(report.passed() && report.entries.len() == 1 && report.unfinished == 0, "{report}");
    assert!(report.left_out.len() == 1 && report.to_string().contains("\nleft out: absent: there is no "), "{report}");
}

#[test]
fn tampered_pictures_fail_and_say_so() {
    let manifest = own_reference("tampered");
    let run = || validate::run(&manifest, &[], &["brute".to_string()], &Options::default()).expect("it runs");
    assert!(run().passed(), "{}", run());
    let image = manifest.with_file_name("pov.exr");
    let good = io::read(&image).expect("read");
    let mut tampered = good.clone();
    tampered.pixels[40][1] += 1e-6;
    io::write(&image, &tampered, &Attributes::default()).expect("written");
    let report = run();
    assert!(!report.passed());
    assert!(report.to_string().contains("pov.exr: the stored pixels were changed"), "{report}");
    std::fs::write(&image, b"nonsense").expect("written");
    assert!(run().to_string().contains("pov.exr: damaged EXR file"), "{}", run());
    std::fs::remove_file(&image).expect("removed");
    assert!(!run().passed() && run().to_string().contains("pov.exr: "));
    io::write(&image, &good, &Attributes::default()).expect("written");
    assert!(run().passed());

    let image = manifest.with_file_name("mitsuba.exr");
    let (mean, mut variance) = io::read_with_variance(&image).expect("read");
    variance.pixels.iter_mut().flatten().for_each(|v| *v *= 100.0);
    io::write_with_variance(&image, &mean, &variance, &Attributes::default()).expect("written");
    assert!(run().to_string().contains("the stored variances were changed"), "{}", run());
}

#[test]
fn pictures_that_are_not_finite_or_of_another_size_fail() {
    let path = own_reference("odd");
    let mut case = Manifest::read(&path).expect("a good manifest").cases.remove(0);
    let scene = load_scene(&case);
    let accel = scene.accel("brute").expect("built");
    let mut picture = io::read(path.with_file_name("pov.exr")).expect("read");
    picture.pixels[7][0] = f32::NAN;
    io::write(path.with_file_name("pov.exr"), &picture, &Attributes::default()).expect("written");
    case.povray.as_mut().expect("it has one").sha256 = sha256::of_pixels(&picture);
    case.mitsuba.as_mut().expect("it has one").width = 23;
    let verdict = check_case(&case, &scene, &*accel, &Options::default());
    assert!(!verdict.passed());
    assert!(verdict.tiers[0].reason().contains("reference has 1 pixels that are not finite"), "{verdict:?}");
    assert!(verdict.tiers[1].reason().contains("24 x 16, the manifest says 23 x 16"), "{verdict:?}");
}

#[test]
fn unknown_names_and_bad_manifests_are_errors() {
    let folder = folder("manifests");
    let path = folder.join("manifest.toml");
    let digest = "0".repeat(64);
    let good = format!(
        "[[case]]\nname = \"a\"\nscene = \"a.toml\"\n[case.povray]\nimage = \"a.exr\"\ngrid = 2\nmax_depth = 3\n\
         version = \"v\"\ncommand = \"c\"\nseconds = 1.0\nsha256 = \"{digest}\"\nout1_floor = 0.0\n"
    );
    let read = |text: &str| {
        std::fs::write(&path, text).expect("written");
        Manifest::read(&path)
    };
    let manifest = read(&good).expect("a good manifest");
    assert_eq!(manifest.cases[0].scene, folder.join("a.toml"));
    let message = manifest.select(&["b".to_string()]).expect_err("unknown").to_string();
    assert!(message.contains("`b`") && message.contains("there are: a"), "{message}");
    for (text, expected) in [
        ("".to_string(), "case"),
        ("case = []".to_string(), "has no case"),
        ("[[case]]\nname = 3".to_string(), "line 2: invalid type"),
        (good.replace("grid = 2", "grid = 0"), "case `a`: povray: grid is 0, not 1 to 64"),
        (good.replace("0000", "000"), "is not 64 lower-case hexadecimal digits"),
        (good.replace("out1_floor = 0.0", "out1_floor = nan"), "out1_floor is NaN"),
        (good.replace("out1_floor = 0.0", "out1_floor = 0.0\ntrim = 0.1"), "trim without a tolerance_reason"),
        (good.replace("name = \"a\"", "name = \"../a\""), "name has other characters"),
        (good.clone() + &good, "case `a`: is there twice"),
        ("[[case]]\nname = \"a\"\nscene = \"a.toml\"\n".to_string(), "why_not_povray"),
        (good.replace("grid", "gird"), "line 6: unknown field `gird`"),
    ] {
        let message = read(&text).expect_err(expected).to_string();
        assert!(message.contains("manifest.toml") && message.contains(expected), "{message}");
    }
    assert_eq!(Manifest::read(folder.join("absent.toml")).expect_err("absent").exit_code(), 3);
    std::fs::write(&path, &good).expect("written");
    let options = Options { replicates: 1, ..Options::default() };
    assert!(validate::run(&path, &[], &[], &options).is_err());
}
