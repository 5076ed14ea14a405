//! The pictures of a scene on the page: ours and theirs, where they differ, and the steps of each accelerator.

use super::html::{Group, anchor, badge, data_uri, escape};
use super::tables::steps;
use super::{Entry, Report, Steps, Test};
use crate::picture::{Picture, agreement, falsecolour};
use std::fmt::Write as _;

/// A scene with all its pictures under one zoom.
pub(super) fn scene(page: &mut String, report: &Report, case: &str) {
    let entries: Vec<&Entry> = report.entries.iter().filter(|e| e.verdict.case == case).collect();
    let passed = entries.iter().all(|e| e.verdict.passed());
    let (at, name) = (anchor(case), escape(case));
    let _ = writeln!(page, "<section class=\"scene\" id=\"{at}\">\n<h2>{name} {}</h2>", badge(passed));
    let groups = report.groups(case);
    if groups.iter().any(|g| g.tier.pictures.is_some()) {
        let _ = writeln!(
            page,
            "<div class=\"tools\"><label>Zoom <input class=\"zoom\" type=\"range\" min=\"0\" max=\"5\" step=\"0.25\" \
             value=\"0\" aria-label=\"zoom of all pictures of {name}\"></label> <output class=\"zoomed\">1\u{d7}</output> \
             <button class=\"reset\" type=\"button\">Reset</button></div>"
        );
    }
    for group in &groups {
        comparison(page, case, group);
    }
    heat(page, case, &entries);
    page.push_str("</section>\n");
}

/// Ours and theirs on top of each other, and the maps of their differences.
fn comparison(page: &mut String, case: &str, group: &Group) {
    let tier = group.tier;
    let _ = writeln!(page, "<h3>Against {} {}</h3>", escape(&tier.reference.version), badge(tier.passed));
    let _ = writeln!(page, "<p>Ours with {}: {}.</p>", escape(&group.accels.join(", ")), escape(&tier.reason()));
    if let Some(pictures) = &tier.pictures {
        let of = format!("{} against {}", escape(case), tier.renderer);
        page.push_str("<div class=\"comparison\">\n");
        let _ = writeln!(
            page,
            "<div class=\"tools\"><button class=\"flip\" type=\"button\" aria-pressed=\"false\">Flip</button> <label>Split \
             <input class=\"split\" type=\"range\" min=\"0\" max=\"100\" value=\"100\" \
             aria-label=\"split of {of}, percent\"></label></div>\n<div class=\"panes\">"
        );
        if let (Some(ours), Some(theirs)) = (data_uri(&pictures.ours), data_uri(&pictures.theirs)) {
            let shape = shape(&pictures.theirs);
            let _ = writeln!(
                page,
                "<figure><div class=\"pane compare\" tabindex=\"0\" role=\"group\" aria-label=\"ours and theirs, {of}\" \
                 {shape}><div class=\"layer theirs\"><img draggable=\"false\" src=\"{theirs}\" alt=\"theirs, {of}\"></div>\
                 <div class=\"layer ours\"><img draggable=\"false\" src=\"{ours}\" alt=\"ours, {of}\"></div></div>\
                 <figcaption><output class=\"names\">ours</output></figcaption></figure>"
            );
        }
        if let Ok(map) = falsecolour::difference(&pictures.ours, &pictures.theirs) {
            pane(page, &map, "difference", &of);
        }
        if let Some(map) = &pictures.map {
            let what = match tier.test {
                Some(Test::Statistical(_)) => "z of tiles",
                _ => "pixels above limits",
            };
            pane(page, map, what, &of);
        }
        page.push_str("</div>\n</div>\n");
    }
    numbers(page, group);
}

/// Heat maps of all accelerators, on one scale for steps and one for tests.
fn heat(page: &mut String, case: &str, entries: &[&Entry]) {
    if entries.iter().all(|e| e.steps.is_none()) {
        return;
    }
    page.push_str("<h3>Work of camera rays</h3>\n<p>Counts for the ray through the middle of each pixel.</p>\n");
    maps(page, case, entries, "steps", (0, |s| s.most_steps));
    maps(page, case, entries, "tests", (1, |s| s.most_tests));
    page.push_str(&steps(entries));
}

/// Heat maps of one channel, whose greatest count `most` gives.
fn maps(page: &mut String, case: &str, entries: &[&Entry], what: &str, (channel, most): (usize, fn(&Steps) -> f32)) {
    let counted = || entries.iter().filter_map(|e| e.steps.as_ref().map(|s| (escape(&e.accel), s)));
    let scale = counted().map(|(_, s)| most(s)).fold(1.0, f32::max);
    let none: Vec<String> = counted().filter(|(_, s)| most(s) == 0.0).map(|(accel, _)| accel).collect();
    let none = if none.is_empty() { String::new() } else { format!("; not counted or none: {}", none.join(", ")) };
    let _ = writeln!(
        page,
        "<p>{what}, logarithmic: <span class=\"scale\"><span>0</span> <span class=\"bar ramp\"></span> <span>{scale:.0}</span></span>, in the \
         middle {:.1}{none}</p>\n<div class=\"panes small\">",
        // Colours are linear in ln(1 + count).
        (0.5 * scale.ln_1p()).exp_m1()
    );
    for (accel, steps) in counted().filter(|(_, s)| most(s) > 0.0) {
        let map = falsecolour::counts(&steps.picture, channel, scale);
        pane(page, &map, &format!("{accel}: {what}"), &escape(case));
    }
    page.push_str("</div>\n");
}

/// One picture; `what` and `of` are HTML.
fn pane(page: &mut String, picture: &Picture, what: &str, of: &str) {
    let Some(uri) = data_uri(picture) else { return };
    let shape = shape(picture);
    let _ = writeln!(
        page,
        "<figure><div class=\"pane\" tabindex=\"0\" role=\"group\" aria-label=\"{what}, {of}\" {shape}>\
         <img draggable=\"false\" src=\"{uri}\" alt=\"{what}, {of}\"></div><figcaption>{what}</figcaption></figure>"
    );
}

/// Keeps the place of a picture before it is decoded.
fn shape(picture: &Picture) -> String {
    format!("style=\"aspect-ratio: {} / {}\"", picture.width, picture.height)
}

/// The numbers behind the verdict and how the reference was made.
fn numbers(page: &mut String, group: &Group) {
    let tier = group.tier;
    page.push_str("<details><summary>Numbers and origin</summary>\n<dl>\n");
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
    }
    let (width, height) = tier.size;
    item("size and samples", format!("{width} x {height}, {} for each pixel", tier.samples));
    item("command, theirs", tier.reference.command.clone());
    if let Some(reason) = &tier.reference.tolerance_reason {
        item("why this tolerance", reason.clone());
    }
    if !tier.ours_sha256.is_empty() {
        item("SHA-256 of our pixels", tier.ours_sha256.clone());
    }
    page.push_str("</dl></details>\n");
}

/// What the colours mean and what the controls do.
pub(super) fn legends() -> String {
    let swatch = |i: usize| {
        let [r, g, b] = falsecolour::LIMITS[i].map(|v| (255.0 * v).round());
        format!("<span class=\"swatch\" style=\"background: rgb({r} {g} {b})\"></span>")
    };
    let z = agreement::MAP_Z;
    format!(
        "<section id=\"reading\">\n<h2>How to read the pictures</h2>\n<ul>\n\
         <li>Click a picture of ours to see theirs in its place, and again for ours. Split shows one at the left and the other at the \
         right.</li>\n\
         <li>Zoom holds for all pictures of a scene: slider, <kbd>+</kbd>, <kbd>-</kbd>, <kbd>0</kbd>, or <kbd>Ctrl</kbd> and the \
         wheel. Drag or use the arrow keys to move, <kbd>Enter</kbd> to flip.</li>\n\
         <li>Difference: largest channel, over the reference's largest channel (at least 0.1), logarithmic: \
         <span class=\"scale\"><span>{:e}</span> <span class=\"bar ramp\"></span> <span>{}</span></span></li>\n\
         <li>z of tiles: standard deviations between ours and theirs: <span class=\"scale\"><span>-{z}, ours darker</span> \
         <span class=\"bar sides\"></span> <span>{z}, ours brighter</span></span></li>\n\
         <li>Pixels above limits: {} within 0.1 %, {} above it, {} above 1 %</li>\n</ul>\n</section>\n",
        falsecolour::LEAST,
        falsecolour::MOST,
        swatch(0),
        swatch(1),
        swatch(2)
    )
}
