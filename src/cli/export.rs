//! `skipgrid export`: the same scene for another renderer.

use super::Outcome;
use super::console::Console;
use super::input::{SceneArgs, check_extension, note_camera, parse_size};
use crate::error::Result;
use crate::render::Settings;
use crate::scene::{ExportSettings, mitsuba, povray};
use std::path::PathBuf;

const DETAILS: &str = "\
Meshes and textures that do not fit into the scene file are written beside it. What the other renderer cannot show as we \
do is said as a warning. POV-Ray's picture is that of our Whitted integrator plus, unless --lamps is 0, the light that comes \
straight from shining surfaces; light from diffuse surfaces to others is in Mitsuba's picture alone.

Examples:
  skipgrid export cornell --to mitsuba -o cornell.xml
  mitsuba -m scalar_rgb -Dspp=64 cornell.xml
  skipgrid export random:n=100 --to povray -o random.pov
  povray +Irandom.pov +W512 +H512 -D";

/// Write a scene for POV-Ray 3.7 or Mitsuba 3, to be rendered by them
#[derive(Debug, clap::Args)]
#[command(after_help = DETAILS)]
pub struct Args {
    #[command(flatten)]
    scene: SceneArgs,

    /// The other renderer
    #[arg(long, value_enum)]
    to: Target,

    /// The scene file: .pov or .xml
    #[arg(long = "output", short = 'o', value_name = "FILE")]
    out: PathBuf,

    /// Columns and rows of the picture; default: the scene's, else 512x512
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Option<(u32, u32)>,

    /// Longest path in edges: 1 sees emission only, 2 adds direct light; default: the scene's, else 8
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    max_depth: Option<u32>,

    /// For POV-Ray: spots along each side of a shining triangle that stand for its light; 0: it lights nothing
    #[arg(long, value_name = "N", default_value_t = ExportSettings::default().lamp_grid,
        value_parser = clap::value_parser!(u32).range(0..=64))]
    lamps: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Target {
    Povray,
    Mitsuba,
}

/// Writes the files.
pub fn run(args: &Args, console: &Console) -> Result<Outcome> {
    let (program, extension) = match args.to {
        Target::Povray => ("POV-Ray", "pov"),
        Target::Mitsuba => ("Mitsuba", "xml"),
    };
    check_extension(&args.out, &format!("a scene for {program}"), extension)?;
    let scene = args.scene.load(console)?;
    note_camera(&scene, console);
    let default = Settings::default();
    let (width, height) = args.size.or(scene.defaults.size).unwrap_or((default.width, default.height));
    let max_depth = args.max_depth.or(scene.defaults.max_depth).unwrap_or(default.max_depth);
    let settings = ExportSettings { width, height, max_depth, lamp_grid: args.lamps };
    let warnings = match args.to {
        Target::Povray => povray::export(&scene, &settings, &args.out)?,
        Target::Mitsuba => mitsuba::export(&scene, &settings, &args.out)?,
    };
    for warning in warnings {
        console.warn(warning);
    }
    Ok(Outcome::Done)
}
