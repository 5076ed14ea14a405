//! Shards that do not make a picture: each fault is told with the file's name, and nothing is written.

use super::*;
use skipgrid::shards::{label, read};
use std::time::SystemTime;

const PICTURE: [&str; 5] = ["cornell", "--size", "16x16", "--spp", "4"];
const CUTS: [&str; 4] = ["--tile-size", "8x8", "--samples-per-shard", "2"];

/// A folder with all shards of [`PICTURE`], and the plan.
fn all_shards(test: &str) -> (PathBuf, Vec<String>) {
    let folder = folder(test);
    let lines = plan(&folder, &PICTURE, &CUTS);
    lines.iter().for_each(|line| {
        follow(&folder, line).done(&[]);
    });
    assert_eq!(shards(&folder).len(), 8);
    (folder, lines)
}

fn name(path: &Path) -> String {
    path.file_name().expect("a file").to_string_lossy().into_owned()
}

/// Merging is refused with these words, and there is no picture.
fn refused(folder: &Path, words: &[&str]) {
    merge(folder, "merged.exr").refused(2, words);
    assert!(!folder.join("merged.exr").exists());
}

#[test]
fn missing_shards_are_named_by_the_commands_that_make_them() {
    let (folder, lines) = all_shards("missing");
    let gone = [1, 6];
    for i in gone {
        let file = lines[i].rsplit(' ').next().expect("a file name");
        fs::remove_file(folder.join(file)).expect("it was made");
    }
    let run = merge(&folder, "merged.exr");
    run.refused(1, &["2 of the shards are missing", "tile 0,0,8,8, samples 2..4"]);
    assert_eq!(run.stdout.lines().collect::<Vec<_>>(), gone.map(|i| lines[i].as_str()));
    assert!(!folder.join("merged.exr").exists());
    run.stdout.lines().for_each(|line| {
        follow(&folder, line).done(&["million rays"]);
    });
    merge(&folder, "merged.exr").done(&["8 shards"]);
    assert!(fs::read(folder.join("merged.exr")).expect("written") == unsharded(&folder, &PICTURE, "whole.exr"));
    fs::remove_dir_all(folder.join("parts")).expect("there");
    merge(&folder, "again.exr").refused(3, &["parts"]);
    fs::create_dir(folder.join("parts")).expect("writable");
    merge(&folder, "again.exr").refused(2, &["parts", "no file that ends in .shard.exr"]);
}

#[test]
fn samples_that_two_shards_have_are_refused_by_both_names() {
    let (folder, _) = all_shards("twice");
    let files = shards(&folder);
    let copy = folder.join("parts/copy.shard.exr");
    fs::copy(&files[2], &copy).expect("writable");
    refused(&folder, &["copy.shard.exr", &name(&files[2]), "overlaps"]);
    fs::remove_file(&copy).expect("there");
    // Another division of the same picture.
    let line = &plan(&folder, &PICTURE, &["--tile-size", "4x4"])[0];
    follow(&folder, line).done(&[]);
    refused(&folder, &["overlaps", "tile 0,0,4,4, samples 0..4"]);
    // All samples of all pixels, but of tiles that are not equal.
    fs::remove_dir_all(folder.join("parts")).expect("there");
    for (tile, samples) in [("0,0,16,16", "0..2"), ("0,0,8,16", "2..4"), ("8,0,8,16", "2..4")] {
        let out = format!("parts/{tile}.shard.exr");
        skipgrid(&folder, &[&["shard"], &PICTURE[..], &["--tile", tile, "--samples", samples, "-o", &out]].concat())
            .done(&[]);
    }
    refused(&folder, &["tiles must be equal or have no pixel in common"]);
}

#[test]
fn shards_of_other_pictures_are_refused_with_the_difference() {
    let (folder, _) = all_shards("foreign");
    let foreign = |changes: &[&str], words: &[&str]| {
        let line = plan(&folder, &[&PICTURE[..], changes].concat(), &CUTS).swap_remove(0);
        follow(&folder, &line).done(&[]);
        let file = line.rsplit(' ').next().expect("a file name");
        refused(&folder, &[&[file, "of another picture than most"], words].concat());
        fs::remove_file(folder.join(file)).expect("there");
    };
    foreign(&["--seed", "1"], &["seed is `1`, not `0`"]);
    foreign(&["--max-depth", "3"], &["maxDepth is `3`, not `8`"]);
    foreign(&["--integrator", "depth"], &["integrator is `depth`"]);
    foreign(&["--accel", "grid"], &["accelerator is `grid`"]);
    foreign(&["--crop", "0,0,8,8"], &["area is `0,0,8,8`, not `0,0,16,16`"]);
    merge(&folder, "merged.exr").done(&[]);
}

#[test]
fn a_scene_that_changes_is_refused_by_shards_and_by_merge() {
    let folder = folder("scene");
    let cube = |height: f32| {
        let corners = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, height, 0.0), (0.0, 0.0, 1.0)];
        let corners: String = corners.iter().map(|(x, y, z)| format!("v {x} {y} {z}\n")).collect();
        corners + "f 1 2 3\nf 1 3 4\nf 1 4 2\nf 2 4 3\n"
    };
    let name = "a tetra'hedron $HOME.obj";
    let picture = [name, "--size", "8x8", "--spp", "2"];
    let cuts = ["--samples-per-shard", "1"];
    write(&folder, name, cube(1.0));
    let lines = plan(&folder, &picture, &cuts);
    follow(&folder, &lines[0]).done(&[]);
    // A comment is no change, a corner is one.
    write(&folder, name, cube(1.0) + "# the end\n");
    follow(&folder, &lines[1]).done(&[]);
    merge(&folder, "merged.exr").done(&["2 shards"]);
    assert!(fs::read(folder.join("merged.exr")).expect("written") == unsharded(&folder, &picture, "whole.exr"));
    write(&folder, name, cube(1.5));
    let made = fs::read(&shards(&folder)[1]).expect("there");
    fs::remove_file(&shards(&folder)[1]).expect("there");
    follow(&folder, &lines[1]).refused(2, &[name, "is not the scene that was planned"]);
    assert_eq!(shards(&folder).len(), 1);
    let other = plan(&folder, &picture, &cuts);
    follow(&folder, &other[1]).done(&[]);
    let (_, place) = label(&shards(&folder)[0]).expect("a shard");
    assert!(place.samples.len() == 1 && other[1] != lines[1]);
    fs::remove_file(folder.join("merged.exr")).expect("there");
    refused(&folder, &["of another picture than most: scene digest is `"]);
    // More of them are in order.
    write(&folder, "parts/second.shard.exr", made);
    refused(&folder, &["of another picture than most: scene digest is `"]);
}

#[test]
fn damaged_files_and_what_is_no_shard_are_refused_by_name() {
    let (folder, lines) = all_shards("damaged");
    let file = shards(&folder)[3].clone();
    let good = fs::read(&file).expect("a shard");
    let mut places: Vec<usize> = (0..good.len()).step_by(7).collect();
    places.push(good.len() - 1);
    for i in places {
        let mut bytes = good.clone();
        bytes[i] ^= 1 << (i % 8);
        fs::write(&file, bytes).expect("writable");
        let error = read(&file).expect_err("a flipped bit").to_string();
        assert!(error.contains(&name(&file)), "{error}");
        assert!(label(&file).is_err(), "bit {} of byte {i}", i % 8);
    }
    for end in (0..good.len()).step_by(11) {
        fs::write(&file, &good[..end]).expect("writable");
        assert!(read(&file).is_err() && label(&file).is_err(), "{end} bytes");
    }
    refused(&folder, &[&name(&file), "damaged: its digest is"]);
    fs::write(&file, &good[..100]).expect("writable");
    refused(&folder, &[&name(&file), "is no shard, or not a whole one"]);
    // The plan makes it anew, with the same bytes.
    let line = lines.iter().find(|line| line.ends_with(&name(&file))).expect("its line");
    follow(&folder, line).done(&["it will be made anew", "million rays"]);
    assert!(fs::read(&file).expect("there") == good);
    unsharded(&folder, &PICTURE, "parts/picture.shard.exr");
    write(&folder, "parts/text.shard.exr", "no shard at all");
    refused(&folder, &["picture.shard.exr", "; ", "text.shard.exr", "is no shard"]);
    let run = skipgrid(&folder, &["merge", "parts/none.shard.exr", "-o", "merged.exr"]);
    run.refused(3, &["parts/none.shard.exr"]);
}

#[test]
fn a_shard_that_is_there_is_left_as_it_is() {
    let (folder, lines) = all_shards("there");
    let state = || {
        shards(&folder).into_iter().map(|file| {
            let meta = fs::metadata(&file).expect("there");
            #[cfg(unix)]
            let inode = std::os::unix::fs::MetadataExt::ino(&meta);
            #[cfg(not(unix))]
            let inode = 0u64;
            (file, inode, meta.modified().unwrap_or(SystemTime::UNIX_EPOCH))
        })
    };
    let before: Vec<_> = state().collect();
    lines.iter().for_each(|line| {
        follow(&folder, line).done(&["is there already"]);
    });
    // Without the digest the scene is read first.
    let by_hand = ["--tile", "8,0,8,8", "--samples", "0..2", "-o"];
    let file = before.iter().find(|(file, ..)| name(file).contains("x8-y0-8x8-s0-2")).expect("this shard");
    let file = file.0.to_str().expect("a plain name");
    skipgrid(&folder, &[&["shard"], &PICTURE[..], &by_hand, &[file]].concat()).done(&["is there already"]);
    assert_eq!(before, state().collect::<Vec<_>>());
    // Another one under its name is replaced, and that is said.
    let seeded = [&["shard"], &PICTURE[..], &["--seed", "9"], &by_hand, &[file]].concat();
    skipgrid(&folder, &seeded).done(&["will be replaced: seed is `0`, not `9`", "million rays"]);
    assert_ne!(before, state().collect::<Vec<_>>());
}

#[test]
fn plans_and_shards_that_cannot_be_are_refused() {
    let folder = folder("usage");
    let shard = |tile: &str, samples: &str, out: &str, words: &[&str]| {
        let place = ["--tile", tile, "--samples", samples, "-o", out];
        skipgrid(&folder, &[&["shard"], &PICTURE[..], &place].concat()).refused(2, words);
    };
    shard("8,8,9,8", "0..4", "a.shard.exr", &["--tile 8,8,9,8 leaves the picture"]);
    shard("0,0,8,8", "2..5", "a.shard.exr", &["--samples 2..5 are beyond the 4"]);
    shard("0,0,8,8", "0..4", "a.exr", &["a.exr", "ends in .shard.exr"]);
    let plan = |args: &[&str], words: &[&str]| {
        let common = ["plan", "cornell", "--shards-in", "parts", "-o", "out.exr"];
        skipgrid(&folder, &[&common, args].concat()).refused(2, words);
    };
    plan(&["--size", "4000x4000", "--tile-size", "1x1"], &["16000000 shards, at most 1000000"]);
    plan(&["--size", "6000x6000"], &["smaller tiles take less"]);
    plan(&["--size", "64x64", "--crop", "60,0,5,5"], &["leaves the picture of 64x64"]);
    plan(&["--integrator", "depth", "--spp", "5"], &["no square number"]);
    for bad in [["--tile", "0,0,0,8"], ["--samples", "4..4"], ["--samples", "5..4"]] {
        let run = skipgrid(&folder, &[&["shard", "cornell", "-o", "a.shard.exr"], &bad[..]].concat());
        assert_eq!(run.code, Some(2), "{bad:?}");
    }
    let run = skipgrid(&folder, &["plan", "a\nb.obj", "--shards-in", "parts", "-o", "out.exr"]);
    run.refused(3, &["b.obj"]);
    write(&folder, "a\nb.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let run = skipgrid(&folder, &["plan", "a\nb.obj", "--shards-in", "parts", "-o", "out.exr"]);
    run.refused(2, &["has a line break"]);
    assert!(run.stdout.is_empty());
    assert_eq!(names(&folder), ["a\nb.obj"]);
}
