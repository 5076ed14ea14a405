//! Radiance's RGBE pictures (`.hdr`, `.pic`) through the `image` crate, read only.

use super::{Declared, blank, check_declared};
use crate::error::{Error, Result};
use crate::picture::Picture;
use image::ImageDecoder;
use image::codecs::hdr::HdrDecoder;
use std::io::{Cursor, Read};
use std::path::Path;

/// The first words of a file: Radiance's own, and what other programs write in its place.
const SIGNATURES: [&[u8]; 2] = [b"#?RADIANCE", b"#?RGBE"];

/// Values are divided by the exposure and the colour correction of the header, as they are to be by its definition.
///
/// The reader is strict: a header line that is no number where one should be is an error. Files whose run lengths stand for
/// more than `MAX_RATIO` bytes a byte, which only the oldest encoding can have, are refused like those of other formats.
pub(super) fn decode(path: &Path, bytes: &[u8]) -> Result<Picture> {
    let rest = SIGNATURES.iter().find_map(|s| bytes.strip_prefix(*s)).ok_or_else(|| {
        Error::malformed(path, "does not start with `#?RADIANCE` or `#?RGBE` as Radiance pictures do")
    })?;
    let fail = |e: image::ImageError| Error::malformed(path, e.to_string());
    // The decoder knows the first signature alone.
    let decoder = HdrDecoder::new(Cursor::new(SIGNATURES[0]).chain(Cursor::new(rest))).map_err(fail)?;
    let (width, height) = decoder.dimensions();
    let declared = Declared {
        width: width.into(),
        height: height.into(),
        bits_per_pixel: 32,
        bytes_per_pixel: 12,
        file: bytes.len() as u64,
    };
    let pixels = check_declared(path, &declared)?;
    let meta = decoder.metadata();
    let exposure = meta.exposure.unwrap_or(1.0);
    let (r, g, b) = meta.color_correction.unwrap_or((1.0, 1.0, 1.0));
    let divisors = [r, g, b].map(|c| c * exposure);
    if !divisors.iter().all(|d| d.is_normal() && *d > 0.0) {
        let cause = format!("exposure {exposure} times colour correction {r} {g} {b} is no divisor above 0");
        return Err(Error::malformed(path, cause));
    }
    let mut picture = blank(path, width, height, pixels)?;
    // As many f32 as the picture has, in their bytes: `check_declared` has counted them.
    let mut raw = vec![0; pixels * 12];
    decoder.read_image(&mut raw).map_err(fail)?;
    let values = raw.chunks_exact(4).map(|b| f32::from_ne_bytes([b[0], b[1], b[2], b[3]]));
    let targets = picture.pixels.iter_mut().flatten().zip(values).zip(divisors.iter().cycle());
    targets.for_each(|((target, value), divisor)| *target = value / divisor);
    Ok(picture)
}
