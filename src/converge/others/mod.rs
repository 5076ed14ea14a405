//! Other renderers, run as programs on the exported scene.

mod mitsuba;
mod povray;

use super::Options;
use super::run::Shot;
use crate::error::{Error, Result};
use crate::render::Integrator;
use crate::scene::{ExportSettings, Scene};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// A program that renders exported scenes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Other {
    /// Mitsuba 3 by its Python module, variant `scalar_rgb`, path tracing.
    Mitsuba,
    /// POV-Ray 3.7, n x n points a pixel: no random numbers, so its error is bias alone.
    Povray,
}

impl Other {
    /// Name of its curve.
    pub fn name(self) -> &'static str {
        match self {
            Other::Mitsuba => "mitsuba",
            Other::Povray => "povray",
        }
    }

    /// Its version if it can be run here, else why not.
    pub fn version(self) -> std::result::Result<String, String> {
        match self {
            Other::Mitsuba => mitsuba::version(),
            Other::Povray => povray::version(),
        }
    }

    /// Why its curve cannot come down to ours, if the integrator says so.
    fn misfit(self, integrator: Integrator) -> Option<&'static str> {
        match (self, integrator) {
            (Other::Povray, Integrator::Path) => {
                Some("povray has no light that bounces between surfaces: what is missing shows as bias")
            }
            (Other::Mitsuba, Integrator::Whitted) => {
                Some("mitsuba traces paths: light that bounces between surfaces shows as bias")
            }
            _ => None,
        }
    }

    /// True if its pictures have noise.
    pub(super) fn is_random(self) -> bool {
        self == Other::Mitsuba
    }

    /// Samples a pixel that it renders if it is asked for so many; `None` if it has no such pattern.
    pub(super) fn samples(self, wanted: u32) -> Option<u32> {
        match self {
            Other::Mitsuba => Some(wanted),
            Other::Povray => Some(wanted).filter(|n| n.isqrt().pow(2) == *n),
        }
    }
}

/// An exported scene, ready to be rendered.
pub(super) struct Exported {
    other: Other,
    file: PathBuf,
    size: (u32, u32),
}

impl Exported {
    /// Writes the scene for `other` into `folder`; also what that cannot show as we do.
    pub fn new(other: Other, scene: &Scene, options: &Options, folder: &Path) -> Result<(Self, Vec<String>)> {
        let &Options { width, height, max_depth, .. } = options;
        // Whitted's method has no light from shining surfaces.
        let lamp_grid = if options.integrator == Integrator::Whitted { 0 } else { ExportSettings::default().lamp_grid };
        let settings = ExportSettings { width, height, max_depth, lamp_grid };
        let file = folder.join(if other == Other::Mitsuba { "mitsuba.xml" } else { "povray.pov" });
        let mut warnings = match other {
            Other::Mitsuba => crate::scene::mitsuba::export(scene, &settings, &file)?,
            Other::Povray => crate::scene::povray::export(scene, &settings, &file)?,
        };
        warnings.extend(other.misfit(options.integrator).map(str::to_string));
        Ok((Self { other, file, size: (width, height) }, warnings))
    }

    /// Who renders.
    pub fn other(&self) -> Other {
        self.other
    }

    /// Renders; the seeds are for two halves, where there are random numbers.
    pub fn render(&self, samples: u32, seeds: [u64; 2]) -> Result<Shot> {
        match self.other {
            Other::Mitsuba => mitsuba::render(&self.file, samples, seeds),
            Other::Povray => povray::render(&self.file, samples, self.size),
        }
    }
}

/// Runs a program to its end; gives its standard output.
fn output(command: &mut Command) -> Result<String> {
    let program = command.get_program().to_string_lossy().into_owned();
    let done = command.stdin(Stdio::null()).output().map_err(|e| Error::io(&program, e))?;
    if done.status.success() {
        return Ok(String::from_utf8_lossy(&done.stdout).into_owned());
    }
    let words = String::from_utf8_lossy(&done.stderr);
    // The last lines say why.
    let last: Vec<&str> = words.lines().rev().map(str::trim).filter(|line| !line.is_empty()).take(3).collect();
    let why = last.into_iter().rev().collect::<Vec<_>>().join("; ");
    Err(Error::invalid(format!("`{program}` failed with {}: {why}", done.status)))
}
