//! EXR headers whose attributes stand in alphabetical order.
//!
//! The encoder keeps attributes in a hash map, so that their order, and with it the file, would differ from run to run.

/// Sorts the attributes of the one header in `file` by name; the file keeps its length, so that no offset changes.
///
/// Layout (OpenEXR file layout, "Header"): after 8 bytes of magic and version, attributes of name, 0, type, 0, size as
/// i32, value; a 0 instead of a name ends the header. A file that is not so stays as it is.
pub(super) fn sort_attributes(file: &mut [u8]) {
    const START: usize = 8;
    let Some(mut attributes) = file.get(START..).and_then(attributes) else { return };
    attributes.sort_unstable();
    let sorted = attributes.concat();
    file[START..START + sorted.len()].copy_from_slice(&sorted);
}

/// The bytes of each attribute.
fn attributes(mut rest: &[u8]) -> Option<Vec<&[u8]>> {
    let mut found = Vec::new();
    while *rest.first()? != 0 {
        let name = 1 + rest.iter().position(|b| *b == 0)?;
        let kind = 1 + rest.get(name..)?.iter().position(|b| *b == 0)?;
        let value = name + kind + 4;
        let size = rest.get(value - 4..value)?.try_into().ok().map(i32::from_le_bytes)?;
        let end = value.checked_add(usize::try_from(size).ok()?)?;
        found.push(rest.get(..end)?);
        rest = &rest[end..];
    }
    Some(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn attributes_are_sorted_and_nothing_else_moves() {
        let (a, b) = (b"alpha\0int\0\x04\0\0\0\x00\x01\x02\x03", b"beta\0string\0\x01\0\0\0z");
        let file = |first: &[u8], second: &[u8]| [b"magicver", first, second, b"\0beta data"].concat();
        let mut bytes = file(b, a);
        sort_attributes(&mut bytes);
        assert_eq!(bytes, file(a, b));
        // Cut within the header: unchanged.
        let whole = file(b, a);
        for end in 0..=8 + a.len() + b.len() {
            let mut bytes = whole[..end].to_vec();
            sort_attributes(&mut bytes);
            assert_eq!(bytes, whole[..end], "{end}");
        }
    }
}
