//! The entry `auto`: what suits the scene and the number of rays.

use super::{Entry, Needs, Spec, spec, with_default};
use crate::auto::{self, Choice, USUAL_RAYS};
use crate::error::Result;
use crate::geometry::Geometry;

pub(super) const ENTRY: Entry = Entry {
    name: "auto",
    summary: "one of the others, by what the scene is like and how many rays there will be; `info` says which and why",
    options: "rays=F (expected rays, from 0; a picture of 512 x 512 pixels with a shadow ray each, and what is rendered with \
              `render`), memory=BYTES (as of grid)",
    source: "estimates from measurements, docs/auto.md",
    needs: Needs::Any,
    exact: true,
};

/// What is chosen for `geometry`, as a specification, and why.
pub(super) fn choose<G: Geometry>(mut spec: Spec, geometry: &G) -> Result<(String, Choice)> {
    let rays = spec.take("rays", |v| v.parse().ok().filter(|r: &f64| r.is_finite() && *r >= 0.0))?;
    let memory = spec.take("memory", spec::parse_bytes)?;
    spec.finish()?;
    let choice = auto::choose(geometry, rays.unwrap_or(USUAL_RAYS));
    let chosen = match memory {
        Some(bytes) => with_default(choice.spec(), "memory", &bytes.to_string()),
        None => choice.spec().to_string(),
    };
    Ok((chosen, choice))
}
