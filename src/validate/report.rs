//! What a validation found, as text, CSV, JSON and HTML.

mod environment;
mod html;
mod tables;
mod viewer;

pub use environment::Environment;

use super::reseed::Reseed;
use super::steps::Steps;
use crate::error::{Error, Result};
use crate::picture::agreement::{DeterministicVerdict, StatisticalVerdict};
use crate::picture::io::{Attributes, write};
use crate::picture::metrics::Metrics;
use crate::picture::{Picture, falsecolour};
use serde::Serialize;
use std::fmt::Write as _;
use std::path::Path;

/// Who made the reference picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Renderer {
    /// POV-Ray, Whitted's method.
    #[serde(rename = "povray")]
    PovRay,
    /// Mitsuba, path tracing.
    #[serde(rename = "mitsuba")]
    Mitsuba,
    /// Whoever made the pictures that the user named.
    #[serde(rename = "theirs")]
    Other,
}

impl std::fmt::Display for Renderer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Renderer::PovRay => "povray",
            Renderer::Mitsuba => "mitsuba",
            Renderer::Other => "theirs",
        })
    }
}

/// How the reference picture was made.
#[derive(Clone, Debug, Serialize)]
pub struct Provenance {
    /// Program and version, or the names of the files.
    pub version: String,
    /// How it was called.
    pub command: String,
    /// Run time, seconds; `None` if it is not known.
    pub seconds: Option<f64>,
    /// Why the tolerance is what it is.
    pub tolerance_reason: Option<String>,
}

/// The test that decided.
#[derive(Clone, Debug, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum Test {
    /// Pixel by pixel.
    Deterministic(DeterministicVerdict),
    /// Tile by tile.
    Statistical(StatisticalVerdict),
}

/// Ours and theirs, linear RGB.
#[derive(Clone, Debug)]
pub struct Pictures {
    /// Ours; the mean where there are several.
    pub ours: Picture,
    /// The reference.
    pub theirs: Picture,
    /// Where they differ by the test that decided: [`crate::picture::agreement::above_limits`] or
    /// [`crate::picture::agreement::z_map`]; `None` if the test could not be made.
    pub map: Option<Picture>,
}

/// One scene, one accelerator, one reference picture.
#[derive(Clone, Debug, Serialize)]
pub struct TierVerdict {
    /// Who made the reference picture.
    pub renderer: Renderer,
    /// True if the pictures agree.
    pub passed: bool,
    /// Why; at least one sentence.
    pub reasons: Vec<String>,
    /// Columns and rows.
    pub size: (u32, u32),
    /// Our samples for each pixel, of all renders together.
    pub samples: u64,
    /// Time that ours took, seconds.
    pub seconds: f64,
    /// Rays that ours took, of all renders together.
    pub rays: u64,
    /// Distances; `None` if they could not be measured.
    pub metrics: Option<Metrics>,
    /// Mean FLIP error; `None` if it could not be measured.
    pub flip: Option<f64>,
    /// The test that decided; `None` if it could not be made.
    pub test: Option<Test>,
    /// Digest of our pixels, see [`super::sha256::of_pixels`]; empty if there are none.
    pub ours_sha256: String,
    /// How theirs was made.
    pub reference: Provenance,
    /// Kept if asked for.
    #[serde(skip)]
    pub pictures: Option<Pictures>,
}

impl TierVerdict {
    pub(super) fn new(renderer: Renderer, reference: Provenance) -> Self {
        Self {
            renderer,
            passed: false,
            reasons: vec![],
            size: (0, 0),
            samples: 0,
            seconds: 0.0,
            rays: 0,
            metrics: None,
            flip: None,
            test: None,
            ours_sha256: String::new(),
            reference,
            pictures: None,
        }
    }

    pub(super) fn failed(mut self, error: &Error) -> Self {
        self.passed = false;
        self.reasons.push(error.to_string());
        self
    }

    /// The reasons as one line.
    pub fn reason(&self) -> String {
        self.reasons.join("; ")
    }
}

/// One scene with one accelerator.
#[derive(Clone, Debug, Serialize)]
pub struct CaseVerdict {
    /// Name in the manifest.
    pub case: String,
    /// One for each reference picture; at least one.
    pub tiers: Vec<TierVerdict>,
}

impl CaseVerdict {
    /// True if all reference pictures agree with ours.
    pub fn passed(&self) -> bool {
        !self.tiers.is_empty() && self.tiers.iter().all(|t| t.passed)
    }
}

/// One scene with one accelerator by name.
#[derive(Clone, Debug, Serialize)]
pub struct Entry {
    /// Specification of the accelerator.
    pub accel: String,
    /// Time that building it took, seconds.
    pub build_seconds: f64,
    /// What was found.
    pub verdict: CaseVerdict,
    /// The work of camera rays; `None` if it was not asked for or there is no picture.
    pub steps: Option<Steps>,
}

/// Everything that a validation found.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Report {
    /// By scene, then by accelerator.
    pub entries: Vec<Entry>,
    /// Pictures that were found equal to the bit to that of the first accelerator.
    pub equal_pictures: usize,
    /// One sentence for each picture that was not.
    pub disagreements: Vec<String>,
    /// The same comparisons with other seeds, if asked for.
    pub reseeds: Vec<Reseed>,
    /// Cases whose scene is not here, with the file: one sentence each.
    pub left_out: Vec<String>,
    /// Scenes with an accelerator, and reseeded sets, that were asked for and left out because the work was stopped.
    pub unfinished: usize,
}

impl Report {
    /// True if there is something, nothing is unfinished, all passed, with all seeds, and the accelerators agree to the
    /// bit. Cases whose scene is not here do not count.
    pub fn passed(&self) -> bool {
        !self.entries.is_empty()
            && self.unfinished == 0
            && self.disagreements.is_empty()
            && self.entries.iter().all(|e| e.verdict.passed())
            && self.reseeds.iter().all(|r| r.verdict.passed)
    }

    /// Adds an entry and compares its pictures with those of the first accelerator for the same scene. Pictures that
    /// are equal are kept only once.
    pub(super) fn add(&mut self, mut entry: Entry) {
        let first = self.entries.iter().find(|e| e.verdict.case == entry.verdict.case);
        if let Some(first) = first {
            for (theirs, ours) in first.verdict.tiers.iter().zip(&mut entry.verdict.tiers) {
                if theirs.ours_sha256.is_empty() && ours.ours_sha256.is_empty() {
                    continue;
                }
                if theirs.ours_sha256 == ours.ours_sha256 {
                    self.equal_pictures += 1;
                    ours.pictures = None;
                    continue;
                }
                self.disagreements.push(format!(
                    "{} as compared with {}: the pictures of `{}` and `{}` are not equal to the bit",
                    entry.verdict.case, ours.renderer, first.accel, entry.accel
                ));
            }
        }
        self.entries.push(entry);
    }

    fn rows(&self) -> impl Iterator<Item = (&Entry, &TierVerdict)> {
        self.entries.iter().flat_map(|e| e.verdict.tiers.iter().map(move |t| (e, t)))
    }

    /// The last lines of the text form: how many passed, and whether accelerators agree.
    pub fn summary(&self) -> String {
        let all = self.rows().count();
        let passed = self.rows().filter(|(_, t)| t.passed).count();
        let mut text = format!("{passed} of {all} comparisons passed");
        if self.equal_pictures + self.disagreements.len() > 0 {
            let compared = self.equal_pictures + self.disagreements.len();
            let equal = self.equal_pictures;
            let _ = write!(text, "; {equal} of {compared} pictures equal the first accelerator's to the bit");
        }
        if self.unfinished > 0 {
            let _ = write!(text, "; interrupted, {} left out", self.unfinished);
        }
        for line in &self.disagreements {
            let _ = write!(text, "\n{line}");
        }
        for line in &self.left_out {
            let _ = write!(text, "\nleft out: {line}");
        }
        for case in self.entries.iter().map(|e| &e.verdict.case) {
            let sets: Vec<&StatisticalVerdict> =
                self.reseeds.iter().filter(|r| r.case == *case).map(|r| &r.verdict).collect();
            if sets.is_empty() || text.contains(&format!("\n{case} reseeded")) {
                continue;
            }
            let passed = sets.iter().filter(|v| v.passed).count();
            let least = |p: fn(&StatisticalVerdict) -> f64| sets.iter().map(|v| p(v)).fold(1.0, f64::min);
            let _ = write!(
                text,
                "\n{case} reseeded: {passed} of {} sets passed; least p of chi-squared {:.1e}, worst tile {:.1e}, mean {:.1e}",
                sets.len(),
                least(|v| v.chi2_p),
                least(|v| v.max_p),
                least(|v| v.global_p)
            );
        }
        text
    }

    /// One line for each comparison, with a heading; shares are 0 to 1.
    pub fn csv(&self) -> String {
        let mut text = String::from(
            "case,accelerator,against,passed,width,height,samples,seconds,build_seconds,rmse,relmse,flip,\
             above_1_percent,above_01_percent,max,mean_ratio,reason\n",
        );
        let number = |value: Option<f64>| value.map_or(String::new(), |v| format!("{v:e}"));
        for (entry, tier) in self.rows() {
            let metric = |get: fn(&Metrics) -> f64| number(tier.metrics.as_ref().map(get));
            let fields = [
                quoted(&entry.verdict.case),
                quoted(&entry.accel),
                tier.renderer.to_string(),
                tier.passed.to_string(),
                tier.size.0.to_string(),
                tier.size.1.to_string(),
                tier.samples.to_string(),
                number(Some(tier.seconds)),
                number(Some(entry.build_seconds)),
                metric(|m| m.rmse),
                metric(|m| m.rel_mse),
                number(tier.flip),
                metric(|m| m.above_1_percent),
                metric(|m| m.above_01_percent),
                metric(|m| m.max),
                metric(|m| m.mean_ratio),
                quoted(&tier.reason()),
            ];
            text.push_str(&fields.join(","));
            text.push('\n');
        }
        text
    }

    /// One self-contained HTML page; shows pictures and steps if they were kept.
    pub fn html(&self, environment: &Environment) -> String {
        html::page(self, environment)
    }

    /// Writes the kept pictures to `folder`, made if missing: `CASE-RENDERER-ACCELERATOR-ours.exr`, `-theirs.exr` and
    /// `-difference.png`; gives their number.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write_pictures(&self, folder: impl AsRef<Path>) -> Result<usize> {
        let folder = folder.as_ref();
        std::fs::create_dir_all(folder).map_err(|e| Error::io(folder, e))?;
        let mut count = 0;
        for (entry, tier) in self.rows() {
            let Some(pictures) = &tier.pictures else { continue };
            let accel = entry.accel.replace(|c: char| !c.is_ascii_alphanumeric() && c != '-', "_");
            // The name of a scene may be any text.
            let case = entry.verdict.case.replace(|c: char| !c.is_ascii_alphanumeric() && c != '-' && c != '_', "_");
            let path = |end: &str| folder.join(format!("{case}-{}-{accel}-{end}", tier.renderer));
            let attributes = Attributes::default().with("case", &entry.verdict.case);
            write(path("ours.exr"), &pictures.ours, &attributes.clone().with("accelerator", &entry.accel))?;
            write(path("theirs.exr"), &pictures.theirs, &attributes.with("renderer", &tier.reference.version))?;
            count += 2;
            if let Ok(map) = falsecolour::difference(&pictures.ours, &pictures.theirs) {
                write(path("difference.png"), &map, &Attributes::default())?;
                count += 1;
            }
        }
        Ok(count)
    }
}

/// A CSV field, in quotes where it needs them (RFC 4180).
fn quoted(field: &str) -> String {
    if field.contains([',', '"', '\n', '\r']) { format!("\"{}\"", field.replace('"', "\"\"")) } else { field.into() }
}

/// A table, then [`Report::summary`].
impl std::fmt::Display for Report {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let width =
            |get: &dyn Fn(&Entry) -> usize, heading: usize| self.entries.iter().map(get).fold(heading, usize::max);
        let case = width(&|e| e.verdict.case.len(), 4);
        let accel = width(&|e| e.accel.len(), 11);
        writeln!(
            f,
            "{:case$}  {:accel$}  {:7}  {:7}  {:>8}  {:>8}  {:>7}  {:>7}  {:>7}  {:>6}  reason",
            "case", "accelerator", "against", "verdict", "RMSE", "relMSE", "FLIP", "> 1 %", "> 0.1 %", "s"
        )?;
        for (entry, tier) in self.rows() {
            let metric = |get: fn(&Metrics) -> f64, show: fn(f64) -> String| {
                tier.metrics.as_ref().map_or("-".into(), |m| show(get(m)))
            };
            let scientific = |v: f64| format!("{v:.1e}");
            let percent = |v: f64| format!("{:.3}", 100.0 * v);
            writeln!(
                f,
                "{:case$}  {:accel$}  {:7}  {:7}  {:>8}  {:>8}  {:>7}  {:>7}  {:>7}  {:>6.1}  {}",
                entry.verdict.case,
                entry.accel,
                tier.renderer,
                if tier.passed { "pass" } else { "FAIL" },
                metric(|m| m.rmse, scientific),
                metric(|m| m.rel_mse, scientific),
                tier.flip.map_or("-".into(), |v| format!("{v:.4}")),
                metric(|m| m.above_1_percent, percent),
                metric(|m| m.above_01_percent, percent),
                tier.seconds,
                tier.reason()
            )?;
        }
        f.write_str(&self.summary())
    }
}
