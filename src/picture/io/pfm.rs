//! Portable float maps: three text lines, then rows of f32 from the bottom.

use super::{Declared, blank, check_declared};
use crate::error::{Error, Result};
use crate::picture::Picture;
use std::path::Path;

/// Longest header field accepted, bytes.
const MAX_FIELD: usize = 64;

pub(super) fn encode(picture: &Picture) -> Vec<u8> {
    // A negative scale says little endian.
    let mut bytes = format!("PF\n{} {}\n-1.0\n", picture.width, picture.height).into_bytes();
    for row in picture.pixels.chunks_exact(picture.width as usize).rev() {
        bytes.extend(row.iter().flatten().flat_map(|v| v.to_le_bytes()));
    }
    bytes
}

/// The scale's magnitude is ignored, as most programs do; its sign is the byte order.
pub(super) fn decode(path: &Path, bytes: &[u8]) -> Result<Picture> {
    let mut at = 0;
    let channels = match field(path, bytes, &mut at, "type")? {
        "PF" => 3,
        "Pf" => 1,
        other => return Err(Error::malformed(path, format!("type `{other}` is neither PF nor Pf"))),
    };
    let width: u32 = number(path, field(path, bytes, &mut at, "width")?, "width")?;
    let height: u32 = number(path, field(path, bytes, &mut at, "height")?, "height")?;
    let scale: f32 = number(path, field(path, bytes, &mut at, "scale")?, "scale")?;
    if !scale.is_finite() || scale == 0.0 {
        return Err(Error::malformed(path, format!("scale {scale} has no sign to tell the byte order")));
    }
    let bits = 32 * channels as u64;
    let (width64, height64, file) = (u64::from(width), u64::from(height), bytes.len() as u64);
    let pixels = check_declared(
        path,
        &Declared { width: width64, height: height64, bits_per_pixel: bits, bytes_per_pixel: 0, file },
    )?;
    let data = &bytes[at..];
    let wanted = pixels * channels * 4;
    if data.len() < wanted {
        let have = data.len();
        return Err(Error::malformed(path, format!("{width} x {height} pixels take {wanted} bytes, there are {have}")));
    }
    let value = |i: usize| {
        let b = [data[4 * i], data[4 * i + 1], data[4 * i + 2], data[4 * i + 3]];
        if scale < 0.0 { f32::from_le_bytes(b) } else { f32::from_be_bytes(b) }
    };
    let mut picture = blank(path, width, height, pixels)?;
    let columns = width as usize;
    for (y, row) in picture.pixels.chunks_exact_mut(columns).enumerate() {
        let first = (height as usize - 1 - y) * columns;
        for (x, pixel) in row.iter_mut().enumerate() {
            let i = (first + x) * channels;
            *pixel = if channels == 3 { [value(i), value(i + 1), value(i + 2)] } else { [value(i); 3] };
        }
    }
    Ok(picture)
}

/// The next word, and the one white character after it.
fn field<'a>(path: &Path, bytes: &'a [u8], at: &mut usize, what: &str) -> Result<&'a str> {
    let rest = &bytes[*at..];
    let start = rest.iter().take_while(|b| b.is_ascii_whitespace()).count();
    let length = rest[start..].iter().take(MAX_FIELD).take_while(|b| !b.is_ascii_whitespace()).count();
    let end = start + length;
    let closed = rest.get(end).is_some_and(u8::is_ascii_whitespace);
    let word = std::str::from_utf8(&rest[start..end]).ok().filter(|w| closed && !w.is_empty());
    *at += end + 1;
    word.ok_or_else(|| Error::malformed(path, format!("header ends or is no text at its {what}")))
}

fn number<T: std::str::FromStr>(path: &Path, word: &str, what: &str) -> Result<T> {
    word.parse().map_err(|_| Error::malformed(path, format!("{what} `{word}` is no usable number")))
}
