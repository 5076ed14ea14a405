//! Meshes whose parts do not fit, and scenes with nothing in them.

use super::{folder, names, skipgrid, write};

#[test]
fn indices_beyond_the_vertices_are_named() {
    let folder = folder("indices");
    for (index, cause) in [
        ("4", "face refers to vertex 4 of 3"),
        ("0", "face refers to vertex 0 of 3"),
        ("-4", "face refers to vertex -4 of 3"),
        ("99999999999999999999", "is not made of indices"),
        ("1/1/1/1", "more than three indices"),
        ("x", "corner `x`"),
    ] {
        write(&folder, "bad.obj", format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 {index}\n"));
        skipgrid(&folder, &["info", "bad.obj"]).refused(2, &["bad.obj: line 4: ", cause]);
    }
    let toml = |index: &str| {
        format!("[[triangles]]\npositions = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]\nindices = [[0, 1, {index}]]\n")
    };
    write(&folder, "bad.toml", toml("3"));
    skipgrid(&folder, &["info", "bad.toml"]).refused(2, &["bad.toml: line 1: triangle 0 refers to vertex 3 of 3"]);
    for index in ["-1", "4294967296", "1.5"] {
        write(&folder, "bad.toml", toml(index));
        skipgrid(&folder, &["info", "bad.toml"]).refused(2, &["bad.toml: line 3: "]);
    }
}

#[test]
fn faces_without_area_and_files_without_faces_are_counted() {
    let folder = folder("faces");
    write(&folder, "few.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1\nf 1 2\nf\nf 1 2 3\nl 1 2\n");
    let run = skipgrid(&folder, &["info", "few.obj"]);
    run.done(&["few.obj: 3 faces with fewer than three corners are left out", "1 statements `l`"]);
    run.counts("triangles", 1);
}

#[test]
fn empty_scenes_are_legal_and_show_the_background() {
    let folder = folder("empty");
    write(&folder, "empty.obj", "");
    write(&folder, "points.obj", "v 0 0 0\n");
    write(&folder, "empty.toml", "environment = [0.25, 0.5, 1.0]\n");
    write(&folder, "empty.tri", b"TRI1\0\0\0\0");
    write(&folder, "empty.gltf", r#"{"asset":{"version":"2.0"}}"#);
    for scene in ["empty.obj", "points.obj", "empty.toml", "empty.tri", "empty.gltf"] {
        for accel in ["grid", "grid-dsz", "brute", "obvhs-cwbvh"] {
            let args = ["render", scene, "--accel", accel, "--size", "4x4", "--spp", "1", "-o", "out.pfm"];
            skipgrid(&folder, &args).done(&["no primitive", scene]);
        }
        let picture = skipgrid::picture::io::read(folder.join("out.pfm")).expect("a picture");
        let first = picture.pixels[0];
        assert!(picture.pixels.iter().all(|&p| p == first), "{scene}: {:?}", picture.pixels);
        if scene == "empty.toml" {
            assert_eq!(first, [0.25, 0.5, 1.0]);
        }
    }
}

#[test]
fn what_is_missing_beside_a_file_is_named() {
    let folder = folder("beside");
    write(&folder, "a.obj", "mtllib gone.mtl here.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl none\nf 1 2 3\n");
    write(&folder, "here.mtl", "newmtl wood\nmap_Kd gone.png\n");
    let words = ["line 1: no materials: gone.mtl", "texture `gone.png` is left out", "line 5: no material `none`"];
    skipgrid(&folder, &["info", "a.obj"]).done(&words);
    write(&folder, "a.toml", "\n[[texture]]\nname = \"t\"\nfile = \"gone.png\"\n");
    skipgrid(&folder, &["info", "a.toml"]).refused(3, &["gone.png: "]);
    write(&folder, "a.toml", "\n[[mesh]]\nfile = \"gone.obj\"\n");
    skipgrid(&folder, &["info", "a.toml"]).refused(3, &["gone.obj: "]);
    write(&folder, "a.toml", "\n[[mesh]]\nfile = \"a.toml\"\n");
    skipgrid(&folder, &["info", "a.toml"]).refused(2, &["a.toml: not a kind of mesh file"]);
    assert_eq!(names(&folder), ["a.obj", "a.toml", "here.mtl"]);
}
