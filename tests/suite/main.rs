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

/// An empty folder below `target/` for one test of the module `suite`.
pub fn folder(suite: &str, test: &str) -> std::path::PathBuf {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join(suite).join(test);
    // Absent the first time.
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("the target folder is writable");
    folder
}

/// Waits until the process catches interrupts and requests to end, so that it hears those that are sent to it; where /proc does not
/// say, does not wait.
#[cfg(unix)]
pub fn await_listener(process: &std::process::Child) {
    let (interrupt, end) = (1u64 << 1, 1u64 << 14);
    for _ in 0..600 {
        let Ok(status) = std::fs::read_to_string(format!("/proc/{}/status", process.id())) else { return };
        let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:"));
        let caught = caught.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(u64::MAX);
        if caught & interrupt != 0 && caught & end != 0 {
            return;
        }
        std::thread::sleep(std::time::Duration::from_millis(100));
    }
    panic!("the process does not listen");
}

/// The program, to be given arguments and run in `folder`, with nothing to read.
pub fn program(folder: &std::path::Path) -> std::process::Command {
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_skipgrid"));
    command.current_dir(folder).stdin(std::process::Stdio::null());
    command
}

/// Exit code, standard output and standard error of a program that does not panic.
pub fn ended(command: &mut std::process::Command) -> (Option<i32>, String, String) {
    let output = command.output().expect("the program starts");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("the program writes Unicode");
    let (stdout, stderr) = (text(output.stdout), text(output.stderr));
    assert!(!stderr.contains("panicked"), "{stderr}");
    (output.status.code(), stdout, stderr)
}
