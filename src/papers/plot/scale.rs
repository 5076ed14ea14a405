//! Logarithmic scales with round ticks.

/// Maps positive numbers to pixels, with ticks at round ones.
pub(super) struct Scale {
    from: f64,
    to: f64,
    low: f64,
    high: f64,
    /// Values with a label, rising.
    pub ticks: Vec<f64>,
}

impl Scale {
    /// From the pixel `from` to the pixel `to`; holds all of `values` that are finite and above 0.
    pub fn new(values: impl Iterator<Item = f64>, from: f64, to: f64) -> Self {
        let usable = values.filter(|v| v.is_finite() && *v > 0.0);
        let (least, most) = usable.fold((f64::INFINITY, 0.0), |(a, b), v| (v.min(a), v.max(b)));
        let (least, most) = if least <= most { (least, most) } else { (1.0, 10.0) };
        let first = least.log10().floor() as i32;
        let last = most.log10().ceil() as i32 + 1;
        let decades = (most / least).log10();
        // Beyond about three decades the labels between the powers of ten would crowd.
        let steps: &[f64] = if decades < 2.2 { &[1.0, 2.0, 5.0] } else { &[1.0] };
        let all: Vec<f64> = (first..=last).flat_map(|e| steps.iter().map(move |s| s * 10f64.powi(e))).collect();
        // A hair of slack, so that a value on a tick needs no other one.
        let below = all.iter().rposition(|t| *t <= least * 1.001).unwrap_or(0);
        let above = all.iter().position(|t| *t >= most * 0.999).unwrap_or(all.len() - 1).max(below + 1);
        let ticks = all[below..=above.min(all.len() - 1)].to_vec();
        let (low, high) = (ticks[0].ln(), ticks[ticks.len() - 1].ln());
        Self { from, to, low, high, ticks }
    }

    /// The pixel of `value`, or `None` if it is not finite and above 0.
    pub fn at(&self, value: f64) -> Option<f64> {
        let usable = value.is_finite() && value > 0.0;
        usable.then(|| self.from + (self.to - self.from) * (value.ln() - self.low) / (self.high - self.low))
    }

    /// A tick in a few letters.
    pub fn label(tick: f64) -> String {
        let digits = (-tick.log10().floor()).clamp(0.0, 12.0) as usize;
        match tick {
            t if t >= 0.999e9 => format!("{:.0}G", t / 1e9),
            t if t >= 0.999e6 => format!("{:.0}M", t / 1e6),
            t if t >= 0.999e4 => format!("{:.0}k", t / 1e3),
            _ => format!("{tick:.digits$}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_hold_their_values_between_round_ticks() {
        let scale = Scale::new([3.0, 47.0, f64::NAN, 0.0].into_iter(), 100.0, 200.0);
        assert_eq!(scale.ticks, [2.0, 5.0, 10.0, 20.0, 50.0]);
        assert_eq!((scale.at(2.0), scale.at(50.0), scale.at(10.0)), (Some(100.0), Some(200.0), Some(150.0)));
        assert_eq!((scale.at(0.0), scale.at(f64::NAN)), (None, None));
        let scale = Scale::new([1.0].into_iter(), 0.0, 1.0);
        assert_eq!(scale.ticks, [1.0, 2.0]);
        let scale = Scale::new([0.004, 3000.0].into_iter(), 0.0, 1.0);
        let labels: Vec<String> = scale.ticks.iter().map(|t| Scale::label(*t)).collect();
        assert_eq!(labels, ["0.001", "0.01", "0.1", "1", "10", "100", "1000", "10k"]);
        assert!(Scale::new(std::iter::empty(), 0.0, 1.0).ticks.len() > 1);
    }
}
