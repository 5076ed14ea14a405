//! MagicaVoxel's files: what is in them, and errors with their place.

use crate::scenes::{folder, read};
use glam::Vec3;
use skipgrid::scene::{Bsdf, Scene};

fn words(words: &[u32]) -> Vec<u8> {
    words.iter().flat_map(|w| w.to_le_bytes()).collect()
}

fn chunk(name: &str, content: &[u8]) -> Vec<u8> {
    [name.as_bytes(), &words(&[content.len() as u32, 0]), content].concat()
}

fn file(chunks: &[Vec<u8>]) -> Vec<u8> {
    let inner = chunks.concat();
    [b"VOX ".as_slice(), &words(&[150]), b"MAIN", &words(&[0, inner.len() as u32]), &inner].concat()
}

/// Both chunks of a model; voxels are x, y, z, colour.
fn model(size: [u32; 3], voxels: &[[u8; 4]]) -> Vec<u8> {
    let content = [words(&[voxels.len() as u32]), voxels.concat()].concat();
    [chunk("SIZE", &words(&size)), chunk("XYZI", &content)].concat()
}

fn dictionary(entries: &[(&str, &str)]) -> Vec<u8> {
    let text = |t: &str| [words(&[t.len() as u32]), t.as_bytes().to_vec()].concat();
    let entries_bytes: Vec<u8> = entries.iter().flat_map(|(k, v)| [text(k), text(v)].concat()).collect();
    [words(&[entries.len() as u32]), entries_bytes].concat()
}

fn transform(id: u32, attributes: &[(&str, &str)], child: u32, layer: u32, frame: &[(&str, &str)]) -> Vec<u8> {
    let parts = [words(&[id]), dictionary(attributes), words(&[child, u32::MAX, layer, 1]), dictionary(frame)];
    chunk("nTRN", &parts.concat())
}

fn group(id: u32, children: &[u32]) -> Vec<u8> {
    let parts = [words(&[id]), dictionary(&[]), words(&[children.len() as u32]), words(children)];
    chunk("nGRP", &parts.concat())
}

fn shape(id: u32, model: u32) -> Vec<u8> {
    chunk("nSHP", &[words(&[id]), dictionary(&[]), words(&[1, model]), dictionary(&[])].concat())
}

fn layer(id: u32, attributes: &[(&str, &str)]) -> Vec<u8> {
    chunk("LAYR", &[words(&[id]), dictionary(attributes), words(&[u32::MAX])].concat())
}

fn load(name: &str, bytes: &[u8]) -> skipgrid::Result<Scene> {
    let path = folder(&format!("vox-{name}")).join("m.vox");
    std::fs::write(&path, bytes).expect("the folder can be written");
    read(&path)
}

/// Corners of the solid voxels' least corners, sorted.
fn cells(scene: &Scene) -> Vec<[i32; 3]> {
    let set = scene.voxels().expect("solid voxels");
    let [nx, ny, _] = set.resolution();
    let solid = (0..set.materials().len() as u32).filter(|&i| set.materials()[i as usize] != 0);
    let corner = |i: u32| set.origin() + Vec3::new((i % nx) as f32, (i / nx % ny) as f32, (i / nx / ny) as f32);
    let mut cells: Vec<_> = solid.map(|i| corner(i).as_ivec3().to_array()).collect();
    cells.sort_unstable();
    cells
}

#[test]
fn a_model_alone_stands_on_its_corner_with_z_upwards() {
    let bytes = file(&[model([2, 3, 4], &[[1, 2, 3, 1], [0, 0, 0, 1]])]);
    let scene = load("alone", &bytes).unwrap_or_else(|e| panic!("{e}"));
    // (x, y, z) becomes (x, z, -y): the cell from y = 2 to 3 lies between -3 and -2.
    assert_eq!(cells(&scene), [[0, 0, -1], [1, 3, -3]]);
    // Without a palette the default one holds, whose first colour is white.
    assert_eq!(scene.materials[0].bsdf, Bsdf::Lambert { albedo: Vec3::ONE, texture: None });
    assert_eq!((scene.materials.len(), scene.materials[0].name.as_str()), (1, "colour 1"));
}

#[test]
fn the_scene_graph_moves_turns_and_hides() {
    let mut palette = vec![0_u8; 1024];
    palette[4 * 6..4 * 6 + 4].copy_from_slice(&[255, 0, 188, 255]);
    let material = [words(&[7]), dictionary(&[("_type", "_emit"), ("_emit", "0.5"), ("_flux", "1")])].concat();
    let metal = [words(&[8]), dictionary(&[("_type", "_metal")])].concat();
    // Two models under groups: one moved, one turned (x to y, y to -x) below a moved group; one hidden by its layer, one by
    // itself.
    let quarter = (1 | 1 << 4).to_string();
    let bytes = file(&[
        model([3, 3, 3], &[[1, 1, 1, 7]]),
        model([4, 2, 1], &[[3, 0, 0, 8], [0, 0, 0, 7]]),
        transform(0, &[], 1, u32::MAX, &[]),
        group(1, &[2, 4, 8, 9]),
        transform(2, &[("_name", "first")], 3, 0, &[("_t", "10 20 30")]),
        shape(3, 0),
        transform(4, &[], 5, 0, &[("_t", "100 0 0")]),
        group(5, &[6]),
        transform(6, &[], 7, 0, &[("_r", &quarter), ("_t", "0 5 0")]),
        shape(7, 1),
        transform(8, &[], 3, 1, &[]),
        transform(9, &[("_hidden", "1")], 3, 0, &[]),
        layer(0, &[]),
        layer(1, &[("_hidden", "1")]),
        chunk("RGBA", &palette),
        chunk("MATL", &material),
        chunk("MATL", &metal),
        chunk("rOBJ", b"settings of a renderer"),
    ]);
    let scene = load("graph", &bytes).unwrap_or_else(|e| panic!("{e}"));
    // First: the middle voxel of 3 x 3 x 3 is on its node. Second: from its pivot (2, 1, 0) the voxels' middles are at
    // (1.5, -0.5) and (-1.5, -0.5); rows (0, -1), (1, 0) turn them to (0.5, 1.5) and (0.5, -1.5); moved by (100, 5).
    assert_eq!(cells(&scene), [[10, 30, -21], [100, 0, -7], [100, 0, -4]]);
    let red = scene.materials.iter().find(|m| m.name == "colour 7").expect("in use");
    let Bsdf::Lambert { albedo, .. } = red.bsdf else { panic!("matt") };
    // sRGB 188 is 0.5029 in linear light, by the standard's formula.
    assert!((albedo - Vec3::new(1.0, 0.0, 0.5029)).abs().max_element() < 1e-4, "{albedo}");
    assert_eq!(red.emission, albedo * 0.5 * 10.0);
    for (i, part) in ["2 hidden nodes", "`_emit` of colour 7 emits", "`_metal` of colour 8 is shown"].iter().enumerate()
    {
        assert!(scene.notes.iter().any(|note| note.contains(part)), "{i} {part}: {:?}", scene.notes);
    }
}

#[test]
fn malformed_files_are_refused_with_the_place() {
    let one = model([1, 1, 1], &[[0, 0, 0, 1]]);
    let good = file(std::slice::from_ref(&one));
    assert!(load("good", &good).is_ok());
    let with = |chunks: &[Vec<u8>]| file(&[std::slice::from_ref(&one), chunks].concat());
    let size = |n: u32| file(&[chunk("SIZE", &words(&[1, n, 1])), chunk("XYZI", &words(&[0]))]);
    let mut long = good.clone();
    long[24..28].copy_from_slice(&u32::MAX.to_le_bytes());
    let mut nested = chunk("SIZE", &words(&[1, 1, 1]));
    nested[8] = 12;
    nested.extend(chunk("XYZI", &[]));
    let circle = [transform(0, &[], 1, u32::MAX, &[]), group(1, &[0])].concat();
    let cases: Vec<(&str, Vec<u8>, &str)> = vec![
        ("empty", Vec::new(), "starts with ``, not `VOX `"),
        ("magic", b"RIFF\x96\0\0\0".to_vec(), "starts with `RIFF`"),
        ("version", [b"VOX ".as_slice(), &words(&[99])].concat(), "version 99"),
        ("header", b"VOX \x96\0".to_vec(), "byte 4: version of 4 bytes, 2 are left"),
        ("no main", [b"VOX ".as_slice(), &words(&[150]), &one].concat(), "not `MAIN`"),
        ("length", long, "byte 20: chunk `SIZE` of 4294967295 bytes, 32 are left"),
        ("trailing", [&good[..], b"xyz"].concat(), "3 bytes follow the chunk `MAIN`"),
        ("size 0", size(0), "model 0 of 1 x 0 x 1 voxels"),
        ("size huge", size(u32::MAX), "model 0 of 1 x 4294967295 x 1 voxels"),
        ("outside", file(&[model([2, 2, 2], &[[0, 0, 2, 1]])]), "voxel 0 at 0, 0, 2 of model 0, which is 2 x 2 x 2"),
        ("colour 0", file(&[model([1, 1, 1], &[[0, 0, 0, 0]])]), "colour 0"),
        ("count", file(&[chunk("SIZE", &words(&[1, 1, 1])), chunk("XYZI", &words(&[9]))]), "9 voxels do not fit in 0"),
        ("count huge", file(&[chunk("SIZE", &words(&[1; 3])), chunk("XYZI", &words(&[u32::MAX]))]), "do not fit"),
        ("no size", file(&[chunk("XYZI", &words(&[0]))]), "no chunk `SIZE` before it"),
        ("no voxels", file(&[chunk("SIZE", &words(&[1, 1, 1]))]), "no chunk `XYZI` after it"),
        ("no model", file(&[chunk("RGBA", &[0; 1024])]), "no model"),
        ("all empty", file(&[model([1, 1, 1], &[])]), "no voxel in 1 models"),
        ("palette", with(&[chunk("RGBA", &[0; 1000])]), "1000 bytes, a palette has 1024"),
        ("nested", file(&[nested]), "has children"),
        ("name", with(&[[&[0xff, 0xfe, 0, 1][..], &words(&[0, 0])].concat()]), "is no chunk's name"),
        ("node ids", with(&[shape(1, 0)]), "node 1 stands where node 0 is expected"),
        ("no child", with(&[transform(0, &[], 7, u32::MAX, &[])]), "refers to node 7 of 1"),
        ("no such model", with(&[shape(0, 5)]), "node 0: refers to model 5 of 1"),
        ("circle", with(&[circle]), "a circle"),
        ("rotation", with(&[transform(0, &[], 1, 0, &[("_r", "255")]), shape(1, 0)]), "rotation `255` is none"),
        ("translation", with(&[transform(0, &[], 1, 0, &[("_t", "1 x 2")]), shape(1, 0)]), "translation `1 x 2`"),
        ("far", with(&[transform(0, &[], 1, 0, &[("_t", "99999999 0 0")]), shape(1, 0)]), "too far from the origin"),
        (
            "apart",
            with(&[
                group(0, &[1, 2]),
                transform(1, &[], 3, 0, &[]),
                transform(2, &[], 3, 0, &[("_t", "5000 0 0")]),
                shape(3, 0),
            ]),
            "spread over [5001, 1, 1] voxels",
        ),
        ("dictionary", with(&[chunk("MATL", &words(&[1, u32::MAX]))]), "4294967295 entries of a dictionary do not fit"),
        ("text", with(&[chunk("MATL", &words(&[1, 1, 90, 0]))]), "text of 90 bytes"),
    ];
    for (name, bytes, cause) in cases {
        let error = load("bad", &bytes).map(|s| s.name).expect_err(name).to_string();
        assert!(error.contains("m.vox: ") && error.contains(cause), "{name}: {error}");
    }
    // Cut off anywhere.
    for length in 0..good.len() {
        assert!(load("cut", &good[..length]).is_err(), "{length} bytes");
    }
}
