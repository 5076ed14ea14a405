//! What `auto` chooses gives the same answers, grows with the number of rays, and the program says what it left out.

use crate::random::Random;
use glam::Vec3;
use skipgrid::auto::{Kind, Look, choose};
use skipgrid::registry::{build, promises_exact};
use skipgrid::scene::{LoadOptions, Scene, load};
use skipgrid::{Accel, Ray, Triangle};

fn scene(spec: &str) -> Scene {
    load(spec, &LoadOptions::default()).expect("made by formula")
}

/// All that is chosen for numbers of rays from none to 10^12, each once.
fn chosen(scene: &Scene) -> Vec<String> {
    let rays = ["0", "1", "30", "1e3", "1e5", "1e7", "1e9", "1e12"];
    let choose = |rays: &str| scene.choose(&format!("auto:rays={rays}")).expect("a number").expect("it is auto").0;
    let mut specs: Vec<String> = rays.iter().map(|rays| choose(rays)).collect();
    specs.dedup();
    specs
}

#[test]
fn every_choice_gives_the_answers_of_brute_force() {
    let mut random = Random::new(77);
    for name in [
        "cornell",
        "random:n=300",
        "soup:n=3000",
        "teapot-patches",
        "flakes:depth=2",
        "voxel-terrain:n=16",
        "teapot-stadium:n=4",
    ] {
        let scene = scene(name);
        let brute = scene.accel("brute").expect("built");
        let (bounds, extent) = (brute.bounds(), brute.bounds().extent());
        let centre = (bounds.min + bounds.max) * 0.5;
        let specs = chosen(&scene);
        assert!(specs.len() > 1, "{name}: always {specs:?}");
        for spec in &specs {
            assert!(promises_exact(spec), "{spec}");
            let accel = scene.accel(spec).expect("built");
            for _ in 0..100 {
                let ray = Ray::new(centre + extent * random.in_cube(), extent * random.in_cube());
                let (found, expected) = (accel.closest_hit(&ray), brute.closest_hit(&ray));
                let bits = |hit: Option<skipgrid::Hit>| hit.map(|hit| (hit.prim, hit.t.to_bits()));
                assert_eq!(bits(found), bits(expected), "{name}, {spec}: {ray:?}");
                assert_eq!(accel.any_hit(&ray), expected.is_some(), "{name}, {spec}: {ray:?}");
            }
        }
    }
}

#[test]
fn what_is_chosen_can_be_built_and_says_why() {
    let mut random = Random::new(5);
    for (count, size) in [(0, 0.1), (1, 0.1), (7, 3.0), (300, 0.2), (20_000, 0.02)] {
        let mut near = |p: Vec3, size: f32| p + size * random.in_cube();
        let mut triangle = || {
            let p = near(Vec3::ZERO, 1.0);
            [p, near(p, size), near(p, size)]
        };
        let triangles: Vec<Triangle> = (0..count).map(|_| triangle()).collect();
        for rays in [0.0, 1.0, 1e3, 1e6, 1e12] {
            let choice = choose(&triangles, rays);
            assert!(build(choice.spec(), &triangles).is_ok(), "{choice:?}");
            assert!(choice.estimates.is_sorted_by(|a, b| a.total() <= b.total()), "{choice:?}");
            assert!(choice.reason().starts_with(choice.spec()));
            let others = choice.left_out().iter().filter(|s| s.contains("times as long")).count();
            assert_eq!(others + 1, choice.estimates.len(), "{choice:?}");
        }
    }
}

#[test]
fn kinds_of_primitives_are_told_apart() {
    assert_eq!(chosen(&scene("cornell"))[0], "brute");
    let patches = scene("teapot-patches").choose("auto").expect("no options").expect("auto").1;
    assert_eq!(patches.look.kind, Kind::Other);
    assert_eq!(Look::at(&Vec::<Triangle>::new()).kind, Kind::Simple);
    assert!(scene("cornell").choose("grid").expect("known").is_none());
    for bad in ["auto:rays=-1", "auto:rays=many", "auto:rays=nan", "auto:density=2"] {
        let error = scene("cornell").choose(bad).expect_err(bad).to_string();
        assert!(error.contains(bad), "{error}");
        assert!(scene("cornell").accel(bad).is_err());
    }
}

#[test]
fn the_program_says_what_was_chosen_and_left_out() {
    let folder = crate::folder("auto", "said");
    let run = |args: &[&str]| crate::ended(crate::program(&folder).args(args));
    let (code, out, _) = run(&["info", "random:n=50000", "--rays", "1e9", "--format", "json"]);
    let facts: serde_json::Value = serde_json::from_str(&out).expect("JSON");
    assert_eq!((code, &facts["accelerator"]), (Some(0), &"nested".into()), "{out}");
    assert!(
        facts["chosen"].as_str().is_some_and(|s| s.starts_with("nested for 50000 primitives and 1.00e9 rays")),
        "{out}"
    );
    let left_out = facts["left_out"].as_array().expect("a list");
    for part in ["triangle test: ", "brute: ", "nested:quality=fast: ", "mailbox: ", "texture look-up: "] {
        assert!(left_out.iter().any(|s| s.as_str().is_some_and(|s| s.starts_with(part))), "no {part} in {out}");
    }
    let (code, _, error) = run(&["render", "cornell", "--size", "2x2", "--spp", "1", "-o", "auto.png"]);
    assert_eq!(code, Some(0), "{error}");
    assert!(error.contains("brute for 36 primitives") && error.contains("left out: "), "{error}");
    let (code, _, error) = run(&["info", "cornell", "--rays", "-1"]);
    assert_eq!(code, Some(2), "{error}");
}
