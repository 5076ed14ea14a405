//! Takes GLB files apart, and fetches buffers and images from the file, data URIs and files beside it.

use crate::error::{Error, Result};
use crate::scene::budget::Budget;
use crate::scene::load::read_bytes;
use ::gltf::json::{Image, Root};
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use base64::{DecodeError, Engine, alphabet};
use std::borrow::Cow;
use std::path::Path;

const MAGIC: &[u8; 4] = b"glTF";
const JSON_CHUNK: u32 = 0x4e4f_534a;
const BINARY_CHUNK: u32 = 0x004e_4942;

/// The JSON text and the binary chunk of a file. Source: glTF 2.0 specification, section 4.4.
pub(super) fn split<'a>(path: &Path, bytes: &'a [u8]) -> Result<(&'a [u8], Option<&'a [u8]>)> {
    if !bytes.starts_with(MAGIC) {
        return Ok((bytes, None));
    }
    let fail = |cause: String| Err(Error::malformed(path, cause));
    let (Some(version), Some(length)) = (word(bytes, 4), word(bytes, 8)) else {
        return fail(format!("{} bytes are too few for a GLB header of 12", bytes.len()));
    };
    if version != 2 {
        return fail(format!("GLB version {version}, only 2 is read"));
    }
    let Some(mut rest) = bytes.get(12..length as usize) else {
        return fail(format!("GLB header states {length} bytes, the file has {}", bytes.len()));
    };
    let mut json = None;
    let mut binary = None;
    let mut offset = 12;
    while !rest.is_empty() {
        let (Some(size), Some(kind)) = (word(rest, 0), word(rest, 4)) else {
            return fail(format!("byte {offset}: {} bytes are too few for a chunk header of 8", rest.len()));
        };
        let Some(chunk) = rest.get(8..).and_then(|r| r.get(..size as usize)) else {
            return fail(format!("byte {offset}: chunk of {size} bytes, {} are left", rest.len() - 8));
        };
        match (kind, json) {
            (JSON_CHUNK, None) => json = Some(chunk),
            (JSON_CHUNK, Some(_)) => return fail(format!("byte {offset}: a second JSON chunk")),
            (_, None) => return fail(format!("byte {offset}: the first chunk is not JSON")),
            (BINARY_CHUNK, _) if binary.is_none() => binary = Some(chunk),
            // Readers pass over chunks that they do not know.
            _ => {}
        }
        rest = &rest[8 + chunk.len()..];
        offset += 8 + chunk.len();
    }
    json.map_or_else(|| fail("no JSON chunk".into()), |json| Ok((json, binary)))
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    let bytes = bytes.get(at..)?.first_chunk::<4>()?;
    Some(u32::from_le_bytes(*bytes))
}

/// The content of all buffers, at least as long as stated.
pub(super) fn buffers<'a>(
    path: &Path,
    root: &Root,
    blob: Option<&'a [u8]>,
    budget: &Budget,
) -> Result<Vec<Cow<'a, [u8]>>> {
    let each = |(i, buffer): (usize, &::gltf::json::Buffer)| {
        let fail = |cause: String| Error::malformed(path, format!("buffers[{i}]: {cause}"));
        let content: Cow<[u8]> = match (&buffer.uri, blob) {
            (Some(uri), _) => Cow::Owned(fetch(path, uri).map_err(|cause| fail(cause.to_string()))?),
            (None, Some(blob)) if i == 0 => Cow::Borrowed(blob),
            (None, _) => return Err(fail("has neither a URI nor a binary chunk".into())),
        };
        if let Cow::Owned(bytes) = &content {
            budget.take(bytes.len() as u64, || format!("{}: buffers[{i}]", path.display()))?;
        }
        let stated = buffer.byte_length.0;
        if (content.len() as u64) < stated {
            return Err(fail(format!("{stated} bytes are stated, {} are there", content.len())));
        }
        Ok(content)
    };
    root.buffers.iter().enumerate().map(each).collect()
}

/// The bytes of an image file, from wherever the image says. The error is the cause alone.
pub(super) fn image(data: &super::accessor::Data, image: &Image) -> std::result::Result<Vec<u8>, String> {
    match (&image.uri, image.buffer_view) {
        (Some(uri), _) => fetch(data.path, uri).map_err(|e| e.to_string()),
        (None, Some(view)) => data.view(view.value()).map(<[u8]>::to_vec).map_err(|e| e.to_string()),
        (None, None) => Err("has neither a URI nor a buffer view".into()),
    }
}

fn fetch(path: &Path, uri: &str) -> Result<Vec<u8>> {
    if let Some(data) = uri.strip_prefix("data:") {
        return data_uri(data).map_err(|cause| Error::invalid(format!("data URI: {cause}")));
    }
    let has_scheme = uri.split_once(':').is_some_and(|(scheme, _)| {
        scheme.len() > 1 && scheme.chars().all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c))
    });
    if has_scheme {
        return Err(Error::invalid(format!("`{uri}` is not a file beside this one")));
    }
    let name = percent_decode(uri).map_err(|cause| Error::invalid(format!("`{uri}`: {cause}")))?;
    read_bytes(&path.parent().unwrap_or(Path::new("")).join(name))
}

fn data_uri(data: &str) -> std::result::Result<Vec<u8>, String> {
    let (head, body) = data.split_once(',').ok_or("no comma")?;
    if !head.ends_with(";base64") {
        return Err("only base64 is read".into());
    }
    base64(body.as_bytes())
}

/// Padding may be missing, and bits behind the last byte may be anything.
fn base64(text: &[u8]) -> std::result::Result<Vec<u8>, String> {
    const LENIENT: GeneralPurposeConfig = GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true);
    GeneralPurpose::new(&alphabet::STANDARD, LENIENT).decode(text).map_err(|e| match e {
        DecodeError::InvalidByte(i, _) => format!("character {i} is no base64 digit"),
        other => format!("{} characters are no base64: {other}", text.len()),
    })
}

fn percent_decode(uri: &str) -> std::result::Result<String, String> {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let Some((&first, tail)) = rest.split_first() {
        rest = tail;
        if first != b'%' {
            bytes.push(first);
            continue;
        }
        let hex = tail.get(..2).and_then(|h| std::str::from_utf8(h).ok());
        let value = hex.and_then(|h| u8::from_str_radix(h, 16).ok());
        bytes.push(value.ok_or("a % without two hexadecimal digits")?);
        rest = &tail[2..];
    }
    String::from_utf8(bytes).map_err(|_| "not UTF-8".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_matches_the_rfc() {
        // RFC 4648, section 10.
        for (text, plain) in
            [("", ""), ("Zg==", "f"), ("Zm8=", "fo"), ("Zm9v", "foo"), ("Zm9vYg", "foob"), ("Zm9vYmFy", "foobar")]
        {
            assert_eq!(base64(text.as_bytes()), Ok(plain.as_bytes().to_vec()), "{text}");
        }
        for bad in ["Z", "Zm9v!", "Zg===", "Zm9vY"] {
            assert!(base64(bad.as_bytes()).is_err(), "{bad}");
        }
    }

    #[test]
    fn percent_signs_are_decoded() {
        assert_eq!(percent_decode("a%20b%C3%A9.png").as_deref(), Ok("a b\u{e9}.png"));
        for bad in ["%", "%2", "%zz", "%ff"] {
            assert!(percent_decode(bad).is_err(), "{bad}");
        }
    }
}
