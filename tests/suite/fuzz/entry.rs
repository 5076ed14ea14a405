//! What is done with the bytes of a fuzzed file: one function for each format.
//!
//! Shared by the mutations of this test program and by the targets of `fuzz/`. An input may be refused; it must not
//! panic, overflow, hang or take more memory than the limits here allow.

use glam::{DVec3, Vec3};
use skipgrid::Ray;
use skipgrid::measure::npy;
use skipgrid::picture::io::{self, PngEncoding};
use skipgrid::render::{Sampler, Settings, render};
use skipgrid::scene::{ExportSettings, LoadOptions, Scene, load, mitsuba, povray, raw};
use std::fs;
use std::path::{Path, PathBuf};

/// What is done with the bytes of one input.
pub type Entry = fn(&[u8]);

/// Name and function of each target; seeds are in `tests/suite/fuzz/seeds/NAME`.
pub const TARGETS: &[(&str, Entry)] =
    &[("gltf", gltf), ("obj", obj), ("toml", toml), ("vox", vox), ("picture", picture), ("arrays", arrays)];

/// Longer inputs are cut: nothing of interest needs more.
pub const MOST_BYTES: usize = 1 << 16;

/// What loading may take: far below the limit of 1 GB under which the fuzzer runs.
const MEMORY: u64 = 1 << 28;

/// Scenes of at most so many primitives are also traced.
const MOST_PRIMITIVES: u32 = 2000;

/// glTF and GLB: the reader tells them apart by their first bytes.
pub fn gltf(bytes: &[u8]) {
    scene("scene.glb", bytes);
}

/// An OBJ file and, after a line `#mtl`, the MTL file `m.mtl` beside it.
pub fn obj(bytes: &[u8]) {
    const MARK: &[u8] = b"\n#mtl\n";
    let cut = bytes.windows(MARK.len()).position(|w| w == MARK).unwrap_or(bytes.len());
    put("m.mtl", bytes.get(cut + MARK.len()..).unwrap_or_default());
    scene("scene.obj", &bytes[..cut]);
}

/// A scene file, with a mesh and a texture beside it that it may refer to.
pub fn toml(bytes: &[u8]) {
    put("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    put("t.png", include_bytes!("seeds/picture/rgb.png"));
    scene("scene.toml", bytes);
}

/// MagicaVoxel's file.
pub fn vox(bytes: &[u8]) {
    scene("scene.vox", bytes);
}

/// EXR, PFM, Radiance's or PNG by their first bytes; all else, and PNG too, as a texture, which may be JPEG.
pub fn picture(bytes: &[u8]) {
    let read = |name: &str| io::read_with(put(name, bytes), PngEncoding::Declared).ok();
    let picture = match bytes {
        [0x76, 0x2f, 0x31, 0x01, ..] => {
            let path = put("a.exr", bytes);
            let _ = (io::read_with_variance(&path), io::read_attributes(&path), io::has_variance(&path));
            read("a.exr")
        }
        [b'P', ..] => read("a.pfm"),
        [b'#', ..] => read("a.hdr"),
        _ => {
            put("t.png", bytes);
            scene("texture.toml", TEXTURED);
            read("a.png")
        }
    };
    if let Some(picture) = picture {
        assert_eq!(picture.pixels.len(), picture.width as usize * picture.height as usize);
    }
}

const TEXTURED: &[u8] = b"[[texture]]\nname = 't'\nfile = 't.png'\n[[material]]\nname = 'm'\ntype = 'lambert'\n\
    texture = 't'\n[[quad]]\ncorner = [0, 0, 0]\nu = [1, 0, 0]\nv = [0, 1, 0]\nmaterial = 'm'\n";

/// `.npy` as rays and as solid voxels, `.tri`, `.sph`, `.rays` and `.truth`.
pub fn arrays(bytes: &[u8]) {
    let path = put("a.raw", bytes);
    match bytes {
        [0x93, ..] => {
            let _ = npy::read_rays(&path);
            scene("scene.npy", bytes);
        }
        [b'R', ..] => drop(raw::read_rays(&path)),
        [b'T', b'R', b'U', ..] => drop(raw::read_truth(&path)),
        [b'S', ..] => scene("scene.sph", bytes),
        _ => scene("scene.tri", bytes),
    }
}

/// Loads a scene in both ways and, if it is small, builds on it, renders a few pixels and exports it.
fn scene(name: &str, bytes: &[u8]) {
    let path = put(name, bytes);
    let spec = path.to_str().expect("the folder's name is UTF-8");
    for drop_invalid in [false, true] {
        let options = LoadOptions { drop_invalid, memory: MEMORY };
        let Ok(scene) = load(spec, &options) else { continue };
        if scene.primitive_count() <= MOST_PRIMITIVES {
            use_up(&scene);
        }
    }
}

fn use_up(scene: &Scene) {
    let Ok(accel) = scene.accel("grid:memory=64M") else { return };
    for ray in [Ray::new(Vec3::ZERO, Vec3::X), Ray::new(Vec3::splat(9.0), Vec3::new(-1.0, -0.99, -1.01))] {
        assert_eq!(accel.closest_hit(&ray).is_some(), accel.any_hit(&ray));
    }
    let settings = Settings {
        width: 3,
        height: 2,
        sampler: Sampler::Sobol(1),
        max_depth: 3,
        threads: Some(1),
        shadow_voxels: Some(false),
        ..Settings::default()
    };
    if let Ok(film) = render(scene, &*accel, &settings, &|_, _| {}) {
        assert!(film.sum.iter().all(|sum: &DVec3| sum.is_finite()));
    }
    if scene.textures.iter().all(|t| t.texels.len() < 1 << 12) {
        let settings = ExportSettings { width: 3, height: 2, max_depth: 3, ..ExportSettings::default() };
        let folder = folder();
        let _ = povray::export(scene, &settings, &folder.join("out.pov"));
        let _ = mitsuba::export(scene, &settings, &folder.join("out.xml"));
    }
}

/// Writes a file of the thread's own folder.
fn put(name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder().join(name);
    fs::write(&path, bytes).expect("the folder for fuzzed files can be written");
    path
}

/// A folder in memory where the system has one.
fn folder() -> PathBuf {
    let memory = Path::new("/dev/shm");
    let above = if memory.is_dir() { memory.to_path_buf() } else { std::env::temp_dir() };
    let thread: String = format!("{:?}", std::thread::current().id()).chars().filter(char::is_ascii_digit).collect();
    let folder = above.join(format!("skipgrid-fuzz-{}-{thread}", std::process::id()));
    fs::create_dir_all(&folder).expect("the folder for temporary files can be written");
    folder
}

/// Removes the thread's folder.
#[allow(dead_code, reason = "the fuzzer's processes do not end by themselves")]
pub fn clean_up() {
    let _ = fs::remove_dir_all(folder());
}
