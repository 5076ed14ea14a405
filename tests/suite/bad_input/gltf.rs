//! glTF files whose counts, offsets and nodes do not fit, or ask for far more than they hold.

use super::{folder, skipgrid, write};

/// A document of `members` over a buffer of 48 zeros and a mesh of a triangle.
fn document(members: &str) -> String {
    let zeros = "A".repeat(64);
    format!(
        r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":48,"uri":"data:;base64,{zeros}"}}],
        "bufferViews":[{{"buffer":0,"byteLength":48}}],{members}}}"#
    )
}

const MESH: &str = r#""meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}]"#;

fn accessor(members: &str) -> String {
    document(&format!(r#""accessors":[{{"bufferView":0,"componentType":5126,"type":"VEC3",{members}}}],{MESH}"#))
}

#[test]
fn accessors_beyond_their_buffers_are_refused_whatever_overflows() {
    let folder = folder("accessors");
    write(&folder, "good.gltf", accessor(r#""count":4"#));
    skipgrid(&folder, &["info", "good.gltf"]).done(&[]);
    for members in [
        r#""count":5"#,
        r#""count":4,"byteOffset":4"#,
        r#""count":1,"byteOffset":40"#,
        r#""count":1,"byteOffset":18446744073709551612"#,
        r#""count":18446744073709551615"#,
        // Twelve times this is four in 64 bits.
        r#""count":1537228672809129302"#,
        r#""count":1537228672809129301,"byteOffset":4"#,
    ] {
        write(&folder, "bad.gltf", accessor(members));
        skipgrid(&folder, &["info", "bad.gltf"]).refused(2, &["bad.gltf: accessors[0]: "]);
    }
    for (view, place) in [
        (r#"{"buffer":0,"byteLength":49}"#, "bufferViews[1]: "),
        (r#"{"buffer":0,"byteLength":8,"byteOffset":18446744073709551612}"#, "bufferViews[1]: "),
        (r#"{"buffer":0,"byteLength":8,"byteStride":252}"#, "bufferViews[1]: "),
        (r#"{"buffer":9,"byteLength":8}"#, "bufferViews[1]"),
    ] {
        let members =
            format!(r#""accessors":[{{"bufferView":0,"componentType":5126,"type":"VEC3","count":4}}],{MESH}"#);
        let text = document(&members).replacen("\"byteLength\":48}]", &format!("\"byteLength\":48}},{view}]"), 1);
        write(&folder, "bad.gltf", text);
        skipgrid(&folder, &["info", "bad.gltf"]).refused(2, &["bad.gltf: ", place]);
    }
}

#[test]
fn nodes_that_form_no_tree_are_refused() {
    let folder = folder("nodes");
    let accessors = r#""accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":4}]"#;
    let nodes = |nodes: &str| document(&format!(r#"{accessors},{MESH},"nodes":[{nodes}]"#));
    for (list, cause) in [
        (r#"{"children":[0]}"#, "own ancestor"),
        (r#"{"children":[1]},{"children":[0]}"#, "own ancestor"),
        (r#"{"children":[1,1]},{"mesh":0}"#, "nodes[1]: is reached twice"),
        (r#"{"children":[2]},{"children":[2]},{"mesh":0}"#, "nodes[2]: is reached twice"),
        (r#"{"children":[7]}"#, "nodes[0].children"),
        (r#"{"mesh":0,"translation":[1e39,0,0]}"#, "nodes[0]"),
        (r#"{"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,1e300,0,0,1]}"#, "nodes[0]"),
        (r#"{"mesh":0,"matrix":[NaN,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}"#, "line"),
        (r#"{"mesh":0,"rotation":[0,0,0,0]}"#, "nodes[0]: rotation"),
    ] {
        write(&folder, "bad.gltf", nodes(list));
        skipgrid(&folder, &["info", "bad.gltf"]).refused(2, &["bad.gltf: ", cause]);
    }
    // With a scene that names the nodes.
    let circle =
        nodes(r#"{"children":[1]},{"children":[0]}"#).replacen("\"nodes\"", r#""scenes":[{"nodes":[0]}],"nodes""#, 1);
    write(&folder, "bad.gltf", circle);
    skipgrid(&folder, &["info", "bad.gltf"]).refused(2, &["nodes[0]: is reached twice"]);
    // A scale of nothing hides a mesh, which the format allows: left out and counted.
    write(
        &folder,
        "flat.gltf",
        nodes(r#"{"mesh":0,"scale":[0,1,1]},{"mesh":0,"matrix":[0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,1]}"#),
    );
    skipgrid(&folder, &["info", "flat.gltf"]).done(&["2 meshes are left out: their transforms flatten"]);
    // A hundred thousand levels, each twice as wide as the one above at first and then half of it.
    let deep: String = (1..100_000)
        .map(|i| format!(r#"{{"children":[{i}],"scale":[{s},1,1]}},"#, s = if i % 2 == 1 { "2" } else { "0.5" }))
        .collect();
    write(&folder, "deep.gltf", nodes(&format!(r#"{deep}{{"mesh":0}}"#)));
    let run = skipgrid(&folder, &["info", "deep.gltf"]);
    run.done(&[]).counts("triangles", 1);
    // So deep that the text cannot be parsed: arrays in arrays.
    let nested = format!(r#"{{"asset":{{"version":"2.0"}},"extras":{}{}}}"#, "[".repeat(100_000), "]".repeat(100_000));
    write(&folder, "nested.gltf", nested);
    skipgrid(&folder, &["info", "nested.gltf"]).refused(2, &["nested.gltf: "]);
}

/// A few bytes that stand for gigabytes: four million zeros, referred to again and again.
#[test]
fn small_files_that_stand_for_too_much_are_refused_before_memory_is_taken() {
    let folder = folder("bombs");
    let accessors = r#""accessors":[{"componentType":5126,"type":"VEC3","count":4194304,"sparse":{"count":1,
        "indices":{"bufferView":0,"componentType":5125},"values":{"bufferView":0}}}]"#;
    let primitive = r#"{"attributes":{"POSITION":0}}"#;
    let primitives = vec![primitive; 4000].join(",");
    let members = format!(r#"{accessors},"meshes":[{{"primitives":[{primitives}]}}],"nodes":[{{"mesh":0}}]"#);
    write(&folder, "bomb.gltf", document(&members));
    let options = skipgrid::scene::LoadOptions { memory: 1 << 28, ..Default::default() };
    let path = folder.join("bomb.gltf");
    let error = skipgrid::scene::load(path.to_str().expect("UTF-8"), &options).expect_err("a bomb").to_string();
    assert!(error.contains("bomb.gltf: ") && error.contains("allowed are 268435456"), "{error}");
    // Instances of one mesh: 3 vertices would be good, so many are not.
    let nodes = vec![r#"{"mesh":0}"#; 400].join(",");
    let members = format!(r#"{accessors},{MESH},"nodes":[{nodes}]"#);
    write(&folder, "instances.gltf", document(&members));
    let path = folder.join("instances.gltf");
    let error = skipgrid::scene::load(path.to_str().expect("UTF-8"), &options).expect_err("a bomb").to_string();
    assert!(error.contains("allowed are 268435456"), "{error}");
}
