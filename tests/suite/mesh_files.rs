//! Scenes from glTF and OBJ: what is in them, and errors with their place.

use crate::scenes::{checks, close, corners, expect, folder, message};
use glam::{DVec3, Vec2, Vec3};
use skipgrid::scene::{Bsdf, CameraSource, Light, LoadOptions, load};

/// A glTF document around one triangle (0 0 0, 1 0 0, 0 1 0) with normals +z; `rest` holds the other members.
fn gltf(rest: &str) -> String {
    let floats: Vec<u8> = [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 0, 1_u8]
        .iter()
        .flat_map(|&v| f32::from(v).to_le_bytes())
        .chain([0, 0, 1, 0, 2, 0, 0, 0])
        .collect();
    let data: String = base64(&floats);
    format!(
        r#"{{"asset":{{"version":"2.0"}},
        "buffers":[{{"byteLength":80,"uri":"data:application/octet-stream;base64,{data}"}}],
        "bufferViews":[{{"buffer":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":36}},
            {{"buffer":0,"byteOffset":72,"byteLength":6}}],
        "accessors":[
            {{"bufferView":0,"componentType":5126,"type":"VEC3","count":3,"min":[0,0,0],"max":[1,1,0]}},
            {{"bufferView":1,"componentType":5126,"type":"VEC3","count":3}},
            {{"bufferView":2,"componentType":5123,"type":"SCALAR","count":3}}],
        {rest}}}"#
    )
}

const TRIANGLE: &str =
    r#""meshes":[{"name":"tri","primitives":[{"attributes":{"POSITION":0,"NORMAL":1},"indices":2}]}]"#;

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let group = |g: &[u8]| {
        let bits = g.iter().chain(&[0, 0]).take(3).fold(0_u32, |bits, &b| bits << 8 | u32::from(b));
        let digit = |k: usize| char::from(DIGITS[(bits >> (18 - 6 * k) & 63) as usize]);
        (0..4).map(|k| if k <= g.len() { digit(k) } else { '=' }).collect::<String>()
    };
    bytes.chunks(3).map(group).collect()
}

#[test]
fn gltf_instances_are_placed_and_mirror_images_keep_their_front() {
    let folder = folder("instances");
    let nodes = r#""nodes":[{"children":[1,2],"translation":[10,0,0]},
        {"mesh":0,"rotation":[0,0.70710678,0,0.70710678]},
        {"mesh":0,"scale":[-2,1,1],"translation":[0,5,0]},{"mesh":0,"scale":[0,1,1]}],
        "scenes":[{"nodes":[0,3]}],"#;
    let s = expect(&folder, "two.gltf", &gltf(&format!("{nodes}{TRIANGLE}")));
    assert_eq!((s.triangle_count(), s.meshes.len(), s.meshes[0].name.as_str()), (2, 2, "tri"));
    // A quarter turn about y takes x to -z and z to x.
    let [a, b, _] = corners(&s, 0);
    assert!((a - Vec3::new(10.0, 0.0, 0.0)).length() < 1e-5 && (b - Vec3::new(10.0, 0.0, -1.0)).length() < 1e-5);
    assert!((s.meshes[0].normals[0] - Vec3::X).length() < 1e-6);
    // Mirrored: x runs to -2, and the front still looks to +z.
    let [a, b, c] = corners(&s, 1);
    assert_eq!((b - a).cross(c - a).normalize(), Vec3::Z);
    assert!([a, b, c].contains(&Vec3::new(8.0, 5.0, 0.0)));
    assert_eq!(s.meshes[1].normals[0], Vec3::Z);
    assert!(s.warnings.iter().any(|w| w.contains("1 meshes are left out")), "{:?}", s.warnings);
}

#[test]
fn gltf_lights_and_camera_become_ours() {
    let folder = folder("lights");
    let rest = r#""extensionsUsed":["KHR_lights_punctual"],
        "extensions":{"KHR_lights_punctual":{"lights":[
            {"type":"point","color":[1,0.5,0.25],"intensity":8},
            {"type":"directional","intensity":3},
            {"type":"spot","intensity":2,"spot":{"innerConeAngle":0.2,"outerConeAngle":0.5}}]}},
        "cameras":[{"type":"perspective","perspective":{"yfov":1.0,"znear":0.1}},
            {"type":"orthographic","orthographic":{"xmag":1,"ymag":1,"zfar":9,"znear":1}}],
        "nodes":[{"translation":[1,2,3],"extensions":{"KHR_lights_punctual":{"light":0}}},
            {"rotation":[-0.70710678,0,0,0.70710678],"extensions":{"KHR_lights_punctual":{"light":1}}},
            {"extensions":{"KHR_lights_punctual":{"light":2}}},{"camera":1},
            {"camera":0,"translation":[0,0,5],"scale":[2,2,2]},{"mesh":0}],"#;
    let s = expect(&folder, "lights.gltf", &gltf(&format!("{rest}{TRIANGLE}")));
    let point = Light::Point { position: DVec3::new(1.0, 2.0, 3.0), intensity: Vec3::new(8.0, 4.0, 2.0) };
    assert_eq!(s.lights[0], point);
    let Light::Directional { direction, irradiance } = s.lights[1] else { panic!("directional") };
    // -z turned by -90 degrees about x is -y.
    assert!(close(direction, DVec3::NEG_Y) && irradiance == Vec3::splat(3.0));
    let Light::Spot { cutoff, beam_width, direction, .. } = s.lights[2] else { panic!("spot") };
    assert!((cutoff - 0.5_f64.to_degrees()).abs() < 1e-5 && (beam_width - 0.2_f64.to_degrees()).abs() < 1e-5);
    assert_eq!(direction, DVec3::NEG_Z);
    assert_eq!((s.camera.source, s.camera.origin), (CameraSource::File, DVec3::new(0.0, 0.0, 5.0)));
    assert!(close(s.camera.target, DVec3::new(0.0, 0.0, 4.0)) && (s.camera.yfov - 1.0_f64.to_degrees()).abs() < 1e-9);
    assert!(s.warnings.iter().any(|w| w.contains("cameras[1]")), "{:?}", s.warnings);
}

#[test]
fn gltf_materials_follow_the_stated_rule() {
    let folder = folder("materials");
    // Two texels: white and black, so every mean is 0.5 (the ends of the sRGB curve are linear).
    let png = base64(&checks());
    let rest = format!(
        r#""images":[{{"uri":"data:image/png;base64,{png}"}},{{"uri":"gone.png"}}],
        "textures":[{{"source":0}},{{"source":1}}],
        "materials":[
            {{"pbrMetallicRoughness":{{"baseColorFactor":[0.2,0.4,0.6,1],"metallicFactor":0,
                "baseColorTexture":{{"index":0}}}}}},
            {{"pbrMetallicRoughness":{{"baseColorFactor":[0.9,0.8,0.7,1],"roughnessFactor":0.5}}}},
            {{"pbrMetallicRoughness":{{"roughnessFactor":0.05}}}},
            {{"extensions":{{"KHR_materials_transmission":{{"transmissionFactor":1}},
                "KHR_materials_ior":{{"ior":1.33}}}}}},
            {{"pbrMetallicRoughness":{{"metallicRoughnessTexture":{{"index":0}}}},"emissiveFactor":[1,1,0],
                "extensions":{{"KHR_materials_emissive_strength":{{"emissiveStrength":5}}}}}},
            {{"pbrMetallicRoughness":{{"metallicFactor":0.9,"metallicRoughnessTexture":{{"index":0}},
                "baseColorTexture":{{"index":1}}}}}}],
        "nodes":[{{"mesh":0}}],{TRIANGLE}"#
    );
    let s = expect(&folder, "materials.gltf", &gltf(&rest));
    let bsdf = |i: usize| &s.materials[i].bsdf;
    assert_eq!(*bsdf(0), Bsdf::Lambert { albedo: Vec3::new(0.2, 0.4, 0.6), texture: Some(0) });
    let rough = |reflectance, alpha| Bsdf::Conductor { eta: Vec3::ZERO, k: Vec3::ONE, reflectance, alpha };
    assert_eq!(*bsdf(1), rough(Vec3::new(0.9, 0.8, 0.7), 0.25));
    assert_eq!(*bsdf(2), Bsdf::Mirror { reflectance: Vec3::ONE });
    assert_eq!(*bsdf(3), Bsdf::Dielectric { ior: 1.33 });
    // Metallic 1 and roughness 1, both times 0.5.
    assert_eq!(*bsdf(4), rough(Vec3::ONE, 0.25));
    assert_eq!(s.materials[4].emission, Vec3::new(5.0, 5.0, 0.0));
    assert_eq!(*bsdf(5), Bsdf::Lambert { albedo: Vec3::ONE, texture: None });
    assert!(s.warnings.iter().any(|w| w.contains("gone.png")), "{:?}", s.warnings);
    // The mesh has no material.
    assert_eq!(s.materials[s.meshes[0].material as usize].name, "grey");
}

#[test]
fn gltf_strips_fans_and_sparse_accessors_are_read() {
    let folder = folder("modes");
    let mesh = |mode: u32| {
        format!(
            r#""meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"mode":{mode}}}]}}],"nodes":[{{"mesh":0}}]"#
        )
    };
    for mode in [4, 5, 6] {
        let s = expect(&folder, "mode.gltf", &gltf(&mesh(mode)));
        let [a, b, c] = corners(&s, 0);
        assert_eq!((s.triangle_count(), (b - a).cross(c - a)), (1, Vec3::Z), "mode {mode}");
    }
    let lines = expect(&folder, "lines.gltf", &gltf(&mesh(1)));
    assert!(lines.triangle_count() == 0 && lines.warnings[0].contains("points and lines"), "{:?}", lines.warnings);
    // Element 2, the corner on y, is replaced by the first normal: (0, 0, 1).
    let sparse = r#""count":3,"sparse":{"count":1,"indices":{"bufferView":2,"byteOffset":4,"componentType":5123},
        "values":{"bufferView":1}},"#;
    let text = gltf(&mesh(4)).replacen("\"count\":3,", sparse, 1);
    let s = expect(&folder, "sparse.gltf", &text);
    assert_eq!(corners(&s, 0)[2], Vec3::Z);
    let bad = message(&folder, "bad.gltf", &text.replacen("\"byteOffset\":4,", "\"byteOffset\":6,", 1));
    assert!(bad.contains("accessors[0]") && bad.contains("sparse indices"), "{bad}");
}

#[test]
fn gltf_errors_name_the_place() {
    let folder = folder("gltf-errors");
    let good = gltf(&format!(r#""nodes":[{{"mesh":0}}],{TRIANGLE}"#));
    assert!(expect(&folder, "good.gltf", &good).warnings.is_empty());
    for (from, to, cause) in [
        ("\"count\":3", "\"count\":4", "accessors[0]: 4 elements of 12 bytes from byte 0, of a view of 36"),
        ("\"count\":3", "\"count\":18446744073709551615", "accessors[0]"),
        ("\"byteOffset\":72", "\"byteOffset\":73", "accessors[2]: starts at byte 0 of a view at 73"),
        ("\"byteOffset\":72", "\"byteOffset\":76", "bufferViews[2]: bytes 76 and 6 more, of a buffer of 80"),
        ("\"byteLength\":80", "\"byteLength\":81", "buffers[0]: 81 bytes are stated, 80 are there"),
        ("\"POSITION\":0", "\"POSITION\":9", "refers to accessor 9 of 3"),
        ("\"NORMAL\":1", "\"NORMAL\":2", "accessors[2]: elements are Scalar"),
        ("\"mesh\":0", "\"mesh\":7", "nodes[0].mesh: index out of bounds"),
        ("\"mesh\":0", "\"children\":[0]", "own ancestor"),
        ("\"mesh\":0", "\"mesh\":0,\"scale\":[1e300,1,1]", "nodes[0]: its transform is not finite"),
        ("\"mesh\":0", "\"mesh\":0,\"rotation\":[0,0,0,0]", "nodes[0]: rotation"),
        ("\"version\":\"2.0\"", "\"version\":\"1.0\"", "asset.version is `1.0`"),
        (
            "\"nodes\"",
            "\"extensionsRequired\":[\"KHR_draco_mesh_compression\"],\"nodes\"",
            "KHR_draco_mesh_compression",
        ),
        ("data:application/octet-stream;base64,", "https://example.org/", "is not a file beside this one"),
        ("data:application/octet-stream;base64,", "data:application/octet-stream;base64,*", "base64"),
    ] {
        let message = message(&folder, "bad.gltf", &good.replacen(from, to, 1));
        assert!(message.contains(cause), "{to}\n{message}");
    }
    // The last index, 2, becomes 2 + 256 * 1.
    let mut bytes = [0_u8; 80];
    bytes[76] = 3;
    let (head, tail) = good.split_once("base64,").expect("a data URI");
    let (_, tail) = tail.split_once('"').expect("its end");
    let message = message(&folder, "bad.gltf", &format!("{head}base64,{}\"{tail}", base64(&bytes)));
    assert!(message.contains("index 2 refers to vertex 3 of 3"), "{message}");
}

#[test]
fn deep_and_shared_node_graphs_end() {
    let folder = folder("deep");
    let nodes: String = (1..100_000).map(|i| format!("{{\"children\":[{i}]}},")).collect();
    let s = expect(&folder, "deep.gltf", &gltf(&format!(r#""nodes":[{nodes}{{"mesh":0}}],{TRIANGLE}"#)));
    assert_eq!(s.triangle_count(), 1);
    let shared = r#""nodes":[{"children":[1,2]},{"children":[2]},{"mesh":0}],"#;
    let message = message(&folder, "shared.gltf", &gltf(&format!("{shared}{TRIANGLE}")));
    assert!(message.contains("nodes[2]: is reached twice"), "{message}");
}

#[test]
fn coordinates_that_are_not_finite_are_refused_or_dropped() {
    let folder = folder("finite");
    let drop = LoadOptions { drop_invalid: true, ..LoadOptions::default() };
    let mut bytes: Vec<u8> = Vec::new();
    for v in [f32::NAN, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
        bytes.extend(v.to_le_bytes());
    }
    bytes.resize(72, 0);
    bytes.extend([0, 0, 1, 0, 2, 0, 0, 0]);
    let good = gltf(&format!(r#""nodes":[{{"mesh":0}}],{TRIANGLE}"#));
    let (head, tail) = good.split_once("base64,").expect("a data URI");
    let (_, tail) = tail.split_once('"').expect("its end");
    let text = format!("{head}base64,{}\"{tail}", base64(&bytes));
    let refusal = message(&folder, "nan.gltf", &text);
    assert!(refusal.contains("accessors[0]: element 0: NaN"), "{refusal}");
    let obj = "v 0 0 inf\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\n";
    let refusal = message(&folder, "inf.obj", obj);
    assert!(refusal.contains("line 1: vertex 1") && refusal.contains("not finite"), "{refusal}");
    for (name, left) in [("nan.gltf", 0), ("inf.obj", 1)] {
        let s = load(folder.join(name).to_str().expect("UTF-8"), &drop).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(s.triangle_count(), left, "{name}");
        assert!(s.warnings.iter().any(|w| w.contains("dropped 1 triangles")), "{:?}", s.warnings);
        assert!(s.meshes.iter().flat_map(|m| &m.positions).all(|p| p.is_finite()));
    }
}

#[test]
fn obj_faces_groups_and_materials_are_read() {
    let folder = folder("obj");
    std::fs::write(folder.join("wood.png"), checks()).expect("the folder can be written");
    let mtl = "newmtl wood\nKd 0.5 0.25 1\nmap_Kd wood.png\nnewmtl chrome\nillum 3\nKs 0.9 0.9 0.9\n\
        newmtl water\nillum 7\nd 0.1\nNi 1.33\nnewmtl lamp\nKd 0 0 0\nKe 2 3 4\nnewmtl torn\nmap_Kd gone.png\n";
    std::fs::write(folder.join("all.mtl"), mtl).expect("the folder can be written");
    let obj = "# five corners, relative indices, texture coordinates\r\nmtllib all.mtl\r\n\
        v 0 0 0\nv 1 0 0\nv 1.5 1 0\nv 0.5 2 0\nv -0.5 1 0\nvt 0.25 0.25\nvn 0 0 2\n\
        g pentagon\nusemtl wood\nf 1/1/1 2/1/1 3/1/1 4/1/1 5/1/1\n\
        usemtl chrome\nf -5 -4 -3\ng other\nusemtl wood\nf 1/1 2/1 3\nf 1 2\nl 1 2 3\n\
        g pentagon\nf 1/1/1 4/1/1 5/1/1\nusemtl nobody\nf 1 2 3\n";
    let s = expect(&folder, "all.obj", obj);
    let meshes: Vec<_> = s.meshes.iter().map(|m| (m.name.as_str(), m.triangles.len(), m.positions.len())).collect();
    assert_eq!(meshes, [("pentagon", 4, 5), ("pentagon", 1, 3), ("other", 1, 3), ("pentagon", 1, 3)]);
    assert_eq!(s.meshes[0].triangles[..3], [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
    // v is turned down, and normals made unit.
    assert_eq!((s.meshes[0].uvs[0], s.meshes[0].normals[0]), (Vec2::new(0.25, 0.75), Vec3::Z));
    assert!(s.meshes[1].normals.is_empty() && s.meshes[1].uvs.is_empty());
    let bsdf = |i: usize| &s.materials[s.meshes[i].material as usize].bsdf;
    assert_eq!(*bsdf(0), Bsdf::Lambert { albedo: Vec3::new(0.5, 0.25, 1.0), texture: Some(0) });
    assert_eq!(*bsdf(1), Bsdf::Mirror { reflectance: Vec3::splat(0.9) });
    assert_eq!(s.materials[s.meshes[3].material as usize].name, "grey");
    let named = |name: &str| s.materials.iter().find(|m| m.name == name).expect(name);
    assert_eq!(named("water").bsdf, Bsdf::Dielectric { ior: 1.33 });
    assert_eq!(named("lamp").emission, Vec3::new(2.0, 3.0, 4.0));
    for cause in ["1 faces with fewer than three", "statements `l`", "`nobody`", "gone.png"] {
        assert!(s.warnings.iter().any(|w| w.contains(cause)), "{cause}: {:?}", s.warnings);
    }
}

#[test]
fn obj_errors_name_the_line() {
    let folder = folder("obj-errors");
    let start = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for (line, cause) in [
        ("f 1 2 4", "line 4: face refers to vertex 4 of 3"),
        ("f 0 1 2", "line 4: face refers to vertex 0 of 3"),
        ("f -4 1 2", "line 4: face refers to vertex -4 of 3"),
        ("f 99999999999999999999 1 2", "line 4: corner `99999999999999999999` is not made of indices"),
        ("f 1/2/3/4 1 2", "line 4: corner `1/2/3/4` has more"),
        ("f /1 1 2", "line 4: corner `/1` is not made of indices"),
        ("v 1 2", "line 4: 2 numbers for a vertex"),
        ("v 1 2 x", "line 4: `x` is no number"),
        ("v 1 2 1e39", "line 4: vertex 4"),
        ("v 1 2 3 0", "line 4: vertex 4"),
        ("vn 1 0", "line 4: 2 numbers for a normal"),
        ("vt nan", "line 4: texture coordinate 1"),
        ("vt 0 0\nf 1/2 2/1 3/1", "line 5: face refers to texture coordinate 2 of 1"),
    ] {
        let message = message(&folder, "bad.obj", &format!("{start}{line}\n"));
        assert!(message.contains(cause), "{line}\n{message}");
    }
}

#[test]
fn obj_corners_keep_what_is_theirs() {
    let folder = folder("obj-corners");
    // One mesh of corners of all kinds, relative and absolute, and a line of three points, which is no triangle.
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.5\nvt 0.25 0.75 0\nf 1 2 3\nf -3/-1 -2/1 -1/2\nl 1 2 3\np 1\nf 1/1 2/2 3\n\
        v 2 2 2 2\nv 5 6 7 0.1 0.2 0.3\nf 4 5 -5\n";
    let s = expect(&folder, "kinds.obj", obj);
    let mesh = &s.meshes[0];
    assert_eq!((s.meshes.len(), mesh.triangles.len()), (1, 4));
    assert_eq!(mesh.uvs.len(), mesh.positions.len());
    let mut corners: Vec<_> = mesh
        .triangles
        .iter()
        .map(|t| t.map(|i| (mesh.positions[i as usize].to_array(), mesh.uvs[i as usize].to_array())))
        .collect();
    let (o, x, y, none) = ([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0; 2]);
    let far = [([1.0; 3], none), ([5.0, 6.0, 7.0], none), (o, none)];
    let plain = [(o, none), (x, none), (y, none)];
    let mapped = [(o, [0.25, 0.25]), (x, [0.5, 1.0]), (y, [0.25, 0.25])];
    let mut wanted = vec![plain, mapped, plain, far];
    let order =
        |a: &[([f32; 3], [f32; 2]); 3], b: &[([f32; 3], [f32; 2]); 3]| a.partial_cmp(b).expect("no coordinate is NaN");
    corners.sort_by(order);
    wanted.sort_by(order);
    assert_eq!(corners, wanted);
    for cause in ["1 faces have normals or texture", "1 statements `l`", "1 statements `p`"] {
        assert!(s.warnings.iter().any(|w| w.contains(cause)), "{cause}: {:?}", s.warnings);
    }
}

#[test]
fn what_an_obj_lacks_is_named_with_its_line() {
    let folder = folder("obj-lacks");
    std::fs::write(folder.join("two.mtl"), "newmtl two\n\nKd 0.5 0.5\n").expect("the folder can be written");
    let obj = "mtllib gone.mtl\nmtllib two.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl two\nf 1//7 2//8 3//9\n";
    let s = expect(&folder, "lacks.obj", obj);
    assert_eq!((s.triangle_count(), s.materials[s.meshes[0].material as usize].name.as_str()), (1, "grey"));
    for cause in [
        "lacks.obj: line 1: no materials: ",
        "gone.mtl",
        "two.mtl: line 3: `0.5 0.5` is no colour",
        "lacks.obj: line 6: no material `two`",
        "faces refer to normals or texture coordinates where the file has none",
    ] {
        assert!(s.warnings.iter().any(|w| w.contains(cause)), "{cause}: {:?}", s.warnings);
    }
    let message = message(&folder, "long.obj", &format!("g {}\n", "x".repeat(256)));
    assert!(message.contains("line 1: a name of 256 bytes"), "{message}");
}
