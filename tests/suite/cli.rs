//! Verbs, exit codes, messages, files: the program as its user meets it.

use skipgrid::registry::{ENTRIES, Entry, Needs};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// What a run of the program gave.
struct Run {
    code: Option<i32>,
    stdout: String,
    stderr: String,
}

/// Runs the program in `folder`.
fn skipgrid(folder: &Path, args: &[&str]) -> Run {
    let output = Command::new(env!("CARGO_BIN_EXE_skipgrid"))
        .args(args)
        .current_dir(folder)
        .stdin(Stdio::null())
        .output()
        .expect("the program starts");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("the program writes Unicode");
    let run = Run { code: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) };
    assert!(!run.stderr.contains("panicked"), "{args:?}: {}", run.stderr);
    run
}

/// An empty folder of the test's own.
fn folder(test: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("cli").join(test);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("the target folder is writable");
    folder
}

/// Names of the files in `folder`, sorted.
fn files(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("the folder exists");
    let mut names: Vec<String> =
        entries.map(|e| e.expect("readable").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

fn json(run: &Run) -> serde_json::Value {
    serde_json::from_str(&run.stdout).unwrap_or_else(|e| panic!("{e}: {}", run.stdout))
}

/// Little-endian bytes after a magic and a count, as in `.tri` and `.rays` files.
fn raw(magic: &[u8; 4], count: u32, values: &[f32]) -> Vec<u8> {
    let numbers = values.iter().flat_map(|v| v.to_le_bytes());
    magic.iter().copied().chain(count.to_le_bytes()).chain(numbers).collect()
}

/// An .npy file, written here by NumPy's description of the format alone.
fn npy(descr: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let header = format!("{{'descr': {descr}, 'fortran_order': False, 'shape': {shape}, }}\n");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.bytes());
    bytes.extend(data);
    bytes
}

/// Two triangles: a right one at z = 0 over (0, 0), (1, 0), (0, 1), and the same at z = 2 with legs of 4.
const TRIANGLES: [f32; 18] = [0., 0., 0., 1., 0., 0., 0., 1., 0., /* second */ 0., 0., 2., 4., 0., 2., 0., 4., 2.];

/// A ray as in a file, and what it hits: parameter and primitive.
type RayAndHit = ([f32; 8], Option<(f32, u32)>);

/// Rays with answers by hand: t counts in the direction's length.
const RAYS: [RayAndHit; 8] = [
    ([0.25, 0.25, -5., 0., 0., 0., 1., f32::INFINITY], Some((5.0, 0))),
    ([0.25, 0.25, -5., 0., 0., 0., 2., f32::INFINITY], Some((2.5, 0))),
    ([0.75, 0.75, -5., 0., 0., 0., 1., f32::INFINITY], Some((7.0, 1))),
    ([0.25, 0.25, -5., 6., 0., 0., 1., f32::INFINITY], Some((7.0, 1))),
    ([0.25, 0.25, -5., 0., 0., 0., 1., 4.0], None),
    // Exactly through the legs of both: triangles are closed.
    ([0.5, 0.0, 5., 0., 0., 0., -1., f32::INFINITY], Some((3.0, 1))),
    ([9.0, 9.0, -5., 0., 0., 0., 1., f32::INFINITY], None),
    ([f32::NAN, 0.25, -5., 0., 0., 0., 1., f32::INFINITY], None),
];

fn ray_values() -> Vec<f32> {
    RAYS.iter().flat_map(|(ray, _)| *ray).collect()
}

fn ray_bytes() -> Vec<u8> {
    ray_values().iter().flat_map(|v| v.to_le_bytes()).collect()
}

/// The accelerators for every scene.
fn general() -> impl Iterator<Item = &'static Entry> {
    ENTRIES.iter().filter(|e| e.needs == Needs::Any)
}

#[test]
fn help_has_examples_for_every_verb() {
    let folder = folder("help");
    let top = skipgrid(&folder, &["--help"]);
    assert_eq!(top.code, Some(0));
    assert!(top.stdout.contains("Exit codes"), "{}", top.stdout);
    for verb in [
        "list",
        "info",
        "render",
        "compare",
        "converge",
        "sweep",
        "bench",
        "trace",
        "run-under",
        "validate",
        "export",
        "diff",
        "completions",
        "man",
    ] {
        let help = skipgrid(&folder, &[verb, "--help"]);
        assert_eq!(help.code, Some(0), "{verb}");
        assert!(help.stdout.contains(&format!("skipgrid {verb}")), "{verb}: {}", help.stdout);
        assert!(help.stdout.contains("Example"), "{verb}: {}", help.stdout);
        assert!(help.stderr.is_empty(), "{verb}: {}", help.stderr);
    }
    let version = skipgrid(&folder, &["--version"]);
    assert_eq!((version.code, version.stdout.trim()), (Some(0), concat!("skipgrid ", env!("CARGO_PKG_VERSION"))));
}

#[test]
fn shells_and_man_get_every_verb() {
    let folder = folder("man");
    let help = skipgrid(&folder, &["--help"]).stdout;
    let listed = help.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    let verbs: Vec<&str> = listed.filter_map(first_word).collect();
    assert!(verbs.contains(&"render") && verbs.contains(&"man"), "{help}");
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = skipgrid(&folder, &["completions", shell]);
        assert_eq!(script.code, Some(0), "{shell}: {}", script.stderr);
        for word in verbs.iter().chain(&["memory-budget"]) {
            assert!(script.stdout.contains(word), "{shell} lacks {word}");
        }
    }
    assert_eq!(skipgrid(&folder, &["man", "--to", "."]).code, Some(0));
    let mut expected: Vec<String> =
        verbs.iter().filter(|verb| **verb != "help").map(|verb| format!("skipgrid-{verb}.1")).collect();
    expected.push("skipgrid.1".into());
    expected.sort();
    assert_eq!(files(&folder), expected);
    for (args, page) in [(&["man"][..], "skipgrid.1"), (&["man", "render"], "skipgrid-render.1")] {
        let text = skipgrid(&folder, args).stdout;
        assert!(text.contains(".TH skipgrid") && text.contains("Examples:"), "{text}");
        assert_eq!(fs::read_to_string(folder.join(page)).expect("the page is there"), text, "{page}");
    }
}

/// The first word of a line of help that starts with two spaces; `None` for those that carry on with what is above.
fn first_word(line: &str) -> Option<&str> {
    line.strip_prefix("  ").filter(|rest| !rest.starts_with(' '))?.split_whitespace().next()
}

/// Bad usage and bad input: 2. Input and output: 3. One line that names the thing, nothing on standard output, and no
/// file left behind.
#[test]
fn failures_have_their_code_and_one_line() {
    let folder = folder("failures");
    for (name, content) in [
        ("good.tri", raw(b"TRI1", 2, &TRIANGLES)),
        ("short.tri", raw(b"TRI1", 3, &TRIANGLES)),
        ("bad.obj", b"v 0 0 0\nv 1 0 0\nf 1 2 9\n".to_vec()),
        ("bad.toml", b"name = 3\n".to_vec()),
        ("scene.xyz", b"what is this".to_vec()),
        ("rays.npy", npy("'<f4'", "(8, 8)", &ray_bytes())),
        ("short.npy", npy("'<f4'", "(9, 8)", &ray_bytes())),
        ("wide.npy", npy("'<f8'", "(4, 8)", &ray_bytes())),
        ("text.npy", b"1 2 3 4".to_vec()),
        ("old.png", b"an old picture".to_vec()),
        ("nan.pfm", pfm(1, 1, &[f32::NAN; 3])),
        ("wide.pfm", pfm(2, 1, &[0.5; 6])),
        ("one.pfm", pfm(1, 1, &[0.5; 3])),
    ] {
        fs::write(folder.join(name), content).expect("the target folder is writable");
    }
    fs::create_dir(folder.join("folder.png")).expect("the target folder is writable");
    let before = files(&folder);
    let trace = ["--hits", "hits.npy", "--accel", "brute"];
    let traced = |args: &[&'static str]| [args, &trace].concat();
    let cases: Vec<(i32, &str, Vec<&str>)> = vec![
        (3, "missing.glb", vec!["info", "missing.glb"]),
        (3, "missing.obj", vec!["render", "missing.obj", "-o", "new.png"]),
        (2, "scene.xyz", vec!["info", "scene.xyz"]),
        (2, "bad.obj", vec!["info", "bad.obj"]),
        (2, "bad.toml", vec!["info", "bad.toml"]),
        (2, "short.tri", vec!["info", "short.tri"]),
        (2, "nowhere", vec!["info", "nowhere"]),
        (2, "random:n=x", vec!["info", "random:n=x"]),
        (2, "did you mean `seed`?", vec!["info", "random:sed=3"]),
        (2, "`random` takes", vec!["info", "random:=3"]),
        (2, "gird", vec!["info", "cornell", "--accel", "gird"]),
        (2, "did you mean `density`?", vec!["info", "cornell", "--accel", "grid-dsz:dens=3"]),
        (2, "did you mean `render`?", vec!["man", "rendr"]),
        (3, "nowhere", vec!["man", "--to", "nowhere"]),
        (2, "density", vec!["info", "cornell", "--accel", "grid:density=-1"]),
        (2, "wants", vec!["info", "random:n=1000", "--accel", "grid", "--memory-budget", "1K"]),
        (2, "out.gif", vec!["render", "cornell", "-o", "out.gif"]),
        (3, "nowhere", vec!["render", "cornell", "-o", "nowhere/out.png"]),
        (2, "--spp 5", vec!["render", "cornell", "-o", "new.png", "--sampler", "regular", "--spp", "5"]),
        (2, "crop", vec!["render", "cornell", "-o", "old.png", "--size", "8x8", "--crop", "9,9,4,4"]),
        (2, "folder.png", vec!["render", "cornell", "-o", "folder.png", "--size", "4x4", "--spp", "1"]),
        (2, "short.npy", traced(&["trace", "good.tri", "--rays", "short.npy"])),
        (2, "wide.npy", traced(&["trace", "good.tri", "--rays", "wide.npy"])),
        (2, "text.npy", traced(&["trace", "good.tri", "--rays", "text.npy"])),
        (2, "bad.obj", traced(&["trace", "good.tri", "--rays", "bad.obj"])),
        (3, "gone.npy", traced(&["trace", "good.tri", "--rays", "gone.npy"])),
        (2, "short.tri", traced(&["trace", "short.tri", "--rays", "rays.npy"])),
        (3, "nowhere", vec!["trace", "good.tri", "--rays", "rays.npy", "--hits", "nowhere/hits.npy"]),
        (2, "gird", vec!["compare", "cornell", "--accel", "gird"]),
        (3, "gone.pfm", vec!["diff", "gone.pfm", "one.pfm"]),
        (2, "wide.pfm", vec!["diff", "wide.pfm", "one.pfm"]),
        (2, "old.png", vec!["diff", "old.png", "one.pfm"]),
        (3, "nowhere", vec!["export", "cornell", "--to", "povray", "-o", "nowhere/out.pov"]),
        (3, "nowhere", vec!["validate", "--reference", "nowhere"]),
    ];
    for (code, named, args) in cases {
        let run = skipgrid(&folder, &args);
        assert_eq!(run.code, Some(code), "{args:?}: {}", run.stderr);
        let errors: Vec<&str> = run.stderr.lines().filter(|l| l.starts_with("skipgrid: error: ")).collect();
        assert_eq!(errors.len(), 1, "{args:?}: {}", run.stderr);
        assert!(errors[0].contains(named), "{args:?}: {}", errors[0]);
        assert!(run.stdout.is_empty(), "{args:?}: {}", run.stdout);
        assert_eq!(files(&folder), before, "{args:?} left something behind");
    }
    assert_eq!(fs::read(folder.join("old.png")).expect("still there"), b"an old picture");
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

#[test]
fn bad_usage_is_explained() {
    let folder = folder("usage");
    for args in [
        &[][..],
        &["paint"],
        &["info"],
        &["list", "--format", "xml"],
        &["render", "cornell"],
        &["render", "cornell", "-o", "a.png", "--size", "0x4"],
        &["render", "cornell", "-o", "a.png", "--spp", "0"],
        &["render", "cornell", "-o", "a.png", "--crop", "1,2"],
        &["render", "cornell", "-o", "a.png", "--threads", "0"],
        &["compare", "cornell", "--rounds", "0"],
        &["info", "cornell", "--memory-budget", "much"],
        &["export", "cornell", "--to", "blender", "-o", "a"],
        &["diff", "a.png", "b.png", "--fail-above", "nan"],
    ] {
        let run = skipgrid(&folder, args);
        assert_eq!(run.code, Some(2), "{args:?}");
        assert!(run.stderr.contains("Usage") || run.stderr.contains("error:"), "{args:?}: {}", run.stderr);
        assert!(run.stdout.is_empty(), "{args:?}: {}", run.stdout);
    }
    assert!(files(&folder).is_empty());
}

#[test]
fn traced_hits_are_the_ones_by_hand_for_every_accelerator() {
    let folder = folder("trace");
    fs::write(folder.join("scene.tri"), raw(b"TRI1", 2, &TRIANGLES)).expect("writable");
    fs::write(folder.join("rays.npy"), npy("'<f4'", "(8, 8)", &ray_bytes())).expect("writable");
    fs::write(folder.join("in.rays"), raw(b"RAY1", 8, &ray_values())).expect("writable");
    let expected: Vec<u8> = RAYS
        .iter()
        .flat_map(|(_, hit)| {
            let (t, prim) = hit.unwrap_or((f32::INFINITY, u32::MAX));
            [t.to_le_bytes(), prim.to_le_bytes()].concat()
        })
        .collect();
    let flags: Vec<u8> = RAYS.iter().map(|(_, hit)| u8::from(hit.is_some())).collect();

    for entry in general() {
        for rays in ["rays.npy", "in.rays"] {
            let args = ["trace", "scene.tri", "--rays", rays, "--hits", "hits.npy", "--accel", entry.name];
            let run = skipgrid(&folder, &args);
            assert_eq!((run.code, run.stdout.as_str()), (Some(0), ""), "{}: {}", entry.name, run.stderr);
            let bytes = fs::read(folder.join("hits.npy")).expect("was written");
            let header = String::from_utf8_lossy(&bytes[10..bytes.len() - expected.len()]).into_owned();
            assert!(
                header.starts_with("{'descr': [('t', '<f4'), ('prim', '<u4')], 'fortran_order': False"),
                "{header}"
            );
            assert!(header.contains("'shape': (8,)"), "{header}");
            assert_eq!(bytes[bytes.len() - expected.len()..], expected, "{}", entry.name);

            assert_eq!(skipgrid(&folder, &[&args[..], &["--any"]].concat()).code, Some(0));
            let bytes = fs::read(folder.join("hits.npy")).expect("was written");
            assert_eq!(bytes[bytes.len() - flags.len()..], flags, "{}", entry.name);
        }
    }
    assert_eq!(files(&folder), ["hits.npy", "in.rays", "rays.npy", "scene.tri"]);
}

#[test]
fn rays_on_the_command_line_print_their_hits() {
    let folder = folder("trace-ray");
    fs::write(folder.join("scene.tri"), raw(b"TRI1", 2, &TRIANGLES)).expect("writable");
    let (mut args, mut expected) = (vec!["trace".to_string(), "scene.tri".into()], String::new());
    for (i, (ray, hit)) in RAYS.iter().enumerate() {
        // In a file the range stands in the middle; here it comes last.
        let order = [0, 1, 2, 4, 5, 6, 3, 7].map(|at| ray[at]);
        let text = order.map(|x| if i % 2 == 0 { x.to_string() } else { format!("{:#x}", x.to_bits()) }).join(" ");
        args.extend(["--ray".into(), text]);
        expected += &match hit {
            Some((t, prim)) => format!("t={t} bits={:#010x} prim={prim} any=true\n", t.to_bits()),
            None => "t=inf bits=0x7f800000 prim=none any=false\n".into(),
        };
    }
    // Six numbers: from 0 to inf; a minus sign at the start is no option.
    args.extend(["--ray".into(), "-0.25  0.25 -5   0.5 0 5".into()]);
    expected += "t=1 bits=0x3f800000 prim=0 any=true\n";
    args.extend(["--ray".into(), " 0.25 0.25 -5 0 0 0x3f800000 ".into()]);
    expected += "t=5 bits=0x40a00000 prim=0 any=true\n";
    for entry in general().filter(|entry| entry.exact) {
        let args: Vec<&str> = args.iter().map(String::as_str).chain(["--accel", entry.name]).collect();
        let run = skipgrid(&folder, &args);
        assert_eq!((run.code, run.stdout.as_str()), (Some(0), &*expected), "{}: {}", entry.name, run.stderr);
    }
    for (ray, words) in [
        ("0 0 0 1 0", "5 numbers, where 6 or 8 make a ray"),
        ("0 0 0 1 0 0 7", "7 numbers"),
        ("0 0 0 1 0 0 0 inf 3", "9 numbers"),
        ("", "0 numbers"),
        ("0 0 0 1 0 one", "`one` is neither a decimal number nor the bits of an f32 such as 0x3f800000"),
        ("0 0 0 1 0 0x1ffffffff", "`0x1ffffffff` is neither"),
        ("0 0 0 1 0 0x+1", "`0x+1` is neither"),
    ] {
        let run = skipgrid(&folder, &["trace", "scene.tri", "--ray", ray]);
        assert_eq!((run.code, run.stdout.as_str()), (Some(2), ""), "{ray}");
        assert!(run.stderr.contains(words), "{ray}: {}", run.stderr);
    }
    for args in [
        vec!["trace", "scene.tri"],
        vec!["trace", "scene.tri", "--ray", "0 0 0 1 0 0", "--hits", "hits.npy"],
        vec!["trace", "scene.tri", "--ray", "0 0 0 1 0 0", "--rays", "r.npy", "--hits", "hits.npy"],
        vec!["trace", "scene.tri", "--rays", "r.npy"],
        vec!["trace", "scene.tri", "--ray", "0 0 0 1 0 0", "--any"],
    ] {
        let run = skipgrid(&folder, &args);
        assert_eq!((run.code, run.stdout.as_str()), (Some(2), ""), "{args:?}: {}", run.stderr);
    }
    assert_eq!(files(&folder), ["scene.tri"]);
}

#[test]
fn compare_finds_identical_hits() {
    let folder = folder("compare");
    let args = ["compare", "random:n=200", "--size", "32x24", "--rounds", "2"];
    let run = skipgrid(&folder, &[&args[..], &["--accel", "brute", "--accel", "grid"]].concat());
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    assert!(run.stdout.contains("identical hits: brute, grid"), "{}", run.stdout);
    assert!(run.stderr.contains("framed"), "no camera in the scene: {}", run.stderr);

    // All accelerators, as JSON.
    let all: Vec<&str> = general().flat_map(|e| ["--accel", e.name]).collect();
    let run = skipgrid(&folder, &[&args[..], &all, &["--format", "json", "--quiet"]].concat());
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""));
    let value = json(&run);
    assert_eq!(value["identical"], true);
    assert_eq!(value["primitives"], 200);
    let kinds = value["rays"].as_array().expect("ray kinds");
    assert_eq!(
        kinds.iter().map(|k| k["kind"].as_str().unwrap_or("")).collect::<Vec<_>>(),
        ["camera", "shadow", "diffuse"]
    );
    assert_eq!(kinds[0]["rays"], 32 * 24);
    // A shadow and a diffuse ray start at each point that a camera ray hits.
    assert!(kinds[0]["hits"].as_u64() > Some(0));
    assert_eq!(kinds[1]["rays"], kinds[0]["hits"]);
    assert_eq!(kinds[2]["rays"], kinds[0]["hits"]);
    let rows = value["accelerators"].as_array().expect("accelerators");
    assert_eq!(rows.len(), general().count());
    for (row, entry) in rows.iter().zip(general()) {
        assert_eq!(row["accelerator"], entry.name);
        for rate in row["rates"].as_array().expect("rates") {
            assert!(rate["rays_per_second"].as_f64() > Some(0.0), "{rate}");
            assert_eq!(rate["ratio"].as_f64() == Some(1.0), entry.name == ENTRIES[0].name, "{rate}");
        }
    }
    // Brute force tests every primitive for every closest-hit ray.
    assert_eq!(rows[0]["accelerator"], "brute");
    assert_eq!(rows[0]["rates"][0]["tests"], 200 * 32 * 24);

    let run = skipgrid(&folder, &[&args[..], &["--format", "csv"]].concat());
    let widths: Vec<usize> = run.stdout.lines().map(|line| line.split(',').count()).collect();
    assert_eq!(widths.len(), 1 + 3 * 2, "a heading, three kinds of two accelerators: {}", run.stdout);
    assert!(widths.iter().all(|w| *w == widths[0]), "{}", run.stdout);
}

#[test]
fn compare_takes_rays_from_a_file() {
    let folder = folder("compare-rays");
    fs::write(folder.join("scene.tri"), raw(b"TRI1", 2, &TRIANGLES)).expect("writable");
    fs::write(folder.join("rays.npy"), npy("'<f4'", "(8, 8)", &ray_bytes())).expect("writable");
    let run = skipgrid(&folder, &["compare", "scene.tri", "--rays", "rays.npy", "--rounds", "1", "--format", "json"]);
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    let hits = RAYS.iter().filter(|(_, hit)| hit.is_some()).count();
    let value = json(&run);
    assert_eq!(value["rays"].as_array().map(Vec::len), Some(1));
    assert_eq!(value["rays"][0]["hits"], hits);
}

#[test]
fn list_names_what_the_registry_has() {
    let folder = folder("list");
    let value = json(&skipgrid(&folder, &["list", "--format", "json"]));
    let names: Vec<&str> =
        value["accelerators"].as_array().expect("a list").iter().filter_map(|e| e["name"].as_str()).collect();
    assert_eq!(names, ENTRIES.iter().map(|e| e.name).collect::<Vec<_>>());
    let scenes = value["scenes"].as_array().expect("a list");
    assert_eq!(scenes.len(), skipgrid::scene::procedural::ENTRIES.len());
    let text = skipgrid(&folder, &["list"]).stdout;
    for name in names.into_iter().chain(scenes.iter().filter_map(|s| s["name"].as_str())) {
        assert!(text.lines().any(|line| line.trim_start().starts_with(name)), "{name}: {text}");
    }
}

#[test]
fn info_counts_primitives_and_bytes() {
    let folder = folder("info");
    // 3 x 3 x 3 cubes of twelve triangles.
    let value = json(&skipgrid(&folder, &["info", "cubes:n=3", "--accel", "grid", "--format", "json"]));
    assert_eq!((&value["triangles"], &value["spheres"]), (&(27 * 12).into(), &0.into()));
    let bytes = ["structure_bytes", "reference_bytes", "skip_table_bytes"].map(|k| value[k].as_u64().expect(k));
    assert_eq!(value["bytes"].as_u64(), Some(bytes.iter().sum()));
    assert!(bytes[1] >= 4 * 27 * 12, "every triangle is in a cell: {value}");
    assert!(value["left_out"].to_string().contains("sphere test"), "{value}");
}

#[test]
fn quiet_leaves_data_only() {
    let folder = folder("quiet");
    let args = ["info", "random:n=5", "--accel", "brute"];
    assert!(skipgrid(&folder, &[&args[..], &["--quiet"]].concat()).stderr.is_empty());
    let args = ["compare", "random:n=5", "--accel", "brute", "--rounds", "1", "--size", "4x4"];
    assert!(!skipgrid(&folder, &args).stderr.is_empty(), "a framed camera is said");
    let run = skipgrid(&folder, &[&args[..], &["-q"]].concat());
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""));
    assert!(!run.stdout.is_empty());
}

#[test]
fn a_reader_that_leaves_is_no_error() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_skipgrid"))
        .arg("list")
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("the program ends");
    assert_eq!(output.status.code(), Some(0));
    assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
}

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

/// A colour PFM file, little endian.
fn pfm(width: u32, height: u32, values: &[f32]) -> Vec<u8> {
    let header = format!("PF\n{width} {height}\n-1.0\n");
    header.bytes().chain(values.iter().flat_map(|v| v.to_le_bytes())).collect()
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
