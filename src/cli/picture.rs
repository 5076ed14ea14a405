//! Which picture is made: the arguments of `render`, `plan` and `shard`.

use super::console::Console;
use super::info::left_out;
use super::input::{DEFAULT_ACCEL, SceneArgs, choose, parse_size};
use crate::error::{Error, Result};
use crate::picture::io::Attributes;
use crate::render::{Crop, Integrator, Sampler, Settings};
use crate::scene::{RenderDefaults, Scene};
use crate::shards::{self, Job};

/// Everything that a picture depends on, and how it is made.
#[derive(Clone, Debug, clap::Args)]
pub struct PictureArgs {
    #[command(flatten)]
    pub scene: SceneArgs,

    /// Accelerator, with options; see `skipgrid list`
    #[arg(long, value_name = "A", default_value = DEFAULT_ACCEL)]
    pub accel: String,

    /// What is computed for each pixel
    #[arg(long, value_enum)]
    pub integrator: Option<Integrator>,

    /// Columns and rows of the whole picture
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    pub size: Option<(u32, u32)>,

    /// Samples for each pixel; a square number for the regular sampler
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub spp: Option<u32>,

    /// Where samples lie in a pixel: Owen-scrambled Sobol points (default for path) or a regular grid (for the rest)
    #[arg(long, value_enum)]
    pub sampler: Option<SamplerName>,

    /// Same seed, same picture
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,

    /// Longest path in edges: 1 sees emission only, 2 adds direct light
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub max_depth: Option<u32>,

    /// Render only these columns and rows of the whole picture
    #[arg(long, value_name = "X,Y,W,H", value_parser = parse_crop)]
    pub crop: Option<Crop>,

    /// Whether rays to point and spot lights ask shadow voxels first; no bit of the picture changes (auto: where there are
    /// many rays for each primitive and light)
    #[arg(long, value_enum, default_value_t)]
    pub shadow_voxels: Choice,

    /// Worker threads; default: as many as there are cores
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    pub threads: Option<u32>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum SamplerName {
    Sobol,
    Regular,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Choice {
    #[default]
    Auto,
    On,
    Off,
}

impl Choice {
    pub fn wish(self) -> Option<bool> {
        match self {
            Choice::Auto => None,
            Choice::On => Some(true),
            Choice::Off => Some(false),
        }
    }
}

/// Words of a command in the form that shells read, on one line.
///
/// # Errors
/// A word has a line break or a zero.
pub fn quoted(words: &[&str]) -> Result<String> {
    let breaks = |word: &&&str| word.contains(['\n', '\r']);
    if let Some(word) = words.iter().find(breaks) {
        return Err(Error::invalid(format!("{word:?} has a line break, which a command of one line cannot have")));
    }
    shlex::try_join(words.iter().copied()).map_err(|error| Error::invalid(format!("{words:?}: {error}")))
}

impl PictureArgs {
    /// The command line, then the wishes of the scene called `name`, then the defaults.
    pub fn settings(&self, wish: &RenderDefaults, name: &str) -> Result<Settings> {
        let default = Settings::default();
        let integrator = match (&self.integrator, wish.integrator.as_deref()) {
            (Some(asked), _) => *asked,
            (None, Some(wanted)) => <Integrator as clap::ValueEnum>::from_str(wanted, true)
                .map_err(|_| Error::invalid(format!("{name}: integrator `{wanted}` is unknown")))?,
            (None, None) => default.integrator,
        };
        let regular = match self.sampler {
            Some(name) => name == SamplerName::Regular,
            None => integrator != Integrator::Path,
        };
        let sampler = match (regular, self.spp) {
            (true, None) => Sampler::Regular(wish.spp.unwrap_or(1).isqrt().max(1)),
            (true, Some(spp)) if spp.isqrt().pow(2) == spp => Sampler::Regular(spp.isqrt()),
            (true, Some(spp)) => {
                let cause =
                    format!("--spp {spp} is no square number, which the regular sampler needs, such as 1, 4, 9, 16");
                return Err(Error::invalid(cause));
            }
            (false, spp) => Sampler::Sobol(spp.or(wish.spp).unwrap_or(16)),
        };
        let (width, height) = self.size.or(wish.size).unwrap_or((default.width, default.height));
        Ok(Settings {
            integrator,
            width,
            height,
            crop: self.crop,
            sampler,
            seed: self.seed,
            max_depth: self.max_depth.or(wish.max_depth).unwrap_or(default.max_depth),
            threads: self.threads.map(|n| n as usize),
            shadow_voxels: self.shadow_voxels.wish(),
            ..default
        })
    }

    /// The accelerator, chosen by the rays of the whole picture if that is left to us, which is said then.
    pub fn accelerator(&self, scene: &Scene, settings: &Settings, console: &Console) -> Result<String> {
        let (spec, choice) = choose(&self.scene.spec(&self.accel), scene, settings.expected_rays(scene))?;
        if let Some(choice) = choice {
            console.note(choice.reason());
            let left_out: Vec<String> = choice.left_out().into_iter().chain(left_out(scene)).collect();
            console.note(format!("left out: {}", left_out.join("; ")));
        }
        Ok(spec)
    }

    /// Everything that the picture depends on, and the accelerator; no clock and no host, so that the same command writes
    /// the same bytes.
    pub fn attributes(&self, spec: &str, settings: &Settings) -> Attributes {
        let sampler = match settings.sampler {
            Sampler::Regular(n) => format!("regular {n}x{n}"),
            Sampler::Sobol(n) => format!("sobol {n}"),
        };
        let mut attributes = Attributes::default()
            .with("renderer", concat!("skipgrid ", env!("CARGO_PKG_VERSION")))
            .with("scene", &self.scene.scene)
            .with("accelerator", spec)
            .with("integrator", name_of(settings.integrator))
            .with("size", format!("{}x{}", settings.width, settings.height))
            .with("sampler", sampler)
            .with("seed", settings.seed.to_string())
            .with("maxDepth", settings.max_depth.to_string())
            .with("rrDepth", settings.rr_depth.to_string());
        if let Some(crop) = &settings.crop {
            attributes = attributes.with("crop", shards::text_of(crop));
        }
        attributes
    }

    /// Whether nothing is left to the scene.
    pub fn is_complete(&self) -> bool {
        let chosen = self.accel.split(':').next().is_some_and(|name| name.trim() != "auto");
        chosen
            && self.integrator.is_some()
            && self.size.is_some()
            && self.spp.is_some()
            && self.sampler.is_some()
            && self.max_depth.is_some()
    }

    /// What all shards of this picture have in common.
    ///
    /// # Errors
    /// The scene's name cannot be a word of a command.
    pub fn job(&self, spec: &str, settings: &Settings, scene_digest: String) -> Result<Job> {
        let scene = &self.scene.scene;
        if scene.starts_with('-') {
            return Err(Error::invalid(format!("`{scene}` would be taken for an option: write ./{scene}")));
        }
        let (sampler, total) = match settings.sampler {
            Sampler::Regular(_) => ("regular", settings.sampler.samples()),
            Sampler::Sobol(n) => ("sobol", n),
        };
        let (width, height) = (settings.width, settings.height);
        let area = settings.crop.unwrap_or(Crop { x: 0, y: 0, width, height });
        let (size, spp, seed) = (format!("{width}x{height}"), total.to_string(), settings.seed.to_string());
        let (depth, crop) = (settings.max_depth.to_string(), shards::text_of(&area));
        let integrator = name_of(settings.integrator);
        let mut words = vec![scene.as_str()];
        words.extend(self.scene.drop_invalid.then_some("--drop-invalid"));
        words.extend(["--accel", spec, "--integrator", &integrator, "--size", &size]);
        words.extend(["--sampler", sampler, "--spp", &spp, "--seed", &seed, "--max-depth", &depth]);
        words.extend(settings.crop.is_some().then_some(["--crop", &crop]).into_iter().flatten());
        let arguments = quoted(&words)?;
        Ok(Job::new(self.attributes(spec, settings), scene_digest, area, total, arguments))
    }
}

fn name_of(integrator: Integrator) -> String {
    format!("{integrator:?}").to_lowercase()
}

/// `X,Y,W,H`, width and height at least 1.
pub fn parse_crop(text: &str) -> std::result::Result<Crop, String> {
    shards::parse_crop(text)
        .ok_or_else(|| "not of the form X,Y,WIDTH,HEIGHT in pixels, such as 10,20,64,48".to_string())
}
