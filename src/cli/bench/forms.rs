//! A benchmark as text, CSV and JSON.

use crate::bench::{KINDS, Mean, SceneResult, Study, UNSUITED, figures};
use crate::cli::compare::{difference, identity};
use crate::cli::document::measured;
use crate::cli::table::{Table, exact, short};
use crate::measure::{Rate, RayKind};
use serde_json::{Value, json};

/// Tables for people: one for each scene, then the means of each class, then the figures of `subject`.
pub(super) fn text(study: &Study, subject: &str) -> String {
    let kinds: Vec<&str> = study.options.kinds.iter().map(|kind| kind.name()).collect();
    let mut out = format!(
        "skipgrid {}: benchmark\n{}\nat most {} rays of a kind, {} rounds, seed {}\n\n\
         Million rays a second of processor time, half the range of the rounds in %, speed over that of an anchor (x),\n\
         tests, steps and leaps a ray (- if not counted): each as {}. Build: nanoseconds of processor time a primitive\n\
         of all threads together; bytes a primitive beside the geometry. Images: milliseconds until 512 x 512 pixels of\n\
         camera and shadow rays are traced, with the build, COMPUTED from the rates. Rays that differ: see the end.\n",
        env!("CARGO_PKG_VERSION"),
        study.machine,
        study.options.rays,
        study.options.rounds,
        study.options.seed,
        kinds.join(" / ")
    );
    for (i, anchor) in study.options.anchors.iter().enumerate() {
        out += &format!("x{}: over {anchor}\n", i + 1);
    }
    for scene in &study.scenes {
        out += &format!("\n{} ({}), {} primitives;", scene.name, scene.class.title(), scene.comparison.primitives);
        for kind in &scene.comparison.kinds {
            let share = 100.0 * kind.hits as f64 / kind.rays.max(1) as f64;
            out += &format!(" {} {} rays ({share:.0} % hit),", kind.rays, kind.kind.name());
        }
        out.pop();
        out += &format!("\n\n{}", of_scene(study, scene).text());
        if !scene.comparison.identical() {
            out += &format!("\n{}", identity(&scene.comparison));
        }
    }
    out += &means(study);
    out += &refusals(study);
    out += &deviations(study);
    let figures = figures(study, subject);
    if !figures.is_empty() {
        out += &format!("\nFigures of {subject}\n\n");
    }
    for figure in figures {
        let word = match figure.met {
            Some(true) => "met    ",
            Some(false) => "MISSED ",
            None => "unknown",
        };
        let numbers = if figure.numbers.is_empty() { String::new() } else { format!(": {}", figure.numbers) };
        out += &format!("{word}  {}{numbers}\n", figure.bar);
    }
    out += if study.identical() {
        "\nidentical hits: on every scene all accelerators that promise exact answers agree to the bit\n"
    } else {
        "\nDIFFERENT HITS\n"
    };
    if study.interrupted {
        out += "interrupted: scenes are missing\n";
    }
    out
}

/// One value for each kind that was measured.
fn joined(study: &Study, value: impl Fn(RayKind) -> f64) -> String {
    study.options.kinds.iter().map(|kind| short(value(*kind))).collect::<Vec<_>>().join("/")
}

/// As [`joined`], for the three values of a mean.
fn of_mean(study: &Study, values: &[f64; 3]) -> String {
    let of = |kind| KINDS.iter().position(|k| *k == kind).map_or(f64::NAN, |k| values[k]);
    joined(study, of)
}

fn of_scene(study: &Study, scene: &SceneResult) -> Table {
    let mut columns = vec!["<accelerator".to_string(), "Mrays/s".into(), "+-%".into()];
    columns.extend((1..=study.options.anchors.len()).map(|i| format!("x{i}")));
    columns.extend(["build", "bytes", "tests", "steps", "leaps"].map(String::from));
    columns.extend(study.options.spp.iter().map(|spp| format!("{spp} spp")));
    let mut table = Table::new(&columns.iter().map(String::as_str).collect::<Vec<_>>());
    for (row, of) in scene.comparison.rows.iter().enumerate() {
        let of_kind =
            |value: &dyn Fn(&Rate) -> f64| joined(study, |kind| scene.rate(row, kind).map_or(f64::NAN, value));
        let mut cells = vec![of.accel.clone(), of_kind(&|rate| rate.rays_per_second / 1e6)];
        let percent = |kind| scene.rate(row, kind).map_or("-".into(), |rate| format!("{:.0}", 100.0 * rate.spread));
        cells.push(study.options.kinds.iter().map(|kind| percent(*kind)).collect::<Vec<String>>().join("/"));
        for anchor in &study.options.anchors {
            let there = scene.row(anchor).is_some();
            cells.push(if there { joined(study, |kind| scene.ratio(row, anchor, kind)) } else { "-".into() });
        }
        cells.extend([short(scene.build_ns(row)), short(scene.bytes(row))]);
        cells.extend([of_kind(&Rate::tests_per_ray), of_kind(&Rate::steps_per_ray), of_kind(&Rate::leaps_per_ray)]);
        cells.extend(study.options.spp.iter().map(|spp| short(1e3 * scene.image_seconds(row, *spp))));
        table.row(cells);
    }
    table
}

/// A table for each class that more than one scene was measured of.
fn means(study: &Study) -> String {
    let means = study.means();
    let mut out = String::new();
    for group in means.chunk_by(|a, b| a.class == b.class) {
        let class = group[0].class;
        let scenes = study.of_class(class).count();
        if scenes < 2 {
            continue;
        }
        let mut columns = vec!["<accelerator".to_string(), "scenes".into(), "Mrays/s".into()];
        columns.extend((1..=study.options.anchors.len()).map(|i| format!("x{i}")));
        columns.extend(["build".into(), "bytes".into()]);
        let mut table = Table::new(&columns.iter().map(String::as_str).collect::<Vec<_>>());
        for mean in group {
            let mut cells = vec![mean.accel.clone(), mean.scenes.to_string()];
            cells.push(of_mean(study, &mean.speed.map(|speed| speed / 1e6)));
            let known = |ratios: &[f64; 3]| ratios.iter().any(|r| r.is_finite());
            cells.extend(mean.ratios.iter().map(|r| if known(r) { of_mean(study, r) } else { "-".into() }));
            cells.extend([short(mean.build_ns), short(mean.bytes)]);
            table.row(cells);
        }
        out += &format!("\nGeometric means of {scenes} scenes: {}\n\n{}", class.title(), table.text());
    }
    out
}

/// What could not be built, but for what is not for such primitives.
fn refusals(study: &Study) -> String {
    let all = study.scenes.iter().flat_map(|s| s.refused.iter().map(move |(accel, cause)| (&s.name, accel, cause)));
    let lines: Vec<String> = all
        .filter(|(.., cause)| *cause != UNSUITED)
        .map(|(scene, accel, cause)| format!("{scene} without {accel}: {cause}\n"))
        .collect();
    if lines.is_empty() { String::new() } else { format!("\n{}", lines.concat()) }
}

/// On how many rays those differ that promise no exact answers.
fn deviations(study: &Study) -> String {
    let mut table =
        Table::new(&["<accelerator", "rays", "missed", "false", "other primitive", "other bits of t", "any hit"]);
    for accel in study.accels() {
        let rows = study.scenes.iter().filter_map(|s| Some((s, &s.comparison.rows[s.row(&accel)?])));
        let rows: Vec<_> = rows.filter(|(_, row)| !row.exact).collect();
        if rows.is_empty() {
            continue;
        }
        let sum = |of: &dyn Fn(&crate::measure::Deviations) -> u64| {
            rows.iter().map(|(_, row)| of(&row.deviations)).sum::<u64>().to_string()
        };
        let rays: u64 = rows.iter().map(|(scene, _)| scene.comparison.rays()).sum();
        let mut cells = vec![accel, rays.to_string(), sum(&|d| d.missed), sum(&|d| d.extra), sum(&|d| d.primitive)];
        cells.extend([sum(&|d| d.parameter), sum(&|d| d.other)]);
        table.row(cells);
    }
    let body = table.text();
    if body.lines().count() < 2 {
        return String::new();
    }
    format!("\nRays on which those that promise no exact answers differ from the exact ones, on all scenes\n\n{body}")
}

/// One line for each scene, kind of rays and accelerator.
pub(super) fn csv(study: &Study) -> String {
    let fixed = "<scene <class primitives <kind rays hits <accelerator exact rays_per_second spread tests_per_ray \
                 steps_per_ray leaps_per_ray differing build_ms build_cpu_ms build_ns_per_primitive bytes \
                 bytes_per_primitive";
    let mut columns: Vec<String> = fixed.split_whitespace().map(String::from).collect();
    columns.extend(study.options.spp.iter().map(|spp| format!("computed_image_s_{spp}_spp")));
    columns.extend(study.options.anchors.iter().map(|anchor| format!("over {anchor}")));
    let mut table = Table::new(&columns.iter().map(String::as_str).collect::<Vec<_>>());
    for scene in &study.scenes {
        let comparison = &scene.comparison;
        for kind in &comparison.kinds {
            for (row, of) in comparison.rows.iter().enumerate() {
                let rate = scene.rate(row, kind.kind);
                let number = |value: &dyn Fn(&Rate) -> f64| exact(rate.map_or(f64::NAN, value));
                let mut cells = vec![scene.name.clone(), scene.class.name().into(), comparison.primitives.to_string()];
                cells.extend([kind.kind.name().to_string(), kind.rays.to_string(), kind.hits.to_string()]);
                cells.extend([of.accel.clone(), of.exact.to_string()]);
                cells.extend([number(&|r| r.rays_per_second), number(&|r| r.spread)]);
                cells.extend([
                    number(&Rate::tests_per_ray),
                    number(&Rate::steps_per_ray),
                    number(&Rate::leaps_per_ray),
                ]);
                cells.push(rate.map_or(String::new(), |r| r.differing.to_string()));
                cells.extend([exact(of.build.milliseconds), exact(of.build.cpu_milliseconds)]);
                cells.extend([
                    exact(scene.build_ns(row)),
                    of.build.memory.total().to_string(),
                    exact(scene.bytes(row)),
                ]);
                cells.extend(study.options.spp.iter().map(|spp| exact(scene.image_seconds(row, *spp))));
                cells.extend(study.options.anchors.iter().map(|anchor| exact(scene.ratio(row, anchor, kind.kind))));
                table.row(cells);
            }
        }
    }
    table.csv()
}

/// Everything.
pub(super) fn json(study: &Study, subject: &str) -> Value {
    let pairs = |pairs: &[(String, String)], key: &str| -> Vec<Value> {
        pairs.iter().map(|(name, reason)| json!({ key: name, "reason": reason })).collect()
    };
    let scenes: Vec<Value> = study
        .scenes
        .iter()
        .map(|scene| {
            let comparison = &scene.comparison;
            let kinds: Vec<Value> = comparison
                .kinds
                .iter()
                .map(|k| json!({ "kind": k.kind.name(), "rays": k.rays, "hits": k.hits }))
                .collect();
            let rows: Vec<Value> = (0..comparison.rows.len()).map(|row| accelerator(study, scene, row)).collect();
            json!({
                "scene": scene.name,
                "class": scene.class.name(),
                "specification": scene.spec,
                "primitives": comparison.primitives,
                "rays": kinds,
                "accelerators": rows,
                "left_out": pairs(&scene.refused, "accelerator"),
                "identical": comparison.identical(),
                "differing": comparison.differing,
                "difference": comparison.difference.as_ref().map(difference),
            })
        })
        .collect();
    let figures: Vec<Value> = figures(study, subject)
        .iter()
        .map(|f| json!({ "figure": f.bar, "met": f.met, "numbers": f.numbers }))
        .collect();
    let body = json!({
        "rounds": study.options.rounds,
        "most_rays": study.options.rays,
        "seed": study.options.seed,
        "anchors": study.options.anchors,
        "scenes": scenes,
        "means": study.means().iter().map(|mean| mean_json(study, mean)).collect::<Vec<_>>(),
        "left_out": pairs(&study.left_out, "scene"),
        "subject": subject,
        "figures": figures,
        "identical": study.identical(),
        "interrupted": study.interrupted,
    });
    measured("skipgrid.bench/1", &study.machine, body)
}

fn accelerator(study: &Study, scene: &SceneResult, row: usize) -> Value {
    let of = &scene.comparison.rows[row];
    let rates: Vec<Value> = study
        .options
        .kinds
        .iter()
        .filter_map(|kind| {
            let rate = scene.rate(row, *kind)?;
            let over = study.options.anchors.iter().map(|a| (a.clone(), json!(scene.ratio(row, a, *kind))));
            Some(json!({
                "kind": kind.name(),
                "rays_per_second": rate.rays_per_second,
                "spread": rate.spread,
                "tests_per_ray": rate.tests_per_ray(),
                "steps_per_ray": rate.steps_per_ray(),
                "leaps_per_ray": rate.leaps_per_ray(),
                "differing": rate.differing,
                "over": over.collect::<serde_json::Map<_, _>>(),
            }))
        })
        .collect();
    let images: Vec<Value> = study
        .options
        .spp
        .iter()
        .map(|spp| json!({ "spp": spp, "seconds_computed": scene.image_seconds(row, *spp) }))
        .collect();
    let d = &of.deviations;
    json!({
        "accelerator": of.accel,
        "described": of.described,
        "exact": of.exact,
        "build_ms": of.build.milliseconds,
        "build_cpu_ms": of.build.cpu_milliseconds,
        "build_ns_per_primitive": scene.build_ns(row),
        "bytes": of.build.memory.total(),
        "bytes_per_primitive": scene.bytes(row),
        "rates": rates,
        "images": images,
        "deviations": {
            "missed": d.missed,
            "extra": d.extra,
            "primitive": d.primitive,
            "parameter": d.parameter,
            "other": d.other,
        },
    })
}

fn mean_json(study: &Study, mean: &Mean) -> Value {
    let by_kind = |values: &[f64; 3]| -> serde_json::Map<String, Value> {
        KINDS.iter().zip(values).map(|(kind, value)| (kind.name().to_string(), json!(value))).collect()
    };
    let over =
        study.options.anchors.iter().zip(&mean.ratios).map(|(anchor, ratios)| (anchor.clone(), json!(by_kind(ratios))));
    json!({
        "class": mean.class.name(),
        "accelerator": mean.accel,
        "scenes": mean.scenes,
        "rays_per_second": by_kind(&mean.speed),
        "over": over.collect::<serde_json::Map<_, _>>(),
        "build_ns_per_primitive": mean.build_ns,
        "bytes_per_primitive": mean.bytes,
    })
}
