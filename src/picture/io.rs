//! EXR, PNG and PFM in and out and Radiance's HDR in, chosen by the file's extension.

mod exr;
mod hdr;
mod pfm;
mod png;
mod replace;

pub use exr::{
    Words, attributes_of, decode_words, encode_words, has_variance, read_attributes, read_with_variance,
    write_with_variance,
};
#[cfg(all(feature = "cli", unix))]
pub(crate) use replace::between_files;
#[cfg(feature = "cli")]
pub(crate) use replace::check_replaceable;
pub use replace::replace_file;

use super::Picture;
use crate::error::{Error, Result};
use std::path::Path;

/// Pictures that take more bytes than this while they are decoded are refused before anything is allocated for them.
pub const MAX_DECODED_BYTES: u64 = 1 << 31;

/// Most bytes that a byte of a compressed file can stand for. Deflate's longest match of 258 bytes takes two bits (RFC
/// 1951); the run lengths of EXR's other methods give less.
const MAX_RATIO: u64 = 1032;

/// Files above this many bytes are refused before they are read.
pub const MAX_FILE_BYTES: u64 = 1 << 30;

/// Named texts that an EXR file carries: render settings, accelerator. Of these a PNG file carries [`PARTIAL`] alone, a PFM
/// file none.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Attributes {
    /// Names and values in the order of insertion.
    pub entries: Vec<(String, String)>,
}

impl Attributes {
    /// The same attributes and one more, behind the others; names are not looked at, so one can be there twice.
    pub fn with(mut self, name: impl Into<String>, value: impl Into<String>) -> Self {
        self.entries.push((name.into(), value.into()));
        self
    }

    /// The first value of `name`, if there is one.
    pub fn get(&self, name: &str) -> Option<&str> {
        self.entries.iter().find(|(n, _)| n == name).map(|(_, value)| value.as_str())
    }
}

/// Name of the attribute of a picture that is not finished; its value says how far it is.
pub const PARTIAL: &str = "partial";

/// How the numbers in a PNG file relate to light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PngEncoding {
    /// Linear if the file's gAMA chunk says 1 (as POV-Ray writes with `File_Gamma=1.0`), else sRGB.
    #[default]
    Declared,
    /// sRGB, whatever the file says.
    Srgb,
    /// Proportional to light, whatever the file says.
    Linear,
}

/// The formats that are read; all but the last are also written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Exr,
    Png,
    Pfm,
    Hdr,
}

impl Format {
    fn of(path: &Path) -> Result<Self> {
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_ascii_lowercase();
        match extension.as_str() {
            "exr" => Ok(Format::Exr),
            "png" => Ok(Format::Png),
            "pfm" => Ok(Format::Pfm),
            "hdr" | "pic" => Ok(Format::Hdr),
            other => {
                let cause = format!("extension `{other}` is no picture format: .exr, .png, .pfm, or .hdr to be read");
                Err(Error::malformed(path, cause))
            }
        }
    }
}

/// Reads a picture; a PNG as [`PngEncoding::Declared`].
///
/// EXR: half, f32 or u32 channels `R`, `G`, `B`, or `Y` alone, without a layer or in the only layer that has any; other
/// channels are ignored. PNG: 8 or 16 bits, grey or colour; opacity is ignored. PFM: `PF` or `Pf`. HDR: Radiance's RGBE.
/// Pixels that are not finite are read as they are.
///
/// # Errors
/// The file cannot be read, has another extension, is damaged, has no colour channels or these in several layers, has
/// several parts, deep data or subsampled channels, has more than [`MAX_FILE_BYTES`], would take more than
/// [`MAX_DECODED_BYTES`] while it is decoded, or states a size for which it is too short.
pub fn read(path: impl AsRef<Path>) -> Result<Picture> {
    read_with(path, PngEncoding::Declared)
}

/// As [`read`], with a say in what the numbers of a PNG mean.
///
/// # Errors
/// As [`read`].
pub fn read_with(path: impl AsRef<Path>, encoding: PngEncoding) -> Result<Picture> {
    decode(path.as_ref(), encoding, None)
}

/// As [`read`], the channels of `layer` in an EXR file: `LAYER.R`, `LAYER.G` and `LAYER.B`, or `LAYER.Y` alone. For other
/// formats, which have no layers, as [`read`].
///
/// # Errors
/// As [`read`]; or an EXR file has no such layer.
pub fn read_layer(path: impl AsRef<Path>, layer: &str) -> Result<Picture> {
    decode(path.as_ref(), PngEncoding::Declared, Some(layer))
}

fn decode(path: &Path, encoding: PngEncoding, layer: Option<&str>) -> Result<Picture> {
    let format = Format::of(path)?;
    let bytes = read_bytes(path)?;
    match format {
        Format::Exr => exr::decode(path, &bytes, layer),
        Format::Png => png::decode(path, &bytes, encoding),
        Format::Pfm => pfm::decode(path, &bytes),
        Format::Hdr => hdr::decode(path, &bytes),
    }
}

/// Writes a picture: EXR in f32 with `attributes`, PNG in sRGB with 8 bits (clamped to 0..1, NaN as 0) and [`PARTIAL`] as a
/// text, PFM in little endian.
///
/// The file appears whole or not at all; an older file of that name stays until then.
///
/// # Errors
/// The extension is another one (Radiance's are read only), the picture is empty or has not as many pixels as its size
/// says, or the file cannot be written.
pub fn write(path: impl AsRef<Path>, picture: &Picture, attributes: &Attributes) -> Result<()> {
    let path = path.as_ref();
    let format = Format::of(path)?;
    check_size(path, picture)?;
    let bytes = match format {
        Format::Exr => exr::encode(path, picture, None, attributes)?,
        Format::Png => {
            let bytes = png::encode(path, picture)?;
            match attributes.get(PARTIAL) {
                Some(text) => png::with_text(bytes, PARTIAL, text),
                None => bytes,
            }
        }
        Format::Pfm => pfm::encode(picture),
        Format::Hdr => return Err(Error::malformed(path, "Radiance pictures are read only: .exr, .png or .pfm")),
    };
    replace_file(path, &bytes)
}

/// The picture as a PNG file in memory, sRGB with 8 bits; `path` is for messages only.
///
/// # Errors
/// The picture's size and number of pixels disagree, or it is empty.
pub fn encode_png(path: &Path, picture: &Picture) -> Result<Vec<u8>> {
    check_size(path, picture)?;
    png::encode(path, picture)
}

/// Reads a regular file of at most [`MAX_FILE_BYTES`].
pub(crate) fn read_bytes(path: &Path) -> Result<Vec<u8>> {
    let meta = std::fs::metadata(path).map_err(|e| Error::io(path, e))?;
    if !meta.is_file() {
        return Err(Error::malformed(path, "is no regular file"));
    }
    if meta.len() > MAX_FILE_BYTES {
        return Err(too_large(path, "file", meta.len(), MAX_FILE_BYTES));
    }
    std::fs::read(path).map_err(|e| Error::io(path, e))
}

fn too_large(path: &Path, what: &str, wanted: u64, allowed: u64) -> Error {
    Error::TooLarge { what: format!("{}: {what}", path.display()), wanted, allowed }
}

/// What a file says of its pixels before they are decoded.
struct Declared {
    width: u64,
    height: u64,
    /// Of a pixel as it is packed in the file before compression.
    bits_per_pixel: u64,
    /// Of a pixel while it is decoded, the picture's own 12 aside.
    bytes_per_pixel: u64,
    /// Of the whole file.
    file: u64,
}

/// Refuses a declared size that is empty, would take too much, or cannot be in the file; gives the number of pixels.
fn check_declared(path: &Path, declared: &Declared) -> Result<usize> {
    let &Declared { width, height, bits_per_pixel, bytes_per_pixel, file } = declared;
    if width == 0 || height == 0 {
        return Err(Error::malformed(path, format!("picture of {width} x {height} pixels is empty")));
    }
    let pixels = width.saturating_mul(height);
    let wanted = pixels.saturating_mul(bytes_per_pixel.saturating_add(12));
    let small_sides = u32::try_from(width).is_ok() && u32::try_from(height).is_ok();
    let Some(count) = usize::try_from(pixels).ok().filter(|_| small_sides && wanted <= MAX_DECODED_BYTES) else {
        return Err(too_large(path, &format!("picture of {width} x {height} pixels"), wanted, MAX_DECODED_BYTES));
    };
    let packed = pixels.saturating_mul(bits_per_pixel) / 8;
    if packed > file.saturating_mul(MAX_RATIO) {
        let cause = format!("picture of {width} x {height} pixels, {packed} bytes, cannot be in a file of {file}");
        return Err(Error::malformed(path, cause));
    }
    Ok(count)
}

/// A black picture whose memory was asked for, not taken for granted.
fn blank(path: &Path, width: u32, height: u32, pixels: usize) -> Result<Picture> {
    let mut buffer = Vec::new();
    let wanted = pixels as u64 * 12;
    buffer.try_reserve_exact(pixels).map_err(|_| too_large(path, "picture", wanted, wanted))?;
    buffer.resize(pixels, [0.0; 3]);
    Ok(Picture { width, height, pixels: buffer })
}

fn check_size(path: &Path, picture: &Picture) -> Result<()> {
    let wanted = u64::from(picture.width) * u64::from(picture.height);
    if wanted != picture.pixels.len() as u64 || wanted == 0 {
        let (w, h, n) = (picture.width, picture.height, picture.pixels.len());
        return Err(Error::malformed(path, format!("picture of {w} x {h} has {n} pixels, not {wanted} above 0")));
    }
    Ok(())
}
