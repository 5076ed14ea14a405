//! What is no readable file, and pictures with pixels that are not finite.

use super::{folder, shell, skipgrid, write};

/// A command line for each thing that is read, with `FILE` in its place.
const READERS: [(&str, &[&str]); 11] = [
    ("x.glb", &["info", "FILE"]),
    ("x.obj", &["info", "FILE"]),
    ("x.toml", &["info", "FILE"]),
    ("x.vox", &["info", "FILE"]),
    ("x.npy", &["info", "FILE"]),
    ("x.tri", &["info", "FILE"]),
    ("x.sph", &["info", "FILE"]),
    ("x.npy", &["trace", "cornell", "--rays", "FILE", "--hits", "hits.npy"]),
    ("x.rays", &["trace", "cornell", "--rays", "FILE", "--hits", "hits.npy"]),
    ("x.exr", &["diff", "FILE", "FILE"]),
    ("x.hdr", &["diff", "FILE", "FILE"]),
];

fn each(folder: &std::path::Path, words: &str, code: i32, make: &str) {
    for (name, args) in READERS {
        let args: Vec<&str> = args.iter().map(|a| if *a == "FILE" { name } else { a }).collect();
        let script = format!("rm -rf {name}; {make} {name} || exit 77; ulimit -v 3000000; exec \"$0\" \"$@\"");
        let run = shell(folder, &script, &args);
        assert_ne!(run.code, Some(77), "{make}: {}", run.stderr);
        run.refused(code, &[name, words]);
    }
}

#[test]
#[cfg(unix)]
fn folders_pipes_and_devices_are_no_files() {
    let folder = folder("kinds");
    each(&folder, "regular file", 2, "mkdir");
    // Nobody ever writes into it: to open it would be to wait for ever.
    each(&folder, "regular file", 2, "mkfifo");
    each(&folder, "regular file", 2, "ln -s /dev/zero");
    each(&folder, "regular file", 2, "ln -s /dev/null");
    each(&folder, "No such file", 3, "rm -f");
    each(&folder, "", 3, "ln -s nowhere");
    // A file of a terabyte without content, where the system has such.
    if shell(&folder, "truncate -s 1T hole && rm hole", &[]).code == Some(0) {
        each(&folder, "", 2, "truncate -s 1T");
    }
    for (place, args) in [
        ("m/manifest.toml", vec!["validate", "--reference", "m"]),
        ("t.png", vec!["info", "t.toml"]),
        ("a.mtl", vec!["info", "a.obj"]),
    ] {
        write(&folder, "t.toml", "[[texture]]\nname = \"t\"\nfile = \"t.png\"\n");
        write(&folder, "a.obj", "mtllib a.mtl\n");
        let run = shell(&folder, &format!("mkdir -p m; rm -f {place}; mkfifo {place}; exec \"$0\" \"$@\""), &args);
        assert!(run.stderr.contains("regular file") && run.stderr.contains(place), "{}", run.stderr);
    }
}

#[test]
#[cfg(unix)]
fn unreadable_and_empty_files_are_said_to_be_so() {
    let folder = folder("unreadable");
    // The superuser reads everything.
    if shell(&folder, "test \"$(id -u)\" -eq 0", &[]).code == Some(0) {
        eprintln!("skipped: the superuser can read files without permission");
    } else {
        each(&folder, "ermission", 3, "install -m 000 /dev/null");
    }
    for (name, args) in READERS.into_iter().filter(|(name, _)| !["x.obj", "x.toml"].contains(name)) {
        let args: Vec<&str> = args.iter().map(|a| if *a == "FILE" { name } else { a }).collect();
        write(&folder, name, "");
        skipgrid(&folder, &args).refused(2, &[name]);
    }
    // Nothing is a scene file and an OBJ file too.
    for name in ["x.obj", "x.toml"] {
        write(&folder, name, "");
        skipgrid(&folder, &["info", name]).done(&["no primitive"]);
    }
}

#[test]
#[cfg(target_os = "linux")]
fn names_that_are_not_utf8_are_files_or_explained() {
    let folder = folder("names");
    // A picture's or a ray file's name may be any bytes, a scene's is text.
    let name = "\"$(printf 'a\\377b')\"";
    let render = format!("exec \"$0\" render cornell --size 2x2 --spp 1 -o {name}.png");
    shell(&folder, &render, &[]).done(&[]);
    shell(&folder, &format!("exec \"$0\" diff {name}.png {name}.png"), &[]).done(&[]);
    let run = shell(&folder, &format!("exec \"$0\" info {name}.obj"), &[]);
    assert!(run.code == Some(2) && run.stderr.contains("UTF-8"), "{:?} {}", run.code, run.stderr);
    shell(&folder, &format!("exec \"$0\" trace cornell --rays {name}.npy --hits h.npy"), &[])
        .refused(3, &["a\u{fffd}b"]);
    // In a file: the line is named.
    write(&folder, "a.toml", b"\n[[mesh]]\nfile = \"\xff.obj\"\n");
    skipgrid(&folder, &["info", "a.toml"]).refused(2, &["a.toml: line 3: not UTF-8"]);
}

#[test]
fn pixels_that_are_not_finite_are_never_equal() {
    let folder = folder("pixels");
    let pfm = |values: [f32; 6]| {
        let numbers = values.iter().flat_map(|v| v.to_le_bytes());
        b"PF\n2 1\n-1.0\n".iter().copied().chain(numbers).collect::<Vec<u8>>()
    };
    write(&folder, "good.pfm", pfm([0.5; 6]));
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut values = [0.5; 6];
        values[4] = bad;
        write(&folder, "bad.pfm", pfm(values));
        for args in [["good.pfm", "bad.pfm"], ["bad.pfm", "good.pfm"], ["bad.pfm", "bad.pfm"]] {
            for metric in ["rmse", "flip", "max", "above1"] {
                let args =
                    [&["diff"], &args[..], &["--metric", metric, "--fail-above", "1e30", "-o", "map.png"]].concat();
                let run = skipgrid(&folder, &args);
                assert_eq!(run.code, Some(1), "{}", run.stderr);
                let nan = usize::from(bad.is_nan());
                let words = format!(
                    "bad.pfm has 1 pixels that are not finite ({nan} of them NaN), the first in column 1, row 0"
                );
                assert!(run.stderr.contains(&words), "{}", run.stderr);
                // Each picture in a row of its own: not finite, NaN, place of the first.
                let rows: Vec<Vec<&str>> = run.stdout.lines().map(|l| l.split_whitespace().collect()).collect();
                for (row, name) in rows[1..].iter().zip(&args[1..3]) {
                    let expected =
                        if *name == "bad.pfm" { ["1", &nan.to_string(), "1", "0"].join(" ") } else { "0 0".into() };
                    assert_eq!(row.join(" "), format!("{name} {expected}"));
                }
                assert!(rows.len() == 3 && !folder.join("map.png").exists());
            }
        }
    }
}
