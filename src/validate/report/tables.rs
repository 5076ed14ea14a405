//! The tables of the page: verdicts, metrics, speed, other seeds.

use super::html::{anchor, badge, escape};
use super::{Entry, Report, Reseed, TierVerdict};
use crate::picture::metrics::Metrics;
use std::fmt::Write as _;

/// A table whose columns are words, or numbers where the heading starts with `>`: these stand at the right.
struct Table<'a> {
    headings: &'a [&'a str],
    text: String,
}

impl<'a> Table<'a> {
    fn new(headings: &'a [&'a str]) -> Self {
        let mut text = String::from("<div class=\"wide\"><table>\n<thead><tr>");
        for heading in headings {
            let _ = match heading.strip_prefix('>') {
                Some(heading) => write!(text, "<th scope=\"col\" class=\"number\">{}</th>", escape(heading)),
                None => write!(text, "<th scope=\"col\">{heading}</th>"),
            };
        }
        text.push_str("</tr></thead>\n<tbody>\n");
        Self { headings, text }
    }

    /// Cells are HTML.
    fn row(&mut self, cells: &[String]) {
        self.text.push_str("<tr>");
        for (cell, heading) in cells.iter().zip(self.headings) {
            let class = if heading.starts_with('>') { " class=\"number\"" } else { "" };
            let _ = write!(self.text, "<td{class}>{cell}</td>");
        }
        self.text.push_str("</tr>\n");
    }

    fn end(self) -> String {
        self.text + "</tbody>\n</table></div>\n"
    }
}

fn link(case: &str) -> String {
    format!("<a href=\"#{}\">{}</a>", anchor(case), escape(case))
}

/// One row for each comparison.
pub(super) fn verdicts(page: &mut String, report: &Report) {
    page.push_str("<section id=\"verdicts\">\n<h2>Verdicts</h2>\n");
    let mut table = Table::new(&["scene", "accelerator", "against", "verdict", "reason"]);
    for (entry, tier) in report.rows() {
        table.row(&[
            link(&entry.verdict.case),
            escape(&entry.accel),
            tier.renderer.to_string(),
            badge(tier.passed),
            escape(&tier.reason()),
        ]);
    }
    page.push_str(&table.end());
    page.push_str("</section>\n");
}

/// One row for each picture of ours that differs from the others.
pub(super) fn metrics(page: &mut String, report: &Report) {
    page.push_str(
        "<section id=\"metrics\">\n<h2>Metrics</h2>\n<p>Linear RGB, theirs is the reference; none of these decides a verdict. \
         Accelerators with equal pictures share a row.</p>\n",
    );
    let headings = [
        "scene",
        "against",
        "accelerators",
        ">RMSE",
        ">relMSE",
        ">MAE",
        ">largest",
        ">PSNR, dB",
        ">FLIP",
        ">> 1 %",
        ">> 0.1 %",
        ">mean ratio",
    ];
    let mut table = Table::new(&headings);
    for case in report.cases() {
        for group in report.groups(case) {
            let tier = group.tier;
            let number = |show: &dyn Fn(&Metrics) -> String| tier.metrics.as_ref().map_or("-".into(), show);
            table.row(&[
                link(case),
                tier.renderer.to_string(),
                escape(&group.accels.join(", ")),
                number(&|m| format!("{:.2e}", m.rmse)),
                number(&|m| format!("{:.2e}", m.rel_mse)),
                number(&|m| format!("{:.2e}", m.mae)),
                number(&|m| format!("{:.2e}", m.max)),
                number(&|m| format!("{:.1}", m.psnr)),
                tier.flip.map_or("-".into(), |v| format!("{v:.4}")),
                number(&|m| format!("{:.3} %", 100.0 * m.above_1_percent)),
                number(&|m| format!("{:.3} %", 100.0 * m.above_01_percent)),
                number(&|m| format!("{:.6}", m.mean_ratio)),
            ]);
        }
    }
    page.push_str(&table.end());
    page.push_str("</section>\n");
}

/// One row for each comparison, with the times.
pub(super) fn speed(page: &mut String, report: &Report) {
    page.push_str(
        "<section id=\"speed\">\n<h2>Speed</h2>\n<p>Times of this one run, accelerators one after the other; \
         <code>skipgrid compare</code> measures them in turns. The ratio is that of render times, over the first accelerator of the \
         scene: below 1 is faster. Theirs was measured when the reference was made.</p>\n",
    );
    let headings = [
        "scene",
        "accelerator",
        "against",
        ">size",
        ">samples",
        ">build, ms",
        ">render, s",
        ">ratio",
        ">rays, millions",
        ">million rays / s",
        ">theirs, s",
    ];
    let mut table = Table::new(&headings);
    for entry in &report.entries {
        let first = report.entries.iter().find(|e| e.verdict.case == entry.verdict.case);
        for (i, tier) in entry.verdict.tiers.iter().enumerate() {
            let rendered = tier.rays > 0;
            let shown = |value: f64, digits: usize| if rendered { format!("{value:.digits$}") } else { "-".into() };
            let over = first.and_then(|e| e.verdict.tiers.get(i)).filter(|t| t.rays > 0);
            let rays = tier.rays as f64 / 1e6;
            table.row(&[
                link(&entry.verdict.case),
                escape(&entry.accel),
                tier.renderer.to_string(),
                size(tier),
                tier.samples.to_string(),
                format!("{:.2}", 1e3 * entry.build_seconds),
                shown(tier.seconds, 3),
                over.map_or("-".into(), |t| shown(tier.seconds / t.seconds, 2)),
                shown(rays, 2),
                shown(rays / tier.seconds, 2),
                tier.reference.seconds.map_or("-".into(), |s| format!("{s:.2}")),
            ]);
        }
    }
    page.push_str(&table.end());
    page.push_str("</section>\n");
}

fn size(tier: &TierVerdict) -> String {
    format!("{} x {}", tier.size.0, tier.size.1)
}

/// The probabilities of all sets of other seeds.
pub(super) fn power(page: &mut String, report: &Report) {
    if report.reseeds.is_empty() {
        return;
    }
    page.push_str(
        "<section id=\"power\">\n<h2>Power: our renders with other seeds</h2>\n<p>Probabilities that a renderer without a \
         fault differs so much by chance. A set fails below the usual limits over the number of sets.</p>\n",
    );
    let mut table = Table::new(&["scene", ">first seed", ">chi-squared", ">worst tile", ">mean", "verdict", "reason"]);
    for Reseed { case, first_seed, verdict: v } in &report.reseeds {
        table.row(&[
            link(case),
            first_seed.to_string(),
            format!("{:.1e}", v.chi2_p),
            format!("{:.1e}", v.max_p),
            format!("{:.1e}", v.global_p),
            badge(v.passed),
            escape(&v.reasons.join("; ")),
        ]);
    }
    page.push_str(&table.end());
    page.push_str("</section>\n");
}

/// What camera rays met, one row for each accelerator of a scene.
pub(super) fn steps(entries: &[&Entry]) -> String {
    let mut table =
        Table::new(&["accelerator", ">steps a ray", ">most steps", ">leaps a ray", ">tests a ray", ">most tests"]);
    for entry in entries {
        if let Some(s) = &entry.steps {
            let counted = |value: String| if s.most_steps > 0.0 { value } else { "-".into() };
            table.row(&[
                escape(&entry.accel),
                counted(format!("{:.2}", s.steps)),
                counted(format!("{:.0}", s.most_steps)),
                format!("{:.2}", s.leaps),
                format!("{:.2}", s.tests),
                format!("{:.0}", s.most_tests),
            ]);
        }
    }
    table.end()
}
