//! Who is tested: an accelerator by its specification, or anything that can be built over a scene.

use crate::accel::{Accel, Candidates};
use crate::error::{Error, Result};
use crate::geometry::SolidVoxels;
use crate::registry::{ENTRIES, Entry, peers, variants, walks, with_default};
use crate::scene::{SceneGeometry, with_geometry};
use glam::Vec3;
use std::sync::Arc;

/// Builds an accelerator over the primitives of a case; the second argument is the case's resolution, if it has one.
type Build = Box<dyn Fn(&SceneGeometry, Option<&str>) -> Result<Box<dyn Accel>> + Send + Sync>;

/// An accelerator under test.
pub struct Contender {
    /// Name in reports: the specification.
    pub name: String,
    /// True if it promises exact answers.
    pub exact: bool,
    entry: Option<&'static Entry>,
    /// True for trees that obvhs builds over whatever it is given.
    keeps_copies: bool,
    build: Build,
}

impl Contender {
    /// The accelerator that `spec` names. Whether there is one shows when it is built.
    pub fn of_spec(spec: &str) -> Self {
        let name = spec.split(':').next().unwrap_or(spec);
        let entry = ENTRIES.iter().find(|entry| entry.name == name);
        // Landings as printed are kept for study: they are known to be wrong.
        let exact = entry.is_none_or(|entry| entry.exact) && !spec.contains("landing=paper");
        let own = spec.to_string();
        let build = move |geometry: &SceneGeometry, resolution: Option<&str>| match resolution {
            Some(resolution) => geometry.accel(&with_default(&own, "resolution", resolution)),
            None => geometry.accel(&own),
        };
        let keeps_copies = name.starts_with("obvhs-native");
        Self { name: spec.to_string(), exact, entry, keeps_copies, build: Box::new(build) }
    }

    /// Something else that `build` makes, such as an accelerator that is known to be wrong.
    pub fn new(
        name: &str,
        exact: bool,
        build: impl Fn(&SceneGeometry) -> Result<Box<dyn Accel>> + Send + Sync + 'static,
    ) -> Self {
        let build: Build = Box::new(move |geometry, _| build(geometry));
        Self { name: name.to_string(), exact, entry: None, keeps_copies: false, build }
    }

    /// True if it can be built over such primitives.
    pub(crate) fn suits(&self, geometry: &SceneGeometry) -> bool {
        self.entry.is_none_or(|entry| with_geometry!(*geometry, g => entry.suits(g)))
    }

    /// An error where obvhs' builder, which compares boxes that are alike with each other, would take minutes. Asked before
    /// [`Contender::build`], so that this is not part of what a build costs.
    pub(crate) fn admit(&self, geometry: &SceneGeometry) -> Result<()> {
        const MOST: u32 = 10_000;
        let copies =
            if self.keeps_copies { with_geometry!(*geometry, g => Candidates::of(g).left_out.copies) } else { 0 };
        if copies > MOST {
            return Err(Error::invalid(format!("left out: obvhs takes minutes to build over {copies} copies")));
        }
        Ok(())
    }

    pub(crate) fn build(&self, geometry: &SceneGeometry, resolution: Option<&str>) -> Result<Box<dyn Accel>> {
        (self.build)(geometry, resolution)
    }
}

/// The accelerators that `specs` name. `all` stands for every variant and the peers; nothing for every walk and the peers.
///
/// # Errors
/// An accelerator or an option is unknown.
pub fn contenders(specs: &[String]) -> Result<Vec<Contender>> {
    specs.iter().filter(|spec| *spec != ALL).try_for_each(|spec| check(spec))?;
    let names = if specs.is_empty() { walks(true).into_iter().chain(peers()).collect() } else { spelled_out(specs) };
    Ok(names.iter().map(|name| Contender::of_spec(name)).collect())
}

/// Stands for every variant and the peers.
const ALL: &str = "all";

/// `specs` with what `all` stands for in its place.
pub fn spelled_out(specs: &[String]) -> Vec<String> {
    let of = |spec: &String| match spec.as_str() {
        ALL => variants(true).into_iter().chain(peers()).collect(),
        _ => vec![spec.clone()],
    };
    specs.iter().flat_map(of).collect()
}

/// # Errors
/// `spec` names no accelerator, or its options are wrong.
fn check(spec: &str) -> Result<()> {
    let contender = Contender::of_spec(spec);
    let triangle = SceneGeometry::Triangles(Arc::new(vec![[Vec3::ZERO, Vec3::X, Vec3::Y]]));
    let geometry = if contender.suits(&triangle) {
        triangle
    } else {
        SceneGeometry::Voxels(SolidVoxels::new([1; 3], vec![1], Vec3::ZERO, 1.0)?)
    };
    contender.build(&geometry, None).map(drop)
}
