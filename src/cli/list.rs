//! `skipgrid list`: what there is to choose from.

use super::Outcome;
use super::console::{Console, Format};
use super::document::document;
use super::table::Table;
use crate::error::Result;
use crate::registry::{ENTRIES, Entry, LEFT_OUT};
use crate::scene::procedural;
use serde_json::{Value, json};

/// List accelerators, scenes made by formula, and features compiled in or left out
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  skipgrid list\n  skipgrid list --format json")]
pub struct Args {
    /// Form of the list
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// Features of the package, whether this program has them, and what they bring.
const FEATURES: &[(&str, bool, &str)] = &[
    ("bvh", cfg!(feature = "bvh"), "the BVH of the crate bvh, a peer"),
    ("embree", cfg!(feature = "embree"), "opens Intel's Embree at run time, a peer"),
    ("gltf", cfg!(feature = "gltf"), "reads .gltf and .glb"),
    ("obj", cfg!(feature = "obj"), "reads .obj and .mtl"),
    ("obvhs", cfg!(feature = "obvhs"), "the BVHs of the obvhs crate"),
    ("parallel", cfg!(feature = "parallel"), "renders and builds on all cores"),
    ("parry", cfg!(feature = "parry"), "the triangle meshes of the crate parry3d, a peer"),
    ("vox", cfg!(feature = "vox"), "reads MagicaVoxel's .vox"),
    ("validate", cfg!(feature = "validate"), "compares pictures with other renderers' ones"),
];

/// Prints the lists.
pub fn run(args: &Args, console: &Console) -> Result<Outcome> {
    match args.format {
        Format::Text => console.data(&text())?,
        Format::Json => console.json(&json())?,
        Format::Csv => console.data(&all().csv())?,
    }
    Ok(Outcome::Done)
}

/// Everything in one table.
fn all() -> Table {
    let mut table = Table::new(&["<kind", "<name", "<summary", "<options", "<source"]);
    for e in ENTRIES {
        table.row(["accelerator", e.name, &summary(e), e.options, e.source].map(String::from).to_vec());
    }
    for e in procedural::ENTRIES {
        table.row(["scene", e.name, e.summary, e.options, e.source].map(String::from).to_vec());
    }
    for (name, on, summary) in FEATURES {
        let state = if *on { "compiled in" } else { "left out" };
        table.row(["feature", name, summary, state, ""].map(String::from).to_vec());
    }
    table
}

fn text() -> String {
    let mut out = String::from("Accelerators (--accel NAME or NAME:OPTION=VALUE,OPTION=VALUE)\n\n");
    for e in ENTRIES {
        out += &entry(e.name, &summary(e), e.options, e.source);
    }
    for (name, feature) in LEFT_OUT {
        out += &format!("  {name:<14} left out; `cargo build --features {feature}` brings it in\n");
    }
    out += "\nScenes made by formula (NAME or NAME:OPTION=VALUE,OPTION=VALUE in the place of a file)\n\n";
    for e in procedural::ENTRIES {
        out += &entry(e.name, e.summary, e.options, e.source);
    }
    out += "\nFeatures\n\n";
    for (name, on, summary) in FEATURES {
        let state = if *on {
            "compiled in".to_string()
        } else {
            format!("left out; `cargo build --features {name}` brings it in")
        };
        out += &format!("  {name:<14} {summary}: {state}\n");
    }
    out
}

/// What it is, and that it cannot be had here if so.
fn summary(entry: &Entry) -> String {
    match entry.missing() {
        Some(cause) => format!("{}; NOT AVAILABLE: {cause}", entry.summary),
        None => entry.summary.to_string(),
    }
}

/// Two or three lines.
fn entry(name: &str, summary: &str, options: &str, source: &str) -> String {
    let options = if options.is_empty() { String::new() } else { format!("  {:<14}   options: {options}\n", "") };
    format!("  {name:<14} {summary}\n{options}  {:<14}   source: {source}\n", "")
}

fn json() -> Value {
    let accelerators: Vec<Value> = ENTRIES
        .iter()
        .map(|e| {
            json!({
                "name": e.name,
                "summary": e.summary,
                "options": e.options,
                "source": e.source,
                "exact": e.exact,
                "missing": e.missing(),
            })
        })
        .collect();
    let left_out: Vec<Value> =
        LEFT_OUT.iter().map(|(name, feature)| json!({ "name": name, "feature": feature })).collect();
    let scenes: Vec<Value> = procedural::ENTRIES
        .iter()
        .map(|e| json!({ "name": e.name, "summary": e.summary, "options": e.options, "source": e.source }))
        .collect();
    let features: Vec<Value> =
        FEATURES.iter().map(|(name, on, summary)| json!({ "name": name, "enabled": on, "summary": summary })).collect();
    let body = json!({ "accelerators": accelerators, "left_out": left_out, "scenes": scenes, "features": features });
    document("skipgrid.list/1", body)
}
