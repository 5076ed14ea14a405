//! Pictures made, compared and exported.

use super::*;

#[test]
fn a_picture_does_not_depend_on_accelerator_and_threads() {
    let folder = folder("render");
    let render = |out: &str, more: &[&str]| {
        let args = ["render", "cornell", "--size", "16x12", "--spp", "4", "-o", out];
        let run = skipgrid(&folder, &[&args[..], more].concat());
        assert_eq!((run.code, run.stdout.as_str()), (Some(0), ""), "{}", run.stderr);
        assert!(run.stderr.contains("Mrays/s"), "{}", run.stderr);
        fs::read(folder.join(out)).expect("was written")
    };
    let first = render("a.pfm", &["--accel", "brute", "--threads", "1"]);
    assert_eq!(first.len(), b"PF\n16 12\n-1.0\n".len() + 16 * 12 * 12);
    for entry in general() {
        assert_eq!(render("b.pfm", &["--accel", entry.name]), first, "{}", entry.name);
    }
    assert_ne!(render("b.pfm", &["--seed", "1"]), first);
    // A crop is a part of the whole.
    let crop = render("c.pfm", &["--crop", "4,3,2,1"]);
    // Rows of PFM files go from the bottom: row 3 from the top is row 8 of 12.
    let start = first.len() - (3 + 1) * 16 * 12 + 4 * 12;
    assert_eq!(crop[crop.len() - 24..], first[start..start + 24]);

    // The settings travel with an EXR, and the same command writes the same bytes.
    let exr = render("a.exr", &["--accel", "grid"]);
    assert_eq!(render("b.exr", &["--accel", "grid"]), exr);
    let text = String::from_utf8_lossy(&exr).into_owned();
    for part in ["accelerator", "grid", "integrator", "path", "16x12", "cornell"] {
        assert!(text.contains(part), "{part}");
    }
    assert_eq!(&render("a.png", &[])[..4], b"\x89PNG");
    assert_eq!(files(&folder), ["a.exr", "a.pfm", "a.png", "b.exr", "b.pfm", "c.pfm"]);
}

#[test]
fn diff_measures_and_judges() {
    let folder = folder("diff");
    // One of six values differs, by 0.6: MSE = 0.36 / 6 = 0.06.
    fs::write(folder.join("a.pfm"), pfm(2, 1, &[0.5, 0.5, 0.5, 0.5, 0.5, 1.1])).expect("writable");
    fs::write(folder.join("b.pfm"), pfm(2, 1, &[0.5; 6])).expect("writable");
    let run = skipgrid(&folder, &["diff", "a.pfm", "b.pfm", "--format", "json"]);
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    let value = json(&run);
    for (metric, expected) in [("mse", 0.06), ("rmse", 0.06f64.sqrt()), ("mae", 0.1), ("max", 0.6), ("above1", 0.5)]
        .into_iter()
        .chain([("psnr", 10.0 * (1.0 / 0.06f64).log10()), ("differing", 0.5), ("mean-ratio", 3.6 / 3.0)])
    {
        let found = value[metric].as_f64().unwrap_or(f64::NAN);
        // The pictures are f32: 0.6 is known to 1e-7.
        assert!((found - expected).abs() < 1e-6, "{metric}: {found}, not {expected}");
    }
    for (bound, code) in [("0.0599", 1), ("0.0601", 0)] {
        let run = skipgrid(&folder, &["diff", "a.pfm", "b.pfm", "--metric", "mse", "--fail-above", bound]);
        assert_eq!(run.code, Some(code), "{bound}");
    }
    // 12.218 decibel, and worse is less.
    for (bound, code) in [("12.2", 0), ("12.3", 1)] {
        let run = skipgrid(&folder, &["diff", "a.pfm", "b.pfm", "--metric", "psnr", "--fail-below", bound]);
        assert_eq!(run.code, Some(code), "{bound}");
    }
    let run = skipgrid(&folder, &["diff", "a.pfm", "b.pfm", "--metric", "hdr-flip", "--exposure-map", "e.png"]);
    assert_eq!((run.code, run.stdout.lines().count()), (Some(0), 2), "{}", run.stderr);
    assert!(run.stderr.contains("hdr-flip over 2 exposures"), "{}", run.stderr);
    fs::remove_file(folder.join("e.png")).expect("a map of the exposures");
    let run = skipgrid(&folder, &["diff", "a.pfm", "a.pfm", "--fail-above", "0", "-o", "map.png"]);
    assert_eq!(run.code, Some(0), "equal pictures: {}", run.stdout);
    assert_eq!(files(&folder), ["a.pfm", "b.pfm", "map.png"]);
}

#[test]
fn exports_are_files_of_their_renderer() {
    let folder = folder("export");
    for (target, file, word) in [("povray", "a.pov", "camera"), ("mitsuba", "a.xml", "<scene")] {
        let run = skipgrid(&folder, &["export", "cornell", "--to", target, "-o", file, "--size", "40x30"]);
        assert_eq!((run.code, run.stdout.as_str()), (Some(0), ""), "{}", run.stderr);
        assert!(fs::read_to_string(folder.join(file)).expect("was written").contains(word), "{target}");
    }
}

/// As after `cargo install --path .`: the program lies elsewhere and runs elsewhere.
#[test]
fn an_installed_program_finds_the_references_and_its_scenes() {
    let place = std::env::temp_dir().join(format!("skipgrid-installed-{}", std::process::id()));
    fs::create_dir_all(&place).expect("there is a folder for what does not last");
    let program = place.join("skipgrid");
    // By another process: a program that this one, with the tests of other threads, has open for writing cannot be started.
    let copied = Command::new("cp").args([Path::new(env!("CARGO_BIN_EXE_skipgrid")), &program]).status();
    assert!(copied.is_ok_and(|status| status.success()), "the program can be copied");
    let run = |reference: &str, args: &[&str]| {
        let mut command = Command::new(&program);
        command.args(args).current_dir(&place).env("SKIPGRID_REFERENCE", reference).stdin(Stdio::null());
        let output = command.output().expect("the program starts");
        (output.status.code(), String::from_utf8(output.stderr).expect("the program writes Unicode"))
    };
    let ours = Path::new(env!("CARGO_MANIFEST_DIR")).join("reference");
    let found = [run("", &["validate", "none"]), run(&ours.to_string_lossy(), &["validate", "none"])];
    let other = run("nowhere", &["validate", "none"]);
    let rendered = run("nowhere", &["render", "cornell", "--size", "4x4", "--spp", "1", "-o", "cornell.png"]);
    let kept = files(&place);
    let _ = fs::remove_dir_all(&place);
    for (code, words) in found {
        assert_eq!(code, Some(2), "{words}");
        assert!(words.contains("no reference scene is called `none`, there are: "), "{words}");
    }
    assert_eq!(other.0, Some(3), "{}", other.1);
    assert!(other.1.contains("nowhere"), "{}", other.1);
    assert_eq!(rendered.0, Some(0), "{}", rendered.1);
    assert!(kept.contains(&"cornell.png".to_string()), "{kept:?}");
}
