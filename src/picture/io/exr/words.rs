//! EXR files of whole numbers: any channels of u32, for a part of a picture.

use super::{
    AnyChannel, AnyChannels, Attributes, ENCODING, Error, FlatSamples, Image, LayerAttributes, Result, Vec2,
    attributes_of, damaged, decode_part, encode_image, utf8,
};
use exr::block::reader::Reader;
use exr::meta::header::ImageAttributes;
use exr::prelude::{IntegerBounds, Layer};
use std::io::Cursor;
use std::path::Path;

/// Channels of u32 for a rectangle of a picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Words {
    /// Columns and rows of the whole picture: the file's display window, from (0, 0).
    pub whole: [u32; 2],
    /// First column and row of the rectangle: the file's data window begins there.
    pub corner: [u32; 2],
    /// Columns and rows of the rectangle.
    pub size: [u32; 2],
    /// Names and values, row by row from the top.
    pub channels: Vec<(String, Vec<u32>)>,
}

/// An EXR file in memory with the channels of `words`, compressed without loss; `path` is for messages only.
///
/// # Errors
/// A number of values differs from the size, or a place is beyond what EXR files count.
pub fn encode_words(path: &Path, words: Words, attributes: &Attributes) -> crate::Result<Vec<u8>> {
    let [width, height] = words.size.map(|n| n as usize);
    if let Some((name, values)) = words.channels.iter().find(|(_, values)| values.len() != width * height) {
        let cause = format!("channel `{name}` has {} values for {width} x {height} pixels", values.len());
        return Err(Error::malformed(path, cause));
    }
    let place =
        |n: u32| i32::try_from(n).map_err(|_| Error::malformed(path, format!("{n} is no place in an EXR file")));
    let position = Vec2(place(words.corner[0])?, place(words.corner[1])?);
    let own = LayerAttributes { layer_position: position, ..super::own_attributes(attributes) };
    let whole = IntegerBounds::new((0, 0), (words.whole[0] as usize, words.whole[1] as usize));
    let channels = words.channels.into_iter();
    let channels = channels.map(|(name, values)| AnyChannel::new(name.as_str(), FlatSamples::U32(values))).collect();
    let layer = Layer::new((width, height), own, ENCODING, AnyChannels::sort(channels));
    encode_image(path, &Image::new(ImageAttributes::new(whole), layer))
}

/// The channels of an EXR file in memory that has none but u32, in the order of their names, and its text attributes.
///
/// # Errors
/// As [`super::super::read`]; or a channel has other values.
pub fn decode_words(path: &Path, bytes: &[u8]) -> crate::Result<(Words, Attributes)> {
    let attributes = attributes_of(path, bytes)?;
    let reader = Reader::read_from_buffered(Cursor::new(bytes), false).map_err(|e| damaged(path, &e))?;
    let window = reader.headers().first().map(|header| header.shared_attributes.display_window);
    let whole = window.map_or([0, 0], |window| [window.size.0 as u32, window.size.1 as u32]);
    let part = decode_part(path, bytes)?;
    let corner = [part.attributes.layer_position.0, part.attributes.layer_position.1];
    let place =
        |n: i32| u32::try_from(n).map_err(|_| Error::malformed(path, format!("begins at {n}, outside the picture")));
    let corner = [place(corner[0])?, place(corner[1])?];
    let size = [part.size.0 as u32, part.size.1 as u32];
    let channels = part.channel_data.list.into_iter().map(|channel| match channel.sample_data {
        FlatSamples::U32(values) => Ok((utf8(&channel.name), values)),
        _ => Err(Error::malformed(path, format!("channel `{}` has other values than u32", channel.name))),
    });
    let channels = channels.collect::<Result<_>>()?;
    Ok((Words { whole, corner, size, channels }, attributes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bit_comes_back_in_its_place() {
        let path = Path::new("words.exr");
        let values: Vec<u32> = (0..12u32).map(|i| i.wrapping_mul(0x9e37_79b9)).collect();
        let channels = vec![("a.high".to_string(), values.clone()), ("a.low".to_string(), vec![u32::MAX; 12])];
        let words = Words { whole: [100, 50], corner: [96, 40], size: [4, 3], channels };
        let attributes = Attributes::default().with("shardTile", "96,40,4,3");
        let bytes = encode_words(path, words.clone(), &attributes).expect("small");
        assert_eq!(bytes, encode_words(path, words.clone(), &attributes).expect("small"));
        assert_eq!(decode_words(path, &bytes).expect("as written"), (words.clone(), attributes.clone()));
        let short = Words { size: [4, 4], ..words };
        assert!(encode_words(path, short, &attributes).is_err());
    }
}
