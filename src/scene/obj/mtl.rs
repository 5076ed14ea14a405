//! Checks the lines of an MTL file before `tobj` reads it.

use super::check::{name, parse, printable, split, words};
use super::{Library, material};
use crate::error::{Error, Result};
use crate::scene::SceneParts;
use crate::scene::budget::Budget;
use crate::scene::load::read_bytes;
use std::path::Path;

/// Most bytes of an MTL file, and most materials in all.
const MAX_BYTES: usize = 1 << 26;
const MAX_MATERIALS: usize = 1 << 16;

/// Adds the materials and textures of an MTL file to `parts`; returns what `tobj` made of it.
///
/// # Errors
/// The file cannot be read or is too large, or a number is none.
pub(super) fn read(path: &Path, parts: &mut SceneParts, budget: &Budget) -> Result<Library> {
    let bytes = read_bytes(path)?;
    if bytes.len() > MAX_BYTES {
        return Err(Error::malformed(path, format!("{} bytes, at most {MAX_BYTES} are read", bytes.len())));
    }
    let text = check(path, &bytes, MAX_MATERIALS.saturating_sub(parts.materials.len()))?;
    let library = tobj::load_mtl_buf(&mut text.as_bytes()).map_err(|e| Error::malformed(path, e.to_string()))?;
    for written in &library.0 {
        material::add(written, path, parts, budget);
    }
    Ok(library)
}

/// The statements that show in a picture, each in the one form that `tobj` knows.
fn check(path: &Path, bytes: &[u8], most: usize) -> Result<String> {
    let mut text = String::new();
    let mut materials = 0;
    for (i, line) in bytes.split(|&b| b == b'\n').enumerate() {
        let fail = |cause: String| Error::malformed(path, format!("line {}: {cause}", i + 1));
        let (keyword, rest) = split(line);
        if keyword == b"newmtl" {
            materials += 1;
            if materials > most {
                return Err(fail(format!("more than {MAX_MATERIALS} materials")));
            }
            text += &format!("newmtl {}\n", name(rest));
        } else if materials > 0 {
            text += &statement(keyword, rest).map_err(fail)?;
        }
    }
    Ok(text)
}

/// Empty for statements that do not show: ambient colour, highlights, bump and the like.
fn statement(keyword: &[u8], rest: &[u8]) -> std::result::Result<String, String> {
    let key = String::from_utf8_lossy(keyword);
    Ok(match keyword {
        b"Kd" | b"Ks" | b"Ke" => {
            let [r, g, b] = colour(rest)?;
            format!("{key} {r} {g} {b}\n")
        }
        b"d" | b"Tr" | b"Ni" => format!("{key} {}\n", number(rest)?),
        b"illum" => format!("{key} {}\n", number(rest)?.clamp(0.0, 100.0) as u8),
        b"map_Kd" if String::from_utf8_lossy(rest).trim().is_empty() => return Err("`map_Kd` without a file".into()),
        b"map_Kd" => format!("{key} {}\n", String::from_utf8_lossy(rest)),
        _ => String::new(),
    })
}

fn number(text: &[u8]) -> std::result::Result<f32, String> {
    // `d -halo 0.5` and the like: the number comes last.
    let number = parse(words(text).last().unwrap_or_default()).filter(|n: &f32| n.is_finite());
    number.ok_or_else(|| format!("`{}` is no finite number", printable(text)))
}

/// Three numbers, or one for all three.
fn colour(text: &[u8]) -> std::result::Result<[f32; 3], String> {
    let numbers: Option<Vec<f32>> = words(text).take(3).map(|w| parse(w).filter(|n: &f32| n.is_finite())).collect();
    match numbers.as_deref() {
        Some(&[r, g, b]) => Ok([r, g, b]),
        Some(&[v]) => Ok([v; 3]),
        _ => Err(format!("`{}` is no colour of one or three finite numbers", printable(text))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_colours_are_checked() {
        assert_eq!(number(b"-halo 0.25"), Ok(0.25));
        assert_eq!(colour(b"0.1 0.2 0.3"), Ok([0.1, 0.2, 0.3]));
        assert_eq!(colour(b"0.5"), Ok([0.5; 3]));
        for bad in [b"".as_slice(), b"1 2", b"spectral file.rfl", b"nan 0 0", b"1 1 1e99"] {
            assert!(colour(bad).is_err(), "{bad:?}");
        }
        assert!(number(b"inf").is_err());
    }

    #[test]
    fn what_tobj_would_panic_on_or_refuse_is_named_by_line() {
        let path = Path::new("a.mtl");
        for (line, cause) in [
            ("Kd 0.5 0.5", "a.mtl: line 3: `0.5 0.5` is no colour"),
            ("Ke", "line 3: `` is no colour"),
            ("Ni glass", "line 3: `glass` is no finite number"),
            ("map_Kd", "line 3: `map_Kd` without a file"),
            ("map_Kd \u{b}\u{a0}", "line 3: `map_Kd` without a file"),
            ("newmtl more", "line 3: more than"),
        ] {
            let text = format!("Kd before any material\nnewmtl one\n{line}\n");
            let message = check(path, text.as_bytes(), 1).expect_err(cause).to_string();
            assert!(message.contains(cause), "{message}");
        }
    }

    #[test]
    fn every_form_of_a_statement_reaches_tobj() {
        let text = "newmtl\nKd 0.25\nd -halo 0.125\nillum 7.0\nNi 1e0\nKa 1\nNs\nTr 0.75\nmap_Kd -s 1 1 1 a b.png\r\n";
        let text = check(Path::new("a.mtl"), text.as_bytes(), 9).unwrap_or_else(|e| panic!("{e}"));
        let (materials, by_name) = tobj::load_mtl_buf(&mut text.as_bytes()).unwrap_or_else(|e| panic!("{e}: {text}"));
        let m = &materials[by_name["unnamed"]];
        assert_eq!((m.diffuse, m.dissolve, m.optical_density), (Some([0.25; 3]), Some(0.125), Some(1.0)));
        assert_eq!((m.illumination_model, m.diffuse_texture.as_deref()), (Some(7), Some("-s 1 1 1 a b.png")));
        assert_eq!(m.unknown_param["Tr"], "0.75");
    }
}
