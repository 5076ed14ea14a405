//! PNG through the `image` crate.

use super::{MAX_DECODED_BYTES, PngEncoding, blank, check_declared};
use crate::error::{Error, Result};
use crate::picture::{Picture, srgb};
use image::codecs::png::{PngDecoder, PngEncoder};
use image::{DynamicImage, ExtendedColorType, ImageDecoder, ImageEncoder, Limits};
use std::io::Cursor;
use std::path::Path;

pub(super) fn encode(path: &Path, picture: &Picture) -> Result<Vec<u8>> {
    let rgb: Vec<u8> = picture.pixels.iter().flatten().map(|&v| srgb::to_byte(v)).collect();
    let mut bytes = Vec::new();
    PngEncoder::new(&mut bytes)
        .write_image(&rgb, picture.width, picture.height, ExtendedColorType::Rgb8)
        .map_err(|e| Error::malformed(path, e.to_string()))?;
    Ok(bytes)
}

pub(super) fn decode(path: &Path, bytes: &[u8], encoding: PngEncoding) -> Result<Picture> {
    let fail = |e: image::ImageError| Error::malformed(path, e.to_string());
    let mut limits = Limits::default();
    limits.max_alloc = Some(MAX_DECODED_BYTES);
    let decoder = PngDecoder::with_limits(Cursor::new(bytes), limits).map_err(fail)?;
    let (width, height) = decoder.dimensions();
    let bytes_per_pixel = u64::from(decoder.color_type().bytes_per_pixel());
    let pixels = check_declared(path, u64::from(width), u64::from(height), bytes_per_pixel)?;
    let linear = match encoding {
        PngEncoding::Linear => true,
        PngEncoding::Srgb => false,
        PngEncoding::Declared => declares_linear(bytes),
    };
    let image = DynamicImage::from_decoder(decoder).map_err(fail)?;
    let mut picture = blank(path, width, height, pixels)?;
    let sixteen = image.color().bytes_per_pixel() / image.color().channel_count() > 1;
    if sixteen {
        for (pixel, source) in picture.pixels.iter_mut().zip(image.to_rgb16().pixels()) {
            *pixel = source.0.map(|v| light(f32::from(v) / 65535.0, linear));
        }
    } else {
        for (pixel, source) in picture.pixels.iter_mut().zip(image.to_rgb8().pixels()) {
            *pixel = source.0.map(|v| light(f32::from(v) / 255.0, linear));
        }
    }
    Ok(picture)
}

/// True if a gAMA chunk of 1 (stored as 100000) stands before the pixels, and no sRGB chunk.
///
/// Read here because the decoder of `image` 0.25 with `png` 0.18 gives no gamma for such files.
fn declares_linear(bytes: &[u8]) -> bool {
    let mut rest = bytes.get(8..).unwrap_or_default();
    let mut linear = false;
    while let [l0, l1, l2, l3, t0, t1, t2, t3, tail @ ..] = rest {
        let length = u32::from_be_bytes([*l0, *l1, *l2, *l3]) as usize;
        match &[*t0, *t1, *t2, *t3] {
            b"gAMA" => linear = tail.starts_with(&100_000u32.to_be_bytes()),
            b"sRGB" => return false,
            b"IDAT" => break,
            _ => {}
        }
        // Behind the data stand four bytes of checksum.
        rest = length.checked_add(4).and_then(|n| tail.get(n..)).unwrap_or_default();
    }
    linear
}

fn light(value: f32, linear: bool) -> f32 {
    if linear { value } else { srgb::decode(f64::from(value)) }
}
