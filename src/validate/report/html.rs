//! The report as one page that needs no network.

use super::{Entry, Report, Reseed, Test, TierVerdict};
use crate::picture::{Picture, falsecolour, io};
use base64::prelude::{BASE64_STANDARD, Engine};
use std::fmt::Write as _;
use std::path::Path;

const STYLE: &str = include_str!("style.css");
const SCRIPT: &str = include_str!("flip.js");

pub(super) fn page(report: &Report) -> String {
    let mut page = String::from("<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n");
    page.push_str("<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n");
    let _ = write!(page, "<title>skipgrid: validation</title>\n<style>\n{STYLE}</style>\n");
    let (class, word) = verdict(report.passed());
    let _ = writeln!(page, "<h1>Validation <span class=\"{class}\">{word}</span></h1>");
    for line in report.summary().lines() {
        let _ = writeln!(page, "<p>{}</p>", escape(line));
    }
    page.push_str(&legend());
    table(&mut page, report);
    power(&mut page, report);
    for entry in &report.entries {
        for tier in &entry.verdict.tiers {
            section(&mut page, entry, tier);
        }
    }
    let _ = writeln!(page, "<script>\n{SCRIPT}</script>\n</html>");
    page
}

fn verdict(passed: bool) -> (&'static str, &'static str) {
    if passed { ("pass", "passed") } else { ("fail", "FAILED") }
}

fn anchor(entry: &Entry, tier: &TierVerdict) -> String {
    let accel = entry.accel.replace(|c: char| !c.is_ascii_alphanumeric(), "-");
    let case = entry.verdict.case.replace(|c: char| !c.is_ascii_alphanumeric() && c != '-' && c != '_', "_");
    format!("{case}-{}-{accel}", tier.renderer)
}

/// Where the page shows these pixels: equal pictures are kept once.
fn shown(report: &Report, entry: &Entry, tier: &TierVerdict) -> Option<String> {
    let same = |e: &Entry, t: &TierVerdict| {
        e.verdict.case == entry.verdict.case && t.renderer == tier.renderer && t.ours_sha256 == tier.ours_sha256
    };
    report.rows().find(|(e, t)| t.pictures.is_some() && same(e, t)).map(|(e, t)| anchor(e, t))
}

fn table(page: &mut String, report: &Report) {
    page.push_str("<table>\n<thead><tr>");
    for heading in
        ["case", "accelerator", "against", "verdict", "RMSE", "relMSE", "FLIP", "&gt; 1 %", "&gt; 0.1 %", "reason"]
    {
        let _ = write!(page, "<th>{heading}</th>");
    }
    page.push_str("</tr></thead>\n<tbody>\n");
    for (entry, tier) in report.rows() {
        let (class, word) = verdict(tier.passed);
        let name = escape(&entry.verdict.case);
        let name = shown(report, entry, tier).map_or(name.clone(), |at| format!("<a href=\"#{at}\">{name}</a>"));
        let _ = write!(
            page,
            "<tr><td>{name}</td><td>{}</td><td>{}</td><td class=\"{class}\">{word}</td>",
            escape(&entry.accel),
            tier.renderer
        );
        let cells = match &tier.metrics {
            Some(m) => [
                format!("{:.2e}", m.rmse),
                format!("{:.2e}", m.rel_mse),
                tier.flip.map_or("-".into(), |v| format!("{v:.4}")),
                format!("{:.3} %", 100.0 * m.above_1_percent),
                format!("{:.3} %", 100.0 * m.above_01_percent),
            ],
            None => ["-"; 5].map(String::from),
        };
        for cell in cells {
            let _ = write!(page, "<td class=\"number\">{cell}</td>");
        }
        let _ = writeln!(page, "<td>{}</td></tr>", escape(&tier.reason()));
    }
    page.push_str("</tbody>\n</table>\n");
}

/// The probabilities of all sets of other seeds.
fn power(page: &mut String, report: &Report) {
    if report.reseeds.is_empty() {
        return;
    }
    page.push_str(
        "<section id=\"power\">\n<h2>Power: our renders with other seeds</h2>\n<p>Probabilities that a renderer without a \
         fault differs so much by chance. A set fails below the usual limits over the number of sets.</p>\n<table>\n<thead>\
         <tr><th>case</th><th>first seed</th><th>chi-squared</th><th>worst tile</th><th>mean</th><th>verdict</th></tr>\
         </thead>\n<tbody>\n",
    );
    for Reseed { case, first_seed, verdict: v } in &report.reseeds {
        let (class, word) = verdict(v.passed);
        let _ = write!(page, "<tr><td>{}</td>", escape(case));
        for cell in [
            first_seed.to_string(),
            format!("{:.1e}", v.chi2_p),
            format!("{:.1e}", v.max_p),
            format!("{:.1e}", v.global_p),
        ] {
            let _ = write!(page, "<td class=\"number\">{cell}</td>");
        }
        let _ = writeln!(page, "<td class=\"{class}\" title=\"{}\">{word}</td></tr>", escape(&v.reasons.join("; ")));
    }
    page.push_str("</tbody>\n</table>\n</section>\n");
}

fn section(page: &mut String, entry: &Entry, tier: &TierVerdict) {
    let Some(pictures) = &tier.pictures else { return };
    let (class, word) = verdict(tier.passed);
    let _ = writeln!(
        page,
        "<section id=\"{}\">\n<h2>{} <small>{} against {}</small> <span class=\"{class}\">{word}</span></h2>",
        anchor(entry, tier),
        escape(&entry.verdict.case),
        escape(&entry.accel),
        escape(&tier.reference.version)
    );
    for reason in &tier.reasons {
        let _ = writeln!(page, "<p>{}</p>", escape(reason));
    }
    let (ours, theirs) = (data_uri(&pictures.ours), data_uri(&pictures.theirs));
    let difference = falsecolour::difference(&pictures.ours, &pictures.theirs).ok().and_then(|map| data_uri(&map));
    page.push_str("<div class=\"pictures\">\n");
    if let (Some(ours), Some(theirs)) = (ours, theirs) {
        let _ = writeln!(
            page,
            "<button class=\"flip\" type=\"button\" aria-label=\"ours and theirs in turn\">\
             <img class=\"ours\" src=\"{ours}\" alt=\"ours\"><img class=\"theirs\" src=\"{theirs}\" alt=\"theirs\">\
             <span class=\"ours\">ours (click for theirs)</span><span class=\"theirs\">theirs (click for ours)</span>\
             </button>"
        );
    }
    if let Some(difference) = difference {
        let _ = writeln!(
            page,
            "<figure><img src=\"{difference}\" alt=\"difference\"><figcaption>difference</figcaption></figure>"
        );
    }
    page.push_str("</div>\n");
    numbers(page, entry, tier);
    page.push_str("</section>\n");
}

/// The numbers behind the verdict and how the reference was made.
fn numbers(page: &mut String, entry: &Entry, tier: &TierVerdict) {
    page.push_str("<details><summary>numbers and origin</summary>\n<dl>\n");
    let mut item = |name: &str, value: String| {
        let _ = writeln!(page, "<dt>{name}</dt><dd>{}</dd>", escape(&value));
    };
    match &tier.test {
        Some(Test::Deterministic(t)) => {
            let of = |value: f64, limit: f64| format!("{value:.3e}, allowed {limit:.3e}");
            item("pixels off by more than 1 %, share", of(t.out1, t.limits.out1));
            item("pixels off by more than 0.1 %, share", of(t.out01, t.limits.out01));
            item("RMSE without the worst 2 %", of(t.trim, t.limits.trim));
            item("deviation of a channel's mean", of(t.ratio, t.limits.ratio));
        }
        Some(Test::Statistical(t)) => {
            let of = |p: f64, limit: f64| format!("{p:.3e}, least allowed {limit:.0e}");
            item("tiles", t.tiles.to_string());
            item("chi-squared over the tiles", format!("{:.1}", t.chi2));
            item("its probability", of(t.chi2_p, t.limits.chi2));
            item("probability of the worst tile", of(t.max_p, t.limits.max));
            item("probability of the mean", of(t.global_p, t.limits.global));
        }
        None => {}
    }
    if let Some(m) = &tier.metrics {
        item("largest difference", format!("{:.3e} in column {}, row {}", m.max, m.max_at.0, m.max_at.1));
        item("ratio of the means", format!("{:.6}", m.mean_ratio));
        item("PSNR", format!("{:.2} dB", m.psnr));
    }
    let (width, height) = tier.size;
    item("size and samples", format!("{width} x {height}, {} for each pixel", tier.samples));
    item("time, ours", format!("{:.2} s, build {:.1} ms", tier.seconds, 1e3 * entry.build_seconds));
    if let Some(seconds) = tier.reference.seconds {
        item("time, theirs", format!("{seconds:.2} s"));
    }
    item("command, theirs", tier.reference.command.clone());
    if let Some(reason) = &tier.reference.tolerance_reason {
        item("why this tolerance", reason.clone());
    }
    page.push_str("</dl></details>\n");
}

/// The scale of the difference pictures.
fn legend() -> String {
    let mut bar = Picture::new(128, 1);
    for (i, pixel) in bar.pixels.iter_mut().enumerate() {
        *pixel = falsecolour::colour(i as f32 / 127.0);
    }
    let Some(uri) = data_uri(&bar) else { return String::new() };
    format!(
        "<p class=\"legend\">Difference, largest channel over the reference's (at least 0.1): {:e} \
         <img src=\"{uri}\" alt=\"black to white\"> {}</p>\n",
        falsecolour::LEAST,
        falsecolour::MOST
    )
}

fn data_uri(picture: &Picture) -> Option<String> {
    let png = io::encode_png(Path::new("report"), picture).ok()?;
    Some(format!("data:image/png;base64,{}", BASE64_STANDARD.encode(&png)))
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
