//! One test program: behaviour through the public interface.
mod auto;
mod bad_input;
mod bench;
mod bezier;
mod bsp;
mod cli;
mod conformance;
mod converge;
mod exactness;
mod export;
mod fuzz;
mod json;
mod malformed;
mod mesh_files;
mod papers;
mod peers;
mod pictures;
mod property;
mod random;
mod render;
mod run_under;
mod scenes;
mod shards;
mod solid;
mod spd;
mod stress;
mod sweep;
mod tidy;
mod truth;
mod validate;
mod voxels;

/// A file or folder of the data that lies beside the repository (or where `SKIPGRID_SHARED` says), if it is there.
pub fn shared(name: &str) -> Option<std::path::PathBuf> {
    let beside = || std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared");
    let folder = std::env::var_os("SKIPGRID_SHARED").map_or_else(beside, Into::into);
    let path = folder.join(name);
    if path.exists() {
        return Some(path);
    }
    eprintln!("skipped: {} is not there", path.display());
    None
}
