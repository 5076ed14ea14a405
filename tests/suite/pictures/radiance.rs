//! Radiance's pictures: what is read, and what is refused.

use super::folder;
use skipgrid::picture::Picture;
use skipgrid::picture::io::{self, Attributes};
use std::fs;

/// Two pixels as they are: 128 2^(129 - 136) = 1, and 32 2^(131 - 136) = 1; exponent 0 is black.
const FLAT: &[u8] = b"\x80\x40\x20\x81\x20\x40\x80\x83";

#[test]
fn radiance_pictures_are_read_with_their_exposure() {
    let folder = folder("radiance");
    let path = folder.join("a.hdr");
    let read = |header: &str, data: &[u8]| {
        fs::write(&path, [header.as_bytes(), data].concat()).expect("the target folder is writable");
        io::read(&path).map(|p| p.pixels)
    };
    let flat = [[1.0, 0.5, 0.25], [1.0, 2.0, 4.0]];
    for signature in ["#?RADIANCE", "#?RGBE"] {
        let header = format!("{signature}\n# made by hand\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n");
        assert_eq!(read(&header, FLAT).expect(signature), flat);
        let header = header.replace("FORMAT", "EXPOSURE=2\nEXPOSURE= 4\nCOLORCORR=1 2 4\nFORMAT");
        let pixels = read(&header, FLAT).expect("exposures multiply");
        assert_eq!(pixels, [[1.0 / 8.0, 0.5 / 16.0, 0.25 / 32.0], [1.0 / 8.0, 2.0 / 16.0, 4.0 / 32.0]]);
    }
    // Eight pixels in run lengths: mark, width, then each component; runs of 8 and single values.
    let runs = [
        b"\x02\x02\x00\x08".as_slice(),
        b"\x88\x80",
        b"\x88\x40",
        b"\x08\x00\x01\x02\x03\x04\x05\x06\x07",
        b"\x88\x88",
    ]
    .concat();
    let header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 8\n";
    let expected: Vec<[f32; 3]> = (0..8_u8).map(|i| [128.0, 64.0, f32::from(i)]).collect();
    assert_eq!(read(header, &runs).expect("run lengths"), expected);
    fs::rename(&path, folder.join("a.PIC")).expect("renamed");
    assert_eq!(io::read(folder.join("a.PIC")).expect("the other extension").pixels, expected);
}

#[test]
fn what_is_no_radiance_picture_is_refused_and_none_is_written() {
    let folder = folder("radiance_bad");
    let path = folder.join("bad.hdr");
    let good = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n";
    for (header, data, words) in [
        ("", b"".as_slice(), "does not start with"),
        ("#?RADIUS", FLAT, "does not start with"),
        ("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n", b"", "header"),
        (&good.replace("rgbe", "xyze"), FLAT, "xyze"),
        (&good.replace("-Y 1 +X 2", "+X 2 -Y 1"), FLAT, ""),
        (&good.replace("-Y 1", "-Y 0"), FLAT, "empty"),
        (&good.replace("+X 2", "+X 4000000000"), FLAT, ""),
        (&good.replace("-Y 1 +X 2", "-Y 30000 +X 30000"), FLAT, "30000 x 30000"),
        (&good.replace("-Y 1 +X 2", "-Y 300 +X 300"), FLAT, "cannot be in a file of"),
        (&good.replace("FORMAT", "EXPOSURE=0\nFORMAT"), FLAT, "divisor"),
        (&good.replace("FORMAT", "EXPOSURE=nan\nFORMAT"), FLAT, "divisor"),
        (&good.replace("FORMAT", "EXPOSURE=much\nFORMAT"), FLAT, "xposure"),
        (good, &FLAT[..7], ""),
    ] {
        fs::write(&path, [header.as_bytes(), data].concat()).expect("the target folder is writable");
        let message = io::read(&path).expect_err(header).to_string();
        assert!(message.contains("bad.hdr") && message.to_lowercase().contains(&words.to_lowercase()), "{message}");
    }
    fs::remove_file(&path).expect("removed");
    let message = io::write(&path, &Picture::new(1, 1), &Attributes::default()).expect_err("read only").to_string();
    assert!(message.contains("read only") && !path.exists(), "{message}");
}
