//! FLIP and HDR-FLIP against the program of their authors.

use super::folder;
use skipgrid::picture::Picture;
use skipgrid::picture::flip::{self, hdr};
use std::fs;
use std::path::Path;
use std::process::Command;

/// Waves, a product of both coordinates, and a chequer; `shift` in columns.
fn waves(width: u32, height: u32, phase: f64, shift: f64, scale: f32) -> Picture {
    let mut picture = Picture::new(width, height);
    for (i, pixel) in picture.pixels.iter_mut().enumerate() {
        let (x, y) = ((i as u32 % width) as f64 + shift, (i as u32 / width) as f64);
        let chequer = ((x / 6.0).floor() + (y / 5.0).floor()).rem_euclid(2.0);
        let red = 0.5 + 0.5 * (0.21 * x + 0.13 * y + phase).sin();
        let green = 0.5 + 0.5 * (0.05 * x * y / 8.0 + 2.0 * phase).sin();
        *pixel = [red, green, 0.8 * chequer + 0.1].map(|v| v as f32 * scale);
    }
    picture
}

#[test]
fn flip_agrees_with_the_program_of_its_authors() {
    // Means by `flip_evaluator.evaluate(reference, test, "LDR", inputsRGB=False)`, flip-evaluator 1.7, of the arrays
    // that `waves` describes: width, height, phase and shift of reference and test, scale. Single pixels differed by
    // 9e-6 at most when this was written.
    let cases = [
        ((64, 48), (0.0, 0.0), (0.05, 0.0), 1.0, 0.189711437),
        ((64, 48), (0.0, 0.0), (0.0, 0.5), 1.0, 0.172815874),
        ((7, 5), (0.0, 0.0), (1.0, 2.0), 1.0, 0.800880790),
        ((40, 30), (0.0, 0.0), (0.3, 1.0), 0.01, 0.080762736),
        ((1, 1), (0.0, 0.0), (2.0, 0.0), 1.0, 0.952335894),
    ];
    for ((width, height), reference, test, scale, expected) in cases {
        let [reference, test] = [reference, test].map(|(phase, shift)| waves(width, height, phase, shift, scale));
        let mean = flip::compare(&test, &reference).expect("comparable").mean();
        assert!((mean - expected).abs() < 1e-5, "{width} x {height}: {mean}, theirs {expected}");
        assert_eq!(flip::compare(&test, &test).expect("comparable").mean(), 0.0);
    }
    let mut black = Picture::new(32, 32);
    let white = Picture { pixels: vec![[1.0; 3]; 32 * 32], ..black.clone() };
    let mean = flip::compare(&white, &black).expect("comparable").mean();
    // Theirs is f32: derivatives of a picture of one value are about 1e-7 there instead of 0, and their root is 3e-4.
    assert!((mean - 0.967395127).abs() < 2e-5, "{mean}");
    black.pixels[7] = [f32::NAN; 3];
    assert!(flip::compare(&white, &black).is_err());
}

/// Radiance over `stops` powers of two, and errors of some per cent that are not the same everywhere.
fn radiances(width: u32, height: u32, stops: f64) -> [Picture; 2] {
    let base = waves(width, height, 0.4, 0.0, 1.0);
    let picture = |error: f64| {
        let mut picture = base.clone();
        for (i, pixel) in picture.pixels.iter_mut().enumerate() {
            let (x, y) = (f64::from(i as u32 % width), f64::from(i as u32 / width));
            let level = stops * (0.5 + 0.5 * (0.11 * x).sin() * (0.17 * y + 0.3).cos());
            let factor = level.exp2() * (1.0 + error * (0.31 * x - 0.23 * y).sin());
            *pixel = pixel.map(|v| (f64::from(v) * factor) as f32);
        }
        picture
    };
    [picture(0.0), picture(0.1)]
}

/// Reads `N.reference`, `N.test` (f32, three a pixel) and writes `N.errors` and `N.json`.
const SCRIPT: &str = "
import json, sys
import numpy as np, flip_evaluator
for i, spec in enumerate(sys.argv[1:]):
    kind, height, width = spec.split(',')
    read = lambda name: np.fromfile(f'{i}.{name}', '<f4').reshape(int(height), int(width), 3)
    linear = dict(inputsRGB=False, applyMagma=False)
    errors, mean, used = flip_evaluator.evaluate(read('reference'), read('test'), kind, **linear)
    np.asarray(errors, '<f4').tofile(f'{i}.errors')
    used = {name: used[name] for name in ('startExposure', 'stopExposure', 'numExposures') if kind == 'HDR'}
    json.dump(dict(mean=float(np.mean(errors, dtype=np.float64)), **used), open(f'{i}.json', 'w'))
";

/// What a test writes for the script: f32 in little endian.
fn raw(path: &Path, picture: &Picture) {
    let bytes: Vec<u8> = picture.pixels.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
    fs::write(path, bytes).expect("the target folder is writable");
}

#[test]
fn flip_and_hdr_flip_agree_with_the_package_where_it_is_installed() {
    let asked = Command::new("python3").args(["-c", "import flip_evaluator, numpy"]).output();
    if !asked.is_ok_and(|o| o.status.success()) {
        eprintln!("skipped: the Python package flip-evaluator is not installed");
        return;
    }
    let folder = folder("flip");
    let mut dim = radiances(50, 31, 4.0);
    dim.iter_mut().flat_map(|p| &mut p.pixels).flatten().for_each(|v| *v *= 1e-4);
    // More than half of it black: the median is 0.
    let mut dark = radiances(40, 30, 6.0);
    dark.iter_mut().for_each(|p| p.pixels[..700].fill([0.0; 3]));
    let waves = [waves(64, 48, 0.0, 0.0, 1.0), waves(64, 48, 0.05, 0.3, 1.0)];
    let hdr = [radiances(64, 48, 1.0), radiances(61, 37, 9.0), radiances(8, 6, 16.0), dim, dark];
    let pairs: Vec<(&str, [Picture; 2])> = std::iter::once(("LDR", waves)).chain(hdr.map(|p| ("HDR", p))).collect();
    let mut arguments = Vec::new();
    for (i, (kind, [reference, test])) in pairs.iter().enumerate() {
        raw(&folder.join(format!("{i}.reference")), reference);
        raw(&folder.join(format!("{i}.test")), test);
        arguments.push(format!("{kind},{},{}", reference.height, reference.width));
    }
    let run = Command::new("python3").args(["-c", SCRIPT]).args(arguments).current_dir(&folder).output();
    let run = run.expect("python3 was there a moment ago");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));

    for (i, (kind, [reference, test])) in pairs.iter().enumerate() {
        let text = fs::read_to_string(folder.join(format!("{i}.json"))).expect("written by the script");
        let theirs: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        let bytes = fs::read(folder.join(format!("{i}.errors"))).expect("written by the script");
        let map = if *kind == "HDR" {
            let found = hdr::compare(test, reference, &|_, _| {}).expect("comparable");
            let hdr::Exposures { start, stop, count } = found.exposures;
            for (ours, name) in [(start, "startExposure"), (stop, "stopExposure"), (f64::from(count), "numExposures")] {
                let theirs = theirs[name].as_f64().expect("a number");
                // Theirs are f32 of about 10 after a logarithm.
                assert!((ours - theirs).abs() < 1e-5, "pair {i}: {name} is {ours}, theirs {theirs}");
            }
            assert!(found.worst.iter().all(|&i| i < count));
            found.map
        } else {
            flip::compare(test, reference).expect("comparable")
        };
        let (mean, expected) = (map.mean(), theirs["mean"].as_f64().expect("a number"));
        assert!((mean - expected).abs() < 1e-5, "pair {i}: {mean}, theirs {expected}");
        assert!(expected > 1e-3, "pair {i} shows no difference: nothing is tested");
        let errors = bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
        let largest = errors.zip(&map.errors).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        eprintln!("pair {i}, {kind}: mean {mean:.7}, theirs {expected:.7}; the worst pixel is {largest:.1e} off");
        // Theirs is computed in f32, ours in f64; the power of 0.7 of a small distance enlarges what f32 loses.
        assert!(largest < 1e-4, "pair {i}: {largest}");
    }
}
