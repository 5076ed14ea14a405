//! Error against run time: its estimates against closed forms and many seeds, never how long anything takes.

use crate::random::Random;
use serde_json::Value;
use skipgrid::accel::{Counts, Memory};
use skipgrid::converge::{
    Clock, Cost, Crossover, Errors, Options, Reference, Study, Truth, crossover, study, study_of,
};
use skipgrid::measure::Built;
use skipgrid::picture::{Picture, io};
use skipgrid::ray::Aabb;
use skipgrid::render::{Sampler, Settings, render};
use skipgrid::scene::{LoadOptions, Scene, load};
use skipgrid::{Accel, Hit, Ray};
use statrs::distribution::{ChiSquared, ContinuousCDF, StudentsT};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::atomic::AtomicBool;

fn folder(test: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("converge").join(test);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("the target folder is writable");
    folder
}

fn cornell() -> Scene {
    load("cornell", &LoadOptions::default()).expect("a scene by formula")
}

fn measure(scene: &Scene, accels: &[&str], options: &Options) -> Study {
    let specs: Vec<String> = accels.iter().map(|a| a.to_string()).collect();
    study(scene, &specs, options, Path::new("."), &|_, _| {}, &AtomicBool::new(false)).expect("a study")
}

/// The scene of all of these: 12 x 12 pixels.
fn small(samples: u32, replicates: u32, truth: u32) -> Options {
    Options { width: 12, height: 12, max_depth: 5, samples, replicates, truth: Truth::Own(truth), ..Options::default() }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn standard_error(values: &[f64]) -> f64 {
    let (n, centre) = (values.len() as f64, mean(values));
    (values.iter().map(|v| (v - centre).powi(2)).sum::<f64>() / (n - 1.0) / n).sqrt()
}

#[test]
fn the_error_falls_as_one_over_samples_and_leaves_no_bias() {
    let replicates = 8;
    let study = measure(&cornell(), &["grid"], &small(64, replicates, 4096));
    let curve = &study.curves[0];
    assert_eq!(curve.points.iter().map(|p| p.samples).collect::<Vec<_>>(), [2, 4, 8, 16, 32, 64]);
    // The slope of each replicate alone: independent of the others, as all seeds differ.
    let noise = study.reference.variance.expect("our own");
    let slopes: Vec<f64> = (0..replicates as usize)
        .map(|r| {
            let points =
                curve.points.iter().map(|p| (f64::from(p.samples).ln(), (p.trials[r].errors.mse - noise).ln()));
            let points: Vec<(f64, f64)> = points.collect();
            let [x, y] = [
                mean(&points.iter().map(|p| p.0).collect::<Vec<_>>()),
                mean(&points.iter().map(|p| p.1).collect::<Vec<_>>()),
            ];
            points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>()
                / points.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
        })
        .collect();
    // Fails a right program once in 1000: Student's quantile for seven degrees of freedom. Scrambled points fall at least as
    // fast as independent ones, and at most as n^-3, which smooth functions have (Owen 1997).
    let quantile = StudentsT::new(0.0, 1.0, f64::from(replicates - 1)).expect("7 > 0").inverse_cdf(0.9995);
    let (slope, bound) = (mean(&slopes), quantile * standard_error(&slopes));
    assert!(slope - bound < -1.0 && slope + bound > -3.0 && bound < 0.9, "{slope} +- {bound}");
    let fitted = curve.slope(&study.reference).expect("six points");
    assert!((fitted - slope).abs() < bound, "{fitted} is not {slope} +- {bound}");

    for point in &curve.points {
        let bias = point.bias(&study.reference);
        // Half of the 95 % interval, whose quantile is 2.365, made one of 99.9 %.
        assert!(bias.square <= quantile / 2.365 * bias.error, "{}: {bias:?}", point.samples);
        let interval = point.mse_interval().expect("eight pictures");
        assert!(interval.low < point.mse() && point.mse() < interval.high, "{interval:?}");
    }
}

#[test]
fn independent_samples_fall_exactly_as_one_over_their_number() {
    let (scene, count) = (cornell(), 512u64);
    let accel = scene.accel("grid").expect("a grid");
    let film = |samples, seed| {
        let settings = Settings {
            width: 12,
            height: 12,
            sampler: Sampler::Sobol(samples),
            max_depth: 5,
            seed,
            ..Settings::default()
        };
        render(&scene, &*accel, &settings, &|_, _| {}).expect("a picture")
    };
    // Its noise is a thousandth of what is told apart here.
    let reference = Reference::of(film(1 << 14, 1 << 20).picture(), None);
    let films: Vec<_> = (0..count).map(|seed| film(1, seed)).collect();
    let errors = |n: usize| -> Vec<f64> {
        let merged = films.chunks(n).map(|part| {
            let mut all = part[0].clone();
            part[1..].iter().for_each(|one| all.merge(one).expect("equal sizes"));
            Errors::of(&[all.picture()], &reference).expect("comparable").0.mse * n as f64
        });
        merged.collect()
    };
    let one = errors(1);
    for n in [4, 16] {
        let many = errors(n);
        // Pictures are independent: four standard errors, and those are small enough to tell 1/n from 1/sqrt n.
        let (difference, error) = (mean(&many) - mean(&one), standard_error(&many).hypot(standard_error(&one)));
        assert!(difference.abs() < 4.0 * error && error < 0.2 * mean(&one), "{n}: {difference} +- {error}");
    }
}

/// Numbers with the standard normal distribution (Box & Muller 1958).
fn normal(random: &mut Random) -> f64 {
    let unit = |random: &mut Random| ((random.next() >> 11) as f64 + 0.5) / (1u64 << 53) as f64;
    (-2.0 * unit(random).ln()).sqrt() * (std::f64::consts::TAU * unit(random)).cos()
}

#[test]
fn the_variance_of_halves_is_right_for_normal_noise() {
    let (size, sigma) = (40u32, 0.25);
    let mut random = Random::new(11);
    let mut noisy = || {
        let pixels = (0..size * size).map(|_| [0; 3].map(|_| (1.0 + sigma * normal(&mut random)) as f32)).collect();
        Picture { width: size, height: size, pixels }
    };
    let flat = Picture { width: size, height: size, pixels: vec![[1.0; 3]; (size * size) as usize] };
    let (errors, _) = Errors::of(&[noisy(), noisy()], &Reference::of(flat, None)).expect("comparable");
    // Of the mean of two halves; n of its squares over it have a chi-squared distribution, for both estimates.
    let (n, variance) = (f64::from(3 * size * size), sigma * sigma / 2.0);
    let law = ChiSquared::new(n).expect("n > 0");
    let (low, high) = (law.inverse_cdf(0.0005) / n, law.inverse_cdf(0.9995) / n);
    for estimate in [errors.variance.expect("two halves"), errors.mse] {
        assert!((low..high).contains(&(estimate / variance)), "{estimate} is not {variance}");
    }
}

#[test]
fn the_variance_of_halves_agrees_with_that_over_many_seeds() {
    let (scene, count) = (cornell(), 48u64);
    let accel = scene.accel("grid").expect("a grid");
    let half = |seed| {
        let settings =
            Settings { width: 12, height: 12, sampler: Sampler::Sobol(2), max_depth: 5, seed, ..Settings::default() };
        render(&scene, &*accel, &settings, &|_, _| {}).expect("a picture").picture()
    };
    let halves: Vec<[Picture; 2]> = (0..count).map(|i| [half(2 * i), half(2 * i + 1)]).collect();
    let black = Reference::of(Picture::new(12, 12), None);
    let shots: Vec<(Errors, Picture)> = halves.iter().map(|h| Errors::of(h, &black).expect("comparable")).collect();
    let by_halves = mean(&shots.iter().map(|(e, _)| e.variance.expect("halves")).collect::<Vec<_>>());
    // For each pixel, mean of its channels: the variance over the pictures, less what the halves say. Both are unbiased, so
    // the mean of the differences over independent pixels is 0 within its standard error.
    let differences: Vec<f64> = (0..144)
        .map(|p| {
            let channel = |c: usize| {
                let values: Vec<f64> = shots.iter().map(|(_, picture)| f64::from(picture.pixels[p][c])).collect();
                let squares =
                    |h: &[Picture; 2]| (f64::from(h[0].pixels[p][c]) - f64::from(h[1].pixels[p][c])).powi(2) / 4.0;
                standard_error(&values).powi(2) * count as f64 - mean(&halves.iter().map(squares).collect::<Vec<_>>())
            };
            (0..3).map(channel).sum::<f64>() / 3.0
        })
        .collect();
    let (difference, error) = (mean(&differences), standard_error(&differences));
    assert!(difference.abs() < 4.0 * error && error < 0.2 * by_halves, "{difference} +- {error} of {by_halves}");
}

/// A quad that fills the view below a white sky: with two edges every pixel is albedo times the sky, whatever the samples.
fn lit_quad(folder: &Path) -> Scene {
    let file = folder.join("quad.toml");
    let text = "name = \"quad\"\nenvironment = [0.5, 0.5, 0.5]\n[camera]\norigin = [0.0, 5.0, 0.0]\ntarget = [0.0, 0.0, 0.0]\n\
                up = [0.0, 0.0, -1.0]\nyfov = 40.0\n[[material]]\nname = \"grey\"\ntype = \"lambert\"\nalbedo = [0.5, 0.5, 0.5]\n\
                [[quad]]\ncorner = [-9.0, 0.0, 9.0]\nu = [18.0, 0.0, 0.0]\nv = [0.0, 0.0, -18.0]\nmaterial = \"grey\"\n";
    fs::write(&file, text).expect("the target folder is writable");
    load(&file.display().to_string(), &LoadOptions::default()).expect("a scene")
}

#[test]
fn five_per_cent_more_albedo_in_the_reference_is_bias_of_the_right_size() {
    let folder = folder("albedo");
    let scene = lit_quad(&folder);
    let (width, height, replicates) = (8u32, 6u32, 6);
    for (albedo, file) in [(0.5f64, "same.exr"), (0.525, "more.exr")] {
        let truth = folder.join(file);
        let pixels = vec![[(0.5 * albedo) as f32; 3]; 48];
        io::write(&truth, &Picture { width, height, pixels }, &io::Attributes::default()).expect("written");
        let truth = Truth::File(truth);
        let options = Options { width, height, max_depth: 2, samples: 64, replicates, truth, ..Options::default() };
        let study = measure(&scene, &["brute"], &options);
        assert_eq!(study.reference.variance, None);
        let expected = (0.5 * (albedo - 0.5)).powi(2);
        let bias = study.curves[0].points[5].bias(&study.reference);
        // Student's quantiles for 1 in 1000 and 1 in 20 and five degrees of freedom are 6.87 and 2.57; and f32.
        assert!(
            (bias.square - expected).abs() <= 6.87 / 2.57 * bias.error + 1e-9,
            "{albedo}: {bias:?}, expected {expected}"
        );
        assert!(bias.error < 0.2 * (0.5f64 * 0.025).powi(2), "{bias:?}");
        assert!(bias.is_significant() || albedo == 0.5, "{bias:?}");
    }
}

#[test]
fn crossovers_have_their_closed_form() {
    let cost = |fixed, per_sample| Cost { fixed, per_sample };
    // 1 + 3 n = 7 + n at n = 3.
    let (quick, slow) = (cost(1.0, 3.0), cost(7.0, 1.0));
    assert_eq!(crossover(&quick, &slow), Crossover::At { samples: 3.0, beyond: 1 });
    assert_eq!(crossover(&slow, &quick), Crossover::At { samples: 3.0, beyond: 0 });
    assert_eq!(crossover(&cost(1.0, 1.0), &cost(2.0, 2.0)), Crossover::Never { faster: 0 });
    assert_eq!(crossover(&cost(2.0, 1.0), &cost(1.0, 1.0)), Crossover::Never { faster: 1 });
    // At half a sample: no picture has so few.
    assert_eq!(crossover(&cost(1.0, 2.0), &cost(1.5, 1.0)), Crossover::Never { faster: 1 });
    assert_eq!(crossover(&quick, &quick), Crossover::Equal);
}

/// Does not see one primitive.
struct Blind(Box<dyn Accel>, u32);

impl Accel for Blind {
    fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        self.0.closest_hit(ray).filter(|hit| hit.prim != self.1)
    }
    fn any_hit(&self, ray: &Ray) -> bool {
        self.0.any_hit(ray)
    }
    fn closest_hit_counted(&self, ray: &Ray, counts: &mut Counts) -> Option<Hit> {
        self.0.closest_hit_counted(ray, counts).filter(|hit| hit.prim != self.1)
    }
    fn any_hit_counted(&self, ray: &Ray, counts: &mut Counts) -> bool {
        self.0.any_hit_counted(ray, counts)
    }
    fn bounds(&self) -> Aabb {
        self.0.bounds()
    }
    fn memory(&self) -> Memory {
        self.0.memory()
    }
}

#[test]
fn pictures_of_exact_accelerators_are_equal_and_a_wrong_one_is_seen() {
    let scene = cornell();
    let study = measure(&scene, &["grid", "brute", "nested"], &small(4, 3, 8));
    assert!(study.identical());
    let errors =
        |i: usize| study.curves[i].points.iter().flat_map(|p| p.trials.iter().map(|t| t.errors)).collect::<Vec<_>>();
    assert!(errors(0) == errors(1) && errors(0) == errors(2) && errors(0).len() == 6);
    assert!(study.curves.iter().all(|c| c.clock == Clock::Processor && c.exact) && study.own() == (0..3));
    let (all, each) = study.crossover(0, 1).expect("two lines");
    assert!(each.len() == 3 && all != Crossover::Equal);

    let make = |exact: bool| {
        let wrong = || Ok(Box::new(Blind(scene.accel("grid")?, 0)) as Box<dyn Accel>);
        let right = Built::new("grid", true, || scene.accel("grid")).expect("a grid");
        [right, Built::new("blind", exact, wrong).expect("a grid")]
    };
    let options = small(4, 3, 8);
    let run = |built: &[Built]| {
        study_of(&scene, built, &options, Path::new("."), &|_, _| {}, &AtomicBool::new(false)).expect("a study")
    };
    let study = run(&make(true));
    // Two numbers of samples, three replicates, two halves.
    assert_eq!(study.differences.len(), 12);
    assert!(study.differences[0].to_string().contains("column"), "{}", study.differences[0]);
    assert!(run(&make(false)).identical(), "an accelerator that promises nothing may differ");
}

#[test]
fn a_wish_to_stop_is_heard() {
    let stop = AtomicBool::new(true);
    let study =
        study(&cornell(), &["grid".into()], &small(4, 3, 8), Path::new("."), &|_, _| {}, &stop).expect("a study");
    assert!(study.interrupted && study.curves[0].points.is_empty() && study.equal_time.is_empty());
}

#[test]
fn options_out_of_range_are_refused() {
    let scene = cornell();
    let refused = |options: Options| {
        let accels = ["grid".to_string()];
        let result = study(&scene, &accels, &options, Path::new("."), &|_, _| {}, &AtomicBool::new(false));
        result.expect_err("out of range").to_string()
    };
    let usual = || small(4, 3, 8);
    for (options, cause) in [
        (Options { samples: 0, ..usual() }, "0 samples"),
        (Options { replicates: 2, ..usual() }, "2 replicates"),
        (Options { truth: Truth::Own(7), ..usual() }, "7 samples"),
        (Options { equal_time: Some(f64::NAN), ..usual() }, "NaN seconds"),
        (Options { integrator: skipgrid::render::Integrator::Depth, ..usual() }, "depth"),
        (Options { width: 0, ..usual() }, "0"),
    ] {
        let said = refused(options);
        assert!(said.contains(cause), "{said:?} does not say {cause:?}");
    }
}

/// Exit code, standard output and standard error of the verb; `path` stands for the search path if given.
fn skipgrid(folder: &Path, args: &[&str], path: Option<&str>) -> (Option<i32>, String, String) {
    let mut program = Command::new(env!("CARGO_BIN_EXE_skipgrid"));
    program.arg("converge").args(args).current_dir(folder).stdin(Stdio::null());
    if let Some(path) = path {
        program.env("PATH", path);
    }
    let output = program.output().expect("the program starts");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("the program writes Unicode");
    let (stdout, stderr) = (text(output.stdout), text(output.stderr));
    assert!(!stderr.contains("panicked"), "{stderr}");
    (output.status.code(), stdout, stderr)
}

#[test]
fn bad_input_has_its_code_and_says_why() {
    let folder = folder("bad");
    let picture =
        |w: u32, h: u32, value: f32| Picture { width: w, height: h, pixels: vec![[value; 3]; (w * h) as usize] };
    io::write(folder.join("3x2.pfm"), &picture(3, 2, 0.5), &io::Attributes::default()).expect("written");
    io::write(folder.join("nan.pfm"), &picture(8, 8, f32::NAN), &io::Attributes::default()).expect("written");
    let cases: [(&[&str], i32, &str); 13] = [
        (
            &["cornell", "--size", "8x8", "--reference", "3x2.pfm"],
            2,
            "3x2.pfm: the reference is 3 x 2, the pictures are 8 x 8",
        ),
        (&["cornell", "--size", "8x8", "--reference", "nan.pfm"], 2, "nan.pfm"),
        (&["cornell", "--reference", "absent.exr"], 3, "absent.exr"),
        (&["cornell", "--reference", "self:0"], 2, "self:SPP"),
        (&["cornell", "--reference", "self:3"], 2, "even number"),
        (&["cornell", "--spp", "0"], 2, "0"),
        (&["cornell", "--spp", "1"], 2, "1"),
        (&["cornell", "--replicates", "2"], 2, "2"),
        (&["cornell", "--accel", "gird"], 2, "did you mean `grid`?"),
        (&["cornell", "--against", "blender"], 2, "blender"),
        (&["cornell", "--target", "0"], 2, "above 0"),
        (&["cornell", "--equal-time", "1"], 2, "--pictures"),
        (&["cornell", "--svg", "nowhere/a.svg"], 3, "nowhere"),
    ];
    for (args, code, cause) in cases {
        let (found, stdout, stderr) = skipgrid(&folder, args, None);
        assert_eq!((found, stdout.as_str()), (Some(code), ""), "{args:?}: {stderr}");
        assert!(stderr.contains(cause), "{args:?}: {stderr}");
    }
}

#[test]
fn text_csv_json_curves_and_pictures_say_the_same() {
    let folder = folder("forms");
    let mut args =
        vec!["cornell", "--size", "8x8", "--spp", "8", "--reference", "self:64", "--accel", "grid", "--accel", "brute"];
    args.extend(["--csv", "a.csv", "--json", "a.json", "--svg", "a.svg", "--target", "1e-9", "--target", "1e9"]);
    args.extend(["--equal-time", "0.5", "--pictures", "equal", "--against", "mitsuba,povray"]);
    // An empty search path: the other renderers are absent.
    let (code, text, notes) = skipgrid(&folder, &args, Some(""));
    assert_eq!(code, Some(0), "{notes}");
    assert!(notes.contains("mitsuba is left out: ") && notes.contains("povray is left out: "), "{notes}");
    assert!(text.contains("identical pictures") && text.contains("efficiency"), "{text}");
    let read = |name: &str| fs::read_to_string(folder.join(name)).expect("written");
    let json: Value = serde_json::from_str(&read("a.json")).expect("JSON");
    assert_eq!((&json["identical"], &json["interrupted"]), (&Value::Bool(true), &Value::Bool(false)));
    let curves = json["curves"].as_array().expect("curves");
    assert_eq!(curves.iter().map(|c| c["renderer"].as_str()).collect::<Vec<_>>(), [Some("grid"), Some("brute")]);
    assert_eq!(json["crossovers"].as_array().map(Vec::len), Some(1));

    let csv = read("a.csv");
    let (header, lines) = csv.split_once('\n').expect("a header");
    assert_eq!(lines.lines().count(), 6);
    for line in lines.lines() {
        let get = |name: &str| {
            let column =
                header.split(',').position(|h| h == name).unwrap_or_else(|| panic!("no column {name}: {header}"));
            line.split(',').nth(column).unwrap_or_else(|| panic!("no {name}: {line}"))
        };
        let number = |name: &str| get(name).parse::<f64>().unwrap_or_else(|_| panic!("{name} of {line}"));
        let curve = curves.iter().find(|c| c["renderer"] == get("accelerator")).expect("the curve");
        let points = curve["points"].as_array().expect("points");
        let point = points.iter().find(|p| p["spp"].as_u64() == get("spp").parse().ok()).expect("the point");
        for (name, key) in [("mse", "mse"), ("seconds_total", "seconds"), ("variance", "variance"), ("bias2", "bias2")]
        {
            let value = point[key].as_f64().expect("a number");
            // Reading JSON rounds the last bit either way.
            assert!((value - number(name)).abs() <= 1e-12 * value.abs(), "{name}: {value} is not {line}");
        }
        let parts = number("seconds_build") + number("seconds_trace");
        assert!((parts - number("seconds_total")).abs() <= 1e-12 * parts, "{line}");
        assert!((number("efficiency") * number("mse") * number("seconds_total") - 1.0).abs() < 1e-9, "{line}");
        assert_eq!((get("scene"), get("clock"), get("replicates")), ("cornell", "processor", "3"));
    }
    let targets = curves[0]["targets"].as_array().expect("targets");
    assert_ne!(targets[0]["how"], "measured");
    assert_eq!((&targets[1]["how"], targets[1]["spp"].as_f64()), (&Value::from("measured"), Some(2.0)));

    let svg = read("a.svg");
    assert!(svg.contains("1 / seconds") && svg.contains("stroke-dasharray"), "{svg}");
    // For each of two curves a band and a line, and the guide; the marks of grid are circles, those of brute squares.
    let elements = crate::papers::elements(&svg);
    assert_eq!((elements["polygon"], elements["polyline"], elements["circle"]), (2, 3, 3 + 1), "{elements:?}");
    for name in ["reference", "1-grid", "2-brute"] {
        for extension in ["exr", "png"] {
            let picture = io::read(folder.join(format!("equal/{name}.{extension}"))).expect("a picture");
            assert_eq!((picture.width, picture.height), (8, 8));
        }
    }
    let shots = json["equal_time"].as_array().expect("equal time");
    assert!(shots.iter().all(|s| s["samples"].as_u64().is_some_and(|n| n >= 2 && n % 2 == 0)), "{shots:?}");
}

/// Whether a program runs here; says so if not.
fn runs(program: &str, args: &[&str]) -> bool {
    let there = Command::new(program).args(args).stdin(Stdio::null()).output().is_ok_and(|o| o.status.success());
    if !there {
        eprintln!("skipped: `{program}` does not run here");
    }
    there
}

#[test]
fn mitsuba_converges_to_our_picture() {
    if !runs("python3", &["-c", "import mitsuba, numpy"]) {
        return;
    }
    let folder = folder("mitsuba");
    let args =
        ["cornell", "--size", "16x16", "--spp", "16", "--accel", "grid", "--against", "mitsuba", "--format", "json"];
    let (code, stdout, stderr) = skipgrid(&folder, &args, None);
    assert_eq!(code, Some(0), "{stderr}");
    let json: Value = serde_json::from_str(&stdout).expect("JSON");
    let curve = &json["curves"][1];
    assert_eq!((&curve["renderer"], &curve["clock"]), (&Value::from("mitsuba"), &Value::from("wall")));
    let points = curve["points"].as_array().expect("points");
    assert_eq!(points.len(), 4);
    let of = |point: &Value, key: &str| point[key].as_f64().expect("a number");
    // Independent samples: an eighth, if nothing but noise is there; three replicates scatter by far less than a factor of two.
    let ratio = of(&points[0], "mse") / of(&points[3], "mse");
    assert!((4.0..16.0).contains(&ratio), "{ratio}");
    let (bias, error) = (of(&points[3], "bias2"), of(&points[3], "bias2_error"));
    // Student's quantiles for 1 in 100 and 1 in 20 and two degrees of freedom are 9.92 and 4.30.
    assert!(bias <= 9.92 / 4.30 * error, "{bias} +- {error}");
}

#[test]
fn povray_comes_near_our_whitted_picture() {
    if !runs("povray", &["--version"]) {
        return;
    }
    let folder = folder("povray");
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("reference/scenes/lanes.toml").display().to_string();
    let mut args = vec![scene.as_str(), "--size", "24x18", "--spp", "64", "--accel", "grid", "--against", "povray"];
    args.extend(["--integrator", "whitted", "--format", "json", "--reference", "self:1024"]);
    let (code, stdout, stderr) = skipgrid(&folder, &args, None);
    assert_eq!(code, Some(0), "{stderr}");
    let json: Value = serde_json::from_str(&stdout).expect("JSON");
    let points = json["curves"][1]["points"].as_array().expect("points");
    assert_eq!(points.iter().map(|p| p["spp"].as_u64()).collect::<Vec<_>>(), [Some(4), Some(16), Some(64)]);
    assert!(points.iter().all(|p| p["variance"].is_null() && p["replicates"].as_array().is_some_and(|r| r.len() == 1)));
    let mse = |i: usize| points[i]["mse"].as_f64().expect("a number");
    // The regular grid misses edges by at most half a cell: its error falls at least by four for each halving of the cells,
    // and no picture of another scene does that.
    assert!(mse(1) < mse(0) / 2.0 && mse(2) < mse(1) / 2.0, "{} {} {}", mse(0), mse(1), mse(2));
}
