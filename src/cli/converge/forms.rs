//! Error against run time as text, CSV and JSON.

use crate::cli::document::measured;
use crate::cli::table::{Table, exact, short};
use crate::converge::{Clock, Crossover, Curve, Point, Reach, Study};
use crate::papers::report::significant as seconds;
use serde_json::{Value, json};

/// Three significant digits with an exponent; `-` if there is no such number.
fn small(value: impl Into<Option<f64>>) -> String {
    match value.into() {
        Some(v) if v.is_finite() => format!("{v:.2e}"),
        _ => "-".to_string(),
    }
}

/// Tables for people.
pub(super) fn text(study: &Study, scene: &str, targets: &[f64]) -> String {
    let options = &study.options;
    let integrator = format!("{:?}", options.integrator).to_lowercase();
    let mut out = format!(
        "skipgrid {}: error against run time, {scene}, {} primitives\n{}\n{integrator}, {} x {} pixels, depth {}, seed {}, {} \
         replicates\n",
        env!("CARGO_PKG_VERSION"),
        study.primitives,
        study.machine,
        options.width,
        options.height,
        options.max_depth,
        options.seed,
        options.replicates
    );
    out += &match study.reference.variance {
        Some(v) => format!("reference: its own variance is {} and is part of every MSE below\n\n", small(v)),
        None => "reference: its own noise is not known and is part of every MSE and bias^2 below\n\n".to_string(),
    };
    out += &points(study).text();
    out += "\nMSE with the ends of its 95 % t interval, bias^2 with half of its own; seconds of ours: processor time of all threads, of others: wall time\n";
    out += "on one thread; efficiency: 1 / (MSE * seconds), build included\n\n";
    out += &lines(study).text();
    if !targets.is_empty() {
        out += "\nUntil the MSE, without the reference's own variance, comes down to\n\n";
        out += &reached(study, targets).text();
    }
    out += &crossovers(study);
    if !study.equal_time.is_empty() {
        let mut table = Table::new(&["<equal time", "samples", "seconds", "MSE"]);
        for shot in &study.equal_time {
            let cells = match shot.picture {
                Some(_) => [shot.samples.to_string(), seconds(shot.seconds), small(shot.mse)],
                None => ["0".into(), "-".into(), "-".into()],
            };
            table.row([vec![shot.name.clone()], cells.to_vec()].concat());
        }
        out += &format!("\n{}", table.text());
    }
    for version in &study.versions {
        out += &format!("\n{version}");
    }
    out + &verdict(study)
}

fn verdict(study: &Study) -> String {
    let exact = study.curves.iter().filter(|c| c.exact).count();
    let mut out = match study.differences.first() {
        Some(first) => format!("\nDIFFERENT PICTURES: {} times; {first}\n", study.differences.len()),
        None if exact > 1 => {
            format!(
                "\nidentical pictures: those of {exact} accelerators are equal to the bit at every number of samples\n"
            )
        }
        None => "\nno two accelerators promise exact answers: no pictures to compare bit by bit\n".to_string(),
    };
    if study.interrupted {
        out += "interrupted: numbers of samples are missing\n";
    }
    out
}

/// One line for each curve and number of samples.
fn points(study: &Study) -> Table {
    let mut table = Table::new(&[
        "<renderer",
        "spp",
        "build s",
        "trace s",
        "MSE",
        "low",
        "high",
        "relMSE",
        "variance",
        "bias^2",
        "+-",
        "efficiency",
    ]);
    for (curve, point) in all(study) {
        let (interval, bias) = (point.mse_interval(), point.bias(&study.reference));
        table.row(vec![
            curve.name.clone(),
            point.samples.to_string(),
            seconds(point.build()),
            seconds(point.trace()),
            small(point.mse()),
            small(interval.map(|i| i.low)),
            small(interval.map(|i| i.high)),
            small(point.rel_mse()),
            small(point.variance()),
            small(bias.square),
            small(bias.error),
            short(point.efficiency()),
        ]);
    }
    table
}

/// Time as a line over samples, and the slope of the error.
fn lines(study: &Study) -> Table {
    let mut table = Table::new(&["<renderer", "fixed s", "s/spp", "over the first", "<clock", "MSE falls as spp^"]);
    let first = study.curves.first().and_then(Curve::cost);
    for curve in &study.curves {
        let Some(cost) = curve.cost() else { continue };
        let slope = curve.slope(&study.reference).map_or("-".to_string(), |s| format!("{s:.2}"));
        let ratio =
            first.filter(|_| curve.clock == Clock::Processor).map_or(f64::NAN, |f| cost.per_sample / f.per_sample);
        let name = curve.name.clone();
        let fixed = seconds(cost.fixed);
        table.row(vec![name, fixed, seconds(cost.per_sample), short(ratio), curve.clock.name().into(), slope]);
    }
    table
}

fn reached(study: &Study, targets: &[f64]) -> Table {
    let mut table = Table::new(&["<renderer", "MSE", "spp", "seconds", "<how"]);
    for curve in &study.curves {
        for &target in targets {
            let (samples, time, how) = match curve.reaches(target, &study.reference) {
                Some(Reach::Measured { samples, seconds: s }) => (short(samples), seconds(s), "measured".to_string()),
                Some(Reach::Extrapolated { samples, seconds: s }) => {
                    (short(samples), seconds(s), "extrapolated as 1/spp".to_string())
                }
                Some(Reach::Never { bias }) => ("-".into(), "-".into(), format!("never: bias^2 is {}", small(bias))),
                None => continue,
            };
            table.row(vec![curve.name.clone(), small(target), samples, time, how]);
        }
    }
    table
}

/// A sentence for each pair of accelerators.
fn crossovers(study: &Study) -> String {
    let mut out = String::new();
    for first in study.own() {
        for second in first + 1..study.own().end {
            let Some((all, each)) = study.crossover(first, second) else { continue };
            let names = [&study.curves[first].name, &study.curves[second].name];
            out += "\n";
            out += &match all {
                Crossover::Never { faster } => {
                    format!(
                        "{} is faster than {} at every number of samples: they never cross",
                        names[faster],
                        names[1 - faster]
                    )
                }
                Crossover::At { samples, beyond } => {
                    format!("{} overtakes {} at {} samples a pixel", names[beyond], names[1 - beyond], short(samples))
                }
                Crossover::Equal => format!("{} and {} take the same time", names[0], names[1]),
            };
            out += &range(&all, &each);
        }
    }
    if out.is_empty() { out } else { out + "\n" }
}

/// What the replicates say on their own.
fn range(all: &Crossover, each: &[Crossover]) -> String {
    let end = |c: &Crossover| match (*all, *c) {
        (Crossover::At { beyond, .. }, Crossover::At { samples, beyond: b }) if b == beyond => Some(samples),
        (Crossover::Never { faster }, Crossover::Never { faster: f }) if f == faster => Some(f64::NAN),
        _ => None,
    };
    let alike: Vec<f64> = each.iter().filter_map(end).collect();
    let (low, high) = alike.iter().fold((f64::INFINITY, 0.0f64), |(a, b), s| (a.min(*s), b.max(*s)));
    let count = format!("{} of {} replicates say so alone", alike.len(), each.len());
    if low <= high { format!(" ({count}: {} to {})", short(low), short(high)) } else { format!(" ({count})") }
}

fn all(study: &Study) -> impl Iterator<Item = (&Curve, &Point)> {
    study.curves.iter().flat_map(|curve| curve.points.iter().map(move |point| (curve, point)))
}

/// One line for each curve and number of samples, all digits.
pub(super) fn csv(study: &Study, scene: &str) -> String {
    let mut table = Table::new(&[
        "<scene",
        "<accelerator",
        "spp",
        "replicates",
        "<clock",
        "seconds_total",
        "seconds_build",
        "seconds_trace",
        "seconds_wall",
        "mse",
        "mse_low",
        "mse_high",
        "rel_mse",
        "variance",
        "bias2",
        "bias2_error",
        "reference_variance",
        "efficiency",
    ]);
    for (curve, point) in all(study) {
        let (interval, bias) = (point.mse_interval(), point.bias(&study.reference));
        let mut cells = vec![scene.to_string(), curve.name.clone(), point.samples.to_string()];
        cells.extend([point.trials.len().to_string(), curve.clock.name().to_string()]);
        cells.extend([point.seconds(), point.build(), point.trace(), point.wall(), point.mse()].map(exact));
        cells.extend(
            [interval.map(|i| i.low), interval.map(|i| i.high), Some(point.rel_mse()), point.variance()].map(exact),
        );
        cells.extend([Some(bias.square), Some(bias.error), study.reference.variance].map(exact));
        cells.push(exact(point.efficiency()));
        table.row(cells);
    }
    table.csv()
}

/// Everything.
pub(super) fn json(study: &Study, scene: &str, targets: &[f64]) -> Value {
    let options = &study.options;
    let curves: Vec<Value> = study.curves.iter().map(|curve| of_curve(study, curve, targets)).collect();
    let pairs = study.own().flat_map(|a| (a + 1..study.own().end).map(move |b| (a, b)));
    let crossovers: Vec<Value> = pairs
        .filter_map(|(a, b)| {
            let (all, each) = study.crossover(a, b)?;
            let names = [&study.curves[a].name, &study.curves[b].name];
            let of = |c: &Crossover| match *c {
                Crossover::Never { faster } => json!({ "samples": null, "faster": names[faster] }),
                Crossover::At { samples, beyond } => json!({ "samples": samples, "faster_beyond": names[beyond] }),
                Crossover::Equal => json!({ "samples": null, "faster": null }),
            };
            let each: Vec<Value> = each.iter().map(of).collect();
            Some(json!({ "between": names, "all": of(&all), "replicates": each }))
        })
        .collect();
    let shots = study.equal_time.iter().map(|s| {
        json!({ "renderer": s.name, "samples": s.samples, "seconds": s.seconds, "mse": s.picture.as_ref().map(|_| s.mse) })
    });
    let body = json!({
        "scene": scene,
        "primitives": study.primitives,
        "machine": study.machine.to_string(),
        "integrator": format!("{:?}", options.integrator).to_lowercase(),
        "size": [options.width, options.height],
        "max_depth": options.max_depth,
        "seed": options.seed,
        "replicates": options.replicates,
        "reference_variance": study.reference.variance,
        "reference_variance_error": study.reference.variance_error,
        "curves": curves,
        "crossovers": crossovers,
        "equal_time": shots.collect::<Vec<Value>>(),
        "versions": study.versions,
        "left_out": study.left_out,
        "warnings": study.warnings,
        "identical": study.identical(),
        "differences": study.differences.iter().map(ToString::to_string).collect::<Vec<_>>(),
        "interrupted": study.interrupted,
    });
    measured("skipgrid.converge/1", &study.machine, body)
}

fn of_curve(study: &Study, curve: &Curve, targets: &[f64]) -> Value {
    let points: Vec<Value> = curve
        .points
        .iter()
        .map(|point| {
            let (interval, bias) = (point.mse_interval(), point.bias(&study.reference));
            let trials: Vec<Value> = point
                .trials
                .iter()
                .map(|t| {
                    let e = &t.errors;
                    json!({ "build": t.build, "trace": t.trace, "wall": t.wall, "mse": e.mse, "rel_mse": e.rel_mse, "variance": e.variance })
                })
                .collect();
            json!({
                "spp": point.samples,
                "seconds": point.seconds(),
                "mse": point.mse(),
                "mse_interval": interval.map(|i| [i.low, i.high]),
                "rel_mse": point.rel_mse(),
                "variance": point.variance(),
                "bias2": bias.square,
                "bias2_error": bias.error,
                "efficiency": point.efficiency(),
                "replicates": trials,
            })
        })
        .collect();
    let targets: Vec<Value> = targets
        .iter()
        .filter_map(|&target| {
            Some(match curve.reaches(target, &study.reference)? {
                Reach::Measured { samples, seconds } => {
                    json!({ "mse": target, "spp": samples, "seconds": seconds, "how": "measured" })
                }
                Reach::Extrapolated { samples, seconds } => {
                    json!({ "mse": target, "spp": samples, "seconds": seconds, "how": "extrapolated" })
                }
                Reach::Never { bias } => json!({ "mse": target, "spp": null, "how": "never", "bias2": bias }),
            })
        })
        .collect();
    let cost = curve.cost();
    json!({
        "renderer": curve.name,
        "clock": curve.clock.name(),
        "exact": curve.exact,
        "fixed_seconds": cost.map(|c| c.fixed),
        "seconds_per_sample": cost.map(|c| c.per_sample),
        "slope": curve.slope(&study.reference),
        "points": points,
        "targets": targets,
    })
}
