//! `docs/json.md` against what the program writes: names and types of all fields of all documents, and the columns of CSV files.

use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// A line of a table: the path to a field, its types, and whether it may be missing.
struct Field {
    path: String,
    types: Vec<String>,
    optional: bool,
}

/// What the page says of a form.
#[derive(Default)]
struct Form {
    fields: Vec<Field>,
    columns: Vec<String>,
}

/// The forms of the page by name, each with the fields of every document and, if it says so, those of the machine.
fn forms() -> BTreeMap<String, Form> {
    let page = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/json.md")).expect("docs/json.md");
    let mut sections = page.split("\n## ");
    let head = fields(sections.next().expect("a head"));
    let mut forms = BTreeMap::new();
    for section in sections {
        let name = section.split('`').nth(1).expect("a name").to_string();
        let mut form = Form { fields: fields(section), columns: Vec::new() };
        for name in ["schema", "version"] {
            form.fields.push(Field { path: name.into(), types: vec!["string".into()], optional: false });
        }
        if section.contains("fields of the machine above") {
            form.fields.extend(head.iter().map(|f| Field { path: f.path.clone(), types: f.types.clone(), ..*f }));
        }
        let columns = section.lines().find_map(|line| line.strip_prefix("    ")).unwrap_or_default();
        form.columns = columns.split(',').map(String::from).collect();
        forms.insert(name, form);
    }
    assert_eq!(head.len(), 4, "the machine");
    forms
}

/// The lines of the tables in `text`.
fn fields(text: &str) -> Vec<Field> {
    let rows = text.lines().filter_map(|line| line.strip_prefix("| `"));
    let field = |row: &str| {
        let (path, rest) = row.split_once("` | ").expect("a path");
        let (types, what) = rest.split_once(" | ").expect("a type");
        assert!(what.len() > 4, "{path} is not described");
        let optional = types.ends_with(", optional");
        let types = types.trim_end_matches(", optional").replace(", ", " or ");
        Field { path: path.into(), types: types.split(" or ").map(String::from).collect(), optional }
    };
    rows.map(field).collect()
}

/// A step of a path: a field, every element, or every value.
fn steps(path: &str) -> Vec<&str> {
    let parts = path.split('.');
    parts.flat_map(|part| std::iter::once(part.trim_end_matches("[]")).chain(part.matches("[]"))).collect()
}

fn is_of(value: &Value, kind: &str) -> bool {
    match kind {
        "string" => value.is_string(),
        "integer" => value.is_u64() || value.is_i64(),
        "number" => value.is_number(),
        "boolean" => value.is_boolean(),
        "object" => value.is_object(),
        "array" => value.is_array(),
        "null" => value.is_null(),
        other => panic!("docs/json.md has a type `{other}`"),
    }
}

/// Every field that the form describes is in `value` with its type; counts where it was found.
fn has(value: &Value, steps: &[&str], field: &Field, found: &mut usize) -> Result<(), String> {
    let fault = |what: &str| Err(format!("{}: {what}: {value:.200}", field.path));
    match (steps, value) {
        ([], _) => {
            *found += 1;
            if field.types.iter().any(|kind| is_of(value, kind)) { Ok(()) } else { fault("is of another type") }
        }
        // A line of its own says where an object or an array may be null.
        (_, Value::Null) => Ok(()),
        (["[]", rest @ ..], Value::Array(values)) => values.iter().try_for_each(|v| has(v, rest, field, found)),
        (["*", rest @ ..], Value::Object(map)) => map.values().try_for_each(|v| has(v, rest, field, found)),
        ([name, rest @ ..], Value::Object(map)) => match map.get(*name) {
            Some(inner) => has(inner, rest, field, found),
            None if field.optional => Ok(()),
            None => fault("is missing"),
        },
        _ => fault("has no such field"),
    }
}

/// Paths of all leaves, objects and arrays of `value` that no field of the form describes or leads through.
fn unknown(value: &Value, at: &mut Vec<String>, paths: &[Vec<&str>], out: &mut Vec<String>) {
    let fits = |path: &&Vec<&str>| path.iter().zip(at.iter()).all(|(a, b)| *a == b || (*a == "*" && b != "[]"));
    let leads = |path: &&Vec<&str>| path.len() > at.len() && fits(path);
    let ends = |path: &&Vec<&str>| path.len() == at.len() && fits(path);
    let inner = paths.iter().any(|path| leads(&path));
    let known = match value {
        Value::Object(_) | Value::Array(_) => inner,
        _ => paths.iter().any(|path| ends(&path)),
    };
    if !known {
        out.push(at.join("."));
        return;
    }
    let mut step = |name: &str, value: &Value| {
        at.push(name.to_string());
        unknown(value, at, paths, out);
        at.pop();
    };
    match value {
        Value::Object(map) => map.iter().for_each(|(name, value)| step(name, value)),
        Value::Array(values) => values.iter().for_each(|value| step("[]", value)),
        _ => {}
    }
}

/// Holds `documents` against the form of their name.
fn check(schema: &str, documents: &[Value]) {
    let forms = forms();
    let form = forms.get(schema).unwrap_or_else(|| panic!("docs/json.md has no {schema}"));
    let paths: Vec<Vec<&str>> = form.fields.iter().map(|field| steps(&field.path)).collect();
    for document in documents {
        assert_eq!(document["schema"], schema);
        assert_eq!(document["version"], env!("CARGO_PKG_VERSION"));
        let mut faults = Vec::new();
        unknown(document, &mut Vec::new(), &paths, &mut faults);
        assert!(faults.is_empty(), "{schema}: not in docs/json.md: {faults:?}");
    }
    for (field, path) in form.fields.iter().zip(&paths) {
        let mut found = 0;
        for document in documents {
            has(document, path, field, &mut found).unwrap_or_else(|fault| panic!("{schema}: {fault}"));
        }
        // In an array that is empty here, or in an object that is null.
        let empty = |document: &Value| reaches_nothing(document, path);
        assert!(found > 0 || field.optional || documents.iter().all(empty), "{schema}: {} does not occur", field.path);
    }
}

/// True if the path ends early: at an empty array, an empty object or a null.
fn reaches_nothing(value: &Value, steps: &[&str]) -> bool {
    match (steps, value) {
        ([], _) => false,
        (_, Value::Null) => true,
        (["[]", rest @ ..], Value::Array(values)) => values.iter().all(|value| reaches_nothing(value, rest)),
        (["*", rest @ ..], Value::Object(map)) => map.values().all(|value| reaches_nothing(value, rest)),
        ([name, rest @ ..], Value::Object(map)) => map.get(*name).is_some_and(|value| reaches_nothing(value, rest)),
        _ => false,
    }
}

/// The header of a CSV file is what the page says; `instead` is what stands for columns that depend on the options.
fn check_columns(schema: &str, csv: &str, instead: &[(&str, &str)]) {
    let forms = forms();
    let told = &forms[schema].columns;
    let told: Vec<&str> =
        told.iter().map(|c| instead.iter().find(|(name, _)| name == c).map_or(c.as_str(), |(_, is)| is)).collect();
    assert_eq!(csv.lines().next().unwrap_or_default().split(',').collect::<Vec<_>>(), told, "{schema}");
}

fn folder(test: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("json").join(test);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("the target folder is writable");
    folder
}

/// Standard output of the program, which ends with `code`.
fn output(folder: &Path, code: i32, line: &str) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_skipgrid"));
    let output = command.args(line.split_whitespace()).arg("-q").current_dir(folder).stdin(Stdio::null()).output();
    let output = output.expect("the program starts");
    let notes = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{line}: {notes}");
    String::from_utf8(output.stdout).expect("Unicode")
}

/// The documents of some command lines.
fn documents(folder: &Path, lines: &[&str]) -> Vec<Value> {
    let parsed = |text: String| serde_json::from_str(&text).unwrap_or_else(|error| panic!("{error}: {text}"));
    lines.iter().map(|line| parsed(output(folder, 0, &format!("{line} --format json")))).collect()
}

/// A grey picture of 16 x 16 pixels.
fn grey(folder: &Path, name: &str, value: f32) {
    let pixels = value.to_le_bytes().repeat(16 * 16 * 3);
    fs::write(folder.join(name), [&b"PF\n16 16\n-1.0\n"[..], &pixels].concat()).expect("writable");
}

#[test]
fn what_there_is() {
    let folder = folder("list");
    check("skipgrid.list/1", &documents(&folder, &["list"]));
    check_columns("skipgrid.list/1", &output(&folder, 0, "list --format csv"), &[]);
    let scenes = ["cornell", "random:n=9 --accel grid-dsz", "voxel-terrain:n=8 --accel voxels", "teapot-patches"];
    check(
        "skipgrid.info/1",
        &documents(&folder, &scenes.map(|scene| format!("info {scene}")).each_ref().map(|s| &**s)),
    );
    check_columns("skipgrid.info/1", &output(&folder, 0, "info cornell --format csv"), &[]);
    check("skipgrid.bench-list/1", &documents(&folder, &["bench --list"]));
    check_columns("skipgrid.bench-list/1", &output(&folder, 0, "bench --list --format csv"), &[]);
    check("skipgrid.stress-list/1", &documents(&folder, &["stress --list"]));
    check_columns("skipgrid.stress-list/1", &output(&folder, 0, "stress --list --format csv"), &[]);
}

#[test]
fn comparisons() {
    let folder = folder("compare");
    let line = "compare random:n=50 --size 8x8 --rounds 1 --accel brute --accel grid --accel obvhs-native-bvh2";
    check("skipgrid.compare/1", &documents(&folder, &[line, "compare random:n=1 --size 1x1 --rounds 1 --accel brute"]));
    check_columns("skipgrid.compare/1", &output(&folder, 0, &format!("{line} --format csv")), &[]);
}

#[test]
fn benchmarks() {
    let folder = folder("bench");
    let line = "bench random:n=50 random:n=60 --accel brute --accel voxels --anchor brute --rays 64 --rounds 1 --spp 3";
    let of_nested = "bench random:n=50 --accel brute --accel nested --rays 64 --rounds 1";
    check("skipgrid.bench/1", &documents(&folder, &[line, of_nested]));
    let columns = [("computed_image_s_N_spp", "computed_image_s_3_spp"), ("over A", "over brute")];
    check_columns("skipgrid.bench/1", &output(&folder, 0, &format!("{line} --format csv")), &columns);
}

#[test]
fn sweeps() {
    let folder = folder("sweep");
    let line = "sweep random:n=50 --size 8x8 --rounds 1 --accel grid --densities 1,2";
    check("skipgrid.sweep/1", &documents(&folder, &[line]));
    check_columns("skipgrid.sweep/1", &output(&folder, 0, &format!("{line} --format csv")), &[]);
}

#[test]
fn convergence() {
    let folder = folder("converge");
    let line = "converge cornell --size 8x8 --spp 4 --accel brute --accel grid --target 1e-1 --target 1e-9";
    let equal = format!("{line} --equal-time 0.01 --pictures p");
    check("skipgrid.converge/1", &documents(&folder, &[line, &equal]));
    check_columns("skipgrid.converge/1", &output(&folder, 0, &format!("{line} --format csv")), &[]);
}

#[test]
fn hard_cases() {
    let folder = folder("stress");
    let line = "stress wt_sphere_rand vox_1x1x1 --rays 20 --accel brute --accel voxels --accel obvhs-native-bvh2";
    check("skipgrid.stress/1", &documents(&folder, &[line, &format!("{line} --rounds 0")]));
    check_columns("skipgrid.stress/1", &output(&folder, 0, &format!("{line} --rounds 0 --format csv")), &[]);
}

#[test]
fn tables_of_papers() {
    let folder = folder("papers");
    check("skipgrid.papers/1", &documents(&folder, &["papers dda --quick --size 8", "papers arvo --quick --size 8"]));
    check_columns("skipgrid.papers/1", &output(&folder, 0, "papers dda --quick --size 8 --format csv"), &[]);
}

#[test]
fn pictures_apart() {
    let folder = folder("diff");
    [("a.pfm", 0.5), ("b.pfm", 0.25), ("nan.pfm", f32::NAN)]
        .iter()
        .for_each(|(name, value)| grey(&folder, name, *value));
    let mut found = documents(&folder, &["diff a.pfm b.pfm", "diff a.pfm a.pfm", "diff a.pfm b.pfm --metric max"]);
    let bad = output(&folder, 1, "diff a.pfm nan.pfm --format json");
    found.push(serde_json::from_str(&bad).expect("JSON"));
    check("skipgrid.diff/1", &found);
    check_columns("skipgrid.diff/1", &output(&folder, 0, "diff a.pfm b.pfm --format csv"), &[]);
}

#[test]
fn validations() {
    let folder = folder("validate");
    let render = "render cornell --size 16x16 --spp 4 --accel grid --seed";
    for rest in ["100 -o a.pfm", "101 -o b.pfm"] {
        output(&folder, 0, &format!("{render} {rest}"));
    }
    output(&folder, 0, "render flakes --size 16x16 --integrator whitted --spp 1 -o f.pfm");
    let path =
        "validate --scene cornell --theirs a.pfm b.pfm --accel brute --accel grid --spp 4 --reseed 1 --report r.html";
    let whitted = "validate --scene flakes --theirs f.pfm --integrator whitted --spp 1 --accel grid";
    let mut found = documents(&folder, &[path, whitted]);
    let beside = fs::read_to_string(folder.join("r.json")).expect("beside the page");
    found.push(serde_json::from_str(&beside).expect("JSON"));
    check("skipgrid.validate/1", &found);
    check_columns("skipgrid.validate/1", &output(&folder, 0, &format!("{whitted} --format csv")), &[]);
}

/// The library's own test holds what it writes against this very line: see `adapters/embree-abi`.
#[test]
fn reports_of_run_under() {
    let forms = forms();
    let source = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("adapters/embree-abi/src/report.rs"));
    let source = source.expect("the library's report");
    let described =
        forms["skipgrid.run-under/1"].fields.iter().map(|f| f.path.as_str()).filter(|path| *path != "schema");
    for path in described {
        assert!(source.contains(&format!("\\\"{path}\\\":")), "{path} is not written");
    }
    let written = source.matches("\\\":").count();
    assert_eq!(written, forms["skipgrid.run-under/1"].fields.len() - 1, "fields of adapters/embree-abi/src/report.rs");
}
