//! Sizes that come from the user or a header and are far too large: refused before memory is taken.

use super::{folder, skipgrid, write};
use skipgrid::picture::io;
use skipgrid::scene::{LoadOptions, load};

#[test]
fn resolutions_beyond_the_budget_name_both_sizes() {
    let folder = folder("grids");
    for accel in [
        "grid:resolution=4096",
        "grid:resolution=4096x4096x4095",
        "grid-dsz:resolution=4096",
        "grid:density=1e300",
        "grid:density=1e9,memory=64M",
        "grid-octant:resolution=1000,memory=64M",
    ] {
        let args = ["info", "random:n=1000", "--accel", accel];
        skipgrid(&folder, &args).refused(2, &["wants ", " bytes, allowed are "]);
    }
    for (accel, cause) in [
        ("grid:resolution=4097", "4097"),
        ("grid:resolution=0", "0"),
        ("grid:resolution=18446744073709551616", "resolution"),
        ("grid:resolution=2x2", "resolution"),
        ("grid:density=nan", "density"),
        ("grid:density=inf", "density"),
        ("grid:density=0", "density"),
        ("grid:memory=99999999999999T", "memory"),
        ("grid-dual:lane=0", "lane"),
        ("grid-dsz:threshold=999999999999", "threshold"),
    ] {
        let run = skipgrid(&folder, &["info", "random:n=1000", "--accel", accel]);
        run.refused(2, &[cause]);
    }
    skipgrid(&folder, &["info", "random:n=1000", "--accel", "grid", "--memory-budget", "1K"]).refused(2, &["1024"]);
}

#[test]
fn films_and_counts_of_rays_are_bounded() {
    let folder = folder("films");
    let render = |extra: &[&str]| {
        let args = [&["render", "cornell", "-o", "out.png"], extra].concat();
        skipgrid(&folder, &args)
    };
    render(&["--size", "4294967295x4294967295"]).refused(2, &["4294967295x4294967295", "wants ", "allowed are"]);
    render(&["--size", "100000x100000"]).refused(2, &["film of 100000x100000 pixels"]);
    render(&["--size", "100000x100000", "--crop", "99999,99999,2,1"]).refused(2, &["crop"]);
    render(&["--spp", "4294967295"]).refused(2, &["4294967295 samples"]);
    render(&["--max-depth", "4294967295"]).refused(2, &["max_depth is 4294967295"]);
    render(&["--threads", "4096", "--size", "4x4", "--spp", "1"]).refused(2, &["4096 threads"]);
    // A corner of a picture that would not fit as a whole.
    render(&["--size", "100000x100000", "--crop", "50000,50000,2,2", "--spp", "1"]).done(&[]);
    let args = ["compare", "cornell", "--size", "4294967295x4294967295", "--max-rays", "4294967295"];
    skipgrid(&folder, &args).refused(2, &["4294967295 rays"]);
    write(&folder, "big.toml", "[render]\nwidth = 16777216\nheight = 16777216\n");
    let args = ["render", "big.toml", "-o", "out.png"];
    skipgrid(&folder, &args).refused(2, &["16777216x16777216"]);
    write(&folder, "big.toml", "[render]\nwidth = 99999999999\n");
    skipgrid(&folder, &args).refused(2, &["big.toml: line 2"]);
}

#[test]
fn procedural_scenes_and_headers_ask_before_they_take() {
    let folder = folder("headers");
    let options = LoadOptions { memory: 1 << 26, ..LoadOptions::default() };
    for scene in ["bumpy:n=8192", "random:n=50000000", "cubes:n=200"] {
        let error = load(scene, &options).expect_err(scene).to_string();
        // At 96 bytes a primitive.
        assert!(error.contains(scene) && error.contains("memory is left for 699050"), "{error}");
    }
    for scene in ["random:n=18446744073709551615", "random:n=50000001", "flakes:depth=8", "spd-tree:n=17"] {
        skipgrid(&folder, &["info", scene]).refused(2, &[scene]);
    }
    // Several bodies that would fit one by one.
    let body = "[[procedural]]\ntype = \"cubes\"\nn = 30\n";
    write(&folder, "many.toml", body.repeat(100));
    let path = folder.join("many.toml");
    let error = load(path.to_str().expect("UTF-8"), &options).expect_err("too many").to_string();
    assert!(error.contains("many.toml: line ") && error.contains("memory is left for"), "{error}");

    let npy = |descr: &str, shape: &str| {
        let header = format!("{{'descr': {descr}, 'fortran_order': False, 'shape': {shape}, }}\n");
        [b"\x93NUMPY\x01\0".as_slice(), &(header.len() as u16).to_le_bytes(), header.as_bytes()].concat()
    };
    for (name, bytes, words) in [
        ("a.npy", npy("'|u1'", "(4096, 4096, 4096)"), "promises 68719476736 voxels"),
        ("a.tri", b"TRI1\xff\xff\xff\xff".to_vec(), "4294967295 items"),
        ("a.sph", b"SPH1\xff\xff\xff\xff".to_vec(), "4294967295 items"),
    ] {
        write(&folder, name, bytes);
        skipgrid(&folder, &["info", name]).refused(2, &[name, words]);
    }
    for (name, bytes, words) in [
        ("r.npy", npy("'<f4'", "(576460752303423488, 8)"), "promises 576460752303423488 rays"),
        ("r.rays", b"RAY1\xff\xff\xff\xff".to_vec(), "4294967295 items"),
    ] {
        write(&folder, name, bytes);
        let args = ["trace", "cornell", "--rays", name, "--hits", "hits.npy"];
        skipgrid(&folder, &args).refused(2, &[name, words]);
    }
}

/// Voxels of two models that lie so far apart that the box around them has 715 million.
#[test]
fn voxels_far_apart_are_refused_before_their_box_is_filled() {
    let words = |w: &[u32]| w.iter().flat_map(|n| n.to_le_bytes()).collect::<Vec<u8>>();
    let text = |t: &str| [words(&[t.len() as u32]), t.as_bytes().to_vec()].concat();
    let chunk =
        |name: &str, content: Vec<u8>| [name.as_bytes().to_vec(), words(&[content.len() as u32, 0]), content].concat();
    let place = |id: u32, child: u32, to: &str| {
        let frame = [words(&[1]), text("_t"), text(to)].concat();
        chunk("nTRN", [words(&[id, 0, child, u32::MAX, u32::MAX, 1]), frame].concat())
    };
    let inner = [
        chunk("SIZE", words(&[1, 1, 1])),
        chunk("XYZI", words(&[1, u32::from_le_bytes([0, 0, 0, 1])])),
        chunk("nGRP", words(&[0, 0, 2, 1, 2])),
        place(1, 3, "0 0 0"),
        place(2, 3, "890 890 890"),
        chunk("nSHP", words(&[3, 0, 1, 0, 0])),
    ]
    .concat();
    let file = [b"VOX ".to_vec(), words(&[150]), b"MAIN".to_vec(), words(&[0, inner.len() as u32]), inner].concat();
    let folder = folder("vox");
    write(&folder, "far.vox", file);
    let path = folder.join("far.vox");
    let options = LoadOptions { memory: 1 << 26, ..LoadOptions::default() };
    let error = load(path.to_str().expect("UTF-8"), &options).expect_err("far apart").to_string();
    assert!(error.contains("far.vox: ") && error.contains("wants 707348019 bytes, allowed are 67108864"), "{error}");
}

/// A chunk of a PNG file; its checksum too.
fn chunk(kind: &[u8; 4], content: &[u8]) -> Vec<u8> {
    let body = [kind, content].concat();
    let crc = !body.iter().fold(u32::MAX, |crc, &b| {
        (0..8).fold(crc ^ u32::from(b), |crc, _| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 })
    });
    [&(content.len() as u32).to_be_bytes(), body.as_slice(), &crc.to_be_bytes()].concat()
}

/// A PNG file that states its size and then has next to nothing.
fn png(width: u32, height: u32, bits: u8, colour: u8) -> Vec<u8> {
    let header = [&width.to_be_bytes()[..], &height.to_be_bytes(), &[bits, colour, 0, 0, 0]].concat();
    let signature = b"\x89PNG\r\n\x1a\n".to_vec();
    [signature, chunk(b"IHDR", &header), chunk(b"IDAT", &[0x78, 1, 3, 0, 0, 0, 0, 1]), chunk(b"IEND", b"")].concat()
}

#[test]
fn pictures_that_state_more_than_they_can_hold_are_refused() {
    let folder = folder("pictures");
    for (name, bytes) in [
        ("square.png", png(40_000, 40_000, 8, 2)),
        ("grey.png", png(30_000, 2_000, 1, 0)),
        ("deep.png", png(8_000, 8_000, 16, 6)),
        ("long.png", png(0x7fff_ffff, 1, 8, 0)),
        ("all.png", png(0x7fff_ffff, 0x7fff_ffff, 16, 6)),
        ("none.png", png(0, 4, 8, 2)),
        ("a.pfm", b"PF\n20000 20000\n-1.0\n".to_vec()),
        ("b.pfm", b"Pf\n4294967295 4294967295\n1.0\n".to_vec()),
    ] {
        write(&folder, name, bytes);
        skipgrid(&folder, &["diff", name, name]).refused(2, &[name]);
    }
    // The same as textures.
    for name in ["square.png", "grey.png", "deep.png", "long.png", "all.png", "none.png"] {
        write(&folder, "t.toml", format!("[[texture]]\nname = \"t\"\nfile = \"{name}\"\n"));
        skipgrid(&folder, &["info", "t.toml"]).refused(2, &[name]);
    }
    // A whole file whose window is enlarged in place: the attribute's four numbers follow its name, type and length.
    let small = skipgrid::picture::Picture { width: 4, height: 4, pixels: vec![[0.5; 3]; 16] };
    io::write(folder.join("good.exr"), &small, &io::Attributes::default()).expect("written");
    let good = std::fs::read(folder.join("good.exr")).expect("there");
    let window = |name: &[u8], to: [i32; 4]| {
        let mark = [name, b"\0box2i\0"].concat();
        let at = good.windows(mark.len()).position(|w| w == mark).expect("an attribute") + mark.len() + 4;
        let mut bytes = good.clone();
        bytes[at..at + 16].copy_from_slice(&to.map(i32::to_le_bytes).concat());
        bytes
    };
    for to in [
        [0, 0, i32::MAX, i32::MAX],
        [i32::MIN, i32::MIN, i32::MAX, i32::MAX],
        [0, 0, 99_999, 0],
        [0, 0, 9_999, 9_999],
        [0, 0, -1, -1],
        [5, 5, 3, 3],
        [0, 0, 1, 3],
    ] {
        write(&folder, "bad.exr", window(b"dataWindow", to));
        let error = io::read(folder.join("bad.exr")).map(|p| (p.width, p.height)).expect_err("not the file's size");
        assert!(error.to_string().contains("bad.exr: "), "{error}");
    }
    for length in (0..good.len()).step_by(7) {
        write(&folder, "cut.exr", &good[..length]);
        let error = io::read(folder.join("cut.exr")).expect_err("cut short").to_string();
        assert!(error.contains("cut.exr: "), "{error}");
    }
}
