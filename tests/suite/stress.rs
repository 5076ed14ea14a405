//! The stress test: its cases have the difficulty they are named for, accelerators pass, and wrong ones do not.

use skipgrid::accel::{Counts, Memory};
use skipgrid::oracle::{Oracle, Primitive, Truth};
use skipgrid::ray::Aabb;
use skipgrid::scene::SceneGeometry;
use skipgrid::stress::cases::{Case, Selection, all, select};
use skipgrid::stress::{Contender, Options, Outcome, Row, Study, Tally, contenders, run};
use skipgrid::{Accel, Hit, Ray};
use std::panic;

/// The case of that name.
fn case(name: &str) -> &'static Case {
    select(&[name.to_string()]).expect("a case of the catalogue").cases[0]
}

/// A run of that case alone.
fn only(name: &str) -> Selection {
    select(&[name.to_string()]).expect("a case of the catalogue")
}

/// The primitives as the oracle has them.
fn primitives(geometry: &SceneGeometry) -> Vec<Primitive> {
    let sphere = |s: &skipgrid::Sphere| Primitive::Sphere { centre: s.centre, radius: s.radius };
    match geometry {
        SceneGeometry::Triangles(list) => list.iter().copied().map(Primitive::Triangle).collect(),
        SceneGeometry::Spheres(list) => list.iter().map(sphere).collect(),
        SceneGeometry::Mixed(both) => {
            both.triangles.iter().copied().map(Primitive::Triangle).chain(both.spheres.iter().map(sphere)).collect()
        }
        SceneGeometry::Voxels(voxels) => voxels.triangles().map(Primitive::Triangle).collect(),
        SceneGeometry::Patches(_) => panic!("no case has patches"),
    }
}

/// Shares of the first `rays` of a case that hit, and that hit several primitives at once; and the largest tie set.
fn shares(case: &Case, rays: u64) -> (f64, f64, usize) {
    let stage = case.stage();
    let oracle = Oracle::new(primitives(&stage.geometry));
    let rays = case.rays(rays);
    let truths: Vec<Truth> = (0..rays).filter_map(|i| oracle.closest(&stage.ray(i))).collect();
    let ties = truths.iter().filter(|truth| truth.prims.len() > 1).count();
    let most = truths.iter().map(|truth| truth.prims.len()).max().unwrap_or(0);
    (truths.len() as f64 / rays as f64, ties as f64 / rays as f64, most)
}

#[test]
fn rays_into_closed_surfaces_always_hit() {
    let closed: Vec<&Case> = all().filter(|case| case.must_hit).collect();
    assert!(closed.len() > 20);
    for case in closed {
        let (hit, ..) = shares(case, 400);
        assert_eq!(hit, 1.0, "{}", case.name);
    }
}

#[test]
fn cases_are_as_hard_as_their_names_say() {
    // At least this share of rays hits, this share hits several primitives at once, this many are hit at once.
    for (name, hits, ties, most) in [
        ("wt_sphere_vertex", 1.0, 0.002, 3),
        ("wt_offset_1e7", 1.0, 0.05, 4),
        ("wt_box_lattice", 1.0, 0.5, 4),
        ("wt_box_diag", 1.0, 0.9, 4),
        ("wt_fan_2000", 1.0, 0.004, 2000),
        ("wt_fan_apex", 1.0, 1.0, 2000),
        ("axis_lattice", 0.2, 0.05, 3),
        ("inplane_lattice", 0.2, 0.02, 3),
        ("diag_lattice", 0.3, 0.2, 5),
        ("border_hits", 0.3, 0.02, 3),
        ("duplicates", 0.5, 0.5, 8),
        ("coplanar_overlap", 0.2, 0.05, 3),
        ("degenerate_mix", 1.0, 0.002, 2),
        ("flat2d", 0.1, 0.01, 2),
        ("one_prim", 0.4, 0.0, 1),
        ("trange", 0.3, 0.0, 1),
        ("soup", 0.1, 0.0, 1),
        ("scene_1e-38", 0.1, 0.0, 1),
        ("dir_scale_1e-40", 0.1, 0.0, 1),
        ("identical_1e5", 0.5, 0.5, 100_000),
        ("identical_spheres_1e5", 0.5, 0.5, 100_000),
        ("one_point", 0.3, 0.2, 1000),
        ("one_point_spheres", 0.9, 0.5, 200),
        ("mixed_tangent_plane", 0.5, 0.2, 2),
        ("mixed_kissing", 0.5, 0.2, 2),
        ("mixed_edges", 0.5, 0.1, 2),
        ("instances_mirrored", 1.0, 0.0, 1),
        ("instances_sheared", 1.0, 0.0, 1),
        ("instances_tiny", 1.0, 0.001, 2),
        ("res_1xNx1", 0.2, 0.02, 3),
        ("solid_lattice", 0.5, 0.1, 3),
        ("solid_offset", 0.5, 0.01, 2),
        ("size_ratio_1e8", 0.5, 0.0, 1),
        ("needles_1e8", 0.3, 0.0, 1),
        ("sph_surface", 0.8, 0.0, 1),
        ("sph_inside", 0.9, 0.0, 1),
        ("sph_dir_1e20", 0.5, 0.0, 1),
        ("sph_r_1e-20", 0.8, 0.0, 1),
        ("teapot_stadium_1e8", 0.7, 0.0, 1),
    ] {
        let found = shares(case(name), 1500);
        println!("{name:24} {:.3} hit {:.3} tie, at most {}", found.0, found.1, found.2);
        assert!(found.0 >= hits && found.1 >= ties && found.2 >= most, "{name}: {found:?}, not {hits} {ties} {most}");
    }
    for name in ["ray_naninf", "empty"] {
        assert_eq!(shares(case(name), 400), (0.0, 0.0, 0), "{name}");
    }
    // Hits and misses lie close together where a case is about that border.
    for name in ["sph_tangent_2e-7", "sph_tangent_1e-5", "far_1e8", "far_1e6", "sph_small_1e6"] {
        let (hit, ..) = shares(case(name), 1500);
        assert!((0.02..=0.98).contains(&hit), "{name}: {hit}");
    }
}

/// A handful of accelerators: each walk and kind of structure.
fn few() -> Vec<Contender> {
    let specs = [
        "brute",
        "grid",
        "grid:step=branchless,mailbox=on",
        "grid:step=integer,density=30",
        "grid-dual:density=30,threshold=1",
        "bsp",
        "bsp:walk=climb",
        "voxels:skip=dsz,threshold=1",
        #[cfg(feature = "obvhs")]
        "obvhs-cwbvh",
    ];
    contenders(&specs.map(String::from)).expect("specifications are right")
}

#[test]
fn every_case_has_strict_zero() {
    let cases: Vec<&'static Case> = all().collect();
    let study = run(
        &Selection { cases: cases.clone(), walks: Vec::new() },
        &few(),
        &Options { rays: 150, rounds: 0 },
        &|_, _, _| {},
    );
    let failures: Vec<String> = study
        .failures()
        .map(|(result, row)| format!("{}: {}: {:?}", result.case.name, row.accel, row.outcome))
        .collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    assert!(study.passed());
    assert_eq!(study.results.len(), cases.len());
    for result in &study.results {
        assert!(!result.case.must_hit || result.hits == result.rays, "{}", result.case.name);
        let solid = matches!(result.case.stage().geometry, SceneGeometry::Voxels(_));
        assert_eq!(result.rows.iter().any(|row| row.accel.starts_with("voxels")), solid, "{}", result.case.name);
        assert!(result.rows.iter().all(|row| row.tally().is_some_and(|tally| tally.rays == result.rays)));
    }
}

/// What a wrong accelerator does to every hit whose bits call for it.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Lie {
    Miss,
    Invent,
    NextPrimitive,
    OtherOfTie,
    OneUlp,
    NotFinite,
    AnyHit,
    Counting,
    Panic,
    Endless,
}

struct Liar(Box<dyn Accel>, Lie);

impl Liar {
    /// One ray in about a hundred, by its bits alone.
    fn strikes(ray: &Ray) -> bool {
        let bits = ray
            .origin
            .to_array()
            .iter()
            .chain(&ray.direction.to_array())
            .fold(0u64, |all, x| (all ^ u64::from(x.to_bits())).wrapping_mul(0x9e37_79b9_7f4a_7c15));
        (bits >> 32) % 100 == 0
    }
}

impl Accel for Liar {
    fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        let hit = self.0.closest_hit(ray);
        if !Self::strikes(ray) {
            return hit;
        }
        match (self.1, hit) {
            (Lie::Miss, _) => None,
            (Lie::Invent, None) => Some(Hit { t: 1.0, prim: 0 }),
            (Lie::NextPrimitive, Some(hit)) => Some(Hit { prim: hit.prim + 1000, ..hit }),
            (Lie::OtherOfTie, Some(hit)) => Some(Hit { prim: hit.prim + 1, ..hit }),
            (Lie::OneUlp, Some(hit)) => Some(Hit { t: hit.t.next_up(), ..hit }),
            (Lie::NotFinite, Some(hit)) => Some(Hit { t: f32::NAN, ..hit }),
            (Lie::Panic, _) => panic!("as it was told"),
            (_, hit) => hit,
        }
    }

    fn any_hit(&self, ray: &Ray) -> bool {
        match self.1 {
            Lie::AnyHit if Self::strikes(ray) => !self.0.any_hit(ray),
            Lie::Miss | Lie::Invent => self.closest_hit(ray).is_some(),
            _ => self.0.any_hit(ray),
        }
    }

    fn closest_hit_counted(&self, ray: &Ray, counts: &mut Counts) -> Option<Hit> {
        self.0.closest_hit_counted(ray, counts);
        if self.1 == Lie::Endless && Self::strikes(ray) {
            counts.steps += 1 << 40;
        }
        let hit = self.closest_hit(ray);
        if self.1 == Lie::Counting && Self::strikes(ray) { None } else { hit }
    }

    fn any_hit_counted(&self, ray: &Ray, _: &mut Counts) -> bool {
        self.any_hit(ray)
    }

    fn bounds(&self) -> Aabb {
        self.0.bounds()
    }

    fn memory(&self) -> Memory {
        self.0.memory()
    }
}

/// What a run says about an accelerator with this lie beside an honest one; it calls itself exact.
fn caught(lie: Lie, name: &str) -> (Study, Tally) {
    let liar = Contender::new("liar", true, move |geometry| Ok(Box::new(Liar(geometry.accel("brute")?, lie))));
    let honest = Contender::of_spec("grid");
    let hook = panic::take_hook();
    panic::set_hook(Box::new(|_| {}));
    let study = run(&only(name), &[honest, liar], &Options { rays: 3000, rounds: 0 }, &|_, _, _| {});
    panic::set_hook(hook);
    let tally = study.results[0].rows[1].tally().expect("it can be built").clone();
    assert!(study.results[0].rows[0].tally().is_some_and(Tally::is_zero), "the honest one is not to blame");
    assert_eq!(study.failures().map(|(_, row)| row.accel.as_str()).collect::<Vec<_>>(), ["liar"], "{lie:?}");
    assert!(!study.passed(), "{lie:?}: {:?}", study.verdicts());
    assert!(!tally.faults.is_empty(), "{lie:?} leaves no trace");
    (study, tally)
}

#[test]
fn every_kind_of_lie_is_caught_in_its_column() {
    type Column = fn(&Tally) -> u64;
    let lies: [(Lie, &str, Column); 9] = [
        (Lie::Miss, "wt_sphere_rand", |t| t.missed),
        (Lie::Invent, "inplane_lattice", |t| t.false_hits),
        (Lie::NextPrimitive, "soup", |t| t.outside),
        (Lie::OneUlp, "wt_sphere_rand", |t| t.not_rounded),
        (Lie::NotFinite, "wt_sphere_rand", |t| t.not_finite),
        (Lie::AnyHit, "wt_sphere_rand", |t| t.any),
        (Lie::Counting, "wt_sphere_rand", |t| t.counted),
        (Lie::Panic, "wt_sphere_rand", |t| t.panics),
        (Lie::Endless, "wt_sphere_rand", |t| t.hangs),
    ];
    for (lie, name, column) in lies {
        let (_, tally) = caught(lie, name);
        // As many as there are rays that the lie strikes, neither more nor less.
        let stage = case(name).stage();
        let oracle = Oracle::new(primitives(&stage.geometry));
        let struck = (0..3000).map(|i| stage.ray(i)).filter(Liar::strikes).filter(|ray| match lie {
            Lie::Invent => oracle.closest(ray).is_none(),
            Lie::NextPrimitive => oracle.closest(ray).is_some(),
            _ => true,
        });
        let struck = struck.count() as u64;
        assert!(struck >= 5, "{lie:?} strikes {struck} rays only: the test is weak");
        assert_eq!(column(&tally), struck, "{lie:?}: {tally:?}");
    }
    // The next primitive of a tie is wrong, but not outside.
    let (_, tally) = caught(Lie::OtherOfTie, "identical_1e5");
    assert!(tally.wrong > tally.outside, "{tally:?}");
    // An error of one unit shows as such.
    let (_, tally) = caught(Lie::OneUlp, "wt_sphere_rand");
    assert!((0.5..=1.5).contains(&tally.t_error), "{tally:?}");
    assert_eq!((tally.strict(), tally.differing > 0), (0, true));
}

#[test]
fn builds_that_fail_are_told_apart() {
    let refuses = Contender::new("refuses", true, |geometry| geometry.accel("grid:resolution=4096,memory=1K"));
    let panics = Contender::new("panics", true, |_| panic!("as it was told"));
    let hook = panic::take_hook();
    panic::set_hook(Box::new(|_| {}));
    let study = run(&only("soup"), &[refuses, panics], &Options { rays: 20, rounds: 0 }, &|_, _, _| {});
    panic::set_hook(hook);
    let rows: &[Row] = &study.results[0].rows;
    assert!(matches!(&rows[0].outcome, Outcome::Refused(reason) if reason.contains("1024")), "{rows:?}");
    assert!(matches!(&rows[1].outcome, Outcome::Panicked(message) if message == "as it was told"), "{rows:?}");
    assert!(!study.passed());
    assert_eq!(study.failures().map(|(_, row)| row.accel.as_str()).collect::<Vec<_>>(), ["panics"]);
}

#[test]
fn accelerators_that_promise_nothing_do_not_decide() {
    let liar = Contender::new("liar", false, |geometry| Ok(Box::new(Liar(geometry.accel("brute")?, Lie::Miss))));
    let study = run(&only("wt_spiky"), &[liar], &Options { rays: 1000, rounds: 1 }, &|_, _, _| {});
    let row = &study.results[0].rows[0];
    assert!(row.tally().is_some_and(|tally| tally.missed > 0));
    assert!(row.times().is_some_and(|times| times.case > 0.0 && times.ordinary > 0.0));
    assert!(study.passed());
}

/// Runs `skipgrid stress` and gives exit code, standard output and standard error.
fn skipgrid(args: &[&str]) -> (Option<i32>, String, String) {
    crate::ended(crate::program(std::path::Path::new(".")).arg("stress").args(args))
}

#[test]
fn the_verb_prints_tables_and_writes_files() {
    let folder = crate::folder("stress", "forms");
    let file = |name: &str| folder.join(name).display().to_string();
    let (csv, json, html) = (file("s.csv"), file("s.json"), file("s.html"));
    let files = ["--csv", &csv, "--json", &json, "--html", &html];
    let few = ["wt_sphere_*", "sph_inside", "solid_lattice", "--rays", "200", "--accel", "grid", "--accel", "brute"];
    let (code, stdout, stderr) = skipgrid(&[&few[..], &files, &["--accel", "voxels"]].concat());
    assert_eq!(code, Some(0), "{stdout}{stderr}");
    assert!(stdout.contains("met     strict zero") && stdout.ends_with("passed\n"), "{stdout}");
    let read = |path: &str| std::fs::read_to_string(path).expect("the file was written");

    let table = read(&csv);
    let header = "family,case,accelerator,exact,outcome,rays,hits,ties,answers,missed,false,wrong,outside,not_finite,\
                  not_rounded,any,counted,differing,panics,hangs,untraced,most_steps,most_tests,t_error_ulp,\
                  ns_case,ns_ordinary,ratio";
    assert_eq!(table.lines().next(), Some(header));
    // Five cases with two accelerators each, and solid voxels with their own.
    assert_eq!(table.lines().count(), 1 + 5 * 2 + 1, "{table}");
    assert!(table.lines().skip(1).all(|line| line.split(',').count() == 27), "{table}");

    let value: serde_json::Value = serde_json::from_str(&read(&json)).expect("it is JSON");
    assert_eq!((&value["passed"], &value["rays"]), (&true.into(), &200.into()));
    let first = &value["cases"][0];
    assert_eq!((&first["case"], &first["hits"]), (&"wt_sphere_rand".into(), &200.into()));
    assert_eq!(first["accelerators"][1]["accelerator"], "brute");
    assert_eq!(first["accelerators"][1]["missed"], 0);

    let page = read(&html);
    assert!(page.starts_with("<!doctype html>") && page.contains("Stress test: passed") && page.ends_with("</html>\n"));
    assert!(!page.contains("http"), "the page needs the network");
}

#[test]
fn the_verb_fails_where_an_exact_accelerator_does_and_refuses_what_it_does_not_know() {
    let (code, _, stderr) = skipgrid(&["wt_sphere_rnd"]);
    assert_eq!(code, Some(2));
    assert!(stderr.contains("did you mean `wt_sphere_rand`?"), "{stderr}");
    let (code, _, stderr) = skipgrid(&["soup", "--accel", "gird"]);
    assert_eq!(code, Some(2));
    assert!(stderr.contains("did you mean `grid`?"), "{stderr}");
    assert_eq!(skipgrid(&["soup", "--rays", "0"]).0, Some(2));
    let (code, _, stderr) = skipgrid(&["soup", "--rays", "10", "--csv", "/nowhere/to/be/found.csv"]);
    assert_eq!(code, Some(3), "{stderr}");

    let (code, stdout, _) = skipgrid(&["--list"]);
    assert_eq!(code, Some(0));
    for name in ["wt_fan_2000", "sph_tangent_2e-7", "res_1xNx1", "instances_tiny", "identical_1e5", "mixed_kissing"] {
        assert!(stdout.contains(name), "{stdout}");
    }
    assert_eq!(stdout.lines().count(), 1 + all().count() + skipgrid::stress::walks::CASES.len());

    // A landing as printed in a paper is known to be wrong, but promises nothing.
    let (code, stdout, _) = skipgrid(&["soup", "--rays", "50", "--accel", "grid-dsz:landing=paper", "--rounds", "0"]);
    assert_eq!(code, Some(0), "{stdout}");
}
