//! Plots as SVG: bars, dots in rows, lines with and without bands, and spots; logarithmic scales, colours and shapes that
//! colour-blind readers can tell apart.

mod bars;
mod curves;
mod dots;
mod lines;
mod scale;
mod scatter;

pub use bars::{Bars, Group};
pub use curves::{Curve, Curves, Plane, Spread};
pub use dots::{Dots, Panel};
pub use lines::{Line, Lines};
pub use scatter::{Scatter, Spot};

use std::fmt::Write as _;

/// What there is to look at.
#[derive(Clone, Debug)]
pub enum Plot {
    /// Groups of bars.
    Bars(Bars),
    /// Panels of lines with bands.
    Curves(Curves),
    /// Panels of rows.
    Dots(Dots),
    /// One panel of lines.
    Lines(Lines),
    /// One panel of spots.
    Scatter(Scatter),
}

impl Plot {
    /// A whole SVG document.
    pub fn svg(&self) -> String {
        match self {
            Plot::Bars(bars) => bars.svg(),
            Plot::Curves(curves) => curves.svg(),
            Plot::Dots(dots) => dots.svg(),
            Plot::Lines(lines) => lines.svg(),
            Plot::Scatter(scatter) => scatter.svg(),
        }
    }
}

/// Okabe & Ito 2008, "Color Universal Design", without the yellow and the black.
const COLOURS: [&str; 6] = ["#0072B2", "#E69F00", "#009E73", "#D55E00", "#CC79A7", "#56B4E9"];

/// Mean width of a letter of 11 pixels' type, pixels; a little more than most.
const LETTER: f64 = 6.4;

/// Around everything, pixels.
const MARGIN: f64 = 20.0;

/// An SVG document in the making. Coordinates are pixels from the top left corner.
struct Svg {
    width: f64,
    height: f64,
    body: String,
}

/// Where text stands relative to its point.
#[derive(Clone, Copy)]
enum Anchor {
    Start,
    Middle,
    End,
}

impl Svg {
    /// A document with a headline and a line below it, which end 54 pixels from the top.
    fn headed(width: f64, height: f64, title: &str, subtitle: &str) -> Self {
        let mut svg = Self { width, height, body: String::new() };
        svg.text((MARGIN, 34.0), Anchor::Start, "title", title);
        svg.text((MARGIN, 54.0), Anchor::Start, "subtitle", subtitle);
        svg
    }

    fn add(&mut self, element: std::fmt::Arguments) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.body, "{element}");
    }

    /// Class `c` is one of the style sheet's.
    fn text(&mut self, (x, y): (f64, f64), anchor: Anchor, class: &str, text: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let text = escaped(text);
        self.add(format_args!(
            "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" class=\"{class}\">{text}</text>"
        ));
    }

    fn line(&mut self, (x1, y1): (f64, f64), (x2, y2): (f64, f64), class: &str) {
        self.add(format_args!("<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" class=\"{class}\"/>"));
    }

    /// The mark of series `i`, with `words` for readers that point at it.
    fn mark(&mut self, (x, y): (f64, f64), i: usize, words: &str) {
        let (colour, words) = (COLOURS[i % COLOURS.len()], escaped(words));
        let shape = match i % 4 {
            0 => format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3.8\""),
            1 => format!("<rect x=\"{:.1}\" y=\"{:.1}\" width=\"6.8\" height=\"6.8\"", x - 3.4, y - 3.4),
            2 => polygon(&[(x, y - 4.4), (x + 4.2, y + 3.2), (x - 4.2, y + 3.2)]),
            _ => polygon(&[(x, y - 4.6), (x + 4.6, y), (x, y + 4.6), (x - 4.6, y)]),
        };
        self.add(format_args!("{shape} fill=\"{colour}\" class=\"mark\"><title>{words}</title></{}>", tag(&shape)));
    }

    /// The entry of series `i` in the legend; its upper left corner is (x, y).
    fn key(&mut self, (x, y): (f64, f64), i: usize, name: &str) {
        self.mark((x + 5.0, y + 8.0), i, name);
        self.text((x + 15.0, y + 12.0), Anchor::Start, "", name);
    }

    fn finish(self) -> String {
        let Self { width, height, body } = self;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" \
             viewBox=\"0 0 {width:.0} {height:.0}\">\n<style>{STYLE}</style>\n\
             <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n{body}</svg>\n"
        )
    }
}

const STYLE: &str = "\
text{font-family:Helvetica,Arial,'Liberation Sans','DejaVu Sans',sans-serif;font-size:11px;fill:#222}\
.title{font-size:18px;font-weight:bold}.subtitle{font-size:12px;fill:#555}.panel{font-size:13px;font-weight:bold}\
.tick{fill:#555}.grid{stroke:#ddd}.axis{stroke:#888}.span{stroke:#bbb;stroke-width:2}\
.mark{stroke:white;stroke-width:0.8}";

/// Width of an entry of the legend, pixels.
fn key_width(name: &str) -> f64 {
    33.0 + LETTER * name.chars().count() as f64
}

/// Width of the headline or the line below it, whichever is longer, pixels.
fn heading_width(title: &str, subtitle: &str) -> f64 {
    LETTER * 1.1 * subtitle.chars().count().max(title.chars().count() * 3 / 2) as f64
}

/// The name of an opened element.
fn tag(element: &str) -> &str {
    element.trim_start_matches('<').split(' ').next().unwrap_or_default()
}

fn polygon(points: &[(f64, f64)]) -> String {
    let points: Vec<String> = points.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
    format!("<polygon points=\"{}\"", points.join(" "))
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
