//! The header of NumPy's `.npy` files.
//!
//! Format: NumPy Enhancement Proposal 1 and `numpy.lib.format`, versions 1.0 to 3.0. A header of a magic, a version, a
//! length and a Python dictionary; then the array.

use std::io::Read;

/// First bytes of every file.
pub(crate) const MAGIC: &[u8; 6] = b"\x93NUMPY";

/// Longest header that is read; NumPy itself refuses more than 10 000 bytes.
const MAX_HEADER: usize = 1 << 16;

/// What is wrong with a file.
#[derive(Debug)]
pub(crate) enum Fault {
    /// The system's reason.
    Io(std::io::Error),
    /// Place and cause.
    Content(String),
}

impl From<String> for Fault {
    fn from(cause: String) -> Self {
        Fault::Content(cause)
    }
}

/// Fills `buffer`; `what` is what ends too early if the file does.
pub(crate) fn fill(source: &mut impl Read, buffer: &mut [u8], what: &str) -> std::result::Result<(), Fault> {
    source.read_exact(buffer).map_err(|error| match error.kind() {
        std::io::ErrorKind::UnexpectedEof => Fault::Content(format!("ends within the {what}")),
        _ => Fault::Io(error),
    })
}

/// What stands before the array.
pub(crate) struct Header {
    /// The dictionary; see [`value`].
    pub text: String,
    /// Bytes before the array.
    pub bytes: u64,
}

/// Reads up to the first byte of the array.
pub(crate) fn read_header(source: &mut impl Read) -> std::result::Result<Header, Fault> {
    let mut start = [0; 8];
    fill(source, &mut start, "first 8 bytes")?;
    if &start[..6] != MAGIC {
        return Err(format!("no .npy file: it starts with {:02x?} instead of {MAGIC:02x?}", &start[..6]).into());
    }
    let header_length = match start[6] {
        1 => {
            let mut bytes = [0; 2];
            fill(source, &mut bytes, "header's length")?;
            usize::from(u16::from_le_bytes(bytes))
        }
        2 | 3 => {
            let mut bytes = [0; 4];
            fill(source, &mut bytes, "header's length")?;
            u32::from_le_bytes(bytes) as usize
        }
        version => return Err(format!("format version {version}.{}; known are 1 to 3", start[7]).into()),
    };
    if header_length > MAX_HEADER {
        return Err(format!("header of {header_length} bytes; at most {MAX_HEADER} are read").into());
    }
    let mut header = vec![0; header_length];
    fill(source, &mut header, "header")?;
    let before = 8 + if start[6] == 1 { 2 } else { 4 } + header_length as u64;
    Ok(Header { text: String::from_utf8_lossy(&header).into_owned(), bytes: before })
}

/// The text of `key`'s value in a Python dictionary of strings, words, tuples and lists.
pub(crate) fn value<'a>(header: &'a str, key: &str) -> std::result::Result<&'a str, String> {
    let place = [format!("'{key}'"), format!("\"{key}\"")].iter().find_map(|k| header.find(k).map(|i| i + k.len()));
    let rest = place.map(|i| header[i..].trim_start());
    let rest = rest.and_then(|r| r.strip_prefix(':')).map(str::trim_start);
    let rest = rest.ok_or_else(|| format!("the header has no `{key}`"))?;
    // Up to the comma or brace outside all brackets.
    let mut depth = 0i32;
    for (i, c) in rest.char_indices() {
        match c {
            '(' | '[' => depth += 1,
            ')' | ']' => depth -= 1,
            ',' | '}' if depth <= 0 => return Ok(rest[..i].trim_end()),
            _ => {}
        }
    }
    Err(format!("the header ends within `{key}`"))
}
