//! Named spots over a plane with logarithmic scales, and a lane for zeros.

use super::scale::Scale;
use super::{Anchor, LETTER, MARGIN, Svg, key_width};
use crate::papers::report::significant;

/// A plane of spots: across from zero, which has a lane of its own, over a logarithmic scale; up a logarithmic scale.
#[derive(Clone, Debug)]
pub struct Scatter {
    /// Headline.
    pub title: String,
    /// A line below it.
    pub subtitle: String,
    /// Name of the horizontal scale, with unit.
    pub x: String,
    /// Name of the vertical scale, with unit.
    pub y: String,
    /// Names of the series.
    pub series: Vec<String>,
    /// The spots.
    pub spots: Vec<Spot>,
}

/// A named spot.
#[derive(Clone, Debug)]
pub struct Spot {
    /// Name, written beside it.
    pub name: String,
    /// Index in [`Scatter::series`].
    pub series: usize,
    /// Across: 0 stands in the lane; one that is negative or not finite leaves the spot out.
    pub x: f64,
    /// Up; one that is not finite and above 0 leaves the spot out.
    pub y: f64,
}

const WIDTH: f64 = 900.0;
const HEIGHT: f64 = 560.0;
/// Of the plane.
const TOP: f64 = 110.0;
const BOTTOM: f64 = HEIGHT - 60.0;
/// Of the lane of zeros, which has room for the names of its spots.
const ZERO: f64 = 80.0;
const LEFT: f64 = 290.0;
const RIGHT: f64 = WIDTH - 190.0;
/// Height of a name.
const LINE: f64 = 13.0;

impl Scatter {
    pub(super) fn svg(&self) -> String {
        let across = Scale::new(self.spots.iter().map(|s| s.x), LEFT, RIGHT);
        let up = Scale::new(self.spots.iter().map(|s| s.y), BOTTOM, TOP);
        let mut svg = Svg::headed(WIDTH, HEIGHT, &self.title, &self.subtitle);
        let mut x = MARGIN;
        for (i, name) in self.series.iter().enumerate() {
            svg.key((x, 66.0), i, name);
            x += key_width(name);
        }
        self.frame(&mut svg, &across, &up);

        let place = |spot: &Spot| Some((if spot.x == 0.0 { ZERO } else { across.at(spot.x)? }, up.at(spot.y)?));
        let mut placed: Vec<((f64, f64), &Spot)> =
            self.spots.iter().filter_map(|spot| Some((place(spot)?, spot))).collect();
        placed.sort_by(|a, b| a.0.1.total_cmp(&b.0.1));
        // Left end, right end and height of the marks and the names so far: a name that would cover one goes below it.
        let mut names: Vec<(f64, f64, f64)> = placed.iter().map(|((x, y), _)| (x - 6.0, x + 6.0, *y)).collect();
        for ((x, y), spot) in placed {
            let (from, to) = (x + 9.0, x + 9.0 + LETTER * spot.name.chars().count() as f64);
            let height = free(&names, (from, to), y);
            names.push((from, to, height));
            if height > y {
                svg.line((x, y), (from - 2.0, height), "grid");
            }
            let words = format!("{}: {} at {}", spot.name, significant(spot.y), significant(spot.x));
            svg.mark((x, y), spot.series, &words);
            svg.text((from, height + 4.0), Anchor::Start, "", &spot.name);
        }
        svg.finish()
    }

    fn frame(&self, svg: &mut Svg, across: &Scale, up: &Scale) {
        svg.line((ZERO, TOP), (ZERO, BOTTOM), "grid");
        svg.text((ZERO, BOTTOM + 16.0), Anchor::Middle, "tick", "0");
        for tick in &across.ticks {
            let Some(x) = across.at(*tick) else { continue };
            svg.line((x, TOP), (x, BOTTOM), "grid");
            svg.text((x, BOTTOM + 16.0), Anchor::Middle, "tick", &Scale::label(*tick));
        }
        let left = ZERO - 20.0;
        for tick in &up.ticks {
            let Some(y) = up.at(*tick) else { continue };
            svg.line((left, y), (RIGHT, y), "grid");
            svg.text((left - 6.0, y + 4.0), Anchor::End, "tick", &Scale::label(*tick));
        }
        // The axis is broken between the lane and the scale.
        svg.line((left, BOTTOM), (LEFT - 24.0, BOTTOM), "axis");
        svg.line((LEFT - 12.0, BOTTOM), (RIGHT, BOTTOM), "axis");
        svg.line((left, TOP), (left, BOTTOM), "axis");
        svg.text(((LEFT + RIGHT) / 2.0, HEIGHT - 20.0), Anchor::Middle, "", &self.x);
        svg.text((20.0, TOP - 10.0), Anchor::Start, "", &self.y);
    }
}

/// The least height from `y` on at which a name between two ends covers none of `names`: left end, right end and height.
fn free(names: &[(f64, f64, f64)], (from, to): (f64, f64), y: f64) -> f64 {
    // A hundredth of a pixel is not seen: without it the rounding of a height just below a name would find that name again.
    let covered = |a: f64, b: f64| (a - b).abs() < LINE - 0.01;
    let mut height = y;
    while let Some((.., other)) = names.iter().find(|(a, b, other)| *a < to && from < *b && covered(*other, height)) {
        height = other + LINE;
    }
    height
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_goes_below_the_one_it_would_cover_whatever_is_rounded() {
        let mut rounded = 0;
        for i in 0..1000 {
            let y = 110.0 + 0.39 * f64::from(i);
            rounded += usize::from((y + LINE) - y < LINE);
            let names = [(0.0, 50.0, y), (0.0, 50.0, y + LINE), (60.0, 90.0, y + 2.0 * LINE)];
            assert_eq!(free(&names[..1], (10.0, 30.0), y), y + LINE);
            assert_eq!(free(&names, (10.0, 30.0), y - 1.0), y + LINE + LINE);
            assert_eq!(free(&names, (51.0, 59.0), y), y);
        }
        assert!(rounded > 0, "no height shows what rounding does");
    }
}
