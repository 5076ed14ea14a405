//! Outputs that cannot be written: the error names the file, an old file stays, nothing else is left behind.
#![cfg(unix)]

use super::{folder, names, shell, write};
use std::fs;
use std::path::Path;

/// A command line for each verb that writes, with the file that it writes; each file has more than a kilobyte.
const WRITERS: [(&str, &[&str]); 8] = [
    ("out.png", &["render", "cornell", "--size", "64x64", "--spp", "1"]),
    ("out.exr", &["render", "cornell", "--size", "64x64", "--spp", "1"]),
    ("out.pfm", &["render", "cornell", "--size", "64x64", "--spp", "1"]),
    ("hits.npy", &["trace", "cornell", "--rays", "rays.npy", "--hits", "hits.npy"]),
    ("out.pov", &["export", "random:n=100", "--to", "povray"]),
    ("out.xml", &["export", "random:n=100", "--to", "mitsuba"]),
    (
        "out.shard.exr",
        &["shard", "cornell", "--size", "64x64", "--spp", "1", "--tile", "0,0,64,64", "--samples", "0..1"],
    ),
    ("map.pfm", &["diff", "a.pfm", "b.pfm"]),
];

/// What the verbs read.
fn inputs(folder: &Path) {
    let header = "{'descr': '<f4', 'fortran_order': False, 'shape': (512, 8), }\n";
    let mut npy = [b"\x93NUMPY\x01\0".as_slice(), &(header.len() as u16).to_le_bytes(), header.as_bytes()].concat();
    npy.resize(npy.len() + 512 * 32, 0);
    write(folder, "rays.npy", npy);
    for name in ["a.pfm", "b.pfm"] {
        let mut pfm = b"PF\n16 16\n-1.0\n".to_vec();
        pfm.resize(pfm.len() + 16 * 16 * 12, 0);
        write(folder, name, pfm);
    }
}

fn args(name: &'static str, verb: &[&'static str]) -> Vec<&'static str> {
    let given = verb.contains(&name);
    if given { verb.to_vec() } else { [verb, &["-o", name]].concat() }
}

/// Runs each verb in `folder` by `script`; it must be refused with code 3, name its file and change nothing.
fn each(folder: &Path, script: &str) {
    inputs(folder);
    for (name, verb) in WRITERS {
        write(folder, name, "the old one");
        let before = names(folder);
        let run = shell(folder, script, &args(name, verb));
        run.refused(3, &[name]);
        assert_eq!(fs::read(folder.join(name)).expect("still there"), b"the old one", "{name}");
        assert_eq!(names(folder), before, "{name}");
        fs::remove_file(folder.join(name)).expect("there");
        let before = names(folder);
        shell(folder, script, &args(name, verb)).refused(3, &[name]);
        assert_eq!(names(folder), before, "{name}");
    }
}

#[test]
fn a_file_that_grows_beyond_what_the_system_allows_leaves_nothing() {
    let folder = folder("limit");
    // The signal is ignored, so that the write itself fails, as on a full disk.
    each(&folder, "trap '' XFSZ; ulimit -f 1; exec \"$0\" \"$@\"");
    // It is the limit that stops them.
    inputs(&folder);
    for (name, verb) in WRITERS {
        shell(&folder, "exec \"$0\" \"$@\"", &args(name, verb)).done(&[]);
        assert!(fs::metadata(folder.join(name)).is_ok_and(|m| m.len() > 1024), "{name}");
    }
}

#[test]
fn full_disks_and_read_only_folders_keep_the_old_file() {
    let folder = folder("disks");
    // Mounts of its own, seen by nobody else, where the system lets us.
    let own = "unshare --mount --map-root-user --user";
    if shell(&folder, &format!("{own} mount -t tmpfs none /mnt"), &[]).code != Some(0) {
        eprintln!("skipped: no mounts of one's own here");
        return;
    }
    fs::create_dir(folder.join("disk")).expect("the target folder is writable");
    inputs(&folder);
    for (name, verb) in WRITERS {
        let args: Vec<String> = args(name, verb).iter().map(|a| a.replace(name, &format!("disk/{name}"))).collect();
        let args: Vec<&str> = args.iter().map(String::as_str).collect();
        for (kind, then) in
            [("size=12k", "head -c 5000 /dev/zero >disk/filler"), ("size=64k", "mount -o remount,ro disk")]
        {
            let script = format!(
                "mount -t tmpfs -o {kind} none disk && echo old >disk/{name} && {then} && cp disk/{name} before || exit 77
                ls disk >names; \"$0\" \"$@\"; code=$?
                cmp disk/{name} before && ls disk | cmp - names || exit 78; exit $code"
            );
            let run = shell(&folder, &format!("exec {own} sh -c '{script}' \"$0\" \"$@\""), &args);
            run.refused(3, &[name]);
        }
    }
    assert!(names(&folder.join("disk")).is_empty());
}

/// Hours of work are not begun for a file that cannot be written: the program ends at once.
#[test]
fn outputs_are_looked_at_before_the_work() {
    let folder = folder("before");
    fs::create_dir(folder.join("taken.x")).expect("the target folder is writable");
    write(&folder, "a.pfm", [&b"PF\n1 1\n-1.0\n"[..], &[0; 12]].concat());
    let before = names(&folder);
    for line in [
        "bench random:n=1000 --accel brute --rounds 1000",
        "sweep random:n=100000 --rounds 1000",
        "converge cornell --spp 131072 --size 1000x1000",
        "stress --accel brute --rays 100000000",
    ] {
        for option in ["--csv", "--json"] {
            let script = format!("timeout 60 \"$0\" {line} {option} taken.x");
            shell(&folder, &script, &[]).refused(2, &["taken.x", "regular file"]);
            let script = format!("timeout 60 \"$0\" {line} {option} a.pfm/x");
            shell(&folder, &script, &[]).refused(3, &["a.pfm"]);
        }
    }
    assert_eq!(names(&folder), before);
}

#[test]
fn standard_output_may_be_full() {
    let folder = folder("stdout");
    if !Path::new("/dev/full").exists() {
        eprintln!("skipped: no /dev/full");
        return;
    }
    write(&folder, "a.pfm", [&b"PF\n1 1\n-1.0\n"[..], &[0; 12]].concat());
    for args in [
        "list",
        "info cornell",
        "info cornell --format json",
        "plan cornell --size 8x8 --shards-in . -o a.exr",
        "trace cornell --ray 1,2,3,4,5,6",
        "compare random:n=5 --size 4x4 --rounds 1",
        "bench --list",
        "bench random:n=5 --accel brute --rays 9 --rounds 1 --json bench.json",
        "sweep random:n=5 --accel brute --size 4x4 --rounds 1",
        "converge cornell --accel grid --size 4x4 --spp 2",
        "stress --list",
        "stress wt_sphere_rand --accel brute --rays 9 --rounds 0",
        "papers dda --quick --size 8",
        "diff a.pfm a.pfm",
        "validate --scene cornell --theirs a.pfm --accel grid --spp 1",
        "completions bash",
        "man",
    ] {
        // A ray is one word.
        let args: Vec<String> = args.split(' ').map(|word| word.replace("1,2,3,4,5,6", "1 2 3 4 5 6")).collect();
        let args: &[&str] = &args.iter().map(String::as_str).collect::<Vec<_>>();
        shell(&folder, "exec \"$0\" \"$@\" >/dev/full", args).refused(3, &["standard output"]);
    }
    // Nobody can read what was measured, but the file has it.
    assert!(folder.join("bench.json").is_file());
    ["bench.json", "a.pfm"].iter().for_each(|name| fs::remove_file(folder.join(name)).expect("there"));
    // A device is not overwritten, and what is no folder holds no file.
    shell(&folder, "ln -s /dev/full out.png; exec \"$0\" \"$@\"", &args("out.png", WRITERS[0].1))
        .refused(2, &["out.png", "regular file"]);
    write(&folder, "file", "x");
    shell(&folder, "exec \"$0\" \"$@\"", &["render", "cornell", "-o", "file/out.png"]).refused(3, &["file"]);
    assert_eq!(names(&folder), ["file", "out.png"]);
}
