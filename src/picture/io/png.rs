//! PNG through the `image` crate.

use super::{Declared, MAX_DECODED_BYTES, PngEncoding, blank, check_declared};
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

/// The file with one more text behind its header. Layout: PNG specification, third edition, sections 5.3 and 11.3.3.2.
pub(super) fn with_text(mut file: Vec<u8>, name: &str, text: &str) -> Vec<u8> {
    /// Signature, then the chunk `IHDR`: length, type, 13 bytes, checksum.
    const HEADER: usize = 8 + 4 + 4 + 13 + 4;
    let body = [b"tEXt", name.as_bytes(), b"\0", text.as_bytes()].concat();
    // The length is that of the content alone; texts are short.
    let length = (body.len() - 4) as u32;
    let chunk = [&length.to_be_bytes(), body.as_slice(), &checksum(&body).to_be_bytes()].concat();
    file.splice(HEADER..HEADER, chunk);
    file
}

/// CRC-32 with the polynomial of IEEE 802.3, bit by bit.
fn checksum(bytes: &[u8]) -> u32 {
    let step = |crc: u32| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 };
    !bytes.iter().fold(u32::MAX, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), |crc, _| step(crc)))
}

pub(super) fn decode(path: &Path, bytes: &[u8], encoding: PngEncoding) -> Result<Picture> {
    let fail = |e: image::ImageError| Error::malformed(path, e.to_string());
    let mut limits = Limits::default();
    limits.max_alloc = Some(MAX_DECODED_BYTES);
    let decoder = PngDecoder::with_limits(Cursor::new(bytes), limits).map_err(fail)?;
    let (width, height) = decoder.dimensions();
    // As decoded, and as three channels of the same depth. A pixel takes a bit in the file at least.
    let decoded = decoder.color_type();
    let three = 3 * u64::from(decoded.bytes_per_pixel() / decoded.channel_count());
    let pixels = check_declared(
        path,
        &Declared {
            width: width.into(),
            height: height.into(),
            bits_per_pixel: decoder.original_color_type().bits_per_pixel().into(),
            bytes_per_pixel: u64::from(decoded.bytes_per_pixel()) + three,
            file: bytes.len() as u64,
        },
    )?;
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn checksums_are_those_of_the_standard() {
        // The check value of CRC-32/ISO-HDLC; and the empty chunk that ends every PNG file.
        assert_eq!(checksum(b"123456789"), 0xcbf4_3926);
        assert_eq!(checksum(b"IEND"), 0xae42_6082);
    }

    #[test]
    fn a_file_with_a_text_is_still_a_picture() {
        let picture = Picture { width: 2, height: 1, pixels: vec![[0.0, 1.0, 0.0], [1.0; 3]] };
        let path = Path::new("a.png");
        let file = with_text(encode(path, &picture).expect("a picture"), "partial", "1 of 2");
        assert_eq!(decode(path, &file, PngEncoding::Declared).expect("a picture"), picture);
        let reader = ::image::codecs::png::PngDecoder::new(Cursor::new(&file));
        assert!(reader.is_ok() && file.windows(15).any(|w| w == b"tEXtpartial\x001 o"));
    }
}
