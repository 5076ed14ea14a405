//! Merged pictures are those of one render, however they were cut, in whatever order, with whatever accelerator.

use super::*;
use skipgrid::render::{Film, Sampler, Settings, join, render, render_part};
use skipgrid::shards::{Merged, label, merge as merge_files};
use skipgrid::{picture::io, scene};

#[test]
fn however_it_is_cut_the_file_is_that_of_one_render() {
    let cases: [(&str, &[&str], &[&str], usize); 8] = [
        ("tiles", &["cornell", "--size", "50x37", "--spp", "16"], &["--tile-size", "16x16"], 12),
        ("samples", &["cornell", "--size", "20x20", "--spp", "16"], &["--samples-per-shard", "4"], 4),
        ("uneven", &["cornell", "--size", "20x20", "--spp", "23", "--seed", "5"], &["--samples-per-shard", "5"], 5),
        ("both", &["cornell", "--size", "30x20", "--spp", "11"], &["--tiles", "3x2", "--samples-per-shard", "3"], 24),
        ("one", &["cornell", "--size", "16x16", "--spp", "4"], &[], 1),
        (
            "whitted",
            &["flakes:depth=1", "--integrator", "whitted", "--size", "24x18", "--spp", "9", "--accel", "grid"],
            &["--tile-size", "12x12", "--samples-per-shard", "2"],
            20,
        ),
        (
            "steps",
            &["random:n=200", "--integrator", "steps", "--size", "24x24", "--accel", "grid:density=4"],
            &["--tiles", "2x2"],
            4,
        ),
        (
            "crop",
            &["cornell", "--size", "60x60", "--spp", "8", "--crop", "21,13,20,17", "--max-depth", "3"],
            &["--tile-size", "8x8", "--samples-per-shard", "8"],
            9,
        ),
    ];
    for (name, picture, cuts, count) in cases {
        let folder = folder(name);
        let lines = plan(&folder, picture, cuts);
        assert_eq!(lines.len(), count, "{name}");
        // The last one first: no shard needs another.
        lines.iter().rev().for_each(|line| {
            follow(&folder, line).done(&["million rays"]);
        });
        merge(&folder, "merged.exr").done(&[&format!("{count} shards")]);
        let merged = fs::read(folder.join("merged.exr")).expect("just written");
        assert!(merged == unsharded(&folder, picture, "whole.exr"), "{name}: the files differ");
        merge(&folder, "merged.png").done(&[]);
        let merged = fs::read(folder.join("merged.png")).expect("just written");
        assert!(merged == unsharded(&folder, picture, "whole.png"), "{name}: the PNG files differ");
        let lit = io::read(folder.join("whole.exr")).expect("a picture").pixels.iter().flatten().any(|&v| v > 0.0);
        assert!(lit, "{name} is black");
    }
}

#[test]
fn sums_variances_and_rays_are_those_of_one_film_in_any_order() {
    let folder = folder("order");
    let lines = plan(
        &folder,
        &["cornell", "--size", "24x16", "--spp", "10", "--accel", "nested"],
        &["--tiles", "2x1", "--samples-per-shard", "3"],
    );
    lines.iter().for_each(|line| {
        follow(&folder, line).done(&[]);
    });
    let scene = scene::load("cornell", &Default::default()).expect("made by formula");
    let settings = Settings { width: 24, height: 16, sampler: Sampler::Sobol(10), ..Settings::default() };
    let whole = render(&scene, &*scene.accel("grid").expect("a grid"), &settings, &|_, _| {}).expect("a film");
    let mut files = shards(&folder);
    assert_eq!(files.len(), 8);
    for _ in 0..files.len() {
        files.rotate_left(1);
        files.swap(0, 5);
        let Ok(Merged::Whole(job, film)) = merge_files(&files) else { panic!("all shards are there: {files:?}") };
        assert_eq!(job.total, 10);
        assert_eq!(film, whole);
        let bits =
            |film: &Film| film.variance_of_mean().pixels.iter().flatten().map(|v| v.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&film), bits(&whole));
    }
}

#[test]
fn parts_by_any_accelerator_join_to_the_same_film() {
    for (name, accels) in [
        ("cornell", &["grid", "nested", "bsp", "obvhs-cwbvh", "brute"][..]),
        ("random:n=60", &["grid-octant", "nested", "obvhs-bvh2"]),
        ("teapot-patches", &["grid", "grid:seeds=voxel"]),
        ("voxel-terrain", &["voxels", "grid"]),
    ] {
        let scene = scene::load(name, &Default::default()).expect("made by formula");
        let settings = Settings { width: 12, height: 9, sampler: Sampler::Sobol(13), seed: 3, ..Settings::default() };
        let first = scene.accel(accels[0]).expect(name);
        let whole = render(&scene, &*first, &settings, &|_, _| {}).expect("a film");
        // Each part by another accelerator.
        let accels: Vec<_> = accels.iter().map(|accel| scene.accel(accel).expect(accel)).collect();
        for cuts in [[0, 13, 13], [0, 4, 8], [0, 1, 12], [0, 7, 11]] {
            let ends = [cuts[1], cuts[2], 13];
            let mut films = Vec::new();
            for (i, (start, end)) in cuts.into_iter().zip(ends).enumerate().filter(|(_, (a, b))| a < b) {
                let accel = &accels[i % accels.len()];
                films.extend(render_part(&scene, &**accel, &settings, start..end, &|_, _| {}).expect("a part"));
            }
            films.reverse();
            assert_eq!(join(13, films).expect("all samples"), whole, "{name} {cuts:?}");
        }
        assert!(render_part(&scene, &*first, &settings, 5..14, &|_, _| {}).is_err());
    }
}

#[test]
fn a_shard_is_the_same_file_on_any_number_of_threads_and_says_what_it_is() {
    let folder = folder("threads");
    let picture = ["cornell", "--size", "40x40", "--spp", "6", "--accel", "grid"];
    let mut files: Vec<Vec<u8>> = Vec::new();
    for threads in ["1", "2", "5"] {
        let threaded = [&picture[..], &["--threads", threads]].concat();
        let lines = plan(&folder, &threaded, &["--tile-size", "40x20", "--samples-per-shard", "5"]);
        assert!(lines[0].contains(&format!(" --threads {threads} ")), "{}", lines[0]);
        follow(&folder, &lines[0]).done(&[]);
        let [file] = &shards(&folder)[..] else { panic!("one shard") };
        files.push(fs::read(file).expect("just written"));
        let (job, place) = label(file).expect("a shard");
        assert_eq!(place.to_string(), "tile 0,0,40,20, samples 0..5");
        assert_eq!(file.file_name().expect("a file").to_string_lossy(), place.file_name(&job));
        assert_eq!(job.attributes.get("accelerator"), Some("grid"));
        fs::remove_file(file).expect("there");
    }
    assert!(files.windows(2).all(|pair| pair[0] == pair[1]));
}

#[test]
fn the_sums_can_be_read_by_anything_that_reads_exr() {
    let folder = folder("form");
    let lines = plan(&folder, &["cornell", "--size", "8x8", "--spp", "4"], &["--tile-size", "8x4"]);
    follow(&folder, &lines[1]).done(&[]);
    let scene = scene::load("cornell", &Default::default()).expect("made by formula");
    let settings = Settings { width: 8, height: 8, sampler: Sampler::Sobol(4), ..Settings::default() };
    let whole = render(&scene, &*scene.accel("brute").expect("a list"), &settings, &|_, _| {}).expect("a film");
    let path = &shards(&folder)[0];
    let (words, attributes) = io::decode_words(path, &fs::read(path).expect("there")).expect("an EXR file");
    assert_eq!((words.whole, words.corner, words.size), ([8, 8], [0, 4], [8, 4]));
    let channel = |name: &str| &words.channels.iter().find(|(n, _)| n == name).expect(name).1;
    let (high, low) = (channel("0-4.squares.G.high"), channel("0-4.squares.G.low"));
    for i in 0..32 {
        let value = f64::from_bits(u64::from(high[i]) << 32 | u64::from(low[i]));
        assert_eq!(value, whole.sum_squares[32 + i].y, "pixel {i}");
    }
    assert_eq!(words.channels.len(), 12);
    assert_eq!(attributes.get("shardTile"), Some("0,4,8,4"));
    assert_eq!(attributes.get("shardSamples"), Some("0..4 of 4"));
}
