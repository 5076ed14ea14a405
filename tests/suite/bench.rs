//! `skipgrid bench`: its list of scenes, its forms, and what it refuses; never how fast anything is.

use crate::papers::elements;
use serde_json::Value;
use skipgrid::accel::{BruteForce, Counts, Memory};
use skipgrid::bench::{BenchScene, Class, KINDS, Options, Source, figures, run, select};
use skipgrid::measure::{RayKind, RayOptions, ray_sets};
use skipgrid::ray::Aabb;
use skipgrid::scene::{LoadOptions, SceneGeometry, load};
use skipgrid::stress::Contender;
use skipgrid::{Accel, Hit, Ray, registry};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

fn folder(test: &str) -> PathBuf {
    crate::folder("bench", test)
}

/// Exit code, standard output and standard error of the verb.
fn skipgrid(folder: &Path, args: &[&str]) -> (Option<i32>, String, String) {
    crate::ended(crate::program(folder).arg("bench").args(args).env_remove("SKIPGRID_SHARED"))
}

#[test]
fn the_scenes_are_as_stated_and_their_cameras_see_them() {
    let scenes = select(&[]).expect("the catalogue");
    assert_eq!(scenes.len(), 30);
    let mut files = 0;
    for scene in &scenes {
        let spec = match scene.source {
            Source::File(path) => match crate::shared(&format!("scenes/{path}")) {
                Some(path) => path.display().to_string(),
                None => continue,
            },
            _ => scene.spec(Path::new("nowhere")),
        };
        files += usize::from(matches!(scene.source, Source::File(_)));
        let mut loaded = load(&spec, &LoadOptions::default()).unwrap_or_else(|e| panic!("{}: {e}", scene.name));
        assert_eq!(loaded.primitive_count(), scene.primitives, "{}", scene.name);
        let spheres = matches!(loaded.geometry, SceneGeometry::Spheres(_));
        let of_spheres = scene.name == "giant-sphere" || scene.class.name().starts_with("sphere");
        assert_eq!(spheres, of_spheres, "{}", scene.name);
        assert!(spheres || matches!(loaded.geometry, SceneGeometry::Triangles(_)), "{}", scene.name);
        // The largest ones take long to build over where this is not optimised.
        if loaded.primitive_count() > 200_000 {
            continue;
        }
        if let Some(view) = &scene.view {
            loaded.camera = view.camera();
        }
        let accel = loaded.accel("grid").expect("a grid");
        let film = RayOptions { width: 16, height: 16, ..RayOptions::default() };
        let sets = ray_sets(&loaded, &*accel, &film).expect("rays");
        let counts: Vec<usize> = sets.iter().map(|set| set.rays.len()).collect();
        // At least an eighth of the picture is not background.
        assert!(counts[0] == 256 && counts[1] > 32 && counts[2] == counts[1], "{}: {counts:?}", scene.name);
    }
    assert!(files == 0 || files == 11, "{files} of the scenes that are files are there");
}

#[test]
fn names_classes_and_anything_that_loads_are_chosen_once() {
    let names = |given: &[&str]| -> Vec<String> {
        let given: Vec<String> = given.iter().map(|name| name.to_string()).collect();
        select(&given).expect("known names").into_iter().map(|scene| scene.name).collect()
    };
    assert_eq!(names(&["sticks-20k", "overlapping", "random:n=5"]), ["sticks-20k", "big-soup-20k", "random:n=5"]);
    assert_eq!(names(&["some/file.obj"]), ["some/file.obj"]);
    let named = |name: &str| select(&[name.to_string()]).expect("known")[0].named;
    assert!(named("dragon") && !named("triangles"));
}

/// The number of that name in a line of CSV.
fn field<'a>(header: &str, line: &'a str, name: &str) -> &'a str {
    let column = header.split(',').position(|h| h == name).unwrap_or_else(|| panic!("no column {name}: {header}"));
    line.split(',').nth(column).unwrap_or_else(|| panic!("no {name}: {line}"))
}

#[test]
fn text_csv_json_and_bars_say_the_same() {
    let folder = folder("forms");
    let mut args = vec!["random:n=60", "teapot:n=1", "--accel", "grid", "--accel", "brute", "--anchor", "brute"];
    args.extend(["--rays", "100", "--rounds", "2", "--spp", "1,16", "--csv", "a.csv", "--json", "a.json"]);
    args.extend(["--svg", "a.svg", "--subject", "grid"]);
    let peer = registry::ENTRIES.iter().any(|entry| entry.name == "obvhs-native-cwbvh");
    if peer {
        args.extend(["--accel", "obvhs-native-cwbvh"]);
    }
    let (code, text, notes) = skipgrid(&folder, &args);
    assert_eq!(code, Some(0), "{notes}");
    let read = |name: &str| fs::read_to_string(folder.join(name)).expect("written");
    let json: Value = serde_json::from_str(&read("a.json")).expect("JSON");
    assert_eq!((&json["identical"], &json["interrupted"]), (&Value::Bool(true), &Value::Bool(false)));
    let scenes = json["scenes"].as_array().expect("scenes");
    assert_eq!(scenes.iter().map(|s| s["primitives"].as_u64()).collect::<Vec<_>>(), [Some(60), Some(56)]);
    assert!(scenes.iter().all(|scene| scene["left_out"].as_array().is_some_and(|list| list.is_empty())));

    let csv = read("a.csv");
    let (header, lines) = csv.split_once('\n').expect("a header");
    let lines: Vec<&str> = lines.lines().collect();
    assert_eq!(lines.len(), 3 * if peer { 6 } else { 4 });
    for line in &lines {
        let get = |name| field(header, line, name);
        let number = |name| get(name).parse::<f64>().unwrap_or_else(|_| panic!("{name} of {line}"));
        let scene = scenes.iter().find(|s| s["scene"] == get("scene")).expect("the scene");
        let rows = scene["accelerators"].as_array().expect("rows");
        let row = rows.iter().find(|r| r["accelerator"] == get("accelerator")).expect("the accelerator");
        let rate = row["rates"].as_array().expect("rates").iter().find(|r| r["kind"] == get("kind")).expect("the kind");
        // Reading JSON rounds the last bit either way.
        let same =
            |json: &Value, column| (json.as_f64().expect("a number") - number(column)).abs() <= 1e-12 * number(column);
        assert!(same(&rate["rays_per_second"], "rays_per_second"), "{line}");
        assert!(same(&row["bytes_per_primitive"], "bytes_per_primitive"), "{line}");
        assert!(same(&rate["over"]["brute"], "over brute"), "{line}");
        if get("accelerator") == "brute" {
            assert_eq!(number("over brute"), 1.0);
            // Every primitive is asked, but by shadow rays, which may stop at the first hit.
            let all = scene["primitives"].as_f64().expect("a count");
            assert!(number("tests_per_ray") <= all && (get("kind") == "shadow" || number("tests_per_ray") == all));
        }
        if get("exact") == "true" {
            assert_eq!(get("differing"), "0");
        }
        // The image: build, then a camera ray and its share of shadow rays for each sample of 512 x 512 pixels.
        let of = |kind: &str| {
            let same = |l: &&&str| {
                ["scene", "accelerator"].iter().all(|c| field(header, l, c) == get(c))
                    && field(header, l, "kind") == kind
            };
            let line = lines.iter().find(same).expect("every kind");
            ["rays", "rays_per_second"].map(|c| field(header, line, c).parse::<f64>().expect("a number"))
        };
        let ([eye, speed], [shadow, shadow_speed]) = (of("camera"), of("shadow"));
        for (spp, column) in [(1.0, "computed_image_s_1_spp"), (16.0, "computed_image_s_16_spp")] {
            let traced = spp * 262_144.0 * (1.0 / speed + shadow / eye / shadow_speed);
            let expected = number("build_cpu_ms") / 1e3 + traced;
            assert!((number(column) / expected - 1.0).abs() < 1e-9, "{column} of {line}");
        }
    }
    // A bar for each rate, a headline for each scene and for their mean; the background is a rectangle too.
    let svg = read("a.svg");
    let means = json["means"].as_array().expect("means").len();
    assert_eq!(elements(&svg)["rect"], 1 + lines.len() + 3 * means);
    for words in ["random:n=60, 60 primitives", "teapot:n=1, 56 primitives", "geometric mean of 2 scenes"] {
        assert!(svg.contains(words), "{words}");
    }
    for words in
        ["random:n=60 (other scenes), 60 primitives", "Geometric means of 2 scenes", "COMPUTED", "Figures of grid"]
    {
        assert!(text.contains(words), "{words}: {text}");
    }
    assert!(text.contains("identical hits"), "{text}");

    let few = ["random:n=9", "--accel", "brute", "--rays", "9", "--rounds", "1", "--kind", "primary", "--format"];
    let (_, csv, _) = skipgrid(&folder, &[&few[..], &["csv"]].concat());
    assert_eq!(csv.lines().count(), 2);
    assert!(csv.contains(",camera,9,"), "{csv}");
    let (_, json, _) = skipgrid(&folder, &[&few[..], &["json"]].concat());
    let json: Value = serde_json::from_str(&json).expect("JSON");
    // Without shadow rays there is no telling how long an image takes.
    assert_eq!(json["scenes"][0]["accelerators"][0]["images"][0]["seconds_computed"], Value::Null);
}

#[test]
fn the_list_shows_what_would_run() {
    let folder = folder("list");
    let (code, out, _) = skipgrid(&folder, &["--list", "--format", "json"]);
    assert_eq!(code, Some(0));
    let value: Value = serde_json::from_str(&out).expect("JSON");
    assert_eq!(value["scenes"].as_array().expect("scenes").len(), 30);
    let accels: Vec<&str> =
        value["accelerators"].as_array().expect("a list").iter().filter_map(|a| a.as_str()).collect();
    assert!(accels.contains(&"grid") && !accels.contains(&"brute"), "{accels:?}");
    let (_, text, _) = skipgrid(&folder, &["--list", "mixed-scale", "--accel", "grid"]);
    assert!(text.contains("teapot-stadium:n=12") && text.ends_with("accelerators: grid\n"), "{text}");
    let (_, csv, _) = skipgrid(&folder, &["--list", "mixed-scale", "--format", "csv"]);
    assert_eq!(csv.lines().count(), 3);
}

#[test]
fn what_is_unknown_or_missing_is_said_with_a_hint() {
    let folder = folder("refusals");
    for (args, code, words) in [
        (&["bunnny"][..], 2, "did you mean `bunny`?"),
        (&["sphere-cloud"], 2, "did you mean `sphere-clouds`?"),
        (&["random-1k", "--accel", "gird"], 2, "did you mean `grid`?"),
        (&["random-1k", "--accel", "grid:density=x"], 2, "density"),
        (&["random-1k", "--kind", "primitive"], 2, "camera"),
        (&["random-1k", "--rounds", "0"], 2, "--rounds"),
        (&["random-1k", "--csv", "nowhere/a.csv"], 3, "nowhere"),
        (&["nowhere.obj", "--accel", "grid"], 3, "nowhere.obj"),
        (
            &["bunny", "--shared", "nowhere", "--accel", "grid"],
            2,
            "bunny is left out: no file nowhere/scenes/bunny.obj",
        ),
        (
            &["mixed-scale", "--max-primitives", "9", "--accel", "grid"],
            2,
            "at most 9 are measured unless the scene is named",
        ),
    ] {
        let (exit, out, error) = skipgrid(&folder, args);
        assert_eq!(exit, Some(code), "{args:?}: {error}");
        assert!(error.contains(words) && out.is_empty(), "{args:?}: {error}");
    }
}

/// Sees nothing.
struct Blind;

impl Accel for Blind {
    fn closest_hit(&self, _: &Ray) -> Option<Hit> {
        None
    }
    fn any_hit(&self, _: &Ray) -> bool {
        false
    }
    fn closest_hit_counted(&self, _: &Ray, counts: &mut Counts) -> Option<Hit> {
        counts.rays += 1;
        None
    }
    fn any_hit_counted(&self, _: &Ray, counts: &mut Counts) -> bool {
        counts.rays += 1;
        false
    }
    fn bounds(&self) -> Aabb {
        Aabb::EMPTY
    }
    fn memory(&self) -> Memory {
        Memory::default()
    }
}

fn teapot(class: Class) -> BenchScene {
    let source = Source::Made("teapot:n=1");
    BenchScene { name: "pot".into(), class, source, primitives: 56, view: None, named: true }
}

fn options() -> Options {
    Options {
        rounds: 1,
        rays: 144,
        seed: 0,
        spp: vec![1],
        kinds: Vec::new(),
        anchors: vec!["embree".into()],
        most_primitives: u32::MAX,
        shared: PathBuf::new(),
    }
}

/// Brute force over triangles, under any name.
fn stand_in(name: &str, exact: bool) -> Contender {
    Contender::new(name, exact, |geometry| match geometry {
        SceneGeometry::Triangles(triangles) => Ok(Box::new(BruteForce::new(triangles.clone()))),
        other => panic!("{other:?}"),
    })
}

#[test]
fn a_wrong_answer_fails_unless_none_was_promised() {
    for promised in [true, false] {
        let blind = Contender::new("blind", promised, |_| Ok(Box::new(Blind)));
        let both = [stand_in("brute", true), blind];
        let never = AtomicBool::new(false);
        let study = run(&[teapot(Class::Triangles)], &both, &options(), &|_, _| {}, &never).expect("a study");
        assert_eq!(study.identical(), !promised);
        let comparison = &study.scenes[0].comparison;
        let hits: u64 = comparison.kinds.iter().map(|kind| kind.hits).sum();
        assert!(hits > 0);
        assert_eq!(comparison.rows[1].deviations.missed, hits);
        let differing = KINDS.map(|kind| study.scenes[0].rate(1, kind).expect("a rate").differing);
        assert_eq!(differing.iter().sum::<u64>(), hits);
        assert_eq!(study.scenes[0].rate(0, RayKind::Camera).map(|rate| rate.differing), Some(0));
    }
}

#[test]
fn figures_are_judged_by_the_means_or_unknown() {
    let all = [stand_in("nested", true), stand_in("embree", true)];
    let never = AtomicBool::new(false);
    let study = run(&[teapot(Class::Triangles)], &all, &options(), &|_, _| {}, &never).expect("a study");
    assert!(figures(&study, "not measured").is_empty());
    let figures = figures(&study, "nested");
    let mean = study.means().into_iter().find(|mean| mean.accel == "nested").expect("a mean");
    let aim = figures.iter().find(|f| f.bar.contains("aim")).expect("the aim");
    assert_eq!(aim.met, Some(mean.ratios[0].iter().all(|ratio| *ratio >= 1.0)));
    assert_eq!(aim.numbers, mean.ratios[0].map(|ratio| format!("{ratio:.2}")).join(" / "));
    // No obvhs, no spheres.
    let unknown = figures.iter().filter(|f| f.bar.contains("obvhs-native") || f.bar.contains("spheres:"));
    assert!(unknown.clone().count() > 3 && unknown.clone().all(|f| f.met.is_none() && f.numbers.is_empty()));
    // Brute force holds nothing, so that it is far below any number of bytes; the logarithm of 0 is no number, though.
    assert!(figures.iter().any(|f| f.bar.starts_with("image at 64 spp, elsewhere") && f.met.is_some()));
}

#[test]
fn a_wish_to_stop_is_heard_between_scenes() {
    let (stop, contenders) = (AtomicBool::new(true), [stand_in("brute", true)]);
    let study = run(&[teapot(Class::Triangles)], &contenders, &options(), &|_, _| {}, &stop).expect("a study");
    assert!(study.interrupted && study.scenes.is_empty());
}
