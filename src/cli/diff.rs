//! `skipgrid diff`: how far two pictures are apart.

use super::Outcome;
use super::console::{Console, Format};
use super::input::check_picture;
use super::table::Table;
use crate::error::{Error, Result};
use crate::picture::io::{self, Attributes};
use crate::picture::{Picture, falsecolour, flip, metrics};
use serde_json::{Map, Value, json};
use std::path::PathBuf;

const DETAILS: &str = "\
Pictures are .exr, .png or .pfm and compared in linear RGB. A pixel that is not finite is an error, never \"equal\".
The map of `flip` shows its error, that of every other metric the difference relative to B, black for 1e-5 and less, \
white for 1 and more.

Examples:
  skipgrid diff ours.exr theirs.exr
  skipgrid diff ours.exr theirs.exr --metric relmse --fail-above 1e-3 -o difference.png";

/// Compare two pictures: RMSE, relMSE, FLIP and more
#[derive(Debug, clap::Args)]
#[command(after_help = DETAILS)]
pub struct Args {
    /// The picture in question
    a: PathBuf,

    /// The reference
    b: PathBuf,

    /// Print this metric alone, and hold it against --fail-above; default: print all, hold rmse against it
    #[arg(long, value_enum)]
    metric: Option<Metric>,

    /// End with exit code 1 if the metric is above this
    #[arg(long, value_name = "X", value_parser = parse_bound)]
    fail_above: Option<f64>,

    /// Where a map of the differences goes: .png, .exr or .pfm
    #[arg(long = "output", short = 'o', value_name = "MAP")]
    out: Option<PathBuf>,

    /// Form of the answer
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// 0 for equal pictures, all of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Metric {
    /// Root of the mean squared difference
    Rmse,
    /// Mean of (a - b)^2
    Mse,
    /// Mean of (a - b)^2 / (b + 0.01)^2, as pbrt's MRSE
    Relmse,
    /// Mean of |a - b|
    Mae,
    /// Largest |a - b|
    Max,
    /// Mean FLIP error at 67 pixels a degree, of pictures clamped to 0..1
    Flip,
    /// Share of pixels that differ by more than 1 %
    Above1,
    /// Share of pixels that differ by more than 0.1 %
    Above01,
}

/// Compares and prints.
pub fn run(args: &Args, console: &Console) -> Result<Outcome> {
    args.out.as_deref().map(check_picture).transpose()?;
    let (a, b) = (io::read(&args.a)?, io::read(&args.b)?);
    // The library does not know the names of the pictures.
    let named = |error: Error| match error {
        Error::Invalid { cause } => Error::invalid(format!("{} and {}: {cause}", args.a.display(), args.b.display())),
        other => other,
    };
    let m = metrics::compare(&a, &b).map_err(named)?;
    let map = flip::compare(&a, &b).map_err(named)?;
    let values = [
        (Metric::Rmse, "rmse", m.rmse),
        (Metric::Mse, "mse", m.mse),
        (Metric::Relmse, "relmse", m.rel_mse),
        (Metric::Mae, "mae", m.mae),
        (Metric::Max, "max", m.max),
        (Metric::Flip, "flip", map.mean()),
        (Metric::Above1, "above1", m.above_1_percent),
        (Metric::Above01, "above01", m.above_01_percent),
    ];
    let shown = values.iter().filter(|(metric, ..)| args.metric.is_none_or(|asked| asked == *metric));
    match args.format {
        Format::Json => {
            let fields: Map<String, Value> = shown.map(|(_, name, value)| (name.to_string(), json!(value))).collect();
            console.json(&Value::Object(fields))?;
        }
        form => {
            let mut table = Table::new(&["<metric", "value"]);
            shown.for_each(|(_, name, value)| table.row(vec![name.to_string(), format!("{value:.6e}")]));
            console.data(&if form == Format::Csv { table.csv() } else { table.text() })?;
        }
    }
    let metric = args.metric.unwrap_or(Metric::Rmse);
    if let Some(out) = &args.out {
        let map = if metric == Metric::Flip {
            let pixels = map.errors.iter().map(|&error| falsecolour::colour(error)).collect();
            Picture { width: map.width, height: map.height, pixels }
        } else {
            falsecolour::difference(&a, &b).map_err(named)?
        };
        io::write(out, &map, &Attributes::default())?;
    }
    let exceeded = values.iter().find(|(m, ..)| *m == metric).zip(args.fail_above).filter(|((.., v), x)| v > x);
    let Some(((_, name, value), bound)) = exceeded else { return Ok(Outcome::Done) };
    console.note(format!("{name} is {value:.6e}, above {bound:e}"));
    Ok(Outcome::CheckFailed)
}

/// A number of at least 0.
fn parse_bound(text: &str) -> std::result::Result<f64, String> {
    match text.parse() {
        Ok(bound) if bound >= 0.0 => Ok(bound),
        _ => Err("not a number of at least 0".into()),
    }
}
