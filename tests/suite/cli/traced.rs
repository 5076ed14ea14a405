//! `skipgrid trace`.

use super::*;

#[test]
fn traced_hits_are_the_ones_by_hand_for_every_accelerator() {
    let folder = folder("trace");
    fs::write(folder.join("scene.tri"), raw(b"TRI1", 2, &TRIANGLES)).expect("writable");
    fs::write(folder.join("rays.npy"), npy("'<f4'", "(8, 8)", &ray_bytes())).expect("writable");
    fs::write(folder.join("in.rays"), raw(b"RAY1", 8, &ray_values())).expect("writable");
    let expected: Vec<u8> = RAYS
        .iter()
        .flat_map(|(_, hit)| {
            let (t, prim) = hit.unwrap_or((f32::INFINITY, u32::MAX));
            [t.to_le_bytes(), prim.to_le_bytes()].concat()
        })
        .collect();
    let flags: Vec<u8> = RAYS.iter().map(|(_, hit)| u8::from(hit.is_some())).collect();

    for entry in general() {
        for rays in ["rays.npy", "in.rays"] {
            let args = ["trace", "scene.tri", "--rays", rays, "--hits", "hits.npy", "--accel", entry.name];
            let run = skipgrid(&folder, &args);
            assert_eq!((run.code, run.stdout.as_str()), (Some(0), ""), "{}: {}", entry.name, run.stderr);
            let bytes = fs::read(folder.join("hits.npy")).expect("was written");
            let header = String::from_utf8_lossy(&bytes[10..bytes.len() - expected.len()]).into_owned();
            assert!(
                header.starts_with("{'descr': [('t', '<f4'), ('prim', '<u4')], 'fortran_order': False"),
                "{header}"
            );
            assert!(header.contains("'shape': (8,)"), "{header}");
            assert_eq!(bytes[bytes.len() - expected.len()..], expected, "{}", entry.name);

            assert_eq!(skipgrid(&folder, &[&args[..], &["--any"]].concat()).code, Some(0));
            let bytes = fs::read(folder.join("hits.npy")).expect("was written");
            assert_eq!(bytes[bytes.len() - flags.len()..], flags, "{}", entry.name);
        }
    }
    assert_eq!(files(&folder), ["hits.npy", "in.rays", "rays.npy", "scene.tri"]);
}

#[test]
fn rays_on_the_command_line_print_their_hits() {
    let folder = folder("trace-ray");
    fs::write(folder.join("scene.tri"), raw(b"TRI1", 2, &TRIANGLES)).expect("writable");
    let (mut args, mut expected) = (vec!["trace".to_string(), "scene.tri".into()], String::new());
    for (i, (ray, hit)) in RAYS.iter().enumerate() {
        // In a file the range stands in the middle; here it comes last.
        let order = [0, 1, 2, 4, 5, 6, 3, 7].map(|at| ray[at]);
        let text = order.map(|x| if i % 2 == 0 { x.to_string() } else { format!("{:#x}", x.to_bits()) }).join(" ");
        args.extend(["--ray".into(), text]);
        expected += &match hit {
            Some((t, prim)) => format!("t={t} bits={:#010x} prim={prim} any=true\n", t.to_bits()),
            None => "t=inf bits=0x7f800000 prim=none any=false\n".into(),
        };
    }
    // Six numbers: from 0 to inf; a minus sign at the start is no option.
    args.extend(["--ray".into(), "-0.25  0.25 -5   0.5 0 5".into()]);
    expected += "t=1 bits=0x3f800000 prim=0 any=true\n";
    args.extend(["--ray".into(), " 0.25 0.25 -5 0 0 0x3f800000 ".into()]);
    expected += "t=5 bits=0x40a00000 prim=0 any=true\n";
    for entry in general().filter(|entry| entry.exact) {
        let args: Vec<&str> = args.iter().map(String::as_str).chain(["--accel", entry.name]).collect();
        let run = skipgrid(&folder, &args);
        assert_eq!((run.code, run.stdout.as_str()), (Some(0), &*expected), "{}: {}", entry.name, run.stderr);
    }
    for (ray, words) in [
        ("0 0 0 1 0", "5 numbers, where 6 or 8 make a ray"),
        ("0 0 0 1 0 0 7", "7 numbers"),
        ("0 0 0 1 0 0 0 inf 3", "9 numbers"),
        ("", "0 numbers"),
        ("0 0 0 1 0 one", "`one` is neither a decimal number nor the bits of an f32 such as 0x3f800000"),
        ("0 0 0 1 0 0x1ffffffff", "`0x1ffffffff` is neither"),
        ("0 0 0 1 0 0x+1", "`0x+1` is neither"),
    ] {
        let run = skipgrid(&folder, &["trace", "scene.tri", "--ray", ray]);
        assert_eq!((run.code, run.stdout.as_str()), (Some(2), ""), "{ray}");
        assert!(run.stderr.contains(words), "{ray}: {}", run.stderr);
    }
    for args in [
        vec!["trace", "scene.tri"],
        vec!["trace", "scene.tri", "--ray", "0 0 0 1 0 0", "--hits", "hits.npy"],
        vec!["trace", "scene.tri", "--ray", "0 0 0 1 0 0", "--rays", "r.npy", "--hits", "hits.npy"],
        vec!["trace", "scene.tri", "--rays", "r.npy"],
        vec!["trace", "scene.tri", "--ray", "0 0 0 1 0 0", "--any"],
    ] {
        let run = skipgrid(&folder, &args);
        assert_eq!((run.code, run.stdout.as_str()), (Some(2), ""), "{args:?}: {}", run.stderr);
    }
    assert_eq!(files(&folder), ["scene.tri"]);
}
