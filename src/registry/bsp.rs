//! The entry `bsp`: which tree, and which way through it.

use super::{Entry, Needs, Spec, spec};
use crate::accel::Accel;
use crate::bsp::{Bsp, BspOptions, Choice, Climb, Form, Midpoint, Partition, Retraverse, Segment};
use crate::error::Result;
use crate::geometry::Geometry;

pub(super) const ENTRY: Entry = Entry {
    name: "bsp",
    summary: "binary space partition or octree, every node of the ray's leaves visited once",
    options: "walk=partition|retraverse|climb (partition), listing=segment|interval|midpoint (interval; of walk=partition), \
              planes=midpoint|sah|oblique (midpoint; the others for segment and interval alone), leaf=N (longest list that \
              is not split, above 0; 2), depth=N (most levels, 0..60; by the primitives), memory=BYTES (as of grid; building \
              included)",
    source: "Arvo 1988; Jansen 1986; Glassner 1984 (retraverse); Amanatides & Woo 1987 (climb)",
    needs: Needs::Any,
    exact: true,
};

#[derive(Clone, Copy, PartialEq)]
enum Way {
    Partition,
    Leaf(Form),
}

/// Builds the tree that `spec` describes.
pub(super) fn build<'a, G: Geometry + 'a>(mut spec: Spec, geometry: G) -> Result<Box<dyn Accel + 'a>> {
    let ways =
        [("partition", Way::Partition), ("retraverse", Way::Leaf(Form::Retraverse)), ("climb", Way::Leaf(Form::Climb))];
    let listings = [("segment", Form::Segment), ("interval", Form::Interval), ("midpoint", Form::Midpoint)];
    let choices = [("midpoint", Choice::Midpoint), ("sah", Choice::Sah), ("oblique", Choice::Oblique)];
    let way = spec.take_choice("walk", &ways)?.unwrap_or(Way::Partition);
    let listing = spec.take_choice("listing", &listings)?;
    let planes = spec.take_choice("planes", &choices)?.unwrap_or_default();
    let usual = BspOptions::default();
    let options = BspOptions {
        planes,
        leaf: spec.take("leaf", |text| text.parse().ok().filter(|&n| n > 0))?.unwrap_or(usual.leaf),
        depth: spec.take("depth", |text| text.parse().ok().filter(|&n| n <= BspOptions::MAX_DEPTH))?,
        memory: spec.take("memory", spec::parse_bytes)?.unwrap_or(usual.memory),
    };
    spec.finish()?;
    let form = match (way, listing) {
        (Way::Partition, listing) => listing.unwrap_or(Form::Interval),
        (Way::Leaf(form), None) => form,
        (Way::Leaf(_), Some(_)) => return Err(spec.error("option `listing` is for walk=partition alone")),
    };
    let halves_only = matches!(form, Form::Midpoint | Form::Retraverse | Form::Climb);
    if halves_only && planes != Choice::Midpoint {
        let option = if form == Form::Midpoint { "listing=midpoint" } else { "walk=retraverse and walk=climb" };
        return Err(spec.error(format!("{option} is for planes=midpoint alone")));
    }
    if planes == Choice::Oblique {
        let tree = Bsp::build_oblique(geometry, &options)?;
        return Ok(match form {
            Form::Segment => Box::new(tree.with_walk::<Partition<Segment>>()?),
            _ => Box::new(tree),
        });
    }
    let tree = Bsp::build(geometry, &options)?;
    Ok(match form {
        Form::Interval => Box::new(tree),
        Form::Segment => Box::new(tree.with_walk::<Partition<Segment>>()?),
        Form::Midpoint => Box::new(tree.with_walk::<Partition<Midpoint>>()?),
        Form::Retraverse => Box::new(tree.with_walk::<Retraverse>()?),
        Form::Climb => Box::new(tree.with_walk::<Climb>()?),
    })
}
