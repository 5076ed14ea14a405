//! `skipgrid converge`: error against run time.

mod forms;
mod plot;

use super::console::Console;
use super::input::{ContenderArgs, Method, check_folder, note_camera, parse_positive, parse_size};
use super::outputs::{Extent, Forms, Outputs};
use super::{Outcome, interrupt};
use crate::converge::{Options, Other, Study, Truth, study};
use crate::error::{Error, Result};
use crate::picture::io::{self, Attributes};
use crate::render::Settings;
use crate::scene::Scene;
use std::path::{Path, PathBuf};

const DETAILS: &str = "\
Pictures of 2, 4, 8, .. samples a pixel are rendered with every accelerator in turns, each as two halves of independent \
seeds, and all that as often as --replicates says with seeds of their own. An accelerator cannot change a picture: those of \
exact ones must be equal to the bit, else the exit code is 1; their curves differ by a shift in time alone.

MSE: mean squared error over all pixels and channels, linear RGB. relMSE: the same with every difference over the \
reference's value + 0.01. Variance: mean of (A - B)^2 / 4 of the halves. bias^2: max(0, MSE - variance - the reference's own \
variance), with half of its 95 % interval. Bands are 95 % Student's t intervals over the replicates. Efficiency is 1 / (MSE * \
seconds), build included. Seconds of ours are processor time of all threads; those of other programs wall time on one thread, \
their start included; so compare these with care.

Crossover: each accelerator's time as a line, build + seconds for each sample, fitted over all numbers of samples; the number of \
samples at which two lines cross, and its range over the replicates.

Examples:
  skipgrid converge cornell --accel grid --accel nested --svg cornell.svg
  skipgrid converge room.glb --reference self:4096 --target 1e-4
  skipgrid converge cornell --against mitsuba --equal-time 1 --pictures equal";

/// Measure error against run time: accelerators, Mitsuba and POV-Ray at more and more samples
#[derive(Debug, clap::Args)]
#[command(after_help = DETAILS)]
pub struct Args {
    #[command(flatten)]
    contenders: ContenderArgs,

    /// What pictures are held against: a picture, or our own of so many samples; default: self of 16 times --spp
    #[arg(long, value_name = "IMAGE|self:SPP", value_parser = parse_truth)]
    reference: Option<Truth>,

    /// Most samples a pixel
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = clap::value_parser!(u32).range(2..=1 << 17))]
    spp: u32,

    /// Independent pictures at every number of samples
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(3..=1000))]
    replicates: u32,

    /// Columns and rows; default: the picture's that is the reference, else the scene's, else 128x128
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Option<(u32, u32)>,

    /// What is computed; default: the scene's, else path. Pixels are sampled at random points here by both
    #[arg(long, value_enum)]
    integrator: Option<Method>,

    /// Longest path in edges; default: the scene's, else 8
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    max_depth: Option<u32>,

    /// Same seed, same pictures
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,

    /// Worker threads of our renderer; default: as many as there are cores
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    threads: Option<u32>,

    /// Other renderers to run on the exported scene, where they are installed
    #[arg(long, value_name = "R,R", value_delimiter = ',', value_enum)]
    against: Vec<Against>,

    /// Say when the MSE comes down to this; give it once for each
    #[arg(long = "target", value_name = "MSE", value_parser = parse_positive)]
    targets: Vec<f64>,

    /// Also render what each can in so many seconds, build included
    #[arg(long, value_name = "SECONDS", value_parser = parse_positive, requires = "pictures")]
    equal_time: Option<f64>,

    /// Folder, made if need be, for the pictures of --equal-time and their reference, as .exr and .png
    #[arg(long, value_name = "DIR", requires = "equal_time")]
    pictures: Option<PathBuf>,

    #[command(flatten)]
    outputs: Outputs,

    /// Where the plot goes
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Against {
    /// Mitsuba 3, Python's module of that name
    Mitsuba,
    /// POV-Ray 3.7; points of a regular grid at 4, 16, 64, .. samples
    Povray,
}

/// Measures and prints.
pub fn run(args: &Args, console: &Console) -> Result<Outcome> {
    args.outputs.check(args.svg.as_deref())?;
    args.pictures.iter().try_for_each(|folder| check_folder(folder))?;
    let scene = args.contenders.scene.load(console)?;
    note_camera(&scene, console);
    let options = options(args, &scene)?;
    let specs = args.contenders.specs();
    let workplace = Workplace::new(!options.others.is_empty())?;

    let progress = console.progress("");
    // A share of 0 to 1.
    let watch = |share: f64, stage: &str| progress.at((share * 1000.0) as u64, 1000, stage);
    let study = study(&scene, &specs, &options, &workplace.folder, &watch, interrupt::request())?;
    drop(progress);
    report(args, &study, console)?;
    Ok(Outcome::of(study.identical(), study.interrupted))
}

/// The command line, then the reference, then the scene's wishes, then the defaults.
fn options(args: &Args, scene: &Scene) -> Result<Options> {
    let (usual, wish) = (Options::default(), &scene.defaults);
    let truth = args.reference.clone().unwrap_or(Truth::Own((16 * args.spp).min(Options::MOST_SAMPLES)));
    let of_reference = match (&truth, args.size) {
        (Truth::File(path), None) => {
            let picture = io::read(path)?;
            Some((picture.width, picture.height))
        }
        _ => None,
    };
    let (width, height) = args.size.or(of_reference).or(wish.size).unwrap_or((usual.width, usual.height));
    let mut others: Vec<Other> = Vec::new();
    for against in &args.against {
        let other = if *against == Against::Mitsuba { Other::Mitsuba } else { Other::Povray };
        if !others.contains(&other) {
            others.push(other);
        }
    }
    Ok(Options {
        integrator: Method::or_wish(args.integrator, wish.integrator.as_deref()),
        width,
        height,
        max_depth: args.max_depth.or(wish.max_depth).unwrap_or(Settings::default().max_depth),
        threads: args.threads.map(|n| n as usize),
        seed: args.seed,
        samples: args.spp,
        replicates: args.replicates,
        truth,
        others,
        equal_time: args.equal_time,
    })
}

fn report(args: &Args, study: &Study, console: &Console) -> Result<()> {
    for (other, reason) in &study.left_out {
        console.note(format!("{other} is left out: {reason}"));
    }
    study.warnings.iter().for_each(|warning| console.warn(warning));
    if study.reference.variance.is_none() && !study.interrupted {
        console.warn("nothing tells the noise of the reference: it is part of bias^2");
    }
    study.differences.iter().take(3).for_each(|d| console.warn(d));
    let (scene, targets) = (&args.contenders.scene.scene, &args.targets);
    let forms = Forms {
        text: &|| forms::text(study, scene, targets),
        csv: &|| forms::csv(study, scene),
        json: &|| forms::json(study, scene, targets),
        shown: (args.svg.as_deref(), &|| plot::curves(study, scene).svg()),
    };
    let finished = study.curves.iter().any(|curve| !curve.points.is_empty());
    args.outputs.write(&forms, Extent::of(study.interrupted, finished), console)?;
    match &args.pictures {
        Some(folder) if !study.interrupted => pictures(folder, study, scene, console),
        _ => Ok(()),
    }
}

/// Writes the pictures of equal time and the reference.
fn pictures(folder: &Path, study: &Study, scene: &str, console: &Console) -> Result<()> {
    if !folder.is_dir() {
        std::fs::create_dir(folder).map_err(|e| Error::io(folder, e))?;
    }
    let write = |name: &str, picture, attributes: &Attributes| -> Result<()> {
        for extension in ["exr", "png"] {
            io::write(folder.join(format!("{name}.{extension}")), picture, attributes)?;
        }
        Ok(())
    };
    let attributes = Attributes::default().with("scene", scene);
    write("reference", &study.reference.picture, &attributes)?;
    for (i, shot) in study.equal_time.iter().enumerate() {
        let Some(picture) = &shot.picture else { continue };
        let plain = |c: char| if c.is_ascii_alphanumeric() || "-.".contains(c) { c } else { '_' };
        // Numbered, as two specifications may differ in other characters alone.
        let name = format!("{}-{}", i + 1, shot.name.chars().map(plain).collect::<String>());
        let attributes = attributes.clone().with("renderer", &shot.name).with("samples", shot.samples.to_string());
        write(&name, picture, &attributes)?;
    }
    console.note(format!("written: pictures of equal time in {}", folder.display()));
    Ok(())
}

/// A folder for exported scenes, gone when this is.
struct Workplace {
    folder: PathBuf,
}

impl Workplace {
    /// Made only if it is `needed`.
    fn new(needed: bool) -> Result<Self> {
        let folder = std::env::temp_dir().join(format!("skipgrid-converge-{}", std::process::id()));
        if needed {
            std::fs::create_dir(&folder).map_err(|e| Error::io(&folder, e))?;
        }
        Ok(Self { folder })
    }
}

impl Drop for Workplace {
    fn drop(&mut self) {
        // It may never have been made; and there is nothing to do about one that cannot be removed.
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

/// `self:SPP` or a file.
fn parse_truth(text: &str) -> std::result::Result<Truth, String> {
    let Some(samples) = text.strip_prefix("self:") else { return Ok(Truth::File(text.into())) };
    let most = Options::MOST_SAMPLES;
    match samples.parse::<u32>() {
        Ok(n) if (2..=most).contains(&n) && n % 2 == 0 => Ok(Truth::Own(n)),
        _ => Err(format!("self:SPP takes an even number of samples, 2 to {most}")),
    }
}
