//! Groups of bars, side by side for several measures.

use super::{Anchor, COLOURS, LETTER, MARGIN, Svg, escaped, heading_width};
use crate::papers::report::significant;

/// Labelled bars in groups; every group has a scale of its own in each column, from 0 to its longest bar.
#[derive(Clone, Debug)]
pub struct Bars {
    /// Headline.
    pub title: String,
    /// A line below it.
    pub subtitle: String,
    /// Names of the columns.
    pub columns: Vec<String>,
    /// The groups, from the top.
    pub groups: Vec<Group>,
}

/// Bars with a headline.
#[derive(Clone, Debug)]
pub struct Group {
    /// Headline.
    pub title: String,
    /// Label, number of the colour, and a length for each column; lengths that are not finite and above 0 get no bar.
    pub rows: Vec<(String, usize, Vec<f64>)>,
}

/// Height of a row, pixels.
const ROW: f64 = 15.0;
/// Longest bar.
const LONGEST: f64 = 190.0;
/// A column: bar, number and air.
const COLUMN: f64 = LONGEST + 60.0;
/// Above the rows of a group: headline.
const ABOVE: f64 = 30.0;
/// Above all groups: title, subtitle, names of the columns.
const HEAD: f64 = 92.0;

impl Bars {
    pub(super) fn svg(&self) -> String {
        let labels = self.groups.iter().flat_map(|g| &g.rows).map(|(label, ..)| label.chars().count());
        let left = MARGIN + LETTER * labels.max().unwrap_or(0) as f64 + 10.0;
        let words = heading_width(&self.title, &self.subtitle);
        let width = (left + COLUMN * self.columns.len() as f64).max(words) + MARGIN;
        let rows: usize = self.groups.iter().map(|g| g.rows.len()).sum();
        let height = HEAD + ABOVE * self.groups.len() as f64 + ROW * rows as f64 + MARGIN;
        let mut svg = Svg::headed(width, height, &self.title, &self.subtitle);
        for (c, name) in self.columns.iter().enumerate() {
            svg.text((left + COLUMN * c as f64, 82.0), Anchor::Start, "panel", name);
        }
        let mut top = HEAD;
        for group in &self.groups {
            svg.text((MARGIN, top + ABOVE - 9.0), Anchor::Start, "panel", &group.title);
            top += ABOVE;
            for c in 0..self.columns.len() {
                group.column(&mut svg, c, (left + COLUMN * c as f64, top));
            }
            for (i, (label, ..)) in group.rows.iter().enumerate() {
                svg.text((left - 8.0, top + ROW * i as f64 + 11.0), Anchor::End, "", label);
            }
            top += ROW * group.rows.len() as f64;
        }
        svg.finish()
    }
}

impl Group {
    /// The bars of column `c`; `left` and `top` are of the first.
    fn column(&self, svg: &mut Svg, c: usize, (left, top): (f64, f64)) {
        let value = |values: &[f64]| values.get(c).copied().filter(|v| v.is_finite() && *v > 0.0);
        let most = self.rows.iter().filter_map(|(.., values)| value(values)).fold(0.0, f64::max);
        for (i, (label, colour, values)) in self.rows.iter().enumerate() {
            let Some(value) = value(values) else { continue };
            let (long, y) = (LONGEST * value / most, top + ROW * i as f64);
            let (colour, number) = (COLOURS[colour % COLOURS.len()], significant(value));
            let words = escaped(&format!("{}, {label}: {number}", self.title));
            svg.add(format_args!(
                "<rect x=\"{left:.1}\" y=\"{:.1}\" width=\"{long:.1}\" height=\"{:.1}\" fill=\"{colour}\"><title>{words}\
                 </title></rect>",
                y + 1.5,
                ROW - 3.0
            ));
            svg.text((left + long + 4.0, y + 11.0), Anchor::Start, "tick", &number);
        }
        let bottom = top + ROW * self.rows.len() as f64;
        svg.line((left, top), (left, bottom), "axis");
    }
}
