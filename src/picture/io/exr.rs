//! OpenEXR through the `exr` crate: f32 out, half, f32 and u32 in.

mod layers;
mod order;
mod words;

pub use words::{Words, decode_words, encode_words};

use super::{
    Attributes, Declared, MAX_DECODED_BYTES, blank, check_declared, check_size, read_bytes, replace_file, too_large,
};
use crate::error::{Error, Result};
use crate::picture::Picture;
use exr::block::reader::Reader;
use exr::prelude::*;
use std::io::Cursor;
use std::path::Path;

/// Our names for the variance of the mean, in the order R, G, B.
const VARIANCE: [&str; 3] = ["variance.R", "variance.G", "variance.B"];
const COLOURS: [&str; 3] = ["R", "G", "B"];

/// How pixels are packed. Blocks are compressed by several threads; without an order of their own they would stand in
/// the file as they were finished, which differs from run to run.
const ENCODING: Encoding =
    Encoding { compression: Compression::ZIP16, line_order: LineOrder::Increasing, ..Encoding::FAST_LOSSLESS };

/// The only part of an EXR file, checked and decoded.
type Part = Layer<AnyChannels<FlatSamples>>;

/// Writes an EXR file with the channels `R`, `G`, `B` (the mean) and `variance.R`, `variance.G`, `variance.B`.
///
/// # Errors
/// The two pictures differ in size, are empty or have not as many pixels as their size says, or the file cannot be written.
pub fn write_with_variance(
    path: impl AsRef<Path>,
    mean: &Picture,
    variance: &Picture,
    attributes: &Attributes,
) -> crate::Result<()> {
    let path = path.as_ref();
    check_size(path, mean)?;
    check_size(path, variance)?;
    if (mean.width, mean.height) != (variance.width, variance.height) {
        let (a, b) = ((mean.width, mean.height), (variance.width, variance.height));
        return Err(Error::malformed(path, format!("mean is {} x {}, variance {} x {}", a.0, a.1, b.0, b.1)));
    }
    replace_file(path, &encode(path, mean, Some(variance), attributes)?)
}

/// Reads what [`write_with_variance`] writes: the mean and its variance.
///
/// # Errors
/// As [`super::read`]; or a variance channel is missing.
pub fn read_with_variance(path: impl AsRef<Path>) -> crate::Result<(Picture, Picture)> {
    let path = path.as_ref();
    let part = decode_part(path, &read_bytes(path)?)?;
    Ok((picture(path, &part, &COLOURS)?, picture(path, &part, &VARIANCE)?))
}

/// Whether the EXR file has the channels of a variance, whose pixels are not looked at.
///
/// # Errors
/// The file cannot be read or its header is damaged.
pub fn has_variance(path: impl AsRef<Path>) -> crate::Result<bool> {
    let path = path.as_ref();
    let bytes = read_bytes(path)?;
    let reader = Reader::read_from_buffered(Cursor::new(&bytes[..]), false).map_err(|e| damaged(path, &e))?;
    let channels = || reader.headers().iter().flat_map(|header| &header.channels.list);
    Ok(VARIANCE.iter().all(|name| channels().any(|c| c.name == **name)))
}

/// The text attributes of an EXR file, in the order of their names.
///
/// # Errors
/// The file cannot be read or its header is damaged.
pub fn read_attributes(path: impl AsRef<Path>) -> crate::Result<Attributes> {
    let path = path.as_ref();
    attributes_of(path, &read_bytes(path)?)
}

/// As [`read_attributes`], of a file in memory; `path` is for messages only.
///
/// # Errors
/// The header is damaged.
pub fn attributes_of(path: &Path, bytes: &[u8]) -> crate::Result<Attributes> {
    let reader = Reader::read_from_buffered(Cursor::new(bytes), false).map_err(|e| damaged(path, &e))?;
    let mut entries = Vec::new();
    for header in reader.headers() {
        for (name, value) in header.own_attributes.other.iter().chain(&header.shared_attributes.other) {
            if let AttributeValue::Text(text) = value {
                entries.push((utf8(name), utf8(text)));
            }
        }
    }
    entries.sort();
    Ok(Attributes { entries })
}

pub(super) fn decode(path: &Path, bytes: &[u8], layer: Option<&str>) -> Result<Picture> {
    let part = decode_part(path, bytes)?;
    let names: Vec<String> = part.channel_data.list.iter().map(|c| utf8(&c.name)).collect();
    let colours = layers::colours(&names, layer).map_err(|cause| Error::malformed(path, cause))?;
    picture(path, &part, &[0, 1, 2].map(|c| colours[c].as_str()))
}

pub(super) fn encode(
    path: &Path,
    mean: &Picture,
    variance: Option<&Picture>,
    attributes: &Attributes,
) -> Result<Vec<u8>> {
    let planes = |picture: &Picture, names: [&'static str; 3]| {
        let plane = |c: usize| FlatSamples::F32(picture.pixels.iter().map(|p| p[c]).collect());
        [0, 1, 2].map(|c| AnyChannel::new(names[c], plane(c)))
    };
    let channels = planes(mean, COLOURS).into_iter();
    let channels = channels.chain(variance.into_iter().flat_map(|v| planes(v, VARIANCE))).collect();
    let size = (mean.width as usize, mean.height as usize);
    let layer = Layer::new(size, own_attributes(attributes), ENCODING, AnyChannels::sort(channels));
    encode_image(path, &Image::from_layer(layer))
}

fn own_attributes(attributes: &Attributes) -> LayerAttributes {
    let mut own = LayerAttributes { software_name: Some(Text::from("skipgrid")), ..LayerAttributes::default() };
    for (name, value) in &attributes.entries {
        own.other.insert(text(name), AttributeValue::Text(text(value)));
    }
    own
}

/// The file in memory, with the same bytes every time.
fn encode_image(path: &Path, image: &Image<Layer<AnyChannels<FlatSamples>>>) -> Result<Vec<u8>> {
    let mut bytes = Cursor::new(Vec::new());
    image.write().to_buffered(&mut bytes).map_err(|e| Error::malformed(path, e.to_string()))?;
    let mut bytes = bytes.into_inner();
    order::sort_attributes(&mut bytes);
    Ok(bytes)
}

/// Checks the header before any pixel is allocated, then decodes.
fn decode_part(path: &Path, bytes: &[u8]) -> Result<Part> {
    let reader = Reader::read_from_buffered(Cursor::new(bytes), false).map_err(|e| damaged(path, &e))?;
    let [header] = reader.headers() else {
        let parts = reader.headers().len();
        return Err(Error::malformed(path, format!("has {parts} parts, wanted is 1")));
    };
    if header.deep {
        return Err(Error::malformed(path, "has deep data, wanted are flat pixels"));
    }
    if let Some(c) = header.channels.list.iter().find(|c| c.sampling != Vec2(1, 1)) {
        let Vec2(x, y) = c.sampling;
        let cause =
            format!("channel `{}` is subsampled, one value for {x} x {y} pixels: wanted is one for each", c.name);
        return Err(Error::malformed(path, cause));
    }
    let Vec2(width, height) = header.layer_size;
    let bytes_per_pixel = header.channels.bytes_per_pixel as u64;
    // PXR24 keeps three of four bytes. In memory: the samples, and as much for a block that is the whole picture.
    let (file, bits_per_pixel) = (bytes.len() as u64, 6 * bytes_per_pixel);
    let (width, height) = (width as u64, height as u64);
    check_declared(path, &Declared { width, height, bits_per_pixel, bytes_per_pixel: 2 * bytes_per_pixel, file })?;
    let block = header.max_block_pixel_size();
    let block_bytes = (block.0 as u64).saturating_mul(block.1 as u64).saturating_mul(bytes_per_pixel);
    if block_bytes > MAX_DECODED_BYTES {
        return Err(too_large(path, &format!("tile of {} x {}", block.0, block.1), block_bytes, MAX_DECODED_BYTES));
    }
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        // In order, so that a damaged file gives the same message every time.
        .non_parallel()
        .from_chunks(reader)
        .map_err(|e| damaged(path, &e))?;
    Ok(image.layer_data)
}

fn channel<'a>(part: &'a Part, name: &str) -> Option<&'a AnyChannel<FlatSamples>> {
    part.channel_data.list.iter().find(|c| c.name == *name)
}

fn picture(path: &Path, part: &Part, names: &[&str; 3]) -> Result<Picture> {
    let Vec2(width, height) = part.size;
    // Checked with the header: sides fit in u32.
    let pixels = width * height;
    let mut picture = blank(path, width as u32, height as u32, pixels)?;
    for (c, name) in names.iter().enumerate() {
        let Some(found) = channel(part, name) else {
            let have: Vec<String> = part.channel_data.list.iter().map(|c| format!("`{}`", c.name)).collect();
            return Err(Error::malformed(path, format!("has no channel `{name}`, only {}", have.join(", "))));
        };
        for (pixel, value) in picture.pixels.iter_mut().zip(found.sample_data.values_as_f32()) {
            pixel[c] = value;
        }
    }
    Ok(picture)
}

fn damaged(path: &Path, error: &exr::error::Error) -> Error {
    Error::malformed(path, format!("damaged EXR file: {error}"))
}

/// EXR texts are bytes; ours are UTF-8.
fn text(s: &str) -> Text {
    Text::from_bytes_unchecked(s.bytes().collect())
}

fn utf8(text: &Text) -> String {
    String::from_utf8_lossy(text.as_slice()).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_of_many_blocks_gives_the_same_bytes_every_time() {
        let path = Path::new("many.exr");
        let mut picture = Picture::new(320, 256);
        for (i, pixel) in picture.pixels.iter_mut().enumerate() {
            // Rows of noise and rows of one colour take different times to compress.
            *pixel = if i / 320 % 96 < 48 { [1.0; 3] } else { [1, 7, 49].map(|n| (i as f32 * n as f32).sin()) };
        }
        let first = encode(path, &picture, None, &Attributes::default()).expect("a small picture");
        for _ in 0..30 {
            assert!(encode(path, &picture, None, &Attributes::default()).expect("a small picture") == first);
        }
        assert_eq!(decode(path, &first, None).expect("as written"), picture);
    }
}
