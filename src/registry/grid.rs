//! The entries `grid` and `grid-..`: how grids step, and what they know of empty space.

use super::{Entry, Needs, Spec, spec};
use crate::accel::Accel;
use crate::error::Result;
use crate::geometry::Geometry;
use crate::grid::skip::{
    Chessboard, DirectedSafeZones, DirectedSafeZones24, Distances, DualExtents, Method, Octants, Packed,
    PrintedLanding, PrintedRule, ProximityClouds, SkipOptions,
};
use crate::grid::{Branchless, Grid, GridOptions, IntegerWalk, SeedRule};

const SKIP_OPTIONS: &str = "threshold=N (least distance worth a leap, 1..255; 3), distances=linear|log2|half (linear; the \
                            others take 4 bits each), and those of grid but step";
const SKIP_OPTIONS_PRINTED: &str = "landing=exact|paper (exact; paper lands as printed, gets rays wrong and counts them), \
                                    threshold=N (least distance worth a leap, 1..255; 3, paper 5), \
                                    distances=linear|log2|half (linear; the others take 4 bits each), and those of grid but \
                                    step";

pub(super) const PLAIN: Entry = Entry {
    name: "grid",
    summary: "uniform grid, voxel walk with recomputed crossings",
    options: "step=branching|branchless|integer (branching), density=F (voxels a primitive, above 0; 2), \
              resolution=N or NxNxN (1..4096), mailbox=on|off (off), seeds=voxel|fixed (voxel; where tests of \
              patches begin), memory=BYTES (a quarter of the machine's, at most 8G)",
    source: "Amanatides & Woo 1987; lists after Lagae & Dutré 2008",
    needs: Needs::Any,
    exact: true,
};

pub(super) const CLOUDS: Entry = Entry {
    name: "grid-clouds",
    summary: "grid with proximity clouds: city-block distances, 4 bytes a voxel",
    options: SKIP_OPTIONS_PRINTED,
    source: "Cohen & Sheffer 1994; Semwal & Kvarnstrom 1997 section 3",
    needs: Needs::Any,
    exact: true,
};

pub(super) const DSZ: Entry = Entry {
    name: "grid-dsz",
    summary: "grid with directed safe zones: a distance for each face, 8 bytes a voxel",
    options: SKIP_OPTIONS_PRINTED,
    source: "Semwal & Kvarnstrom 1997 section 4",
    needs: Needs::Any,
    exact: true,
};

pub(super) const DUAL: Entry = Entry {
    name: "grid-dual",
    summary: "grid with dual extents: a cloud and six lanes, 8 bytes a voxel",
    options: "lane=N (half width of the lanes in voxels, 1..255; 16), landing=exact|paper (exact), \
              threshold=N (least distance worth a leap, 1..255; 3), distances=linear|log2|half (linear), and those of grid \
              but step",
    source: "Semwal & Kvarnstrom 1997 section 5",
    needs: Needs::Any,
    exact: true,
};

pub(super) const DSZ24: Entry = Entry {
    name: "grid-dsz24",
    summary: "grid with directed safe zones of 24 values, kept as eight octant distances, 8 bytes a voxel",
    options: SKIP_OPTIONS,
    source: "Semwal & Kvarnstrom 1997 section 10",
    needs: Needs::Any,
    exact: true,
};

pub(super) const CHESSBOARD: Entry = Entry {
    name: "grid-chessboard",
    summary: "grid with Chebyshev distances, leaps to the exit of the empty cube, 4 bytes a voxel",
    options: SKIP_OPTIONS,
    source: "Sramek & Kaufman 2000",
    needs: Needs::Any,
    exact: true,
};

pub(super) const OCTANT: Entry = Entry {
    name: "grid-octant",
    summary: "grid with a Chebyshev distance for each octant of directions, 8 bytes a voxel",
    options: SKIP_OPTIONS,
    source: "after Es & Isler 2007 and Deakin & Knackstedt 2020",
    needs: Needs::Any,
    exact: true,
};

/// Builds the grid that `spec` describes.
pub(super) fn build<'a, G: Geometry + 'a>(spec: Spec, geometry: G) -> Result<Box<dyn Accel + 'a>> {
    match spec.name() {
        "grid" => plain(spec, geometry),
        "grid-clouds" => skip_grid_printed::<_, ProximityClouds>(spec, geometry),
        "grid-dsz" => skip_grid_printed::<_, DirectedSafeZones>(spec, geometry),
        "grid-dual" => skip_grid_printed::<_, DualExtents>(spec, geometry),
        "grid-dsz24" => skip_grid::<_, DirectedSafeZones24>(spec, geometry),
        "grid-chessboard" => skip_grid::<_, Chessboard>(spec, geometry),
        "grid-octant" => skip_grid::<_, Octants>(spec, geometry),
        _ => Err(spec.unknown_name(super::ENTRIES)),
    }
}

/// A grid without distances.
fn plain<'a, G: Geometry + 'a>(mut spec: Spec, geometry: G) -> Result<Box<dyn Accel + 'a>> {
    let steps = [("branching", Step::Branching), ("branchless", Step::Branchless), ("integer", Step::Integer)];
    let step = spec.take_choice("step", &steps)?;
    let options = grid_options(&mut spec)?;
    spec.finish()?;
    let grid = Grid::build(geometry, &options)?;
    Ok(match step.unwrap_or_default() {
        Step::Branching => Box::new(grid),
        Step::Branchless => Box::new(grid.with_walk::<Branchless>()),
        Step::Integer => Box::new(grid.with_walk::<IntegerWalk>()),
    })
}

/// How the plain grid steps.
#[derive(Clone, Copy, Default)]
enum Step {
    #[default]
    Branching,
    Branchless,
    Integer,
}

/// A grid with the distances of a method whose landing is in print.
fn skip_grid_printed<'a, G: Geometry + 'a, M: PrintedRule>(mut spec: Spec, geometry: G) -> Result<Box<dyn Accel + 'a>> {
    let paper = spec.take_choice("landing", &[("exact", false), ("paper", true)])?.unwrap_or_default();
    if !paper {
        return skip_grid::<G, M>(spec, geometry);
    }
    // The paper leaps from five on.
    let printed = SkipOptions { threshold: 5, ..SkipOptions::default() };
    let (grid, skip) = grid_and_skip::<G, M>(spec, geometry, printed)?;
    Ok(Box::new(PrintedLanding::<G, M>::new(grid, &skip)?))
}

/// A grid with the distances of a method.
fn skip_grid<'a, G: Geometry + 'a, M: Method>(spec: Spec, geometry: G) -> Result<Box<dyn Accel + 'a>> {
    let (grid, skip) = grid_and_skip::<G, M>(spec, geometry, SkipOptions::default())?;
    Ok(match skip.distances {
        Distances::Linear => Box::new(grid.with_skip::<M>(&skip)?),
        _ => Box::new(grid.with_table::<M, Packed>(&skip)?),
    })
}

/// The plain grid that `spec` describes, and the options of its skip table; `default` where it says nothing.
fn grid_and_skip<G: Geometry, M: Method>(
    mut spec: Spec,
    geometry: G,
    default: SkipOptions,
) -> Result<(Grid<G>, SkipOptions)> {
    let skip = skip_options::<M>(&mut spec, default)?;
    let options = grid_options(&mut spec)?;
    spec.finish()?;
    Ok((Grid::build(geometry, &options)?, skip))
}

/// The options of a skip table; `default` where the specification says nothing.
pub(super) fn skip_options<M: Method>(spec: &mut Spec, default: SkipOptions) -> Result<SkipOptions> {
    let forms = [("linear", Distances::Linear), ("log2", Distances::Log2), ("half", Distances::HalfLog2)];
    let mut skip = SkipOptions {
        distances: spec.take_choice("distances", &forms)?.unwrap_or(default.distances),
        threshold: spec.take("threshold", above_zero)?.unwrap_or(default.threshold),
        ..default
    };
    // Only regions with a width of their own have lanes.
    if M::WIDTHS > 0 {
        skip.lane = spec.take("lane", above_zero)?.unwrap_or(default.lane);
    }
    Ok(skip)
}

fn above_zero(text: &str) -> Option<u8> {
    text.parse().ok().filter(|&n| n > 0)
}

fn grid_options(spec: &mut Spec) -> Result<GridOptions> {
    let mut options = GridOptions::default();
    if let Some(density) = spec.take("density", |v| v.parse().ok().filter(|d: &f64| d.is_finite() && *d > 0.0))? {
        options.density = density;
    }
    options.resolution = spec.take("resolution", parse_resolution)?;
    if let Some(mailbox) = spec.take_choice("mailbox", &[("on", true), ("off", false)])? {
        options.mailbox = mailbox;
    }
    if let Some(seeds) = spec.take_choice("seeds", &[("voxel", SeedRule::Voxel), ("fixed", SeedRule::Fixed)])? {
        options.seeds = seeds;
    }
    if let Some(memory) = spec.take("memory", spec::parse_bytes)? {
        options.memory = memory;
    }
    Ok(options)
}

fn parse_resolution(text: &str) -> Option<[u32; 3]> {
    let counts: Vec<u32> = text.split('x').map(|n| n.parse().ok()).collect::<Option<_>>()?;
    let counts = match counts[..] {
        [n] => [n; 3],
        [x, y, z] => [x, y, z],
        _ => return None,
    };
    counts.iter().all(|n| (1..=GridOptions::MAX_RESOLUTION).contains(n)).then_some(counts)
}
