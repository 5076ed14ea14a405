//! `skipgrid papers`: the tables and claims of the papers, measured again.

mod forms;

use super::Outcome;
use super::console::Console;
use super::input::{check_file, parse_positive};
use crate::error::Result;
use crate::papers::{
    Report, amanatides_woo, arvo, dda, exactness, newton_seeds, semwal_kvarnstrom, shadow_voxels, spd,
};
use crate::picture::io::replace_file;
use clap::builder::RangedU64ValueParser;
use std::path::{Path, PathBuf};

const DETAILS: &str = "\
Every picture is rendered once; its rays are recorded and traced again through each accelerator, on one thread, in turns. \
Every answer must equal the plain grid's to the bit, else the exit code is 1. Full runs take minutes; --quick takes \
seconds and shows what there is to see, not how fast it is.

Examples:
  skipgrid papers amanatides-woo
  skipgrid papers arvo --grids 4,64,1024
  skipgrid papers semwal-kvarnstrom --grids 32,64 --svg skips.svg
  skipgrid papers spd --format markdown -o spd.md --svg spd.svg";

/// Measure the papers' tables again and judge their claims
#[derive(Debug, clap::Args)]
#[command(after_help = DETAILS)]
pub struct Args {
    #[command(subcommand)]
    paper: Paper,
}

#[derive(Debug, clap::Subcommand)]
enum Paper {
    AmanatidesWoo(AmanatidesWoo),
    Arvo(Arvo),
    Dda(Dda),
    Exactness(Exactness),
    NewtonSeeds(NewtonSeeds),
    SemwalKvarnstrom(SemwalKvarnstrom),
    ShadowVoxels(ShadowVoxels),
    Spd(Spd),
}

/// Amanatides & Woo 1987: tests per ray with and without rayID, time against subdivision
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  skipgrid papers amanatides-woo --quick\n  skipgrid papers amanatides-woo --grids 8,16,32 --svg subdivision.svg"
)]
struct AmanatidesWoo {
    /// Subdivisions of each axis; the paper's own come on top (1 to 128)
    #[arg(long, value_name = "N,N,..", value_delimiter = ',', value_parser = grid())]
    grids: Vec<u32>,

    #[command(flatten)]
    common: Common,
}

/// Arvo 1988: nodes and leaves of rays through octrees, linear walks against re-traversal
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  skipgrid papers arvo --quick\n  skipgrid papers arvo --grids 4,64,1024 --scene flakes"
)]
struct Arvo {
    /// Leaves on each axis of the complete trees, powers of two (4 to 1024)
    #[arg(long, value_name = "N,N,..", value_delimiter = ',', value_parser = grid())]
    grids: Vec<u32>,

    /// Rays through each of them (1000; 100 with --quick)
    #[arg(long, value_name = "N", value_parser = RangedU64ValueParser::<u32>::new().range(1..=1_000_000))]
    rays: Option<u32>,

    /// Accelerator, with options; give it once for each (all of the note's and a BVH); the plain grid always comes first
    #[arg(long = "accel", value_name = "A")]
    accels: Vec<String>,

    /// Scene, a file or one made by formula; give it once for each (random, flakes, bumpy, two of SPD)
    #[arg(long = "scene", value_name = "S")]
    scenes: Vec<String>,

    #[command(flatten)]
    common: Common,
}

/// Amanatides & Woo 1987, last section: bicubic patches by Newton's method with starting points in the voxels
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  skipgrid papers newton-seeds --quick\n  skipgrid papers newton-seeds --grids 8,32 --meshes 16 -o seeds.json"
)]
struct NewtonSeeds {
    /// Voxels on each axis (4,8,16,32,64)
    #[arg(long, value_name = "N,N,..", value_delimiter = ',', value_parser = grid())]
    grids: Vec<u32>,

    /// Steps along each patch edge of the tessellated teapots (4,8,16,32,64)
    #[arg(long, value_name = "N,N,..", value_delimiter = ',', value_parser = grid())]
    meshes: Vec<u32>,

    #[command(flatten)]
    common: Common,
}

/// Semwal & Kvarnstrom 1997: skip methods on four scenes, three views, three grid sizes
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  skipgrid papers semwal-kvarnstrom --quick\n  skipgrid papers semwal-kvarnstrom --grids 32,64 --accel grid-dsz --accel grid-dual"
)]
struct SemwalKvarnstrom {
    /// Voxels on each axis (32,64,128)
    #[arg(long, value_name = "N,N,..", value_delimiter = ',', value_parser = grid())]
    grids: Vec<u32>,

    /// Accelerator, with options; give it once for each (all skip methods); the plain grid always comes first
    #[arg(long = "accel", value_name = "A")]
    accels: Vec<String>,

    /// One of the paper's scenes; give it once for each (random, lanes, flakes, cars)
    #[arg(long = "scene", value_name = "S")]
    scenes: Vec<String>,

    #[command(flatten)]
    common: Common,
}

/// Amanatides & Woo 1987, last section: two bits a light and voxel that spare shadow rays
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  skipgrid papers shadow-voxels --quick\n  skipgrid papers shadow-voxels --scene flakes -o shadow.csv"
)]
struct ShadowVoxels {
    /// Scene, a file or one made by formula; give it once for each (seven made by formula)
    #[arg(long = "scene", value_name = "S")]
    scenes: Vec<String>,

    #[command(flatten)]
    common: Common,
}

/// Haines' Standard Procedural Databases over all accelerators
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  skipgrid papers spd --quick\n  skipgrid papers spd --format markdown -o spd.md --svg spd.svg"
)]
struct Spd {
    /// Accelerator, with options; give it once for each (all); the plain grid always comes first
    #[arg(long = "accel", value_name = "A")]
    accels: Vec<String>,

    /// Scene, a file or one made by formula; give it once for each (all of SPD)
    #[arg(long = "scene", value_name = "S")]
    scenes: Vec<String>,

    /// Voxels a primitive, of grids that do not set it
    #[arg(long, value_name = "F", default_value_t = 20.0, value_parser = parse_positive)]
    density: f64,

    #[command(flatten)]
    common: Common,
}

/// The article on branchless DDA: solid voxels, branching and branchless, plain and with each skip table
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  skipgrid papers dda --quick\n  skipgrid papers dda --scene voxel-terrain:n=64 --rounds 9"
)]
struct Dda {
    /// Scene of solid voxels, a .vox or .npy file or one made by formula; give it once for each (voxel-terrain of two sizes)
    #[arg(long = "scene", value_name = "S")]
    scenes: Vec<String>,

    #[command(flatten)]
    common: Common,
}

/// Our own claim: what exact answers cost against plain tests, and errors against run time
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  skipgrid papers exactness --quick --no-peers\n  skipgrid papers exactness --scene bumpy:n=64 --rays 1000"
)]
struct Exactness {
    /// Scene of triangles, a file or one made by formula; give it once for each (six made by formula)
    #[arg(long = "scene", value_name = "S")]
    scenes: Vec<String>,

    /// Rays of each case that errors are counted on (10000; 300 with --quick)
    #[arg(long, value_name = "N", value_parser = RangedU64ValueParser::<u32>::new().range(1..=1_000_000))]
    rays: Option<u32>,

    /// Leave out Embree and the other ray tracers with tests of their own
    #[arg(long)]
    no_peers: bool,

    #[command(flatten)]
    common: Common,
}

#[derive(Debug, clap::Args)]
struct Common {
    /// Rows and columns of the pictures (192; 48 with --quick)
    #[arg(long, value_name = "N", value_parser = RangedU64ValueParser::<u32>::new().range(1..=1024))]
    size: Option<u32>,

    /// Timed rounds (5; 1 with --quick)
    #[arg(long, value_name = "N", value_parser = RangedU64ValueParser::<u32>::new().range(1..=1000))]
    rounds: Option<u32>,

    /// Small pictures, coarse grids, one round
    #[arg(long)]
    quick: bool,

    /// Form of the report; default: by the extension of the output (.txt, .csv, .json, .md), else text
    #[arg(long, value_enum)]
    format: Option<Form>,

    /// Where a plot goes: .svg
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,

    /// Where the report goes, instead of standard output
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// The form of a report.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Form {
    /// Aligned columns for people
    Text,
    /// One line for each cell: table, row, column, value
    Csv,
    /// One JSON object
    Json,
    /// A page with tables
    Markdown,
}

fn grid() -> RangedU64ValueParser<u32> {
    RangedU64ValueParser::new().range(1..=1024)
}

/// Measures and prints.
pub fn run(args: &Args, console: &Console) -> Result<Outcome> {
    let common = match &args.paper {
        Paper::AmanatidesWoo(AmanatidesWoo { common, .. })
        | Paper::Arvo(Arvo { common, .. })
        | Paper::NewtonSeeds(NewtonSeeds { common, .. })
        | Paper::SemwalKvarnstrom(SemwalKvarnstrom { common, .. })
        | Paper::ShadowVoxels(ShadowVoxels { common, .. })
        | Paper::Spd(Spd { common, .. })
        | Paper::Exactness(Exactness { common, .. })
        | Paper::Dda(Dda { common, .. }) => common,
    };
    common.output.iter().chain(&common.svg).try_for_each(|file| check_file(file))?;
    let report = measure(&args.paper, common, console)?;

    let svg = common.svg.as_deref();
    let text = match common.format.unwrap_or_else(|| Form::of(common.output.as_deref())) {
        Form::Text => forms::text(&report),
        Form::Csv => forms::csv(&report),
        Form::Json => forms::json(&report),
        Form::Markdown => forms::markdown(&report, svg),
    };
    if let Some(file) = svg {
        replace_file(file, report.plot.svg().as_bytes())?;
        console.note(format!("plot: {}", file.display()));
    }
    match &common.output {
        Some(file) => {
            replace_file(file, text.as_bytes())?;
            console.note(format!("report: {}", file.display()));
        }
        None => console.data(&text)?,
    }
    if report.wrong > 0 {
        console.warn(format!("{} answers differ from the plain grid's or from exact arithmetic", report.wrong));
        return Ok(Outcome::CheckFailed);
    }
    Ok(Outcome::Done)
}

impl Form {
    fn of(output: Option<&Path>) -> Self {
        match output.and_then(|file| file.extension()).and_then(|e| e.to_str()) {
            Some("csv") => Form::Csv,
            Some("json") => Form::Json,
            Some("md") => Form::Markdown,
            _ => Form::Text,
        }
    }
}

fn measure(paper: &Paper, common: &Common, console: &Console) -> Result<Report> {
    let progress = console.progress("");
    let watch = |done: usize, all: usize, next: &str| progress.at(done as u64, all as u64, next);
    let quick = common.quick;
    let size = common.size.unwrap_or(if quick { 48 } else { 192 });
    let rounds = common.rounds.unwrap_or(if quick { 1 } else { 5 });
    let or = |given: &[u32], full: &[u32], small: &[u32]| match given {
        [] if quick => small.to_vec(),
        [] => full.to_vec(),
        _ => given.to_vec(),
    };
    let names = |given: &[String], usual: &[&[&str]]| match given {
        [] => usual.iter().copied().flatten().map(|name| name.to_string()).collect(),
        _ => given.to_vec(),
    };
    let methods: &[&str] = &semwal_kvarnstrom::METHODS;
    match paper {
        Paper::AmanatidesWoo(args) => {
            let grids = or(&args.grids, &[1, 2, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128], &[2, 4, 8]);
            amanatides_woo::run(&amanatides_woo::Options { size, rounds, grids }, &watch)
        }
        Paper::Arvo(args) => {
            let grids = or(&args.grids, &[4, 8, 16, 32, 64, 128, 256, 512, 1024], &[4, 16, 64]);
            let scenes = names(&args.scenes, if quick { &[&arvo::QUICK_SCENES] } else { &[&arvo::SCENES] });
            let accels = names(&args.accels, &[&arvo::METHODS]);
            let rays = args.rays.unwrap_or(if quick { 100 } else { 1000 });
            let most = if quick { 2_000 } else { 100_000 };
            arvo::run(&arvo::Options { grids, rays, size, rounds, scenes, accels, most }, &watch)
        }
        Paper::NewtonSeeds(args) => {
            let grids = or(&args.grids, &[4, 8, 16, 32, 64], &[4, 16]);
            let meshes = or(&args.meshes, &[4, 8, 16, 32, 64], &[4, 8]);
            newton_seeds::run(&newton_seeds::Options { size, rounds, grids, meshes }, &watch)
        }
        Paper::SemwalKvarnstrom(args) => {
            let grids = or(&args.grids, &[32, 64, 128], &[16, 32]);
            let (accels, scenes) = (names(&args.accels, &[methods]), args.scenes.clone());
            semwal_kvarnstrom::run(&semwal_kvarnstrom::Options { size, rounds, grids, accels, scenes }, &watch)
        }
        Paper::ShadowVoxels(args) => {
            let scenes = args.scenes.clone();
            shadow_voxels::run(&shadow_voxels::Options { size, rounds, scenes }, &watch)
        }
        Paper::Spd(args) => {
            let (accels, scenes) = (names(&args.accels, &[methods, &spd::BVHS]), args.scenes.clone());
            let patience = if quick { 0.05 } else { 0.5 };
            spd::run(&spd::Options { size, rounds, density: args.density, accels, scenes, patience }, &watch)
        }
        Paper::Dda(args) => {
            let usual: &[&str] =
                if quick { &["voxel-terrain:n=32"] } else { &["voxel-terrain", "voxel-terrain:n=256"] };
            let scenes = names(&args.scenes, &[usual]);
            dda::run(&dda::Options { size, rounds, scenes }, &watch)
        }
        Paper::Exactness(args) => {
            let usual: &[&str] = if quick { &["bumpy:n=16"] } else { &exactness::SCENES };
            let scenes = names(&args.scenes, &[usual]);
            let rays = args.rays.unwrap_or(if quick { 300 } else { 10_000 });
            exactness::run(&exactness::Options { size, rounds, scenes, rays, peers: !args.no_peers }, &watch)
        }
    }
}
