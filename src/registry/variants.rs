//! Lists of specifications that cover what accelerators can do, for tests and studies.

use super::{ENTRIES, Needs};

const SKIPS: [&str; 6] = ["clouds", "dsz", "dual", "dsz24", "chessboard", "octant"];

/// Every exact accelerator that can be built over any geometry, or over solid voxels too if `solid`, and each of the options
/// that change what is built or how it is walked; each specification once.
pub fn variants(solid: bool) -> Vec<String> {
    let mut specs = exact_entries(solid);
    let grids = ["density=0.05", "density=30", "resolution=1", "resolution=1x40x1", "resolution=64", "mailbox=on"];
    specs.extend(grids.iter().map(|o| format!("grid:{o}")));
    specs.push("grid:step=branchless".into());
    specs.push("grid:step=integer,resolution=64".into());
    for name in SKIPS {
        for options in ["density=30,distances=log2", "resolution=1x40x1,distances=half,threshold=3"] {
            specs.push(format!("grid-{name}:{options}"));
        }
    }
    let trees = ["listing=segment", "listing=midpoint", "walk=retraverse", "walk=climb", "leaf=1,depth=60", "depth=1"];
    specs.extend(trees.iter().map(|o| format!("bsp:{o}")));
    for planes in ["sah", "oblique"] {
        specs.extend(["leaf=1", "listing=segment"].iter().map(|o| format!("bsp:planes={planes},{o}")));
    }
    let nested = ["quality=fast", "quality=best,density=0", "density=3", "below=nodes", "isa=portable"];
    specs.extend(nested.map(|o| format!("nested:{o}")));
    specs.push("nested:isa=portable,below=nodes,quality=best".into());
    specs.push("grid-dual:resolution=64,lane=255,threshold=1".into());
    specs.push("grid-dsz:density=30,mailbox=on".into());
    if solid {
        specs.push("voxels:step=branchless".into());
        for skip in SKIPS {
            for options in ["threshold=1", "threshold=1,distances=log2", "distances=half"] {
                specs.push(format!("voxels:skip={skip},{options}"));
            }
        }
    }
    for name in ["obvhs-bvh2", "obvhs-cwbvh"] {
        if ENTRIES.iter().any(|e| e.name == name) {
            specs.extend(["fastest", "very_slow"].iter().map(|p| format!("{name}:preset={p}")));
        }
    }
    specs
}

/// The exact accelerators as [`variants`] has them, but of options that differ in numbers alone one each: every walk, skip
/// method, form of distances and kind of tree once.
pub fn walks(solid: bool) -> Vec<String> {
    let mut specs = exact_entries(solid);
    specs.extend(["step=branchless", "step=integer,density=30", "mailbox=on,density=30"].map(|o| format!("grid:{o}")));
    let forms = ["linear", "log2", "half"].iter().cycle();
    for (name, form) in SKIPS.iter().zip(forms) {
        specs.push(format!("grid-{name}:density=30,threshold=1,distances={form}"));
    }
    specs.extend(["listing=segment", "listing=midpoint", "walk=retraverse", "walk=climb"].map(|o| format!("bsp:{o}")));
    specs.extend(["sah,leaf=1", "sah,listing=segment", "oblique"].map(|o| format!("bsp:planes={o}")));
    if solid {
        specs.push("voxels:step=branchless".into());
        specs.extend(SKIPS.map(|skip| format!("voxels:skip={skip},threshold=1")));
    }
    specs
}

/// The accelerators compiled in and present here that bring a triangle test of their own and are here to be compared with.
pub fn peers() -> Vec<String> {
    let present = ENTRIES.iter().filter(|e| !e.exact && e.missing().is_none());
    present.map(|e| e.name.to_string()).collect()
}

fn exact_entries(solid: bool) -> Vec<String> {
    let suited = ENTRIES.iter().filter(|e| solid || e.needs == Needs::Any).filter(|e| e.exact);
    suited.map(|e| e.name.to_string()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::registry::build;
    use glam::Vec3;

    #[test]
    fn every_specification_can_be_built_and_is_there_once() {
        let triangles = vec![[Vec3::ZERO, Vec3::X, Vec3::Y]];
        for mut specs in [variants(false), walks(false)] {
            for spec in &specs {
                assert!(build(spec, &triangles).is_ok(), "{spec}");
            }
            let count = specs.len();
            specs.sort();
            specs.dedup();
            assert_eq!(specs.len(), count);
        }
    }
}
