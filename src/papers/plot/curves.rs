//! Panels of lines over logarithmic planes, with bands around them and guides of a given slope.

use super::scale::Scale;
use super::{Anchor, COLOURS, MARGIN, Svg, heading_width, key_width};
use crate::papers::report::significant;

/// Panels in rows; a legend above names the lines of all.
#[derive(Clone, Debug)]
pub struct Curves {
    /// Headline.
    pub title: String,
    /// A line below it.
    pub subtitle: String,
    /// Names of the series.
    pub series: Vec<String>,
    /// The panels, row by row.
    pub planes: Vec<Plane>,
    /// Panels side by side, at least 1.
    pub columns: usize,
    /// Width and height of a panel's plane, pixels.
    pub size: (f64, f64),
}

/// A panel: two logarithmic scales of its own.
#[derive(Clone, Debug)]
pub struct Plane {
    /// Headline.
    pub title: String,
    /// Name of the horizontal scale, with unit.
    pub x: String,
    /// Name of the vertical scale, with unit.
    pub y: String,
    /// The lines.
    pub curves: Vec<Curve>,
    /// Slope of a dashed line through the lower left of the points, and its name.
    pub guide: Option<(f64, String)>,
}

/// A line of a panel.
#[derive(Clone, Debug)]
pub struct Curve {
    /// Number of its series.
    pub series: usize,
    /// From left to right; numbers that are not finite and above 0 are left out.
    pub points: Vec<Spread>,
}

/// A point with its band.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Place on the horizontal scale.
    pub x: f64,
    /// Place on the vertical scale.
    pub y: f64,
    /// Lower end of the band; that and the next equal to `y` where there is none.
    pub low: f64,
    /// Upper end of the band.
    pub high: f64,
}

/// Left of a plane: tick labels.
const LEFT: f64 = 62.0;
/// Above a plane: headline and name of the vertical scale.
const ABOVE: f64 = 46.0;
/// Below a plane: tick labels and name of the horizontal scale.
const BELOW: f64 = 52.0;
/// Height of the title and the subtitle.
const HEAD: f64 = 66.0;
/// Height of a line of the legend.
const KEYS: f64 = 18.0;

impl Curves {
    pub(super) fn svg(&self) -> String {
        let columns = self.columns.clamp(1, self.planes.len().max(1));
        let (wide, high) = (LEFT + self.size.0 + 16.0, ABOVE + self.size.1 + BELOW);
        let words = heading_width(&self.title, &self.subtitle);
        let width = (wide * columns as f64).max(words) + 2.0 * MARGIN;
        // Places of the legend's entries, line by line.
        let (mut x, mut y, mut keys) = (MARGIN, HEAD, Vec::new());
        for name in &self.series {
            if x > MARGIN && x + key_width(name) > width - MARGIN {
                (x, y) = (MARGIN, y + KEYS);
            }
            keys.push((x, y));
            x += key_width(name);
        }
        let head = y + KEYS;
        let rows = self.planes.len().div_ceil(columns) as f64;
        let mut svg = Svg::headed(width, head + high * rows + MARGIN, &self.title, &self.subtitle);
        for (i, (name, place)) in self.series.iter().zip(keys).enumerate() {
            svg.key(place, i, name);
        }
        for (i, plane) in self.planes.iter().enumerate() {
            let corner = (MARGIN + LEFT + wide * (i % columns) as f64, head + ABOVE + high * (i / columns) as f64);
            plane.draw(&mut svg, corner, self.size, &self.series);
        }
        svg.finish()
    }
}

impl Plane {
    /// `left` and `top` are of the plane.
    fn draw(&self, svg: &mut Svg, (left, top): (f64, f64), (width, height): (f64, f64), series: &[String]) {
        let (right, bottom) = (left + width, top + height);
        let points = || self.curves.iter().flat_map(|c| &c.points);
        let across = Scale::new(points().map(|p| p.x), left, right);
        let up = Scale::new(points().flat_map(|p| [p.y, p.low, p.high]), bottom, top);
        svg.text((left, top - 24.0), Anchor::Start, "panel", &self.title);
        svg.text((left, top - 8.0), Anchor::Start, "tick", &self.y);
        for tick in &across.ticks {
            let Some(x) = across.at(*tick) else { continue };
            svg.line((x, top), (x, bottom), "grid");
            svg.text((x, bottom + 16.0), Anchor::Middle, "tick", &label(*tick));
        }
        for tick in &up.ticks {
            let Some(y) = up.at(*tick) else { continue };
            svg.line((left, y), (right, y), "grid");
            svg.text((left - 8.0, y + 4.0), Anchor::End, "tick", &label(*tick));
        }
        svg.line((left, bottom), (right, bottom), "axis");
        svg.line((left, top), (left, bottom), "axis");
        svg.text(((left + right) / 2.0, bottom + 34.0), Anchor::Middle, "", &self.x);
        self.guide(svg, &across, &up, (top, bottom));
        for curve in &self.curves {
            curve.draw(svg, &across, &up, series.get(curve.series).map_or("", String::as_str));
        }
    }

    /// The dashed line of the guide's slope through the first point, cut at the plane.
    fn guide(&self, svg: &mut Svg, across: &Scale, up: &Scale, (top, bottom): (f64, f64)) {
        let Some((slope, name)) = &self.guide else { return };
        let place = |p: &Spread| Some((across.at(p.x)?, up.at(p.y)?));
        let firsts = self.curves.iter().filter_map(|c| c.points.iter().find(|p| place(p).is_some()));
        let Some(start) = firsts.min_by(|a, b| (a.x * a.y).total_cmp(&(b.x * b.y))) else { return };
        let last = across.ticks.iter().copied().fold(start.x, f64::max);
        // In many short pieces, of which those within the plane are kept.
        let piece = |i: u32| start.x * (last / start.x).powf(f64::from(i) / 64.0);
        let at = |x: f64| Some((across.at(x)?, up.at(start.y * (x / start.x).powf(*slope))?));
        let inside: Vec<(f64, f64)> =
            (0..=64).filter_map(|i| at(piece(i))).filter(|(_, y)| (top..=bottom).contains(y)).collect();
        let path: Vec<String> = inside.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
        let [Some(first), Some(end)] = [path.first(), path.last()] else { return };
        svg.add(format_args!(
            "<polyline points=\"{first} {end}\" fill=\"none\" stroke=\"#888\" stroke-dasharray=\"5 4\"/>"
        ));
        if let Some((x, y)) = inside.get(inside.len() * 3 / 4) {
            svg.text((x - 6.0, y + 14.0), Anchor::End, "tick", name);
        }
    }
}

impl Curve {
    fn draw(&self, svg: &mut Svg, across: &Scale, up: &Scale, name: &str) {
        let colour = COLOURS[self.series % COLOURS.len()];
        let place = |p: &Spread| Some((across.at(p.x)?, [up.at(p.y)?, up.at(p.low)?, up.at(p.high)?]));
        let places: Vec<(f64, [f64; 3])> = self.points.iter().filter_map(place).collect();
        let path = |which: usize| places.iter().map(move |(x, ys)| format!("{x:.1},{:.1}", ys[which]));
        if self.points.iter().any(|p| p.low < p.high) {
            let around: Vec<String> = path(1).chain(path(2).rev()).collect();
            let around = around.join(" ");
            svg.add(format_args!("<polygon points=\"{around}\" fill=\"{colour}\" fill-opacity=\"0.16\"/>"));
        }
        let line = path(0).collect::<Vec<_>>().join(" ");
        svg.add(format_args!("<polyline points=\"{line}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.6\"/>"));
        for p in self.points.iter().filter(|p| place(p).is_some()) {
            let Some((x, [y, ..])) = place(p) else { continue };
            svg.mark((x, y), self.series, &format!("{name} at {}: {}", significant(p.x), label(p.y)));
        }
    }
}

/// A number in a few letters, small ones as powers of ten.
fn label(value: f64) -> String {
    if value < 0.999e-3 { format!("{value:.0e}") } else { Scale::label(value) }
}
