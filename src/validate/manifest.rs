//! `reference/manifest.toml`: which scenes were rendered by which program, how, and what deviation is allowed.

use crate::error::{Error, Result};
use crate::picture::io::read_bytes;
use serde::Deserialize;
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// Largest side of a reference picture, pixels.
const MAX_SIDE: u32 = 16384;
/// Largest number of samples for each pixel, replicates and edges of a path.
const MAX_COUNT: u32 = 1 << 20;

/// All reference pictures.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// One for each scene, in the file's order; at least one.
    #[serde(rename = "case")]
    pub cases: Vec<Case>,
}

/// One scene and the pictures that other programs made of it.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// Unique name.
    pub name: String,
    /// Scene file; relative to the manifest in the file, with its folder once read.
    pub scene: PathBuf,
    /// True if the scene is not kept with the pictures: where it is missing the case is left out.
    #[serde(default)]
    pub optional: bool,
    /// POV-Ray's picture.
    pub povray: Option<PovRay>,
    /// Why there is none.
    pub why_not_povray: Option<String>,
    /// Mitsuba's picture.
    pub mitsuba: Option<Mitsuba>,
    /// Why there is none.
    pub why_not_mitsuba: Option<String>,
}

/// A picture without noise: Whitted's method on a regular grid of samples.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PovRay {
    /// EXR, or linear PNG; box-averaged over the samples of a pixel.
    pub image: PathBuf,
    /// Samples along a pixel's side.
    pub grid: u32,
    /// Longest path in edges.
    pub max_depth: u32,
    /// Program and version.
    pub version: String,
    /// How it was called.
    pub command: String,
    /// Run time, seconds.
    pub seconds: f64,
    /// SHA-256 of the decoded pixels, see [`super::sha256::of_pixels`].
    pub sha256: String,
    /// Share (0 to 1) of pixels beyond 1 % between this picture and a faultless renderer with f32 rays; 0 if absent.
    #[serde(default)]
    pub out1_floor: f64,
    /// Allowed [`crate::picture::agreement::DeterministicVerdict::trim`], if not the usual one.
    pub trim: Option<f64>,
    /// Why the tolerance is what it is; a must with `trim`.
    pub tolerance_reason: Option<String>,
}

/// A picture with noise: the mean of independent path-traced pictures and the variance of that mean.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mitsuba {
    /// EXR with channels `R`, `G`, `B` and `variance.R`, `variance.G`, `variance.B`.
    pub image: PathBuf,
    /// Independent renders, at least 2.
    pub replicates: u32,
    /// Samples for each pixel in each of them.
    pub spp: u32,
    /// Longest path in edges.
    pub max_depth: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Program and version.
    pub version: String,
    /// How it was called.
    pub command: String,
    /// Run time, seconds.
    pub seconds: f64,
    /// SHA-256 of the decoded mean, see [`super::sha256::of_pixels`].
    pub sha256: String,
    /// The same of the variance, if known.
    pub variance_sha256: Option<String>,
    /// Why the tolerance is what it is.
    pub tolerance_reason: Option<String>,
}

impl Manifest {
    /// Reads a manifest and puts its folder before all its paths.
    ///
    /// # Errors
    /// The file cannot be read, is not TOML of this form, names a case twice, or has a value out of range: the message
    /// says which.
    pub fn read(path: impl AsRef<Path>) -> Result<Manifest> {
        let path = path.as_ref();
        let text = String::from_utf8(read_bytes(path)?).map_err(|e| Error::malformed(path, e.to_string()))?;
        let mut manifest: Manifest = toml::from_str(&text).map_err(|e| Error::malformed(path, located(&text, &e)))?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let mut names = HashSet::new();
        for case in &mut manifest.cases {
            let fail = |cause: String| Err(Error::malformed(path, format!("case `{}`: {cause}", case.name)));
            if !names.insert(case.name.clone()) {
                return fail("is there twice".into());
            }
            if let Err(cause) = case.check() {
                return fail(cause);
            }
            case.scene = folder.join(&case.scene);
            if let Some(povray) = &mut case.povray {
                povray.image = folder.join(&povray.image);
            }
            if let Some(mitsuba) = &mut case.mitsuba {
                mitsuba.image = folder.join(&mitsuba.image);
            }
        }
        if manifest.cases.is_empty() {
            return Err(Error::malformed(path, "has no case"));
        }
        Ok(manifest)
    }

    /// The cases with these names, in the order of `names`; all if there is none.
    ///
    /// # Errors
    /// A name is not in the manifest: the message lists those that are.
    pub fn select(&self, names: &[String]) -> Result<Vec<&Case>> {
        if names.is_empty() {
            return Ok(self.cases.iter().collect());
        }
        let find = |name: &String| {
            self.cases.iter().find(|c| c.name == *name).ok_or_else(|| {
                let known: Vec<&str> = self.cases.iter().map(|c| c.name.as_str()).collect();
                Error::invalid(format!("no reference scene is called `{name}`, there are: {}", known.join(", ")))
            })
        };
        names.iter().map(find).collect()
    }
}

/// One line: where, and what.
fn located(text: &str, error: &toml::de::Error) -> String {
    let before = error.span().and_then(|span| text.get(..span.start)).unwrap_or("");
    format!("line {}: {}", before.matches('\n').count() + 1, error.message().replace('\n', ", "))
}

impl Case {
    fn check(&self) -> std::result::Result<(), String> {
        if self.name.is_empty() || !self.name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'-' || b == b'_') {
            return Err("name has other characters than letters, digits, - and _".into());
        }
        match (&self.povray, &self.why_not_povray) {
            (None, None) => return Err("has no picture of POV-Ray and no why_not_povray".into()),
            (Some(_), Some(_)) => return Err("has a picture of POV-Ray and a why_not_povray".into()),
            _ => {}
        }
        if self.povray.is_none() && self.mitsuba.is_none() {
            return Err("has no picture at all".into());
        }
        if let Some(p) = &self.povray {
            p.check().map_err(|cause| format!("povray: {cause}"))?;
        }
        if let Some(m) = &self.mitsuba {
            m.check().map_err(|cause| format!("mitsuba: {cause}"))?;
        }
        Ok(())
    }
}

fn in_range(what: &str, value: u32, least: u32, most: u32) -> std::result::Result<(), String> {
    if (least..=most).contains(&value) { Ok(()) } else { Err(format!("{what} is {value}, not {least} to {most}")) }
}

fn check_digest(what: &str, digest: &str) -> std::result::Result<(), String> {
    let hexadecimal = digest.bytes().all(|b| b.is_ascii_digit() || (b'a'..=b'f').contains(&b));
    if digest.len() == 64 && hexadecimal {
        return Ok(());
    }
    Err(format!("{what} `{digest}` is not 64 lower-case hexadecimal digits"))
}

impl PovRay {
    fn check(&self) -> std::result::Result<(), String> {
        in_range("grid", self.grid, 1, 64)?;
        in_range("max_depth", self.max_depth, 1, MAX_COUNT)?;
        check_digest("sha256", &self.sha256)?;
        if !(0.0..=1.0).contains(&self.out1_floor) {
            return Err(format!("out1_floor is {}, not a share of 0 to 1", self.out1_floor));
        }
        match self.trim {
            Some(trim) if !(trim > 0.0 && trim.is_finite()) => Err(format!("trim is {trim}, not above 0")),
            Some(_) if self.tolerance_reason.is_none() => Err("trim without a tolerance_reason".into()),
            _ => Ok(()),
        }
    }
}

impl Mitsuba {
    fn check(&self) -> std::result::Result<(), String> {
        in_range("replicates", self.replicates, 2, MAX_COUNT)?;
        in_range("spp", self.spp, 1, MAX_COUNT)?;
        in_range("max_depth", self.max_depth, 1, MAX_COUNT)?;
        in_range("width", self.width, 1, MAX_SIDE)?;
        in_range("height", self.height, 1, MAX_SIDE)?;
        check_digest("sha256", &self.sha256)?;
        self.variance_sha256.iter().try_for_each(|digest| check_digest("variance_sha256", digest))
    }
}
