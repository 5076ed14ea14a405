//! What is listed, counted and compared.

use super::*;

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
