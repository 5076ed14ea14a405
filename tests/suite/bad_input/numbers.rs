//! Numbers that are not finite.

use super::{folder, skipgrid, write};

/// A scene file of one good triangle and, between, what is at fault.
fn scene(fault: &str) -> String {
    format!("[[triangles]]\npositions = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]\nindices = [[0, 1, 2]]\n{fault}\n")
}

#[test]
fn each_is_refused_with_its_place() {
    let folder = folder("numbers");
    let triangle = "[[triangles]]\nindices = [[0, 1, 2]]\npositions = ";
    for (fault, words) in [
        (format!("{triangle}[[0, 0, 0], [1, nan, 0], [0, 1, 0]]"), ["line 4", "position 1"]),
        (format!("{triangle}[[0, 0, 0], [1, 0, 0], [0, 1, -inf]]"), ["line 4", "position 2"]),
        // Beyond the range of single precision.
        (format!("{triangle}[[0, 0, 0], [1e39, 0, 0], [0, 1, 0]]"), ["line 4", "position 1"]),
        (
            format!("{triangle}[[0, 0, 0], [1, 0, 0], [0, 1, 0]]\nnormals = [[0, 0, 1], [0, 0, nan], [0, 0, 1]]"),
            ["line 4", "normal 1"],
        ),
        (format!("{triangle}[[0, 0, 0], [1, 0, 0], [0, 1, 0]]\nuvs = [[0, 0], [0, 0], [inf, 1]]"), ["line 4", "uv 2"]),
        ("[[sphere]]\ncentre = [nan, 0, 0]\nradius = 1".into(), ["line 4", "centre"]),
        ("[[sphere]]\ncentre = [0, 0, 0]\nradius = inf".into(), ["line 4", "radius"]),
        ("[[quad]]\ncorner = [0, 0, 0]\nu = [inf, 0, 0]\nv = [0, 1, 0]".into(), ["line 4", "quad"]),
        ("[[procedural]]\ntype = \"cubes\"\nscale = nan".into(), ["line 4", "scale"]),
        ("[[procedural]]\ntype = \"cubes\"\nscale = [1, 0, 1]".into(), ["line 4", "flatten"]),
        ("[[procedural]]\ntype = \"cubes\"\ntranslate = [inf, 0, 0]".into(), ["line 4", "translate"]),
        ("[[procedural]]\ntype = \"cubes\"\nn = 1\ntranslate = [1e39, 0, 0]".into(), ["line 4", "moves a vertex"]),
        ("[camera]\norigin = [nan, 0, 0]\ntarget = [0, 0, 0]\nyfov = 40".into(), ["line 4", "camera"]),
        ("[camera]\norigin = [0, 0, 0]\ntarget = [0, 0, 0]\nyfov = 40".into(), ["line 4", "camera"]),
        ("[camera]\norigin = [0, 0, 1]\ntarget = [0, 0, 0]\nyfov = nan".into(), ["line 4", "camera"]),
        ("[[material]]\nname = \"m\"\ntype = \"lambert\"\nalbedo = [nan, 0, 0]".into(), ["line 4", "material `m`"]),
        ("[[material]]\nname = \"m\"\ntype = \"mirror\"\nemission = [inf, 0, 0]".into(), ["line 4", "material `m`"]),
        ("[[material]]\nname = \"m\"\ntype = \"dielectric\"\nior = nan".into(), ["line 4", "material `m`"]),
        ("[[light]]\ntype = \"point\"\nposition = [nan, 0, 0]\nintensity = [1, 1, 1]".into(), ["line 4", "light"]),
        (
            "[[light]]\ntype = \"directional\"\ndirection = [0, 0, 0]\nirradiance = [1, 1, 1]".into(),
            ["line 4", "direction"],
        ),
    ] {
        write(&folder, "bad.toml", scene(&fault));
        let run = skipgrid(&folder, &["info", "bad.toml"]);
        run.refused(2, &["bad.toml: ", words[0], words[1]]);
        assert!(run.stdout.is_empty());
    }
    // Keys of the whole file come first.
    write(&folder, "bad.toml", format!("environment = [nan, 0, 0]\n{}", scene("")));
    skipgrid(&folder, &["info", "bad.toml"]).refused(2, &["bad.toml: line 1: environment"]);
    for (obj, words) in [
        ("v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n", ["line 2", "vertex 2"]),
        ("v 0 0 0\nv 1 0 1e39\nv 0 1 0\nf 1 2 3\n", ["line 2", "vertex 2"]),
        ("v 0 0 0\nv 1 0 0 0\nv 0 1 0\nf 1 2 3\n", ["line 2", "vertex 2"]),
        ("v 0 0 0\nvn 0 0 inf\n", ["line 2", "normal 1"]),
        ("v 0 0 0\nvt nan\n", ["line 2", "texture coordinate 1"]),
    ] {
        write(&folder, "bad.obj", obj);
        skipgrid(&folder, &["info", "bad.obj"]).refused(2, &["bad.obj: ", words[0], words[1]]);
    }
}

#[test]
fn the_option_drops_and_counts_what_is_not_finite() {
    let folder = folder("drop");
    // Of the positions 1 is bad; so are triangle 1 by its normal 4 and, below, one of two spheres.
    let bad = "[[triangles]]\npositions = [[0, 0, 0], [nan, 0, 0], [0, 1, 0], [1, 1, 0], [2, 1, 0]]\n\
        normals = [[0, 0, 1], [0, 0, 1], [0, 0, 1], [0, 0, 1], [0, inf, 1]]\n\
        uvs = [[0, 0], [0, 0], [0, 0], [0, 0], [0, 0]]\nindices = [[0, 1, 2], [2, 3, 4], [0, 2, 3]]\n\
        [[sphere]]\ncentre = [0, inf, 0]\nradius = 1\n[[sphere]]\ncentre = [0, 0, 0]\nradius = 1";
    write(&folder, "bad.toml", scene(bad));
    let run = skipgrid(&folder, &["info", "bad.toml", "--drop-invalid"]);
    run.done(&["line 4: dropped 2 triangles", "line 9: dropped a sphere"]);
    run.counts("triangles", 2).counts("spheres", 1);
    // What is wrong otherwise stays wrong.
    write(&folder, "wrong.toml", scene("[[sphere]]\ncentre = [0, 0, 0]\nradius = -1"));
    skipgrid(&folder, &["info", "wrong.toml", "--drop-invalid"]).refused(2, &["line 4", "radius"]);
    write(&folder, "bad.obj", "v 0 0 0\nv 1 nan 0\nv 0 1 0\nv 1 1 1\nf 1 2 3\nf 1 3 4\nf 1 2 3 4\n");
    // The quadrilateral is two triangles, one of them good.
    let args = ["render", "bad.obj", "--drop-invalid", "--size", "4x4", "--spp", "1", "-o", "out.png"];
    skipgrid(&folder, &args).done(&["bad.obj: dropped 2 triangles"]);
    // Files of bare primitives keep their indices: what is bad is counted, and nothing hits it.
    let mut tri = b"TRI1\x02\0\0\0".to_vec();
    let values = [0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0., f32::NAN, 1., 0., 0., 0., 1., 0.];
    tri.extend(values.iter().flat_map(|v: &f32| v.to_le_bytes()));
    write(&folder, "bad.tri", tri);
    skipgrid(&folder, &["info", "bad.tri"]).done(&["bad.tri: 1 primitives are not finite"]);
}
