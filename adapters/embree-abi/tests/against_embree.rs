//! A C program that uses everything the library supports prints the same text with Embree 3 itself and with this library, by every kind of
//! accelerator; and valgrind finds nothing lost in it.
//!
//! Skips, and says so, where a C compiler, Embree's headers or valgrind are missing.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The program, compiled against Embree; `None` if that cannot be done here.
fn program() -> Option<PathBuf> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/program.c");
    let program = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("program-{}", std::process::id()));
    let tried = Command::new("cc")
        .args(["-Wall", "-Wextra", "-Werror", "-o"])
        .args([&program, &source])
        .args(["-lembree3", "-lpthread", "-lm"])
        .output();
    match tried {
        Ok(output) if output.status.success() => Some(program),
        Ok(output) => {
            let message = String::from_utf8_lossy(&output.stderr);
            assert!(message.contains("rtcore.h") || message.contains("-lembree3"), "{message}");
            println!("skipped: there is no Embree 3 to compile against");
            None
        }
        Err(error) => {
            println!("skipped: no C compiler: {error}");
            None
        }
    }
}

/// A folder in which the loader finds the library as Embree's.
fn folder() -> PathBuf {
    let built = Command::new(env!("CARGO")).args(["build", "--quiet", "--package", "skipgrid-embree3"]).status();
    assert!(built.expect("cargo runs").success(), "the library is not built");
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).parent().expect("the folder lies in `target`");
    let folder = target.join(format!("tmp/library-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("the target folder is writable");
    std::fs::copy(target.join("debug/libskipgrid_embree3.so"), folder.join("libembree3.so.3"))
        .expect("the library is there");
    folder
}

fn text(output: &Output) -> String {
    assert!(output.status.success(), "{output:?}");
    String::from_utf8_lossy(&output.stdout).into_owned()
}

#[test]
fn a_program_prints_the_same_as_with_embree() {
    let Some(program) = program() else { return };
    let embree = text(&Command::new(&program).output().expect("it runs"));
    assert!(embree.lines().count() > 80 && embree.ends_with("filters were called 1\n"), "{embree}");
    let folder = folder();
    for accel in
        ["nested", "nested:isa=portable", "grid:mailbox=on", "grid-octant", "bsp", "obvhs-cwbvh", "brute", "auto"]
    {
        let ours = Command::new(&program).env("LD_LIBRARY_PATH", &folder).env("SKIPGRID_ACCEL", accel).output();
        assert_eq!(text(&ours.expect("it runs")), embree, "{accel}");
    }

    // Who was there: the report says so.
    let report = folder.join("report.json");
    let run = Command::new(&program).env("LD_LIBRARY_PATH", &folder).env("SKIPGRID_REPORT", &report).output();
    text(&run.expect("it runs"));
    let line = std::fs::read_to_string(&report).expect("a report is written");
    for part in
        ["\"library\":\"skipgrid-embree3\"", "\"accelerator\":\"nested\"", "\"devices\":1,", "\"closest_rays\":"]
    {
        assert!(line.contains(part), "{part}: {line}");
    }
    assert!(!line.contains("\"closest_rays\":0,"), "{line}");

    // A wrong accelerator is no device.
    let wrong =
        Command::new(&program).env("LD_LIBRARY_PATH", &folder).env("SKIPGRID_ACCEL", "gird").output().expect("it runs");
    let said = String::from_utf8_lossy(&wrong.stderr);
    assert!(said.contains("did you mean `grid`"), "{said}");
    assert!(String::from_utf8_lossy(&wrong.stdout).starts_with("device 0\n"));

    match Command::new("valgrind").arg("--version").output() {
        Err(error) => println!("skipped in part: no valgrind: {error}"),
        Ok(_) => {
            let checked = Command::new("valgrind")
                .args(["--quiet", "--leak-check=full", "--show-leak-kinds=definite,indirect"])
                .args(["--errors-for-leak-kinds=definite,indirect", "--error-exitcode=9"])
                .arg(&program)
                .env("LD_LIBRARY_PATH", &folder)
                .output()
                .expect("valgrind runs");
            assert_eq!(text(&checked), embree, "{}", String::from_utf8_lossy(&checked.stderr));
        }
    }
}
