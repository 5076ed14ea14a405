//! Panels of labelled rows with a dot for each series.

use super::scale::Scale;
use super::{Anchor, LETTER, MARGIN, Svg, heading_width, key_width};
use crate::papers::report::significant;

/// Small multiples: every panel has the same series, and a scale of its own.
#[derive(Clone, Debug)]
pub struct Dots {
    /// Headline.
    pub title: String,
    /// A line below it.
    pub subtitle: String,
    /// Names of the series.
    pub series: Vec<String>,
    /// The panels, row by row.
    pub panels: Vec<Panel>,
    /// Panels side by side, at least 1.
    pub columns: usize,
}

/// One scale with its rows.
#[derive(Clone, Debug)]
pub struct Panel {
    /// Headline with the unit.
    pub title: String,
    /// Label and a value for each series; values that are not finite and above 0 get no dot.
    pub rows: Vec<(String, Vec<f64>)>,
}

/// Height of a row, pixels.
const ROW: f64 = 19.0;
/// Width of a panel's scale.
const SCALE: f64 = 280.0;
/// Above the rows of a panel: headline.
const ABOVE: f64 = 26.0;
/// Below them: tick labels and air.
const BELOW: f64 = 40.0;
/// Above all panels: title, subtitle, legend.
const HEAD: f64 = 96.0;

impl Dots {
    pub(super) fn svg(&self) -> String {
        let labels = || self.panels.iter().flat_map(|p| &p.rows).map(|(label, _)| label.chars().count());
        let label = LETTER * labels().max().unwrap_or(0) as f64 + 10.0;
        let columns = self.columns.clamp(1, self.panels.len().max(1));
        let across = label + SCALE + 30.0;
        let height = |row: &[Panel]| ABOVE + BELOW + ROW * row.iter().map(|p| p.rows.len()).max().unwrap_or(0) as f64;
        let legend: f64 = self.series.iter().map(|s| key_width(s)).sum();
        let words = heading_width(&self.title, &self.subtitle);
        let width = (2.0 * MARGIN + across * columns as f64).max(2.0 * MARGIN + legend.max(words));
        let all: f64 = self.panels.chunks(columns).map(height).sum();
        let mut svg = Svg::headed(width, HEAD + all + MARGIN, &self.title, &self.subtitle);
        let mut x = MARGIN;
        for (i, name) in self.series.iter().enumerate() {
            svg.key((x, 66.0), i, name);
            x += key_width(name);
        }
        let mut top = HEAD;
        for row in self.panels.chunks(columns) {
            for (i, panel) in row.iter().enumerate() {
                self.panel(&mut svg, panel, (MARGIN + across * i as f64 + label, top + ABOVE));
            }
            top += height(row);
        }
        svg.finish()
    }

    /// `left` and `top` are of the area of the dots.
    fn panel(&self, svg: &mut Svg, panel: &Panel, (left, top): (f64, f64)) {
        let scale = Scale::new(panel.rows.iter().flat_map(|(_, v)| v.iter().copied()), left, left + SCALE);
        let bottom = top + ROW * panel.rows.len() as f64;
        svg.text((left, top - 8.0), Anchor::Start, "panel", &panel.title);
        let mut labelled = f64::NEG_INFINITY;
        for tick in &scale.ticks {
            let Some(x) = scale.at(*tick) else { continue };
            svg.line((x, top), (x, bottom), "grid");
            let label = Scale::label(*tick);
            let half = LETTER * label.chars().count() as f64 / 2.0;
            if x - half > labelled + 4.0 {
                svg.text((x, bottom + 15.0), Anchor::Middle, "tick", &label);
                labelled = x + half;
            }
        }
        svg.line((left, bottom), (left + SCALE, bottom), "axis");
        for (i, (label, values)) in panel.rows.iter().enumerate() {
            let y = top + ROW * (i as f64 + 0.5);
            svg.line((left, y), (left + SCALE, y), "grid");
            svg.text((left - 8.0, y + 4.0), Anchor::End, "", label);
            let places: Vec<Option<f64>> = values.iter().map(|v| scale.at(*v)).collect();
            let (least, most) =
                places.iter().flatten().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (x.min(a), x.max(b)));
            if least < most {
                svg.line((least, y), (most, y), "span");
            }
            // Side by side, so that no dot hides another.
            let apart = 9.0 / values.len().saturating_sub(1).max(1) as f64;
            for (s, x) in places.iter().enumerate() {
                let Some(x) = *x else { continue };
                let offset = (s as f64 - (values.len() as f64 - 1.0) / 2.0) * apart;
                let series = self.series.get(s).map_or("", String::as_str);
                svg.mark((x, y + offset), s, &format!("{label}, {series}: {}", significant(values[s])));
            }
        }
    }
}
