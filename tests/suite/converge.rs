//! Error against run time: its estimates against closed forms and many seeds, never how long anything takes.

mod program;

use crate::random::Random;
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
use std::sync::atomic::AtomicBool;

fn folder(test: &str) -> PathBuf {
    crate::folder("converge", test)
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
