//! `skipgrid run-under`: real programs with another library in the place of Embree, and what is refused.
//!
//! Programs are made here by the C compiler. Where Embree's headers are installed, one links Embree itself; the library that takes
//! its place is a small one, also made here, that says so.

#![cfg(target_os = "linux")]

use std::fs;
use std::io::{Read, Write};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};

/// What the library of these tests does in the place of Embree 3: it reports as ours does.
const LIBRARY: &str = r#"
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>
static int device;
void *rtcNewDevice(const char *config) { (void)config; return &device; }
void rtcReleaseDevice(void *device) {
    (void)device;
    FILE *report = fopen(getenv("SKIPGRID_REPORT"), "a");
    fprintf(report, "{\"library\":\"test\",\"accelerator\":\"%s\",\"commits\":2,\"build_seconds\":0.5,\"primitives\":3,"
        "\"bytes\":64,\"closest_rays\":40,\"any_rays\":2,\"errors\":0,\"causes\":\"\"}\n", getenv("SKIPGRID_ACCEL"));
    fclose(report);
}
"#;

/// Makes a device if told to, copies its input, and ends as it is told.
const PROGRAM: &str = r#"
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
void *rtcNewDevice(const char *config);
void rtcReleaseDevice(void *device);
int main(int count, char **words) {
    int end = atoi(words[1]);
    setvbuf(stdout, NULL, _IONBF, 0);
    if (count < 3) rtcReleaseDevice(rtcNewDevice(NULL));
    for (int c; (c = getchar()) != EOF;) putchar(c);
    fputs("said by the program\n", stderr);
    if (end < 0) raise(-end);
    return end;
}
"#;

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// An empty folder of the test's own, with an empty one below it for what is temporary.
fn folder(test: &str) -> PathBuf {
    let folder = crate::folder("run_under", test);
    fs::create_dir_all(folder.join("tmp")).expect("the target folder is writable");
    folder
}

/// Compiles C; `None` if there is no compiler.
fn compile(folder: &Path, source: &str, out: &str, options: &[&str]) -> Option<PathBuf> {
    let (file, out) = (folder.join(format!("{out}.c")), folder.join(out));
    fs::write(&file, source).expect("the target folder is writable");
    let Ok(run) = Command::new("cc").arg(&file).arg("-o").arg(&out).args(options).current_dir(folder).output() else {
        eprintln!("skipped: no C compiler");
        return None;
    };
    assert!(run.status.success(), "{}", text(&run.stderr));
    Some(out)
}

/// The library of these tests by both its names, and the program linked to it with `options`.
fn program(folder: &Path, options: &[&str]) -> Option<PathBuf> {
    let shared = ["-shared", "-fPIC", "-Wl,-soname,libembree3.so.3"];
    let ours = compile(folder, LIBRARY, "libskipgrid_embree3.so", &shared)?;
    fs::create_dir_all(folder.join("theirs")).expect("the target folder is writable");
    // Theirs makes no report.
    let theirs = folder.join("theirs").join("libembree3.so.3");
    let silent = "void *rtcNewDevice(const char *c) { return (void *)c; } void rtcReleaseDevice(void *d) { (void)d; }";
    fs::rename(compile(folder, silent, "theirs.so", &shared)?, &theirs).expect("the target folder is writable");
    let all: Vec<&str> = [theirs.to_str().expect("Unicode")].into_iter().chain(options.iter().copied()).collect();
    assert!(ours.exists());
    compile(folder, PROGRAM, "program", &all)
}

/// Starts `skipgrid run-under` in `folder`.
fn start(folder: &Path, args: &[&str]) -> Child {
    Command::new(env!("CARGO_BIN_EXE_skipgrid"))
        .arg("run-under")
        .args(args)
        .current_dir(folder)
        .env("TMPDIR", folder.join("tmp"))
        .env_remove("SKIPGRID_ACCEL")
        .env_remove("SKIPGRID_EMBREE_LIBRARY")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts")
}

/// Runs `skipgrid run-under` in `folder` with `input`.
fn run_under(folder: &Path, args: &[&str], input: &str) -> Output {
    let mut child = start(folder, args);
    // One that is refused does not read.
    let _ = child.stdin.take().expect("piped").write_all(input.as_bytes());
    end(folder, child)
}

/// Waits for the end, after which nothing temporary may be left.
fn end(folder: &Path, child: Child) -> Output {
    let output = child.wait_with_output().expect("the program ends");
    assert!(!text(&output.stderr).contains("panicked"), "{}", text(&output.stderr));
    let left = fs::read_dir(folder.join("tmp")).expect("the folder exists").count();
    assert_eq!(left, 0, "something is left in the temporary folder");
    output
}

/// The program is swapped by `by`, its ends and streams are its own, and what was traced is said.
fn check_swap(folder: &Path, program: &Path, by: &str) {
    let program = program.to_str().expect("Unicode");
    for (end, code) in [("0", 0), ("7", 7), ("-15", 143)] {
        let run = run_under(folder, &["--accel", "grid:density=3", "--library", ".", "--", program, end], "through\n");
        let said = text(&run.stderr);
        assert_eq!(run.status.code(), Some(code), "{said}");
        assert_eq!(text(&run.stdout), "through\n");
        assert!(said.contains("links Embree 3 as libembree3.so.3"), "{said}");
        assert!(said.contains(&format!("instead, by {by}")), "{said}");
        assert!(said.contains("said by the program"), "{said}");
        assert!(
            said.contains("grid:density=3: 40 rays for the closest hit and 2 for any hit, 2 builds in 0.500 s"),
            "{said}"
        );
    }
}

#[test]
fn the_library_goes_before_the_systems_and_before_runpath() {
    let folder = folder("runpath");
    let Some(program) = program(&folder, &["-Wl,--enable-new-dtags,-rpath,$ORIGIN/theirs"]) else { return };
    check_swap(&folder, &program, "LD_LIBRARY_PATH");
}

#[test]
fn the_library_is_preloaded_where_a_folder_is_fixed() {
    let folder = folder("rpath");
    let Some(program) = program(&folder, &["-Wl,--disable-new-dtags,-rpath,$ORIGIN/theirs"]) else { return };
    check_swap(&folder, &program, "LD_PRELOAD");
}

#[test]
fn a_program_without_a_device_is_a_warning_and_quiet_is_quiet() {
    let folder = folder("no_device");
    let Some(program) = program(&folder, &["-Wl,-rpath,$ORIGIN/theirs"]) else { return };
    let program = program.to_str().expect("Unicode");
    let run = run_under(&folder, &["--library", ".", "--", program, "0", "no device"], "");
    assert_eq!(run.status.code(), Some(0));
    assert!(text(&run.stderr).contains("without making an Embree device"), "{}", text(&run.stderr));
    let run = run_under(&folder, &["--quiet", "--library", ".", "--", program, "0"], "");
    assert_eq!((run.status.code(), text(&run.stderr).as_str()), (Some(0), "said by the program\n"));
}

/// The keyboard's interrupt reaches the program by itself; a request to end is passed on.
#[test]
fn a_request_to_end_is_the_programs() {
    let folder = folder("signal");
    let Some(program) = program(&folder, &["-Wl,-rpath,$ORIGIN/theirs"]) else { return };
    let mut child = start(&folder, &["--library", ".", "--", program.to_str().expect("Unicode"), "0"]);
    // It copies what it is given, so that it runs once this came back.
    let mut input = child.stdin.take().expect("piped");
    input.write_all(b"!").expect("it reads");
    child.stdout.as_mut().expect("piped").read_exact(&mut [0]).expect("it writes");
    let kill = Command::new("kill").args(["-TERM", &child.id().to_string()]).status().expect("there is a kill");
    assert!(kill.success());
    let run = end(&folder, child);
    assert_eq!(run.status.code(), Some(128 + 15), "{}", text(&run.stderr));
    assert!(text(&run.stderr).contains("nested: 40 rays"), "{}", text(&run.stderr));
    drop(input);
}

#[test]
fn reports_are_added_to_a_file() {
    let folder = folder("report");
    let Some(program) = program(&folder, &["-Wl,-rpath,$ORIGIN/theirs"]) else { return };
    let program = program.to_str().expect("Unicode");
    for lines in [1, 2] {
        let args = ["--report", "report.jsonl", "--accel", "brute", "--library", ".", "--", program, "0"];
        assert_eq!(run_under(&folder, &args, "").status.code(), Some(0));
        let report = fs::read_to_string(folder.join("report.jsonl")).expect("it was written");
        assert_eq!(report.lines().filter(|line| line.contains(r#""accelerator":"brute""#)).count(), lines);
    }
}

#[test]
fn a_script_may_name_the_file_that_links_embree() {
    let folder = folder("script");
    let Some(program) = program(&folder, &["-Wl,-rpath,$ORIGIN/theirs"]) else { return };
    let script = folder.join("script");
    fs::write(&script, "#!/bin/sh\n./program 5\n").expect("the target folder is writable");
    fs::set_permissions(&script, fs::Permissions::from_mode(0o755)).expect("the target folder is writable");
    let refused = run_under(&folder, &["--library", ".", "--", "./script"], "");
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("--linked-by"), "{}", text(&refused.stderr));
    let program = program.to_str().expect("Unicode");
    let run = run_under(&folder, &["--library", ".", "--linked-by", program, "--", "./script"], "");
    assert_eq!(run.status.code(), Some(5), "{}", text(&run.stderr));
    assert!(text(&run.stderr).contains("40 rays"), "{}", text(&run.stderr));
}

/// Embree's own header and library, by the name that they are installed under.
#[test]
fn a_program_of_embrees_own_headers_is_swapped() {
    let folder = folder("embree");
    let shared = ["-shared", "-fPIC"];
    let Some(library) = compile(&folder, LIBRARY, "libskipgrid_embree3.so", &shared) else { return };
    let header = Path::new("/usr/include/embree3/rtcore.h");
    if !header.exists() {
        eprintln!("skipped: {} is not there", header.display());
        return;
    }
    let source = "#include <embree3/rtcore.h>\nint main(void) { rtcReleaseDevice(rtcNewDevice(0)); return 0; }\n";
    let Some(program) = compile(&folder, source, "program", &["-lembree3"]) else { return };
    let (program, library) = (program.to_str().expect("Unicode"), library.to_str().expect("Unicode"));
    let run = run_under(&folder, &["--library", library, "--", program], "");
    let said = text(&run.stderr);
    assert_eq!(run.status.code(), Some(0), "{said}");
    assert!(said.contains("libembree3.so.3") && said.contains("nested: 40 rays"), "{said}");
}

#[test]
fn what_cannot_be_is_refused_before_anything_starts() {
    let folder = folder("refused");
    let Some(program) = program(&folder, &["-Wl,-rpath,$ORIGIN/theirs"]) else { return };
    // Says what it lacks; and what stands in no library of the wanted kind.
    let lacking = "void *rtcNewDevice(const char *c) { return (void *)c; }";
    fs::create_dir(folder.join("lacking")).expect("the target folder is writable");
    compile(&folder, lacking, "lacking/libskipgrid_embree3.so", &["-shared", "-fPIC"]).expect("there is a compiler");
    let plain = "int main(void) { return 0; }";
    compile(&folder, plain, "plain", &[]).expect("there is a compiler");
    compile(&folder, plain, "fixed", &["-static"]).expect("there is a compiler");
    let built_in = r#"#include <stdio.h>
        int main(void) { return puts("Embree Ray Tracing Kernels 3.13.5") < 0; }"#;
    compile(&folder, built_in, "built_in", &[]).expect("there is a compiler");
    fs::write(folder.join("text"), "no program\n").expect("the target folder is writable");
    fs::write(folder.join("odd"), "neither\n").expect("the target folder is writable");
    fs::set_permissions(folder.join("odd"), fs::Permissions::from_mode(0o755)).expect("the target folder is writable");
    fs::create_dir(folder.join("empty")).expect("the target folder is writable");
    let program = program.to_str().expect("Unicode");
    for (args, code, says) in [
        (vec!["--accel", "gird", "--", program], 2, "`gird`: unknown accelerator"),
        (vec!["--accel", "grid:density=0", "--", program], 2, "density"),
        (vec!["--accel", "voxels", "--", program], 2, "any"),
        (vec!["--accel", "embree", "--", program], 2, "any"),
        (vec!["--library", ".", "--", "no-such-program"], 3, "no-such-program: no such program on PATH"),
        (vec!["--library", ".", "--", "./no-such-program"], 3, "./no-such-program"),
        (vec!["--library", ".", "--", "./text"], 3, "./text"),
        (vec!["--library", ".", "--", "./odd"], 2, "neither an ELF file nor a script"),
        (vec!["--library", ".", "--", "./plain"], 2, "links Embree as a shared library"),
        (vec!["--library", ".", "--", "./fixed"], 2, "links Embree as a shared library"),
        (vec!["--library", ".", "--", "./built_in"], 2, "Embree is built into"),
        (vec!["--library", ".", "--linked-by", "./gone", "--", "./plain"], 3, "./gone"),
        (vec!["--library", "empty", "--", program], 2, "cargo build --release -p skipgrid-embree3"),
        (vec!["--library", "gone", "--", program], 3, "gone"),
        (vec!["--library", "text", "--", program], 2, "neither `embree3` nor `embree4`"),
        (vec!["--library", "lacking", "--", program], 2, "lacks 1 of 2 functions"),
        (vec!["--report", "gone/report", "--library", ".", "--", program], 3, "gone"),
        (vec![], 2, "PROGRAM"),
    ] {
        let run = run_under(&folder, &args, "");
        let said = text(&run.stderr);
        assert_eq!(run.status.code(), Some(code), "{args:?}: {said}");
        assert!(said.contains(says), "{args:?}: {said}");
        assert!(run.stdout.is_empty() && !said.contains("said by the program"), "{args:?}: {said}");
    }
}
