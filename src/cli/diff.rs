//! `skipgrid diff`: how far two pictures are apart.

use super::Outcome;
use super::console::{Console, Format};
use super::document::document;
use super::input::check_picture;
use super::table::Table;
use crate::error::{Error, Result};
use crate::picture::flip::hdr;
use crate::picture::io::{self, Attributes};
use crate::picture::metrics::{self, NonFinite};
use crate::picture::{Picture, falsecolour, flip};
use serde_json::{Map, Value, json};
use std::path::{Path, PathBuf};

const DETAILS: &str = "\
Pictures are .exr, .png, .pfm or .hdr and compared in linear RGB. Pixels that are not finite are counted, with the first of \
each picture, and end with exit code 1, never \"equal\".
The map of the two FLIPs shows their error, that of every other metric the difference relative to B, black for 1e-5 and \
less, white for 1 and more. The map of exposures goes from black, the lowest, to white. In JSON an infinite psnr is null.

Examples:
  skipgrid diff ours.exr theirs.exr
  skipgrid diff ours.exr theirs.exr --metric relmse --fail-above 1e-3 -o difference.png
  skipgrid diff ours.exr theirs.hdr --metric hdr-flip -o flip.png --exposure-map exposures.png";

const SCHEMA: &str = "skipgrid.diff/1";

/// Compare two pictures: RMSE, relMSE, PSNR, FLIP, HDR-FLIP and more
#[derive(Debug, clap::Args)]
#[command(after_help = DETAILS)]
pub struct Args {
    /// The picture in question
    a: PathBuf,

    /// The reference
    b: PathBuf,

    /// Print this metric alone, and hold it against the bounds; default: print all, hold rmse against them
    #[arg(long, value_enum)]
    metric: Option<Metric>,

    /// End with exit code 1 if the metric is above this
    #[arg(long, value_name = "X", value_parser = parse_bound)]
    fail_above: Option<f64>,

    /// End with exit code 1 if the metric is below this; for psnr and mean-ratio
    #[arg(long, value_name = "X", value_parser = parse_bound)]
    fail_below: Option<f64>,

    /// Layer of EXR files to compare, such as `diffuse` for `diffuse.R`; default: no layer, or the only one with colours
    #[arg(long, value_name = "NAME")]
    layer: Option<String>,

    /// Where a map of the differences goes: .png, .exr or .pfm
    #[arg(long = "output", short = 'o', value_name = "MAP")]
    out: Option<PathBuf>,

    /// Where a map goes of the exposures at which HDR-FLIP found its largest errors: .png, .exr or .pfm
    #[arg(long, value_name = "MAP")]
    exposure_map: Option<PathBuf>,

    /// Form of the answer
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// 0 for equal pictures but for psnr (infinite) and mean-ratio (1).
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Metric {
    /// Root of the mean squared difference
    Rmse,
    /// Mean of (a - b)^2
    Mse,
    /// Mean of (a - b)^2 / (b + 0.01)^2, as pbrt's MRSE
    Relmse,
    /// Mean of (a - b)^2 / (b^2 + 0.01), after Rousselle et al. 2011
    RelmseRousselle,
    /// Mean of |a - b|
    Mae,
    /// Largest |a - b|
    Max,
    /// 10 log10(1 / mse), decibel for a peak of 1
    Psnr,
    /// Mean FLIP error at 67 pixels a degree, of pictures clamped to 0..1
    Flip,
    /// The same for high dynamic range: the largest error of each pixel over the exposures that B asks for
    HdrFlip,
    /// Share of pixels that differ by more than 1 %
    Above1,
    /// Share of pixels that differ by more than 0.1 %
    Above01,
    /// Share of pixels that differ at all
    Differing,
    /// Sum of all values of A over that of B
    MeanRatio,
}

/// Compares and prints.
pub fn run(args: &Args, console: &Console) -> Result<Outcome> {
    for map in args.out.iter().chain(&args.exposure_map) {
        check_picture(map)?;
    }
    if let Some(layer) = args.layer.as_ref().filter(|_| !is_exr(&args.a) && !is_exr(&args.b)) {
        let (a, b) = (args.a.display(), args.b.display());
        return Err(Error::invalid(format!(
            "--layer {layer}: EXR files alone have layers, and neither {a} nor {b} is one"
        )));
    }
    let read = |path: &Path| match &args.layer {
        Some(layer) => io::read_layer(path, layer),
        None => io::read(path),
    };
    let (a, b) = (read(&args.a)?, read(&args.b)?);
    let bad = [&a, &b].map(NonFinite::of);
    if bad.iter().any(|bad| bad.count > 0) {
        return not_finite(args, bad, console);
    }
    // The library does not know the names of the pictures.
    let named = |error: Error| match error {
        Error::Invalid { cause } => Error::invalid(format!("{} and {}: {cause}", args.a.display(), args.b.display())),
        other => other,
    };
    let m = metrics::compare(&a, &b).map_err(named)?;
    // The two that take time are left out where nobody asks.
    let wanted = |metric| args.metric.is_none_or(|asked| asked == metric);
    let flip = wanted(Metric::Flip).then(|| flip::compare(&a, &b));
    let hdr = wanted(Metric::HdrFlip) || args.exposure_map.is_some();
    let hdr = hdr.then(|| exposed(&a, &b, console));
    // Who asked for everything gets everything else.
    let spare = args.metric.is_none() && args.exposure_map.is_none();
    let flip = flip.and_then(|found| unless_too_large(found, spare, console)).transpose().map_err(named)?;
    let hdr = hdr.and_then(|found| unless_too_large(found, spare, console)).transpose().map_err(named)?;
    let mean = |map: Option<&flip::ErrorMap>| map.map_or(f64::NAN, flip::ErrorMap::mean);
    let values = [
        (Metric::Rmse, "rmse", m.rmse),
        (Metric::Mse, "mse", m.mse),
        (Metric::Relmse, "relmse", m.rel_mse),
        (Metric::RelmseRousselle, "relmse-rousselle", m.rel_mse_rousselle),
        (Metric::Mae, "mae", m.mae),
        (Metric::Max, "max", m.max),
        (Metric::Psnr, "psnr", m.psnr),
        (Metric::Flip, "flip", mean(flip.as_ref())),
        (Metric::HdrFlip, "hdr-flip", mean(hdr.as_ref().map(|h| &h.map))),
        (Metric::Above1, "above1", m.above_1_percent),
        (Metric::Above01, "above01", m.above_01_percent),
        (Metric::Differing, "differing", m.differing),
        (Metric::MeanRatio, "mean-ratio", m.mean_ratio),
    ];
    // What was left out is NaN, which no other value is.
    let shown = values.iter().filter(|(metric, _, value)| wanted(*metric) && !value.is_nan());
    match args.format {
        Format::Json => {
            let fields: Map<String, Value> = shown.map(|(_, name, value)| (name.to_string(), json!(value))).collect();
            console.json(&document(SCHEMA, Value::Object(fields)))?;
        }
        form => {
            let mut table = Table::new(&["<metric", "value"]);
            shown.for_each(|(_, name, value)| table.row(vec![name.to_string(), format!("{value:.6e}")]));
            console.data(&if form == Format::Csv { table.csv() } else { table.text() })?;
        }
    }
    if let Some(found) = &hdr {
        let hdr::Exposures { start, stop, count } = found.exposures;
        console.note(format!("hdr-flip over {count} exposures from {start:.4} to {stop:.4} stops"));
    }
    let metric = args.metric.unwrap_or(Metric::Rmse);
    if let Some(out) = &args.out {
        let errors = match metric {
            Metric::Flip => flip.as_ref(),
            Metric::HdrFlip => hdr.as_ref().map(|h| &h.map),
            _ => None,
        };
        let map = match errors {
            Some(map) => coloured(&a, map.errors.iter().copied()),
            None => falsecolour::difference(&a, &b).map_err(named)?,
        };
        io::write(out, &map, &Attributes::default())?;
    }
    if let (Some(out), Some(found)) = (&args.exposure_map, &hdr) {
        let last = (found.exposures.count - 1) as f32;
        io::write(out, &coloured(&a, found.worst.iter().map(|&i| i as f32 / last)), &Attributes::default())?;
    }
    let Some((_, name, value)) = values.iter().find(|(m, ..)| *m == metric) else { return Ok(Outcome::Done) };
    let above = args.fail_above.filter(|bound| value > bound).map(|bound| format!("above {bound:e}"));
    let below = args.fail_below.filter(|bound| value < bound).map(|bound| format!("below {bound:e}"));
    let Some(side) = above.or(below) else { return Ok(Outcome::Done) };
    console.note(format!("{name} is {value:.6e}, {side}"));
    Ok(Outcome::CheckFailed)
}

/// What was found; nothing but a warning if it takes too much memory and can be spared.
fn unless_too_large<T>(found: Result<T>, spare: bool, console: &Console) -> Option<Result<T>> {
    match found {
        Err(error @ Error::TooLarge { .. }) if spare => {
            console.warn(format!("left out: {error}"));
            None
        }
        other => Some(other),
    }
}

/// HDR-FLIP with a bar.
fn exposed(a: &Picture, b: &Picture, console: &Console) -> Result<hdr::Comparison> {
    let progress = console.progress("exposures");
    hdr::compare(a, b, &|done, all| progress.at(done.into(), all.into(), "exposures"))
}

/// `levels` of 0 to 1, one for each pixel of `like`, in colours.
fn coloured(like: &Picture, levels: impl Iterator<Item = f32>) -> Picture {
    Picture { width: like.width, height: like.height, pixels: levels.map(falsecolour::colour).collect() }
}

/// Says how many pixels of each picture are not finite, and where the first one is.
fn not_finite(args: &Args, bad: [NonFinite; 2], console: &Console) -> Result<Outcome> {
    let both = || [&args.a, &args.b].into_iter().zip(bad);
    match args.format {
        Format::Json => {
            console.json(&document(SCHEMA, json!({ "not_finite": { "a": bad[0], "b": bad[1] } })))?;
        }
        form => {
            let mut table = Table::new(&["<picture", "not finite", "NaN", "column", "row"]);
            for (path, bad) in both() {
                let place = |get: fn((u32, u32)) -> u32| bad.first.map_or(String::new(), |at| get(at).to_string());
                let counts = [bad.count, bad.nan].map(|n| n.to_string());
                let [all, nan] = counts;
                table.row(vec![path.display().to_string(), all, nan, place(|at| at.0), place(|at| at.1)]);
            }
            console.data(&if form == Format::Csv { table.csv() } else { table.text() })?;
        }
    }
    for (path, bad) in both() {
        bad.complaint(&path.display().to_string()).into_iter().for_each(|words| console.note(words));
    }
    Ok(Outcome::CheckFailed)
}

fn is_exr(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr"))
}

/// A number of at least 0.
fn parse_bound(text: &str) -> std::result::Result<f64, String> {
    match text.parse() {
        Ok(bound) if bound >= 0.0 => Ok(bound),
        _ => Err("not a number of at least 0".into()),
    }
}
