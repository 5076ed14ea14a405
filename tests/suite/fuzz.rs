//! Bytes at random: files mutated from small good ones, through every reader. Nothing may panic or hang.
//!
//! The same targets run under cargo-fuzz, guided by coverage: see `fuzz/`. Here the mutations are seeded and few, so that
//! they run with every test; `SKIPGRID_FUZZ_SECONDS` says for how long each target is to run instead, and
//! `SKIPGRID_FUZZ_SEED` from which seed.

#[path = "fuzz/entry.rs"]
mod entry;

use crate::random::Random;
use entry::{MOST_BYTES, TARGETS};
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Inputs of a target where no time is asked for.
const INPUTS: u64 = 400;
/// No input may take longer.
const LONGEST: Duration = Duration::from_secs(10);

fn seeds_of(target: &str) -> Vec<(PathBuf, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/suite/fuzz/seeds").join(target);
    let mut seeds: Vec<_> = fs::read_dir(&folder)
        .expect("every target has seeds")
        .map(|entry| entry.expect("readable").path())
        .map(|path| (path.clone(), fs::read(&path).expect("readable")))
        .collect();
    seeds.sort();
    assert!(!seeds.is_empty(), "{target} has no seed");
    seeds
}

fn number(variable: &str) -> Option<u64> {
    let text = std::env::var(variable).ok()?;
    Some(text.parse().unwrap_or_else(|_| panic!("{variable}={text} is no number")))
}

/// Bytes and words that readers stumble over.
const WORDS: [&[u8]; 24] = [
    b"0",
    b"-1",
    b"1e39",
    b"nan",
    b"inf",
    b"4294967295",
    b"4294967296",
    b"18446744073709551615",
    b"\0\0\0\0",
    b"\xff\xff\xff\xff",
    b"\xff\xff\xff\x7f",
    b"\0\0\0\x80",
    b"\x01\0\0\0",
    b"\0\0\xc0\x7f",
    b"\0\0\x80\x7f",
    b"{",
    b"[",
    b"\"",
    b"\n",
    b" ",
    b"/",
    b"%",
    b"\xff",
    b"\0",
];

/// One to eight changes of `bytes`; `other` is a good file to take parts from.
fn mutate(bytes: &mut Vec<u8>, other: &[u8], random: &mut Random) {
    for _ in 0..=random.below(8) {
        let at = random.below(bytes.len() + 1);
        let length = random.below(1 + (bytes.len() - at).min(64));
        match random.below(9) {
            0 if at < bytes.len() => bytes[at] ^= 1 << random.below(8),
            1 if at < bytes.len() => bytes[at] = random.next() as u8,
            2 => drop(bytes.drain(at..at + length)),
            3 => bytes.truncate(at),
            4 => drop(bytes.splice(at..at, bytes[at..at + length].to_vec())),
            5 => {
                let word = WORDS[random.below(WORDS.len())];
                let end = if random.below(2) == 0 { at } else { (at + word.len()).min(bytes.len()) };
                bytes.splice(at..end, word.iter().copied());
            }
            6 => {
                let from = random.below(other.len() + 1);
                let part = &other[from..from + random.below(1 + (other.len() - from).min(256))];
                bytes.splice(at..at + length, part.iter().copied());
            }
            7 => decimal(bytes, at, random),
            _ if at + 4 <= bytes.len() => {
                // A number of four bytes, moved a little: counts and lengths that are nearly right.
                let word: [u8; 4] = std::array::from_fn(|i| bytes[at + i]);
                let moved = u32::from_le_bytes(word).wrapping_add(random.below(9) as u32).wrapping_sub(4);
                bytes[at..at + 4].copy_from_slice(&moved.to_le_bytes());
            }
            _ => {}
        }
    }
    bytes.truncate(MOST_BYTES);
}

/// Replaces the first number in decimal behind `at`.
fn decimal(bytes: &mut Vec<u8>, at: usize, random: &mut Random) {
    let Some(start) = bytes[at..].iter().position(u8::is_ascii_digit).map(|i| at + i) else { return };
    let length = bytes[start..].iter().take_while(|b| b.is_ascii_digit()).count();
    let shift = random.below(64);
    let number = random.next() >> shift;
    bytes.splice(start..start + length, number.to_string().into_bytes());
}

/// The function's own words if it panics, or what it cost too much of.
fn fault(target: fn(&[u8]), bytes: &[u8]) -> Option<String> {
    let start = Instant::now();
    let outcome = catch_unwind(AssertUnwindSafe(|| target(bytes)));
    let took = start.elapsed();
    match outcome {
        Ok(()) => (took > LONGEST).then(|| format!("took {took:?}")),
        Err(cause) => {
            let text = cause.downcast_ref::<String>().map(String::as_str);
            Some(text.or_else(|| cause.downcast_ref::<&str>().copied()).unwrap_or("a panic").to_owned())
        }
    }
}

fn run(name: &str) {
    let (_, target) = TARGETS.iter().find(|(known, _)| *known == name).expect("a target");
    let seeds = seeds_of(name);
    for (path, bytes) in &seeds {
        assert_eq!(fault(*target, bytes), None, "{}", path.display());
    }
    let seed = number("SKIPGRID_FUZZ_SEED").unwrap_or(1);
    let time = number("SKIPGRID_FUZZ_SECONDS").map(Duration::from_secs);
    let start = Instant::now();
    let mut input = 0;
    while time.map_or(input < INPUTS, |time| start.elapsed() < time) {
        let mut random = Random::new(seed.wrapping_mul(0x1_0000_0001) ^ input);
        let mut bytes = seeds[random.below(seeds.len())].1.clone();
        mutate(&mut bytes, &seeds[random.below(seeds.len())].1, &mut random);
        if let Some(fault) = fault(*target, &bytes) {
            let kept = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("fuzz-{name}-{seed}-{input}"));
            fs::write(&kept, &bytes).expect("the target folder is writable");
            panic!("{name}: SKIPGRID_FUZZ_SEED={seed}, input {input}: {fault}; kept as {}", kept.display());
        }
        input += 1;
    }
    if time.is_some() {
        eprintln!("{name}: {input} inputs in {:.0} s", start.elapsed().as_secs_f64());
    }
    entry::clean_up();
}

#[test]
fn gltf() {
    run("gltf");
}

#[test]
fn obj() {
    run("obj");
}

#[test]
fn toml() {
    run("toml");
}

#[test]
fn vox() {
    run("vox");
}

#[test]
fn pictures() {
    run("picture");
}

#[test]
fn arrays() {
    run("arrays");
}

#[test]
fn good_files_are_read_and_small() {
    let mut all = 0;
    for (name, _) in TARGETS {
        all += seeds_of(name).iter().map(|(_, bytes)| bytes.len()).sum::<usize>();
    }
    assert!(all < 100_000, "{all} bytes of seeds");
    // A seed that is refused would never lead into the reader.
    for name in
        ["gltf/whole.gltf", "gltf/whole.glb", "gltf/sparse.glb", "gltf/quantised.glb", "vox/one.vox", "vox/graph.vox"]
    {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/suite/fuzz/seeds").join(name);
        let scene = skipgrid::scene::load(path.to_str().expect("UTF-8"), &Default::default());
        assert!(scene.is_ok_and(|s| s.primitive_count() > 0), "{name}");
    }
}
