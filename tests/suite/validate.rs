//! The validator passes what is right and fails what is tampered with.

use glam::Vec3;
use skipgrid::accel::{Accel, Counts, Hit, Memory};
use skipgrid::picture::Picture;
use skipgrid::picture::io::{self, Attributes};
use skipgrid::ray::{Aabb, Ray};
use skipgrid::render::{Integrator, Sampler, Settings, render};
use skipgrid::scene::{Bsdf, LoadOptions, Scene, load};
use skipgrid::validate::{self, Case, Manifest, Options, check_case, sha256};
use std::path::{Path, PathBuf};

/// A folder of its own for one test, under `target/`.
fn folder(test: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("validate").join(test);
    std::fs::create_dir_all(&folder).expect("a writable target folder");
    folder
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

/// The case with POV-Ray's picture alone.
fn povray_only(case: &Case) -> Case {
    Case { mitsuba: None, ..case.clone() }
}

/// The case with Mitsuba's picture alone.
fn mitsuba_only(case: &Case) -> Case {
    Case { povray: None, ..case.clone() }
}

fn assert_fails(case: &Case, scene: &Scene, accel: &dyn Accel, fault: &str) {
    let verdict = check_case(case, scene, accel, &Options::default());
    let reasons: Vec<String> = verdict.tiers.iter().map(|t| t.reason()).collect();
    assert!(verdict.tiers.iter().all(|t| !t.passed), "{} passed with {fault}: {reasons:?}", case.name);
    assert!(reasons.iter().all(|r| !r.is_empty()));
}

fn assert_passes(case: &Case, scene: &Scene, accel: &dyn Accel) {
    for tier in check_case(case, scene, accel, &Options::default()).tiers {
        assert!(tier.passed, "{} against {}: {}", case.name, tier.renderer, tier.reason());
    }
}

/// Multiplies every diffuse albedo.
fn scale_albedo(scene: &mut Scene, factor: f32) {
    for material in &mut scene.materials {
        if let Bsdf::Lambert { albedo, .. } = &mut material.bsdf {
            *albedo = (*albedo * factor).min(Vec3::ONE);
        }
    }
}

/// Turns the camera by half a pixel of a picture with `height` rows.
fn shift_half_a_pixel(scene: &mut Scene, height: u32) {
    let camera = &mut scene.camera;
    let [_, right, _] = camera.basis();
    let pixel = 2.0 * (camera.yfov.to_radians() / 2.0).tan() / f64::from(height);
    camera.target += right * (0.5 * pixel * (camera.target - camera.origin).length());
}

/// Misses every occluder for one shadow ray of `one_in`, chosen by the ray's bits.
struct DropsShadows<A> {
    accel: A,
    one_in: u64,
}

impl<A: Accel> Accel for DropsShadows<A> {
    fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        self.accel.closest_hit(ray)
    }
    fn any_hit(&self, ray: &Ray) -> bool {
        let mut hash = 0u64;
        for value in ray.origin.to_array().into_iter().chain(ray.direction.to_array()) {
            hash = (hash ^ u64::from(value.to_bits())).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            hash ^= hash >> 29;
        }
        !hash.is_multiple_of(self.one_in) && self.accel.any_hit(ray)
    }
    fn closest_hit_counted(&self, ray: &Ray, counts: &mut Counts) -> Option<Hit> {
        self.accel.closest_hit_counted(ray, counts)
    }
    fn any_hit_counted(&self, ray: &Ray, _: &mut Counts) -> bool {
        self.any_hit(ray)
    }
    fn bounds(&self) -> Aabb {
        self.accel.bounds()
    }
    fn memory(&self) -> Memory {
        self.accel.memory()
    }
}

#[test]
fn povray_agrees_and_every_fault_is_found() {
    let Some(manifest) = reference() else { return };
    let cases: Vec<Case> = manifest.cases.iter().filter(|c| c.povray.is_some()).map(povray_only).collect();
    assert!(cases.len() >= 6, "only {} scenes have a picture of POV-Ray", cases.len());
    for case in &cases {
        let scene = load_scene(case);
        assert_passes(case, &scene, &*scene.accel("grid").expect("built"));
        // The faster accelerator, since pictures do not depend on it.
        let accel = scene.accel("obvhs-cwbvh").expect("built");
        assert_fails(case, &scene, &DropsShadows { accel: &*accel, one_in: 1000 }, "one shadow ray in 1000 dropped");
        let mut bright = scene.clone();
        scale_albedo(&mut bright, 1.01);
        assert_fails(case, &bright, &*accel, "1 % more albedo");
        let rows = io::read(&case.povray.as_ref().expect("filtered").image).expect("read").height;
        let mut turned = scene.clone();
        shift_half_a_pixel(&mut turned, rows);
        assert_fails(case, &turned, &*accel, "half a pixel of shift");
    }
}

#[test]
fn mitsuba_agrees_and_faults_are_found() {
    let Some(manifest) = reference() else { return };
    let Some(case) = manifest.cases.iter().find(|c| c.name == "cornell") else {
        panic!("the reference has no scene `cornell`");
    };
    let case = &mitsuba_only(case);
    let scene = load_scene(case);
    let accel = scene.accel("grid").expect("built");
    assert_passes(case, &scene, &*accel);
    let mut bright = scene.clone();
    scale_albedo(&mut bright, 1.01);
    assert_fails(case, &bright, &*accel, "1 % more albedo");
    let mut turned = scene.clone();
    shift_half_a_pixel(&mut turned, case.mitsuba.as_ref().expect("it has one").height);
    assert_fails(case, &turned, &*accel, "half a pixel of shift");
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
    let report = validate::run(&manifest, &[], &accels, &options).expect("it runs");
    assert!(report.passed(), "{report}");
    assert_eq!((report.entries.len(), report.equal_pictures), (2, 2));
    let text = report.to_string();
    assert!(text.ends_with("4 of 4 comparisons passed; 2 of 2 pictures equal the first accelerator's to the bit"));
    assert_eq!(report.csv().lines().count(), 5);
    assert!(report.csv().lines().skip(1).all(|line| line.starts_with("small,") && line.contains(",true,24,16,")));
    let json = serde_json::to_value(&report).expect("serialised");
    assert_eq!(json["entries"][1]["verdict"]["tiers"][0]["renderer"], "povray");
    assert_eq!(json["entries"][0]["verdict"]["tiers"][0]["test"]["kind"], "deterministic");
    let html = report.html();
    assert!(html.contains("data:image/png;base64,") && html.contains("none &lt;&amp;&gt;"));
    assert!(!html.contains("http"), "the page needs the network");
    // Legend, and ours, theirs and difference of both comparisons; equal pictures of the second accelerator are not repeated.
    assert_eq!(html.matches("data:image/png").count(), 7);
    let out = folder("reports").join("pictures");
    assert_eq!(report.write_pictures(&out).expect("written"), 6);
    assert!(io::read(out.join("small-povray-brute-ours.exr")).is_ok());
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
