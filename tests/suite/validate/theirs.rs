//! Pictures that the user has of a scene of his own.

use super::faults::Fault;
use super::{SCENE, folder};
use skipgrid::Error;
use skipgrid::picture::io::{self, Attributes};
use skipgrid::picture::{Picture, metrics};
use skipgrid::render::{Integrator, Sampler, Settings, render};
use skipgrid::scene::{LoadOptions, Scene, load};
use skipgrid::validate::{Options, Report, Theirs, against};
use std::fs;
use std::path::{Path, PathBuf};

/// The scene, and its file in `folder`.
fn small(folder: &Path) -> Scene {
    let file = folder.join("small.toml");
    fs::write(&file, SCENE).expect("written");
    load(file.to_str().expect("text"), &LoadOptions::default()).expect("a good scene")
}

fn settings(integrator: Integrator, sampler: Sampler, seed: u64) -> Settings {
    Settings { integrator, width: 40, height: 24, sampler, max_depth: 3, seed, ..Settings::default() }
}

fn picture(scene: &Scene, settings: &Settings) -> Picture {
    let accel = scene.accel("brute").expect("built");
    render(scene, &*accel, settings, &|_, _| {}).expect("rendered").picture()
}

/// Files with independent renders of `scene`, with seeds that the validator does not use itself.
fn renders(scene: &Scene, folder: &Path, name: &str, count: u64, spp: u32) -> Vec<PathBuf> {
    let write = |seed: u64| {
        let path = folder.join(format!("{name}{seed}.pfm"));
        let noisy = picture(scene, &settings(Integrator::Path, Sampler::Sobol(spp), 1000 + seed));
        io::write(&path, &noisy, &Attributes::default()).expect("written");
        path
    };
    (0..count).map(write).collect()
}

fn theirs(integrator: Integrator, images: &[PathBuf]) -> Theirs {
    Theirs { images: images.to_vec(), renders: 2, integrator, grid: 2, max_depth: 3 }
}

fn run(scene: &Scene, theirs: &Theirs) -> skipgrid::Result<Report> {
    against(scene, theirs, &["brute".to_string(), "grid".to_string()], &Options::default())
}

#[test]
fn one_picture_without_noise_is_compared_pixel_by_pixel() {
    let folder = folder("theirs_whitted");
    let scene = small(&folder);
    let path = folder.join("a.exr");
    let good = picture(&scene, &settings(Integrator::Whitted, Sampler::Regular(2), 0));
    io::write(&path, &good, &Attributes::default()).expect("written");
    let report = run(&scene, &theirs(Integrator::Whitted, std::slice::from_ref(&path))).expect("it runs");
    assert!(report.passed() && report.equal_pictures == 1, "{report}");
    assert!(report.to_string().contains("theirs"), "{report}");
    let bright = Fault::Albedo(0.1).scene(&scene, 24);
    let report = run(&bright, &theirs(Integrator::Whitted, std::slice::from_ref(&path))).expect("it runs");
    assert!(!report.passed(), "{report}");
    // What a PNG makes of a picture that goes beyond 1.
    let mut glaring = scene.clone();
    glaring.environment *= 20.0;
    let mut cut = picture(&glaring, &settings(Integrator::Whitted, Sampler::Regular(2), 0));
    cut.pixels.iter_mut().flatten().for_each(|v| *v = v.min(1.0));
    io::write(&path, &cut, &Attributes::default()).expect("written");
    let report = run(&glaring, &theirs(Integrator::Whitted, std::slice::from_ref(&path))).expect("it runs");
    assert!(!report.passed() && report.to_string().contains("theirs ends at 1 while ours reaches 2:"), "{report}");
    let mut bad = good.clone();
    bad.pixels[7][1] = f32::NAN;
    io::write(&path, &bad, &Attributes::default()).expect("written");
    let report = run(&scene, &theirs(Integrator::Whitted, std::slice::from_ref(&path))).expect("it runs");
    assert!(!report.passed() && report.to_string().contains("1 pixels that are not finite"), "{report}");
}

#[test]
fn noisy_pictures_are_compared_within_their_noise() {
    let folder = folder("theirs_path");
    let scene = small(&folder);
    let several = renders(&scene, &folder, "a", 8, 32);
    let bright = Fault::Albedo(1.0).scene(&scene, 24);
    for images in [&several[..], &several[..2]] {
        let report = run(&scene, &theirs(Integrator::Path, images)).expect("it runs");
        assert!(report.passed(), "{} pictures: {report}", images.len());
    }
    let report = run(&bright, &theirs(Integrator::Path, &several)).expect("it runs");
    assert!(!report.passed(), "{report}");

    // The same as one picture with the variance of its mean.
    let pictures: Vec<Picture> = several.iter().map(|path| io::read(path).expect("read")).collect();
    let (mut mean, mut variance) = (Picture::new(40, 24), Picture::new(40, 24));
    let count = pictures.len() as f64;
    for i in 0..mean.pixels.len() {
        for c in 0..3 {
            let values = || pictures.iter().map(|p| f64::from(p.pixels[i][c]));
            let average = values().sum::<f64>() / count;
            let squares: f64 = values().map(|v| (v - average).powi(2)).sum();
            mean.pixels[i][c] = average as f32;
            variance.pixels[i][c] = (squares / (count - 1.0) / count) as f32;
        }
    }
    let path = folder.join("mean.exr");
    io::write_with_variance(&path, &mean, &variance, &Attributes::default()).expect("written");
    let known = Theirs { renders: 8, ..theirs(Integrator::Path, &[path]) };
    let [one, all] =
        [run(&scene, &known), run(&scene, &theirs(Integrator::Path, &several))].map(|r| r.expect("it runs"));
    assert!(one.passed(), "{one}");
    let of = |report: &Report| report.entries[0].verdict.tiers[0].reason();
    assert_eq!(of(&one), of(&all), "mean and variance say the same as the renders");
    assert!(!run(&bright, &known).expect("it runs").passed());
}

#[test]
fn one_picture_of_unknown_noise_can_be_shown_to_agree_but_not_to_differ() {
    let folder = folder("theirs_single");
    let scene = small(&folder);
    // Nearly without noise: agrees within ours.
    let calm = renders(&scene, &folder, "calm", 1, 4096);
    let report = run(&scene, &theirs(Integrator::Path, &calm)).expect("it runs");
    assert!(report.passed() && report.to_string().contains("agree all the more"), "{report}");
    // Much noisier than ours: its noise is beyond ours, and nobody can say what it is.
    let noisy = renders(&scene, &folder, "noisy", 1, 1);
    let report = run(&scene, &theirs(Integrator::Path, &noisy)).expect("it runs");
    assert!(!report.passed() && report.to_string().contains("nothing here can tell"), "{report}");
    let metrics: metrics::Metrics = report.entries[0].verdict.tiers[0].metrics.expect("measured all the same");
    assert!(metrics.rmse > 0.0);
}

#[test]
fn what_cannot_be_compared_is_an_error() {
    let folder = folder("theirs_errors");
    let scene = small(&folder);
    let [a, b] = ["a.pfm", "b.pfm"].map(|name| folder.join(name));
    io::write(&a, &Picture::new(4, 3), &Attributes::default()).expect("written");
    io::write(&b, &Picture::new(3, 4), &Attributes::default()).expect("written");
    for (integrator, images, words) in [
        (Integrator::Path, vec![], "no picture"),
        (Integrator::Whitted, vec![a.clone(), a.clone()], "2 pictures for Whitted's method"),
        (Integrator::Depth, vec![a.clone()], "Depth cannot be compared"),
        (Integrator::Path, vec![a.clone(), b.clone()], "b.pfm: picture is 3 x 4"),
        (Integrator::Path, vec![a.clone(), folder.join("gone.exr")], "gone.exr"),
    ] {
        let message = run(&scene, &theirs(integrator, &images)).expect_err(words).to_string();
        assert!(message.contains(words), "{message}");
    }
    let bad = Theirs { max_depth: 0, ..theirs(Integrator::Whitted, &[a]) };
    assert!(matches!(run(&scene, &bad), Err(Error::Invalid { .. })));
}

#[test]
fn the_program_compares_them_and_writes_the_same_report() {
    let folder = folder("theirs_program");
    let scene = small(&folder);
    renders(&scene, &folder, "a", 4, 16);
    let program = |args: &[&str]| crate::ended(crate::program(&folder).args(args));
    let common = ["validate", "--scene", "small.toml", "--max-depth", "3", "--accel", "grid", "--accel", "brute"];
    let noisy = ["--theirs", "a0.pfm", "a1.pfm", "a2.pfm", "a3.pfm", "--reseed", "2"];
    let (code, stdout, stderr) =
        program(&[&common[..], &noisy, &["--report", "report.html", "--pictures", "pictures"]].concat());
    assert_eq!(code, Some(0), "{stdout}{stderr}");
    assert!(stdout.contains("small reseeded: 2 of 2 sets passed"), "{stdout}");
    let page = fs::read_to_string(folder.join("report.html")).expect("a report");
    assert!(page.contains("id=\"power\"") && page.contains("a0.pfm, a1.pfm"), "{page}");
    let mut names: Vec<_> =
        fs::read_dir(folder.join("pictures")).expect("pictures").map(|e| e.expect("an entry")).collect();
    names.sort_by_key(|e| e.file_name());
    let names: Vec<String> = names.iter().map(|e| e.file_name().to_string_lossy().into_owned()).collect();
    assert_eq!(
        names,
        ["small-theirs-grid-difference.png", "small-theirs-grid-ours.exr", "small-theirs-grid-theirs.exr"]
    );

    // Another depth is another picture.
    let deep =
        ["validate", "--scene", "small.toml", "--max-depth", "8", "--theirs", "a0.pfm", "a1.pfm", "a2.pfm", "a3.pfm"];
    let (code, stdout, stderr) = program(&[&deep[..], &["--format", "json"]].concat());
    assert_eq!(code, Some(1), "{stderr}");
    let value: serde_json::Value = serde_json::from_str(&stdout).expect("JSON");
    assert_eq!(value["report"]["entries"][0]["verdict"]["tiers"][0]["renderer"], "theirs");
    for (args, words) in [
        (&["--theirs", "a0.pfm"][..], "--scene"),
        (&["--scene", "small.toml"], "--theirs"),
        (&["cornell", "--scene", "small.toml", "--theirs", "a0.pfm"], "cannot be used with"),
        (&["--scene", "small.toml", "--theirs", "a0.pfm", "--integrator", "whitted", "--spp", "5"], "--spp 5"),
        (&["--scene", "small.toml", "--theirs", "small.toml"], "no picture format"),
    ] {
        let (code, _, stderr) = program(&[&["validate"], args].concat());
        assert!(code == Some(2) && stderr.contains(words), "{args:?}: {code:?} {stderr}");
    }
}
