//! The report as one page that needs no network: its frame, and what its parts share.

use super::tables::{metrics, power, speed, verdicts};
use super::viewer::{legends, scene};
use super::{Environment, Report, TierVerdict};
use crate::picture::{Picture, falsecolour, io};
use base64::prelude::{BASE64_STANDARD, Engine};
use std::fmt::Write as _;
use std::path::Path;

const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");
const SELF_TEST: &str = include_str!("selftest.js");

pub(super) fn page(report: &Report, environment: &Environment) -> String {
    let mut page = String::from("<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n");
    page.push_str("<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n");
    // An empty icon: else browsers ask for one.
    page.push_str("<link rel=\"icon\" href=\"data:,\">\n<title>skipgrid: validation</title>\n");
    let _ = write!(page, "<style>\n{STYLE}{}</style>\n", ramps());
    let _ = writeln!(page, "<header>\n<h1>Validation {}</h1>", badge(report.passed()));
    for line in report.summary().lines() {
        let _ = writeln!(page, "<p>{}</p>", escape(line));
    }
    page.push_str("</header>\n");
    contents(&mut page, report);
    page.push_str("<main>\n");
    verdicts(&mut page, report);
    metrics(&mut page, report);
    speed(&mut page, report);
    power(&mut page, report);
    page.push_str(&legends());
    for case in report.cases() {
        scene(&mut page, report, case);
    }
    origin(&mut page, report, environment);
    let _ = writeln!(page, "</main>\n<script>\n{SCRIPT}{SELF_TEST}</script>\n</html>");
    page
}

/// Renders that gave the same picture of a scene, and so the same verdict against one reference.
pub(super) struct Group<'a> {
    /// The one whose pictures are kept.
    pub tier: &'a TierVerdict,
    /// Specifications of the accelerators.
    pub accels: Vec<&'a str>,
}

impl Report {
    /// Names of the scenes, each once.
    pub(super) fn cases(&self) -> Vec<&str> {
        let mut cases: Vec<&str> = Vec::new();
        for entry in &self.entries {
            if !cases.contains(&entry.verdict.case.as_str()) {
                cases.push(&entry.verdict.case);
            }
        }
        cases
    }

    /// The comparisons of a scene, those with equal pictures and reasons taken together.
    pub(super) fn groups(&self, case: &str) -> Vec<Group<'_>> {
        let mut groups: Vec<Group> = Vec::new();
        for (entry, tier) in self.rows().filter(|(entry, _)| entry.verdict.case == case) {
            let same = |g: &&mut Group| {
                let t = g.tier;
                t.renderer == tier.renderer && t.ours_sha256 == tier.ours_sha256 && t.reasons == tier.reasons
            };
            match groups.iter_mut().find(same) {
                Some(group) => group.accels.push(&entry.accel),
                None => groups.push(Group { tier, accels: vec![&entry.accel] }),
            }
        }
        groups
    }
}

/// Links to all parts.
fn contents(page: &mut String, report: &Report) {
    page.push_str("<nav aria-label=\"contents\">\n<ul>\n");
    let mut parts = vec![("verdicts", "Verdicts"), ("metrics", "Metrics"), ("speed", "Speed")];
    if !report.reseeds.is_empty() {
        parts.push(("power", "Other seeds"));
    }
    parts.extend([("reading", "How to read the pictures"), ("environment", "Environment")]);
    for (at, title) in parts {
        let _ = writeln!(page, "<li><a href=\"#{at}\">{title}</a></li>");
    }
    page.push_str("</ul>\n<ul>\n");
    for case in report.cases() {
        let passed = report.entries.iter().filter(|e| e.verdict.case == case).all(|e| e.verdict.passed());
        let mark = if passed { "" } else { " <b class=\"fail\">FAILED</b>" };
        let _ = writeln!(page, "<li><a href=\"#{}\">{}</a>{mark}</li>", anchor(case), escape(case));
    }
    page.push_str("</ul>\n</nav>\n");
}

/// What it was run with.
fn origin(page: &mut String, report: &Report, environment: &Environment) {
    page.push_str("<section id=\"environment\">\n<h2>Environment</h2>\n<dl>\n");
    let mut item = |name: &str, value: &str| {
        let _ = writeln!(page, "<dt>{name}</dt><dd>{}</dd>", escape(value));
    };
    item("program", &environment.program);
    item("machine", &environment.machine);
    item("command", &environment.command);
    item("threads", &environment.threads.map_or("as many as there are cores".into(), |n| n.to_string()));
    let Environment { replicates, spp, .. } = environment;
    item("against noise", &format!("{replicates} renders of {spp} samples for each pixel"));
    let mut versions: Vec<&str> = Vec::new();
    for (_, tier) in report.rows() {
        if !versions.contains(&tier.reference.version.as_str()) {
            versions.push(&tier.reference.version);
        }
    }
    item("references", &versions.join("; "));
    page.push_str("</dl>\n</section>\n");
}

/// A verdict as a word in its colour.
pub(super) fn badge(passed: bool) -> String {
    let (class, word) = if passed { ("pass", "passed") } else { ("fail", "FAILED") };
    format!("<span class=\"{class}\">{word}</span>")
}

/// Where a scene stands on the page. Its name may be any text.
pub(super) fn anchor(case: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    let escaped: Vec<String> =
        case.chars().map(|c| if plain(c) { c.to_string() } else { format!(".{:x}", u32::from(c)) }).collect();
    format!("scene-{}", escaped.concat())
}

/// The colours of the scales, for the style.
fn ramps() -> String {
    let bar = |colour: &dyn Fn(f32) -> [f32; 3]| {
        let mut bar = Picture::new(256, 1);
        for (i, pixel) in bar.pixels.iter_mut().enumerate() {
            *pixel = colour(i as f32 / 255.0);
        }
        data_uri(&bar).unwrap_or_default()
    };
    let ramp = bar(&falsecolour::colour);
    let sides = bar(&|level| falsecolour::diverging(2.0 * level - 1.0));
    format!(":root {{ --ramp: url(\"{ramp}\"); --sides: url(\"{sides}\"); }}\n")
}

pub(super) fn data_uri(picture: &Picture) -> Option<String> {
    let png = io::encode_png(Path::new("report"), picture).ok()?;
    Some(format!("data:image/png;base64,{}", BASE64_STANDARD.encode(&png)))
}

pub(super) fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
