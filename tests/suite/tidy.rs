//! The tree keeps its own rules.

use std::fs;
use std::path::{Path, PathBuf};

/// Modules and what they may use of the others. Each uses only what stands above it: there is no cycle.
const MAY_USE: &[(&str, &[&str])] = &[
    ("error", &[]),
    ("ray", &[]),
    ("random", &[]),
    ("npy", &[]),
    ("parallel", &[]),
    // Shares nothing with what it judges.
    ("oracle", &["ray"]),
    ("picture", &["error"]),
    ("geometry", &["error", "ray"]),
    ("accel", &["geometry", "parallel", "ray"]),
    ("grid", &["accel", "error", "geometry", "parallel", "ray"]),
    ("bsp", &["accel", "error", "geometry", "ray"]),
    ("nested", &["accel", "error", "geometry", "grid", "parallel", "ray"]),
    ("auto", &["geometry", "ray"]),
    ("adapters", &["accel", "error", "geometry", "ray"]),
    // Only the registry names an adapter.
    ("registry", &["accel", "adapters", "auto", "bsp", "error", "geometry", "grid", "nested"]),
    ("scene", &["accel", "auto", "error", "geometry", "npy", "picture", "random", "ray", "registry"]),
    // The renderer knows no accelerator by name.
    ("render", &["accel", "error", "geometry", "picture", "ray", "scene"]),
    ("validate", &["accel", "error", "picture", "render", "scene"]),
    // Knows no accelerator and no command line.
    ("shards", &["error", "geometry", "picture", "render", "scene"]),
    ("measure", &["accel", "error", "npy", "random", "ray", "registry", "scene"]),
    ("converge", &["accel", "error", "measure", "picture", "registry", "render", "scene"]),
    ("stress", &["accel", "error", "geometry", "grid", "measure", "oracle", "random", "ray", "registry", "scene"]),
    (
        "papers",
        &[
            "accel", "bsp", "error", "geometry", "grid", "measure", "oracle", "random", "ray", "registry", "render",
            "scene", "stress",
        ],
    ),
    ("bench", &["error", "measure", "papers", "ray", "registry", "scene", "stress"]),
    (
        "cli",
        &[
            "accel", "auto", "bench", "converge", "error", "measure", "papers", "picture", "ray", "registry", "render",
            "scene", "shards", "stress", "validate",
        ],
    ),
];

/// Files above this many lines do more than one thing.
const MOST_LINES: usize = 420;

/// Where unsafe code may stand: calls into other languages.
const UNSAFE_ALLOWED: &[&str] =
    &["adapters/accel/embree.rs", "adapters/accel/embree", "adapters/embree-abi", "src/nested/simd.rs"];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Rust files below the folders, as paths relative to the package.
fn rust_files(folders: &[&str]) -> Vec<PathBuf> {
    files(folders, "rs")
}

/// Files with the extension below the folders, as paths relative to the package.
fn files(folders: &[&str], extension: &str) -> Vec<PathBuf> {
    let mut files = Vec::new();
    let mut open: Vec<PathBuf> = folders.iter().map(|f| root().join(f)).filter(|f| f.is_dir()).collect();
    while let Some(folder) = open.pop() {
        for entry in fs::read_dir(&folder).expect("a folder of the package is readable") {
            let path = entry.expect("a folder of the package is readable").path();
            if path.is_dir() && !path.ends_with("target") {
                open.push(path);
            } else if path.extension().is_some_and(|e| e == extension) {
                files.push(path.strip_prefix(root()).expect("below the package").to_path_buf());
            }
        }
    }
    files.sort();
    assert!(!files.is_empty(), "{folders:?} has no .{extension}");
    files
}

fn read(path: &Path) -> String {
    fs::read_to_string(root().join(path)).expect("a file of the package is readable")
}

/// The lines of code without comments.
fn code(text: &str) -> impl Iterator<Item = &str> {
    text.lines().map(|line| line.split("//").next().unwrap_or(""))
}

/// The module that a file of `src` or `adapters` belongs to.
fn module(path: &Path) -> String {
    if path.starts_with("adapters") {
        return "adapters".into();
    }
    let inner = path.strip_prefix("src").expect("a file of src");
    let first = inner.components().next().expect("a file has a name").as_os_str().to_string_lossy();
    first.trim_end_matches(".rs").to_string()
}

/// Modules that follow `crate::` in `line`.
fn used(line: &str) -> Vec<&str> {
    let ends = |c: char| !c.is_alphanumeric() && c != '_';
    line.split("crate::").skip(1).map(|rest| rest.split(ends).next().unwrap_or("")).collect()
}

#[test]
fn modules_use_only_what_they_may() {
    for (i, (name, allowed)) in MAY_USE.iter().enumerate() {
        let above: Vec<&str> = MAY_USE[..i].iter().map(|(name, _)| *name).collect();
        assert!(allowed.iter().all(|a| above.contains(a)), "{name} may use something below it");
    }
    let mut faults = Vec::new();
    let mut seen = 0;
    for path in rust_files(&["src", "adapters/accel"]) {
        let module = module(&path);
        if ["lib", "main"].contains(&module.as_str()) {
            continue;
        }
        let allowed = MAY_USE.iter().find(|(name, _)| *name == module).map(|(_, allowed)| *allowed);
        let allowed = allowed.unwrap_or_else(|| panic!("{}: the table lacks `{module}`", path.display()));
        let text = read(&path);
        // Tests at the foot of a file may use anything.
        let body = text.split("#[cfg(test)]\nmod tests").next().unwrap_or("");
        for (number, line) in code(body).enumerate() {
            for name in used(line) {
                seen += 1;
                // `crate::{a, b}` hides what is used; `crate::Result` and the like are re-exports.
                let fine = name == module || allowed.contains(&name) || name.starts_with(char::is_uppercase);
                if !fine {
                    faults.push(format!("{}:{}: `{module}` uses `{name}`", path.display(), number + 1));
                }
            }
        }
    }
    assert!(seen > 50, "the search finds next to nothing");
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn the_architecture_has_the_table_of_dependences() {
    let text = read(Path::new("ARCHITECTURE.md"));
    let rows = text.lines().filter_map(|line| {
        let cells: Vec<&str> = line.strip_prefix("| `")?.strip_suffix('|')?.split('|').map(str::trim).collect();
        let [name, _, uses] = cells[..] else { return None };
        Some((name.trim_end_matches('`').to_string(), uses.replace('`', "")))
    });
    let rows: Vec<(String, String)> = rows.collect();
    let table: Vec<(String, String)> = MAY_USE.iter().map(|(name, uses)| ((*name).into(), uses.join(" "))).collect();
    assert_eq!(rows, table, "ARCHITECTURE.md and MAY_USE differ");
}

#[test]
fn files_are_short_and_say_what_they_are_for() {
    for path in rust_files(&["src", "adapters", "tests", "examples", "benches"]) {
        let text = read(&path);
        let lines = text.lines().count();
        assert!(lines <= MOST_LINES, "{}: {lines} lines, at most {MOST_LINES}", path.display());
        assert!(text.starts_with("//! "), "{} does not start with `//! `", path.display());
    }
}

#[test]
fn nothing_is_left_undone() {
    let marks = ["todo!", "unimplemented!", "dbg!"].map(|mark| format!("{mark}{}", '('));
    for path in rust_files(&["src", "adapters", "tests", "examples"]) {
        let text = read(&path);
        for (number, line) in code(&text).enumerate() {
            for mark in &marks {
                assert!(!line.contains(mark.as_str()), "{}:{}: {mark}", path.display(), number + 1);
            }
        }
    }
}

#[test]
fn unsafe_code_stands_only_where_allowed() {
    for path in rust_files(&["src", "adapters", "tests", "examples"]) {
        if UNSAFE_ALLOWED.iter().any(|allowed| path.starts_with(allowed)) {
            continue;
        }
        let word = ["un", "safe"].concat();
        let text = read(&path);
        for (number, line) in code(&text).enumerate() {
            let mut words = line.split(|c: char| !c.is_alphanumeric() && c != '_');
            assert!(!words.any(|w| w == word), "{}:{}: {line}", path.display(), number + 1);
        }
    }
}

#[test]
fn files_that_may_be_unsafe_are_listed_with_reasons() {
    let list = read(Path::new("UNSAFE.md"));
    for allowed in UNSAFE_ALLOWED.iter().filter(|path| root().join(path).exists()) {
        assert!(list.contains(&format!("| `{allowed}")), "UNSAFE.md does not list {allowed}");
    }
}

#[test]
fn only_the_program_prints() {
    let marks = ["print!", "println!", "eprint!", "eprintln!"].map(|mark| format!("{mark}{}", '('));
    for path in rust_files(&["src", "adapters/accel"]) {
        if path.starts_with("src/cli") {
            continue;
        }
        let text = read(&path);
        for (number, line) in code(&text).enumerate() {
            let found = marks.iter().find(|mark| line.contains(mark.as_str()));
            assert_eq!(found, None, "{}:{}", path.display(), number + 1);
        }
    }
}

#[test]
fn the_commands_of_the_readme_are_run_before_every_release() {
    let (readme, script) = (read(Path::new("README.md")), read(Path::new(".ci/run")));
    let runs: Vec<&str> = script.lines().map(str::trim).collect();
    for command in ["cargo run --release -- validate", "cargo test"] {
        assert!(readme.lines().any(|line| line.trim() == command), "the README does not say `{command}`");
        assert!(runs.contains(&command), ".ci/run does not run `{command}`");
    }
}

/// Where the links of a text in Markdown lead; not those in code.
fn links(text: &str) -> Vec<String> {
    let (mut fenced, mut links) = (false, Vec::new());
    for line in text.lines() {
        if line.trim_start().starts_with("```") {
            fenced = !fenced;
        } else if !fenced {
            let prose: String = line.split('`').step_by(2).collect();
            let ends = prose.split("](").skip(1).filter_map(|rest| rest.split_once(')'));
            links.extend(ends.map(|(target, _)| target.to_string()));
        }
    }
    links
}

/// Links of a text at `path` that lead to no file.
fn broken(path: &Path, text: &str) -> Vec<String> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut targets = links(text);
    targets.retain(|target| !target.contains("://") && !target.starts_with('#'));
    targets.retain(|target| !root().join(folder).join(target.split('#').next().unwrap_or("")).exists());
    targets
}

#[test]
fn links_between_documents_lead_to_files() {
    let sample =
        "[a](README.md) `[b](no.md)`\n```\n[c](no.md)\n```\n[`d`](src/no.rs#e) ![f](docs/no.png) [g](https://h.org)";
    assert_eq!(broken(Path::new("x.md"), sample), ["src/no.rs#e", "docs/no.png"]);
    let mut documents = files(&["docs", "adapters", "reference"], "md");
    documents.extend(["README.md", "ARCHITECTURE.md", "CHANGELOG.md", "UNSAFE.md"].map(PathBuf::from));
    let (mut seen, mut faults) = (0, Vec::new());
    for path in documents {
        let text = read(&path);
        seen += links(&text).len();
        faults.extend(broken(&path, &text).iter().map(|target| format!("{}: {target}", path.display())));
    }
    assert!(seen > 100, "the search finds next to nothing: {seen}");
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// What stands in the first cells of the tables of a text, in backticks.
fn named(text: &str) -> Vec<&str> {
    text.lines().filter_map(|line| line.strip_prefix("| `")?.split_once("` |").map(|(name, _)| name)).collect()
}

#[test]
fn every_method_has_its_page() {
    let (readme, index) = (read(Path::new("README.md")), read(Path::new("docs/methods/README.md")));
    let section = readme.split("\n## ").find(|part| part.starts_with("The methods\n")).expect("a section of methods");
    let methods = named(section);
    assert!(methods.len() >= 16 && methods.contains(&"grid-dsz"), "{methods:?}");
    let page = |name: &str| read(&Path::new("docs/methods").join(name));
    for method in methods {
        let row = index.lines().find(|line| line.starts_with(&format!("| `{method}` | [")));
        let row = row.unwrap_or_else(|| panic!("the table of docs/methods/README.md lacks `{method}`"));
        let tells = links(row).iter().any(|target| page(target).contains(method));
        assert!(tells, "no page of {row} names `{method}`");
    }
    let pages = files(&["docs/methods"], "md");
    for path in pages.iter().filter(|path| !path.ends_with("README.md")) {
        let name = path.file_name().expect("a file has a name").to_string_lossy();
        assert!(links(&index).contains(&name.to_string()), "docs/methods/README.md does not lead to {name}");
    }
    // Those that came into the code without a row in the README.
    let all: String = pages.iter().map(|path| read(path)).collect();
    for path in rust_files(&["src/grid/skip"]).iter().filter(|path| read(path).contains("\nimpl Method for ")) {
        assert!(
            all.contains(&format!("({})", Path::new("../..").join(path).display())),
            "no page leads to {}",
            path.display()
        );
    }
}
