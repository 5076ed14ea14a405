//! The entry `voxels`: how solid voxels are walked, and what is known of the space around them.

use super::grid::skip_options;
use super::{Entry, Needs, Spec, spec};
use crate::accel::Accel;
use crate::error::Result;
use crate::geometry::SolidVoxels;
use crate::grid::skip::{
    Chessboard, DirectedSafeZones, DirectedSafeZones24, Distances, DualExtents, Method, Octants, Packed,
    ProximityClouds, SkipOptions,
};
use crate::grid::{Branchless, SolidGrid, SolidOptions};

pub(super) const ENTRY: Entry = Entry {
    name: "voxels",
    summary: "solid voxels without lists: a hit is a crossing from empty to solid; for scenes of voxels alone",
    options: "step=branching|branchless (branching), skip=none|clouds|dsz|dual|dsz24|chessboard|octant (none; with \
              step=branching), threshold=N (3), distances=linear|log2|half (linear), lane=N (16; of dual), memory=BYTES (a \
              quarter of the machine's, at most 8G)",
    source: "after an article on branchless DDA voxel tracing; Amanatides & Woo 1987",
    needs: Needs::SolidVoxels,
    exact: true,
};

/// Builds the walk that `spec`, of the accelerator `voxels`, describes.
pub(super) fn build<'a>(mut spec: Spec, voxels: SolidVoxels) -> Result<Box<dyn Accel + 'a>> {
    type Make = fn(Spec, SolidVoxels) -> Result<Box<dyn Accel>>;
    let skips: [(&str, Option<Make>); 7] = [
        ("none", None),
        ("clouds", Some(table::<ProximityClouds>)),
        ("dsz", Some(table::<DirectedSafeZones>)),
        ("dual", Some(table::<DualExtents>)),
        ("dsz24", Some(table::<DirectedSafeZones24>)),
        ("chessboard", Some(table::<Chessboard>)),
        ("octant", Some(table::<Octants>)),
    ];
    let branchless = spec.take_choice("step", &[("branching", false), ("branchless", true)])?.unwrap_or_default();
    let skip = spec.take_choice("skip", &skips)?.flatten();
    match skip {
        Some(_) if branchless => Err(spec.error("skip tables are walked with step=branching only")),
        Some(make) => make(spec, voxels),
        None => {
            let options = options(&mut spec)?;
            spec.finish()?;
            let plain = SolidGrid::build(voxels, &options)?;
            Ok(if branchless { Box::new(plain.with_walk::<Branchless>()) } else { Box::new(plain) })
        }
    }
}

fn table<M: Method>(mut spec: Spec, voxels: SolidVoxels) -> Result<Box<dyn Accel>> {
    let skip = skip_options::<M>(&mut spec, SkipOptions::default())?;
    let options = options(&mut spec)?;
    spec.finish()?;
    let plain = SolidGrid::build(voxels, &options)?;
    Ok(match skip.distances {
        Distances::Linear => Box::new(plain.with_table::<M, M::Slot>(&skip)?),
        _ => Box::new(plain.with_table::<M, Packed>(&skip)?),
    })
}

fn options(spec: &mut Spec) -> Result<SolidOptions> {
    let memory = spec.take("memory", spec::parse_bytes)?;
    Ok(memory.map_or_else(SolidOptions::default, |memory| SolidOptions { memory }))
}
