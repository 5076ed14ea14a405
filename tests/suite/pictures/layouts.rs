//! Every layout of channels in EXR and PNG files.

use super::folder;
use exr::prelude::*;
use skipgrid::picture::io;
use std::fs;
use std::path::Path;

/// Values that a half holds exactly.
const VALUES: [f32; 6] = [0.0, 0.25, 0.5, 1.0, 2.0, 100.0];

#[derive(Clone, Copy, Debug)]
enum Kind {
    Half,
    Float,
    Uint,
}

/// A channel of 3 x 2 pixels whose values are `VALUES` times `factor`.
fn channel(name: &str, kind: Kind, factor: f32) -> AnyChannel<FlatSamples> {
    let values = || VALUES.iter().map(|v| v * factor);
    let samples = match kind {
        Kind::Half => FlatSamples::F16(values().map(f16::from_f32).collect()),
        Kind::Float => FlatSamples::F32(values().collect()),
        Kind::Uint => FlatSamples::U32(values().map(|v| v as u32).collect()),
    };
    AnyChannel::new(name, samples)
}

fn layer(channels: Vec<AnyChannel<FlatSamples>>) -> Layer<AnyChannels<FlatSamples>> {
    let channels = AnyChannels::sort(channels.into_iter().collect());
    Layer::new((3, 2), LayerAttributes::named("part"), Encoding::UNCOMPRESSED, channels)
}

fn write(path: &Path, channels: Vec<AnyChannel<FlatSamples>>) {
    Image::from_layer(layer(channels)).write().to_file(path).expect("the target folder is writable");
}

#[test]
fn exr_files_of_any_layout_are_read() {
    let folder = folder("layouts");
    let path = folder.join("a.exr");
    let rgb = |prefix: &str, kind, factors: [f32; 3]| {
        let names = ["R", "G", "B"].into_iter().zip(factors);
        names.map(|(name, f)| channel(&format!("{prefix}{name}"), kind, f)).collect::<Vec<_>>()
    };
    let read = |names: Vec<AnyChannel<FlatSamples>>, chosen: Option<&str>| {
        write(&path, names);
        let picture = chosen.map_or_else(|| io::read(&path), |layer| io::read_layer(&path, layer));
        picture.map(|p| p.pixels)
    };
    let expected = |factors: [f32; 3]| VALUES.map(|v| factors.map(|f| v * f));
    let factors = [1.0, 4.0, 2.0];
    for kind in [Kind::Half, Kind::Float] {
        assert_eq!(read(rgb("", kind, factors), None).expect("RGB"), expected(factors), "{kind:?}");
    }
    assert_eq!(read(rgb("", Kind::Uint, [4.0, 8.0, 400.0]), None).expect("u32"), expected([4.0, 8.0, 400.0]));
    // Kinds may differ from channel to channel; opacity and depth are ignored.
    let mixed = vec![
        channel("R", Kind::Half, 1.0),
        channel("G", Kind::Float, 3.0),
        channel("B", Kind::Uint, 4.0),
        channel("A", Kind::Half, 0.5),
        channel("depth.Z", Kind::Float, 7.0),
    ];
    assert_eq!(read(mixed, None).expect("RGBA and Z"), expected([1.0, 3.0, 4.0]));
    assert_eq!(read(vec![channel("Y", Kind::Half, 2.0)], None).expect("grey"), expected([2.0; 3]));
    let layers = || [rgb("diffuse.", Kind::Half, factors), rgb("glossy.", Kind::Float, [3.0; 3])].concat();
    assert_eq!(read(layers(), Some("glossy")).expect("the second layer"), expected([3.0; 3]));
    let one = [rgb("diffuse.", Kind::Half, factors), vec![channel("depth.Z", Kind::Float, 1.0)]].concat();
    assert_eq!(read(one, None).expect("the only layer with colours"), expected(factors));
    for (names, chosen, words) in [
        (layers(), None, "has the layers `diffuse`, `glossy`"),
        (layers(), Some("shadow"), "no channel `shadow.R`"),
        (vec![channel("R", Kind::Half, 1.0)], None, "no channel `G`, only `R`"),
        (vec![channel("A", Kind::Half, 1.0)], None, "no channel `R`, only `A`"),
        (
            rgb("", Kind::Half, factors).into_iter().chain([channel("RY", Kind::Half, 1.0)]).skip(3).collect(),
            None,
            "chroma",
        ),
    ] {
        let message = read(names, chosen).expect_err(words).to_string();
        assert!(message.contains("a.exr: ") && message.contains(words), "{message}");
    }
}

#[test]
fn exr_files_of_several_parts_or_with_subsampled_channels_are_refused() {
    let folder = folder("parts");
    let path = folder.join("parts.exr");
    let part = |name: &str| {
        let mut part = layer(["R", "G", "B"].map(|n| channel(n, Kind::Half, 1.0)).to_vec());
        part.attributes.layer_name = Some(Text::from(name));
        part
    };
    let attributes = ImageAttributes::new(IntegerBounds::from_dimensions((3, 2)));
    let image = Image::from_layers(attributes, vec![part("left"), part("right")]);
    image.write().to_file(&path).expect("the target folder is writable");
    let message = io::read(&path).expect_err("two parts").to_string();
    assert!(message.contains("parts.exr: has 2 parts"), "{message}");

    // The crate writes none: the header's entry of a channel is its name, 0, type, linearity, and the two steps.
    let path = folder.join("half.exr");
    let samples = FlatSamples::F16(vec![f16::from_f32(1.0); 16]);
    let channels = AnyChannels::sort([AnyChannel::new("Y", samples)].into_iter().collect());
    let grey = Layer::new((4, 4), LayerAttributes::default(), Encoding::UNCOMPRESSED, channels);
    Image::from_layer(grey).write().to_file(&path).expect("the target folder is writable");
    let mut bytes = fs::read(&path).expect("just written");
    let entry = b"chlist\0".len() + 4 + bytes.windows(7).position(|w| w == b"chlist\0").expect("a list of channels");
    let steps = entry + b"Y\0".len() + 8;
    assert_eq!(&bytes[steps..steps + 8], &[1, 0, 0, 0, 1, 0, 0, 0]);
    (bytes[steps], bytes[steps + 4]) = (2, 2);
    fs::write(&path, bytes).expect("writable");
    let message = io::read(&path).expect_err("subsampled").to_string();
    assert!(message.contains("half.exr: ") && message.contains("subsampl"), "{message}");
}

#[test]
fn png_files_are_grey_or_coloured_of_8_or_16_bits_with_opacity_or_without() {
    let folder = folder("png_kinds");
    let path = folder.join("a.png");
    // 188 of 255 in sRGB is 0.50289 of light; 0.5 in 16 bits is 0.21404. Opacity is ignored.
    let (light8, light16) = (0.502_886_5, 0.214_047);
    let check = |picture: image::DynamicImage, expected: [f32; 3]| {
        picture.save(&path).expect("the target folder is writable");
        let found = io::read(&path).expect("read").pixels[0];
        assert!((0..3).all(|c| (found[c] - expected[c]).abs() < 1e-5), "{:?}: {found:?}", picture.color());
    };
    let (half, full) = (32_768_u16, 65_535_u16);
    check(image::GrayImage::from_pixel(1, 1, image::Luma([188])).into(), [light8; 3]);
    check(image::GrayAlphaImage::from_pixel(1, 1, image::LumaA([188, 7])).into(), [light8; 3]);
    check(image::RgbImage::from_pixel(1, 1, image::Rgb([188, 0, 255])).into(), [light8, 0.0, 1.0]);
    check(image::RgbaImage::from_pixel(1, 1, image::Rgba([188, 0, 255, 7])).into(), [light8, 0.0, 1.0]);
    let buffer = image::ImageBuffer::from_pixel(1, 1, image::Luma([half]));
    check(image::DynamicImage::ImageLuma16(buffer), [light16; 3]);
    let buffer = image::ImageBuffer::from_pixel(1, 1, image::LumaA([half, 9]));
    check(image::DynamicImage::ImageLumaA16(buffer), [light16; 3]);
    let buffer = image::ImageBuffer::from_pixel(1, 1, image::Rgb([half, 0, full]));
    check(image::DynamicImage::ImageRgb16(buffer), [light16, 0.0, 1.0]);
    let buffer = image::ImageBuffer::from_pixel(1, 1, image::Rgba([half, 0, full, 9]));
    check(image::DynamicImage::ImageRgba16(buffer), [light16, 0.0, 1.0]);
}
