//! Time over subdivision: the figure of Amanatides & Woo 1987 for any scene.

use crate::measure::{Axis, Sweep};
use crate::papers::plot::{Curve, Curves, Plane, Plot, Spread};

/// A panel for each kind of rays, and a row of them for each option that is a number; bands are the spread of the rounds.
pub fn planes(sweep: &Sweep, scene: &str, rounds: u32) -> Plot {
    let axes = [
        (Axis::Density, "density: voxels a primitive"),
        (Axis::Leap, "threshold: least distance worth a leap"),
        (Axis::Leaf, "leaf: longest list that is not split"),
    ];
    let swept = axes.iter().filter(|(axis, _)| sweep.settings.iter().any(|s| s.axis == Some(*axis)));
    let planes = swept.flat_map(|(axis, x)| {
        sweep.kinds.iter().enumerate().map(move |(k, kind)| Plane {
            title: format!("{} rays over {}", kind.kind.name(), axis.name()),
            x: x.to_string(),
            y: "nanoseconds a ray".into(),
            curves: (0..sweep.accels.len())
                .map(|accel| curve(sweep, accel, *axis, k))
                .filter(|c| !c.points.is_empty())
                .collect(),
            guide: None,
        })
    });
    Plot::Curves(Curves {
        title: format!("Time over subdivision: {scene}"),
        subtitle: format!(
            "{} primitives, medians of {rounds} rounds, bands: half their range; {}",
            sweep.primitives, sweep.machine
        ),
        series: sweep.accels.clone(),
        planes: planes.collect(),
        columns: sweep.kinds.len().max(1),
        size: (300.0, 220.0),
    })
}

fn curve(sweep: &Sweep, accel: usize, axis: Axis, kind: usize) -> Curve {
    let settings = sweep.settings.iter().filter(|s| s.accel == accel && s.axis == Some(axis));
    let mut points: Vec<Spread> = settings
        .filter_map(|s| {
            let (rate, x) = (s.rates[kind]?, s.value.parse().ok()?);
            let y = 1e9 / rate.rays_per_second;
            Some(Spread { x, y, low: y / (1.0 + rate.spread), high: y * (1.0 + rate.spread) })
        })
        .collect();
    points.sort_by(|a, b| a.x.total_cmp(&b.x));
    Curve { series: accel, points }
}
