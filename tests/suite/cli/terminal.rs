//! What is for terminals alone: colour, and the line that says how far the work is.
#![cfg(unix)]

use super::*;

/// What a terminal of 80 columns would show while `line` runs there; `None` where there is no `script` to make one.
fn on_a_terminal(folder: &Path, variables: &str, line: &str) -> Option<String> {
    let program = env!("CARGO_BIN_EXE_skipgrid");
    let inner = format!("stty cols 80; exec env {variables} '{program}' {line}");
    let mut command = Command::new("script");
    command.args(["-q", "-e", "-c", &inner, "/dev/null"]).current_dir(folder).stdin(Stdio::null());
    // What the tests run under must not decide.
    for name in ["NO_COLOR", "CLICOLOR", "CLICOLOR_FORCE", "CI"] {
        command.env_remove(name);
    }
    let Ok(output) = command.env("TERM", "xterm").output() else {
        eprintln!("skipped: no program `script` here");
        return None;
    };
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    // A check may say no.
    assert!(matches!(output.status.code(), Some(0 | 1)), "{line}: {text}");
    Some(text)
}

/// Whether an escape sequence in `text` sets a colour or a weight: numbers and an `m`.
fn coloured(text: &str) -> bool {
    let ends = |rest: &str| rest.trim_start_matches(|c: char| c.is_ascii_digit() || c == ';').starts_with('m');
    text.split("\x1b[").skip(1).any(ends)
}

#[test]
fn colour_is_for_terminals_that_want_it() {
    let folder = folder("colour");
    let Some(help) = on_a_terminal(&folder, "", "--help") else { return };
    assert!(coloured(&help), "{help:?}");
    for (variables, line) in [
        ("NO_COLOR=1", "--help"),
        ("TERM=dumb", "--help"),
        ("TERM=dumb CI=true", "render --help"),
        ("NO_COLOR=1 CI=true", "render --help"),
    ] {
        let Some(help) = on_a_terminal(&folder, variables, line) else { return };
        assert!(help.contains("skipgrid") && !help.contains('\x1b'), "{variables}: {help:?}");
    }
}

#[test]
fn nothing_that_is_piped_has_an_escape() {
    let folder = folder("escape");
    fs::write(folder.join("a.pfm"), pfm(1, 1, &[0.5; 3])).expect("writable");
    for (code, line) in [
        (0, "--help"),
        (0, "help render"),
        (2, ""),
        (2, "rendr"),
        (2, "render cornell --spp -1 -o a.png"),
        (0, "list"),
        (0, "info cornell"),
        (0, "render cornell --size 8x8 --spp 1 -o a.png"),
        (0, "plan cornell --size 8x8 --spp 1 --shards-in . -o a.png"),
        (0, "shard cornell --size 8x8 --spp 1 --tile 0,0,8,8 --samples 0..1 -o a.shard.exr"),
        (0, "merge a.shard.exr -o a.exr"),
        (0, "compare random:n=5 --size 4x4 --rounds 1"),
        (0, "bench random:n=5 --accel brute --rays 9 --rounds 1"),
        (0, "sweep random:n=5 --accel brute --size 4x4 --rounds 1"),
        (0, "converge cornell --accel grid --size 4x4 --spp 2"),
        (0, "stress wt_sphere_rand --accel brute --rays 9 --rounds 0"),
        (0, "papers dda --quick --size 8"),
        (0, "diff a.pfm a.pfm"),
        (0, "export cornell --to mitsuba -o a.xml"),
        // A picture of one grey is not that of the scene.
        (1, "validate --scene cornell --theirs a.pfm --accel grid --spp 1"),
        (0, "completions bash"),
        (0, "man"),
    ] {
        let run = skipgrid(&folder, &line.split_whitespace().collect::<Vec<_>>());
        assert_eq!(run.code, Some(code), "{line}: {}", run.stderr);
        for text in [run.stdout, run.stderr] {
            assert!(!text.contains('\x1b') && !text.contains('\r'), "{line}: {text:?}");
        }
    }
}

#[test]
fn a_terminal_shows_how_far_the_work_is_and_how_long_the_rest_takes() {
    let folder = folder("progress");
    // A hundred tiles; more samples until it takes seconds.
    let render = |spp: u32| format!("render cornell --size 160x160 --spp {spp} --threads 1 --accel brute -o a.pfm");
    let mut shown = String::new();
    for spp in [4, 16, 64, 256, 1024] {
        let Some(text) = on_a_terminal(&folder, "", &render(spp)) else { return };
        shown = text;
        if shown.contains(" s left") {
            break;
        }
    }
    for part in ["rendering", "[", "=>", " %, about ", " s left"] {
        assert!(shown.contains(part), "{part}: {shown:?}");
    }
    // No line is longer than the terminal: it would leave its beginnings behind.
    let drawn = shown.split("\x1b[2K").skip(1).filter(|line| line.contains(" %,"));
    for line in drawn {
        let line = line.trim_end_matches(['\r', '\n']);
        assert!(line.chars().count() <= 80, "{line:?}");
    }
    // In the end the line is gone and the words stand alone.
    let last = shown.trim_end().rsplit("\x1b[2K").next().expect("a line");
    assert!(last.trim_start().starts_with("skipgrid: a.pfm: build"), "{last:?}");
    assert!(!coloured(&shown), "{shown:?}");

    fs::write(folder.join("a.pfm"), pfm(8, 8, &[0.5; 192])).expect("writable");
    for (line, word) in [
        ("compare random:n=500 --size 16x16 --rounds 2", "timing diffuse rays"),
        ("bench random:n=500 --accel grid --rays 99 --rounds 1", "timing diffuse rays"),
        ("sweep random:n=500 --accel grid --size 8x8 --rounds 1", "timing diffuse rays"),
        ("converge cornell --accel grid --size 8x8 --spp 4", "4 samples"),
        ("stress wt_sphere_rand --accel grid --rays 99 --rounds 0", "wt_sphere_rand: "),
        ("papers dda --quick --size 16", "voxel-terrain"),
        ("validate --scene cornell --theirs a.pfm --accel grid --spp 2", "cornell"),
        ("shard cornell --size 8x8 --spp 1 --tile 0,0,8,8 --samples 0..1 -o a.shard.exr", "rendering"),
        ("merge a.shard.exr -o a.exr", "a.shard.exr"),
    ] {
        let _ = fs::remove_file(folder.join("a.exr"));
        let Some(text) = on_a_terminal(&folder, "", line) else { return };
        let drawn: Vec<&str> = text.split("\x1b[2K").filter(|part| part.contains(" %")).collect();
        assert!(drawn.iter().any(|part| part.contains(word)), "{line}: {text:?}");
        for (variables, option) in [("", "--quiet"), ("TERM=dumb", "")] {
            let Some(text) = on_a_terminal(&folder, variables, &format!("{line} {option}")) else { return };
            assert!(!text.contains('\x1b'), "{variables} {line} {option}: {text:?}");
        }
    }
}
