//! Lines over a logarithmic plane, named at their ends.

use super::scale::Scale;
use super::{Anchor, COLOURS, LETTER, Svg};
use crate::papers::report::significant;

/// A plane with two logarithmic scales.
#[derive(Clone, Debug)]
pub struct Lines {
    /// Headline.
    pub title: String,
    /// A line below it.
    pub subtitle: String,
    /// Name of the horizontal scale, with unit.
    pub x: String,
    /// Name of the vertical scale, with unit.
    pub y: String,
    /// The lines.
    pub lines: Vec<Line>,
}

/// A named line.
#[derive(Clone, Debug)]
pub struct Line {
    /// Name.
    pub name: String,
    /// Points from left to right; those that are not finite and above 0 are left out.
    pub points: Vec<(f64, f64)>,
}

const WIDTH: f64 = 780.0;
const HEIGHT: f64 = 500.0;
/// Of the plane.
const LEFT: f64 = 70.0;
const TOP: f64 = 100.0;
const BOTTOM: f64 = HEIGHT - 60.0;

impl Lines {
    pub(super) fn svg(&self) -> String {
        let names = LETTER * self.lines.iter().map(|l| l.name.chars().count()).max().unwrap_or(0) as f64;
        let right = WIDTH - 40.0 - names;
        let points = || self.lines.iter().flat_map(|l| l.points.iter());
        let across = Scale::new(points().map(|p| p.0), LEFT, right);
        let up = Scale::new(points().map(|p| p.1), BOTTOM, TOP);
        let mut svg = Svg::headed(WIDTH, HEIGHT, &self.title, &self.subtitle);
        for tick in &across.ticks {
            let Some(x) = across.at(*tick) else { continue };
            svg.line((x, TOP), (x, BOTTOM), "grid");
            svg.text((x, BOTTOM + 16.0), Anchor::Middle, "tick", &Scale::label(*tick));
        }
        for tick in &up.ticks {
            let Some(y) = up.at(*tick) else { continue };
            svg.line((LEFT, y), (right, y), "grid");
            svg.text((LEFT - 8.0, y + 4.0), Anchor::End, "tick", &Scale::label(*tick));
        }
        svg.line((LEFT, BOTTOM), (right, BOTTOM), "axis");
        svg.line((LEFT, TOP), (LEFT, BOTTOM), "axis");
        svg.text(((LEFT + right) / 2.0, HEIGHT - 20.0), Anchor::Middle, "", &self.x);
        svg.text((20.0, TOP - 14.0), Anchor::Start, "", &self.y);

        // Heights of the names: pushed apart where the ends are near.
        let mut ends: Vec<(f64, usize)> = Vec::new();
        for (i, line) in self.lines.iter().enumerate() {
            let place = |&(x, y): &(f64, f64)| Some((across.at(x)?, up.at(y)?));
            let places: Vec<(f64, f64)> = line.points.iter().filter_map(place).collect();
            let path: Vec<String> = places.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
            let colour = COLOURS[i % COLOURS.len()];
            svg.add(format_args!(
                "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.6\"/>",
                path.join(" ")
            ));
            for ((x, y), value) in places.iter().zip(line.points.iter().filter(|p| place(p).is_some())) {
                let words = format!("{} at {}: {}", line.name, significant(value.0), significant(value.1));
                svg.mark((*x, *y), i, &words);
            }
            ends.extend(places.last().map(|end| (end.1, i)));
        }
        ends.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut lowest = f64::NEG_INFINITY;
        for (y, i) in ends {
            lowest = y.max(lowest + 15.0);
            svg.mark((right + 14.0, lowest), i, &self.lines[i].name);
            svg.text((right + 24.0, lowest + 4.0), Anchor::Start, "", &self.lines[i].name);
        }
        svg.finish()
    }
}
