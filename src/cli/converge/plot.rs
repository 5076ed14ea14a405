//! Error over seconds as a picture.

use crate::converge::{Clock, Point, Study};
use crate::papers::plot::{Curve, Curves, Plane, Plot, Spread};

/// Mean squared error over seconds, both logarithmic; a dashed line falls as 1 / seconds.
pub fn curves(study: &Study, scene: &str) -> Plot {
    let spread = |p: &Point| {
        let y = p.mse();
        let (low, high) = p.mse_interval().map_or((y, y), |i| (i.low, i.high));
        Spread { x: p.seconds(), y, low, high }
    };
    let curve =
        |(series, c): (usize, &crate::converge::Curve)| Curve { series, points: c.points.iter().map(spread).collect() };
    let name = |c: &crate::converge::Curve| match c.clock {
        Clock::Processor => c.name.clone(),
        Clock::Wall => format!("{} (wall time, one thread)", c.name),
    };
    let options = &study.options;
    Plot::Curves(Curves {
        title: format!("Error over time: {scene}"),
        subtitle: format!(
            "{} x {} pixels, 2 to {} samples, {} replicates, bands: 95 % t intervals; {}",
            options.width, options.height, options.samples, options.replicates, study.machine
        ),
        series: study.curves.iter().map(name).collect(),
        planes: vec![Plane {
            title: "Mean squared error".into(),
            x: "seconds, build included".into(),
            y: "MSE, linear RGB".into(),
            curves: study.curves.iter().enumerate().map(curve).collect(),
            guide: Some((-1.0, "1 / seconds".into())),
        }],
        columns: 1,
        size: (640.0, 400.0),
    })
}
