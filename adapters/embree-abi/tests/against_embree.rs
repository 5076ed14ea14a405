//! C programs that use everything the libraries support print the same text with Embree itself and with these libraries, by every kind of
//! accelerator; and valgrind finds nothing lost in them.
//!
//! Embree 3 comes from the system, Embree 4 from the Python package embreex. Skips, and says so, where one of them, a C compiler or
//! valgrind is missing.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const ACCELERATORS: [&str; 8] =
    ["nested", "nested:isa=portable", "grid:mailbox=on", "grid-octant", "bsp", "obvhs-cwbvh", "brute", "auto"];

fn scratch(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}-{}", std::process::id()))
}

/// A program of this folder, compiled with what follows; `None` if there is no compiler or no Embree 3.
fn compiled(source: &str, link: &[&str]) -> Option<PathBuf> {
    let program = scratch(source.trim_end_matches(".c"));
    let tried = Command::new("cc")
        .args(["-Wall", "-Wextra", "-Werror", "-o"])
        .args([&program, &Path::new(env!("CARGO_MANIFEST_DIR")).join("tests").join(source)])
        .args(link)
        .args(["-lpthread", "-lm"])
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

/// Embree 4 as the Python package embreex brings it.
fn embree_four() -> Option<PathBuf> {
    let script = "import embreex, pathlib; \
                  print(next((pathlib.Path(embreex.__file__).parent.parent / 'embreex.libs').glob('libembree4*')))";
    match Command::new("python3").args(["-c", script]).output() {
        Ok(output) if output.status.success() => Some(String::from_utf8_lossy(&output.stdout).trim().into()),
        _ => {
            println!("skipped: there is no Python package embreex, which brings Embree 4");
            None
        }
    }
}

/// The library of a package, built as these tests are.
fn library(package: &str) -> PathBuf {
    let built = Command::new(env!("CARGO")).args(["build", "--quiet", "--package", package]).status();
    assert!(built.expect("cargo runs").success(), "the library is not built");
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).parent().expect("the folder lies in `target`");
    target.join("debug").join(format!("lib{}.so", package.replace('-', "_")))
}

/// Runs the program with Embree, which lies in the folder `embree` or where the loader finds it, then by every accelerator in its place and
/// under valgrind. `ours` is the variable that makes the loader find our library, and its value.
fn compare(program: &Path, embree: &Path, ours: &(&str, PathBuf)) {
    let search = ("LD_LIBRARY_PATH", embree);
    let run = |command: &mut Command| text(&command.output().expect("it runs"));
    let expected = run(Command::new(program).env(search.0, search.1));
    assert!(expected.lines().count() > 15, "{expected}");
    for accel in ACCELERATORS {
        let found =
            run(Command::new(program).env(search.0, search.1).env(ours.0, &ours.1).env("SKIPGRID_ACCEL", accel));
        assert_eq!(found, expected, "{accel}");
    }
    if let Err(error) = Command::new("valgrind").arg("--version").output() {
        println!("skipped in part: no valgrind: {error}");
        return;
    }
    let checked = Command::new("valgrind")
        .args(["--quiet", "--leak-check=full", "--show-leak-kinds=definite,indirect"])
        .args(["--errors-for-leak-kinds=definite,indirect", "--error-exitcode=9"])
        .arg(program)
        .env(search.0, search.1)
        .env(ours.0, &ours.1)
        .output()
        .expect("valgrind runs");
    assert_eq!(text(&checked), expected, "{}", String::from_utf8_lossy(&checked.stderr));
}

fn text(output: &Output) -> String {
    assert!(output.status.success(), "{output:?}");
    String::from_utf8_lossy(&output.stdout).into_owned()
}

#[test]
fn a_program_for_embree_3_prints_the_same() {
    let Some(program) = compiled("program.c", &["-lembree3"]) else { return };
    let folder = scratch("library");
    std::fs::create_dir_all(&folder).expect("the target folder is writable");
    std::fs::copy(library("skipgrid-embree3"), folder.join("libembree3.so.3")).expect("the library is there");
    let ours = ("LD_LIBRARY_PATH", folder.clone());
    compare(&program, Path::new(""), &ours);

    // Who was there: the report says so.
    let report = folder.join("report.json");
    let run = Command::new(&program).env(ours.0, &ours.1).env("SKIPGRID_REPORT", &report).output();
    text(&run.expect("it runs"));
    let line = std::fs::read_to_string(&report).expect("a report is written");
    for part in
        ["\"library\":\"skipgrid-embree3\"", "\"accelerator\":\"nested\"", "\"devices\":1,", "\"closest_rays\":"]
    {
        assert!(line.contains(part), "{part}: {line}");
    }
    assert!(!line.contains("\"closest_rays\":0,"), "{line}");

    // A wrong accelerator is no device.
    let wrong = Command::new(&program).env(ours.0, &ours.1).env("SKIPGRID_ACCEL", "gird").output().expect("it runs");
    let said = String::from_utf8_lossy(&wrong.stderr);
    assert!(said.contains("did you mean `grid`"), "{said}");
    assert_eq!(String::from_utf8_lossy(&wrong.stdout), "device 0\n");
}

#[test]
fn a_program_for_embree_4_prints_the_same() {
    let Some(embree) = embree_four() else { return };
    let link = embree.to_string_lossy();
    let Some(program) = compiled("program4.c", &[&link]) else { return };
    let folder = embree.parent().expect("a library lies in a folder");
    compare(&program, folder, &("LD_PRELOAD", library("skipgrid-embree4")));
}
