//! Files and metrics of pictures.

mod flip;
mod layouts;
mod radiance;

use skipgrid::picture::Picture;
use skipgrid::picture::io::{self, Attributes, PngEncoding};
use std::path::PathBuf;

fn folder(test: &str) -> PathBuf {
    crate::folder("pictures", test)
}

/// Values of all magnitudes, not symmetric in any way, with the odd ones among them.
fn gradient(width: u32, height: u32) -> Picture {
    let mut picture = Picture::new(width, height);
    for (i, pixel) in picture.pixels.iter_mut().enumerate() {
        let x = i as f32;
        *pixel = [x * 0.37, (x * 1.7).sin().abs(), 1.0 / (x + 1.0)];
    }
    picture
}

fn bits(picture: &Picture) -> Vec<u32> {
    picture.pixels.iter().flatten().map(|v| v.to_bits()).collect()
}

#[test]
fn float_formats_keep_every_bit() {
    let folder = folder("bits");
    let mut picture = gradient(13, 7);
    picture.pixels[5] = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    picture.pixels[6] = [-0.0, f32::MIN_POSITIVE / 4.0, f32::MAX];
    for name in ["a.exr", "a.pfm", "A.EXR"] {
        let path = folder.join(name);
        io::write(&path, &picture, &Attributes::default()).expect("written");
        let back = io::read(&path).expect("read back");
        assert_eq!((back.width, back.height), (13, 7), "{name}");
        assert_eq!(bits(&back), bits(&picture), "{name}");
    }
}

#[test]
fn exr_files_carry_texts_and_a_variance() {
    let folder = folder("exr");
    let path = folder.join("variance.exr");
    let (mean, mut variance) = (gradient(5, 4), gradient(5, 4));
    variance.pixels.iter_mut().flatten().for_each(|v| *v *= 1e-3);
    let attributes = Attributes::default().with("accelerator", "grid:density=4").with("scene", "Döner ☀");
    io::write_with_variance(&path, &mean, &variance, &attributes).expect("written");
    let (m, v) = io::read_with_variance(&path).expect("read back");
    assert_eq!((bits(&m), bits(&v)), (bits(&mean), bits(&variance)));
    let found = io::read_attributes(&path).expect("read back");
    assert_eq!(found.get("accelerator"), Some("grid:density=4"));
    assert_eq!(found.get("scene"), Some("Döner ☀"));
    assert_eq!(bits(&io::read(&path).expect("extra channels are ignored")), bits(&mean));

    io::write(&path, &mean, &attributes).expect("written");
    let message = io::read_with_variance(&path).expect_err("no variance").to_string();
    assert!(message.contains("variance.exr") && message.contains("no channel `variance.R`"), "{message}");
    let reserved = Attributes::default().with("compression", "none");
    let message = io::write(&path, &mean, &reserved).expect_err("a reserved name").to_string();
    assert!(message.contains("compression"), "{message}");
    let other = gradient(4, 5);
    assert!(io::write_with_variance(&path, &mean, &other, &attributes).is_err());
    assert_eq!(bits(&io::read(&path).expect("the old file stays")), bits(&mean));
}

#[test]
fn png_is_srgb_unless_told_otherwise() {
    let path = folder("png").join("a.png");
    let mut picture = Picture::new(2, 1);
    picture.pixels = vec![[0.214_041, 1.0, 0.0], [-1.0, 7.0, f32::NAN]];
    io::write(&path, &picture, &Attributes::default()).expect("written");
    let linear = io::read_with(&path, PngEncoding::Linear).expect("read back");
    // 0.214041 is 0.5 in sRGB, 127.5 of 255 before rounding.
    assert!((linear.pixels[0][0] - 0.5).abs() <= 0.5 / 255.0 + 1e-6);
    assert_eq!(linear.pixels[1], [0.0, 1.0, 0.0]);
    let light = io::read(&path).expect("read back");
    assert!((light.pixels[0][0] - 0.214_041).abs() < 2e-3, "{:?}", light.pixels[0]);
    assert_eq!(light, io::read_with(&path, PngEncoding::Srgb).expect("read back"));
}

#[test]
fn linear_png_of_16_bits_is_read_as_povray_means_it() {
    // 2 x 1 pixels, 16-bit RGB, gAMA 1.0, one IDAT; written by Python's zlib from the values below.
    let bytes = include_bytes!("data/linear16.png");
    let path = folder("png16").join("linear16.png");
    std::fs::write(&path, bytes).expect("written");
    let picture = io::read(&path).expect("read");
    let expected = [[0.0, 65535.0, 32768.0], [1.0, 256.0, 12345.0]].map(|p: [f32; 3]| p.map(|v| v / 65535.0));
    assert_eq!(picture.pixels, expected);
    assert!(io::read_with(&path, PngEncoding::Srgb).expect("read").pixels[0][2] < 0.22);
}

#[test]
fn refuses_what_is_no_picture() {
    let folder = folder("refused");
    let cases: [(&str, &[u8], &str); 9] = [
        ("empty.exr", b"", "damaged EXR"),
        ("text.exr", b"not an EXR file at all", "damaged EXR"),
        ("empty.png", b"", "empty.png"),
        ("empty.pfm", b"", "type"),
        ("short.pfm", b"PF\n2 2\n-1.0\nabc", "take 48 bytes, there are 3"),
        ("huge.pfm", b"PF\n4000000000 4000000000\n-1.0\n", "4000000000 x 4000000000"),
        ("negative.pfm", b"PF\n-2 2\n-1.0\n", "width `-2`"),
        ("scale.pfm", b"PF\n1 1\n0\n0000000000000", "scale 0"),
        ("picture.jpg", b"", "extension `jpg`"),
    ];
    for (name, bytes, expected) in cases {
        let path = folder.join(name);
        std::fs::write(&path, bytes).expect("written");
        let message = io::read(&path).expect_err(name).to_string();
        assert!(message.contains(name) && message.contains(expected), "{name}: {message}");
    }
    let missing = io::read(folder.join("missing.exr")).expect_err("missing");
    assert_eq!(missing.exit_code(), 3, "{missing}");
    std::fs::create_dir_all(folder.join("folder.exr")).expect("a folder");
    assert!(io::read(folder.join("folder.exr")).is_err());
}

#[test]
fn writing_leaves_no_halves_behind() {
    let folder = folder("halves");
    let directory = folder.join("directory.exr");
    std::fs::create_dir_all(&directory).expect("a folder");
    let picture = gradient(3, 3);
    assert!(io::write(&directory, &picture, &Attributes::default()).is_err());
    assert!(io::write(folder.join("absent/a.exr"), &picture, &Attributes::default()).is_err());
    let mut wrong = picture.clone();
    wrong.pixels.pop();
    assert!(io::write(folder.join("wrong.pfm"), &wrong, &Attributes::default()).is_err());
    io::write(folder.join("a.pfm"), &picture, &Attributes::default()).expect("written");
    let mut names: Vec<_> = std::fs::read_dir(&folder)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").file_name().into_string().expect("text"))
        .collect();
    names.sort();
    assert_eq!(names, ["a.pfm", "directory.exr"]);
}

#[test]
fn refuses_every_damaged_exr_file() {
    let Some(folder) = crate::shared("scenes/malformed/exr") else { return };
    let mut seen = 0;
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        let message = io::read(&path).expect_err(&name).to_string();
        assert!(message.contains(&name), "{name}: {message}");
        seen += 1;
    }
    assert_eq!(seen, 12);
}
