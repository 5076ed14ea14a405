//! `skipgrid validate`: our pictures against those of POV-Ray and Mitsuba, or against any others of any scene.

use super::console::{Console, Format};
use super::document::document;
use super::input::{DEFAULT_ACCELS, Method, SceneArgs, check_file, check_folder, note_camera};
use super::outputs::partial;
use super::{Outcome, interrupt};
use crate::error::{Error, Result};
use crate::measure::Machine;
use crate::picture::io::replace_file;
use crate::render::{Integrator, Settings, omissions};
use crate::scene::Scene;
use crate::validate::{self, Environment, Options, Report, Theirs};
use serde_json::json;
use std::path::{Path, PathBuf};

/// What marks a folder of reference pictures.
const MANIFEST: &str = "manifest.toml";

const DETAILS: &str = "\
Every scene of the reference folder is rendered with every accelerator. POV-Ray's pictures have no noise and are \
compared pixel by pixel; Mitsuba's are compared tile by tile within the noise of both sides. The pictures of all \
accelerators must be equal to the bit. The exit code is 1 if anything differs.

The reference folder is what --reference or the environment variable SKIPGRID_REFERENCE names, else `reference` in the current \
folder, in a folder above the program, or in the source tree that the program was built from. It is part of the repository, not of \
the published package.

With --scene and --theirs a scene of yours is compared with pictures that another program made of it, in their size: with \
--integrator whitted one picture without noise, pixel by pixel; else the noisy ones of a path tracer, tile by tile. Of these \
give two or more independent renders, or one EXR file with the variance of its mean in `variance.R`, `variance.G` and \
`variance.B`. One noisy picture alone can be shown to agree, but not to differ: that may be its noise.

Examples:
  skipgrid validate
  skipgrid validate --reseed 20 --report report.html
  skipgrid validate --scene room.glb --theirs a.exr b.exr c.exr d.exr --max-depth 8
  skipgrid validate --scene flakes --theirs flakes.png --integrator whitted --spp 4 --max-depth 6
  skipgrid validate glass cornell --accel grid:density=8 --report report.html";

/// Compare our pictures with those of POV-Ray and Mitsuba
#[derive(Debug, clap::Args)]
#[command(after_help = DETAILS)]
pub struct Args {
    /// Names in the reference folder's manifest; default: all
    cases: Vec<String>,

    /// Accelerator, with options; give it once for each
    #[arg(long = "accel", value_name = "A", default_values = DEFAULT_ACCELS)]
    accels: Vec<String>,

    /// The reference folder; default: as below
    #[arg(long, value_name = "DIR")]
    reference: Option<PathBuf>,

    /// A scene of yours, file or formula, to be compared with --theirs
    #[arg(long, value_name = "SCENE", requires = "theirs", conflicts_with_all = ["cases", "reference"])]
    scene: Option<String>,

    /// Pictures that another program made of --scene: .exr, .png, .pfm or .hdr
    #[arg(long, value_name = "IMAGE", num_args = 1.., requires = "scene")]
    theirs: Vec<PathBuf>,

    /// Renders whose mean a single picture with variance is; 2 trusts its variance least
    #[arg(long, value_name = "N", default_value_t = 2, requires = "theirs",
        value_parser = clap::value_parser!(u32).range(2..=1 << 20))]
    theirs_renders: u32,

    /// How --scene is rendered: path for pictures with noise, whitted for those without; default: as the scene says, else path
    #[arg(long, value_enum, requires = "theirs")]
    integrator: Option<Method>,

    /// Longest path in edges, for --scene; default: as the scene says, else 8
    #[arg(long, value_name = "N", requires = "theirs", value_parser = clap::value_parser!(u32).range(1..))]
    max_depth: Option<u32>,

    /// Samples for each pixel: of each render (path, default 32), or of a regular grid, a square number (whitted)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    spp: Option<u32>,

    /// Renders of ours with different seeds that a noisy picture is compared with
    #[arg(long, value_name = "N", default_value_t = Options::default().replicates,
        value_parser = clap::value_parser!(u32).range(2..=1 << 20))]
    replicates: u32,

    /// Repeat each comparison within noise with N further sets of renders, and list their probabilities
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=10_000))]
    reseed: u32,

    /// Where a self-contained HTML page with all pictures goes, with its numbers as JSON beside it: FILE with the ending .json
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,

    /// Where the pictures go: ours, theirs, difference
    #[arg(long, value_name = "DIR")]
    pictures: Option<PathBuf>,

    /// Worker threads; default: as many as there are cores
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    threads: Option<u32>,

    /// Form of the table
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// Validates and prints.
pub fn run(args: &Args, console: &Console) -> Result<Outcome> {
    args.report.as_deref().map(check_report).transpose()?;
    args.pictures.as_deref().map(check_folder).transpose()?;
    let scene = args.scene.as_ref().map(|name| load(name, console)).transpose()?;
    let progress = console.progress("");
    let watch = |done: usize, all: usize, next: &str| progress.at(done as u64, all as u64, next);
    let options = Options {
        threads: args.threads.map(|n| n as usize),
        replicates: args.replicates,
        spp: args.spp.unwrap_or(Options::default().spp),
        reseeds: args.reseed,
        keep_pictures: args.report.is_some() || args.pictures.is_some(),
        count_steps: args.report.is_some(),
        progress: Some(&watch),
        stop: Some(interrupt::request()),
    };
    let report = match &scene {
        Some(scene) => {
            let theirs = theirs(args, scene)?;
            omissions(scene, theirs.integrator).iter().for_each(|words| console.warn(words));
            validate::against(scene, &theirs, &args.accels, &options)
        }
        None => {
            let folder = args.reference.clone().map_or_else(find_reference, Ok)?;
            validate::run(folder.join(MANIFEST), &args.cases, &args.accels, &options)
        }
    }?;
    let environment = environment(&options);
    drop(progress);
    if report.unfinished > 0 && report.entries.is_empty() {
        return Ok(Outcome::Interrupted);
    }

    match args.format {
        Format::Text => console.data(&format!("{report}\n"))?,
        Format::Csv => console.data(&report.csv())?,
        Format::Json => {
            let body = json!({ "passed": report.passed(), "report": report });
            console.json(&document("skipgrid.validate/1", body))?;
        }
    }
    if let Some(file) = &args.report {
        let file = &if report.unfinished > 0 { partial(file) } else { file.clone() };
        let data = write_report(file, &report, &environment)?;
        console.note(format!("report: {}, its numbers: {}", file.display(), data.display()));
    }
    if let Some(folder) = &args.pictures {
        let count = report.write_pictures(folder)?;
        console.note(format!("{count} pictures in {}", folder.display()));
    }
    Ok(match report.passed() {
        _ if report.unfinished > 0 => Outcome::Interrupted,
        true => Outcome::Done,
        false => Outcome::CheckFailed,
    })
}

/// The user's own scene.
fn load(name: &str, console: &Console) -> Result<Scene> {
    let source = SceneArgs { scene: name.to_string(), drop_invalid: false, memory_budget: None };
    let scene = source.load(console)?;
    note_camera(&scene, console);
    Ok(scene)
}

/// Finds out before the work whether a page can be written and its numbers beside it.
fn check_report(file: &Path) -> Result<()> {
    if file.extension().is_some_and(|e| e.eq_ignore_ascii_case("json")) {
        let cause = "the page cannot end in .json: the file beside it does; such as report.html";
        return Err(Error::invalid(format!("--report {}: {cause}", file.display())));
    }
    check_file(file)?;
    check_file(&file.with_extension("json"))
}

/// Writes the page and, beside it, all that it says without its pictures; gives the name of the latter.
fn write_report(file: &Path, report: &Report, environment: &Environment) -> Result<PathBuf> {
    let summary = report.summary();
    let body = json!({
        "passed": report.passed(),
        "summary": summary.lines().collect::<Vec<_>>(),
        "environment": environment,
        "report": report,
    });
    let data = file.with_extension("json");
    replace_file(&data, format!("{:#}\n", document("skipgrid.validate/1", body)).as_bytes())?;
    replace_file(file, report.html(environment).as_bytes())?;
    Ok(data)
}

/// What this run was made with.
fn environment(options: &Options) -> Environment {
    let word = |word: std::ffi::OsString| match word.to_string_lossy() {
        plain if !plain.contains(char::is_whitespace) && !plain.is_empty() => plain.into_owned(),
        other => format!("'{other}'"),
    };
    let words: Vec<String> = std::env::args_os().skip(1).map(word).collect();
    Environment {
        program: concat!("skipgrid ", env!("CARGO_PKG_VERSION")).to_string(),
        machine: Machine::this().to_string(),
        command: format!("skipgrid {}", words.join(" ")),
        threads: options.threads,
        replicates: options.replicates,
        spp: options.spp,
    }
}

/// The command line, then the scene's wishes, then the defaults.
fn theirs(args: &Args, scene: &Scene) -> Result<Theirs> {
    let wish = &scene.defaults;
    let integrator = Method::or_wish(args.integrator, wish.integrator.as_deref());
    let whitted = integrator == Integrator::Whitted;
    let grid = match args.spp {
        Some(spp) if whitted && spp.isqrt().pow(2) != spp => {
            let cause = format!("--spp {spp} is no square number, which Whitted's method needs, such as 1, 4, 9, 16");
            return Err(Error::invalid(cause));
        }
        spp => spp.or(wish.spp).unwrap_or(1).isqrt().max(1),
    };
    Ok(Theirs {
        images: args.theirs.clone(),
        renders: args.theirs_renders,
        integrator,
        grid,
        max_depth: args.max_depth.or(wish.max_depth).unwrap_or(Settings::default().max_depth),
    })
}

/// The folder that SKIPGRID_REFERENCE names, else `reference` in the current folder, in a folder above the program, or in the
/// source tree that it was built from.
fn find_reference() -> Result<PathBuf> {
    // Not by clap: the variable must not stand in the way of --scene.
    if let Some(named) = std::env::var_os("SKIPGRID_REFERENCE").filter(|named| !named.is_empty()) {
        return Ok(named.into());
    }
    let program = std::env::current_exe().ok();
    let above = program.iter().flat_map(|path| path.ancestors().skip(1));
    let built_from = Path::new(env!("CARGO_MANIFEST_DIR"));
    first_reference(std::iter::once(Path::new(".")).chain(above).chain([built_from]))
}

/// The first `reference` in one of `folders`.
///
/// # Errors
/// None of them has one with a manifest.
fn first_reference<'a>(mut folders: impl Iterator<Item = &'a Path>) -> Result<PathBuf> {
    let found = folders.find_map(|folder| Some(folder.join("reference")).filter(|f| f.join(MANIFEST).is_file()));
    found.ok_or_else(|| {
        Error::invalid(format!(
            "the reference pictures are missing: no reference/{MANIFEST} in the current folder, above the program or where it \
             was built; they are in the folder `reference` of skipgrid's repository, not in the published package: name the \
             folder with --reference or SKIPGRID_REFERENCE, or compare with pictures of your own by --scene and --theirs"
        ))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_folder_with_a_manifest_is_taken_and_a_missing_one_explained() {
        let [none, here] = ["src", "."].map(|folder| Path::new(env!("CARGO_MANIFEST_DIR")).join(folder));
        let error = first_reference([none.as_path()].into_iter()).expect_err("src has no pictures").to_string();
        for part in ["reference/manifest.toml", "--reference", "SKIPGRID_REFERENCE", "--theirs", "repository"] {
            assert!(error.contains(part), "{error}");
        }
        // The published package has no pictures.
        if here.join("reference").join(MANIFEST).is_file() {
            let found = first_reference([none.as_path(), here.as_path()].into_iter()).expect("the pictures are there");
            assert_eq!(found, here.join("reference"));
        }
    }
}
