//! Bad usage and bad input: codes and messages.

use super::*;

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
        (2, "folder.png: is a folder", vec!["info", "folder.png"]),
        (2, "--subject nosuch", vec!["bench", "random:n=5", "--accel", "grid", "--subject", "nosuch"]),
        (2, "did you mean `grid`?", vec!["bench", "random:n=5", "--accel", "grid", "--anchor", "gird"]),
        (2, "hits.txt", vec!["trace", "good.tri", "--rays", "rays.npy", "--hits", "hits.txt"]),
        (2, ".xml", vec!["export", "cornell", "--to", "mitsuba", "-o", "old.png"]),
        (2, "--layer albedo", vec!["diff", "one.pfm", "one.pfm", "--layer", "albedo"]),
        (2, "old.png", vec!["validate", "--scene", "cornell", "--theirs", "one.pfm", "--pictures", "old.png"]),
        (3, "nowhere", vec!["validate", "--scene", "cornell", "--theirs", "one.pfm", "--report", "nowhere/r.html"]),
        (2, "folder.png", vec!["converge", "cornell", "--json", "folder.png"]),
        (2, "no case `nosuch`", vec!["stress", "nosuch"]),
        (3, "nowhere", vec!["papers", "arvo", "-o", "nowhere/a.txt"]),
        (2, "has no file that ends in .shard.exr", vec!["merge", "folder.png", "-o", "new.png"]),
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

#[test]
fn bad_usage_is_explained() {
    let folder = folder("usage");
    for args in [
        // Numbers below 0 are values, and refused as such.
        &["render", "cornell", "-o", "a.png", "--spp", "-1"][..],
        &["info", "cornell", "--rays", "-5"],
        &["bench", "--rays", "-1"],
        &["converge", "cornell", "--target", "-1"],
        &["papers", "spd", "--density", "-1"],
    ] {
        let run = skipgrid(&folder, args);
        assert_eq!(run.code, Some(2), "{args:?}");
        let [.., option, value] = args else { unreachable!("they have values") };
        assert!(run.stderr.contains(&format!("invalid value '{value}' for '{option}")), "{args:?}: {}", run.stderr);
    }
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
