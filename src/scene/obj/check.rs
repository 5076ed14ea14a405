//! Checks the lines of an OBJ file and writes them again for `tobj`, so plain that it cannot go wrong.
//!
//! Vertices come first, then the faces of each group and material; so the place of an error is found here, where faces
//! refer to vertices above them. Names of groups and files are replaced by numbers.

use super::faces::{Faces, NONE};
use crate::error::{Error, Result};
use glam::{Vec2, Vec3};
use std::collections::{BTreeMap, HashSet};
use std::path::Path;

/// Most different statements that are counted by name.
const MAX_KEYWORDS: usize = 16;
/// Most bytes of a name of a group or material.
const MAX_NAME: usize = 255;

/// What a file holds, once all its lines are good.
#[derive(Default)]
pub(super) struct Checked {
    /// The statements `v`, `vt` and `vn`.
    vertices: Vec<u8>,
    pub faces: Faces,
    /// What the statements `mtllib` name, each once, with the line.
    pub libraries: Vec<(usize, String)>,
    /// Faces refer to normals or texture coordinates, and there are none so far.
    dangling: bool,
    /// How often each statement that is not read occurs.
    passed_over: BTreeMap<String, usize>,
}

impl Checked {
    /// The text for `tobj`, with the given number of MTL files.
    pub(super) fn text(&self, libraries: usize) -> Vec<u8> {
        let mut text: Vec<u8> = (0..libraries).flat_map(|n| format!("mtllib {n}\n").into_bytes()).collect();
        text.extend_from_slice(&self.vertices);
        self.faces.write(&mut text);
        text
    }

    /// What is left out; `partial` meshes have normals at some corners only.
    pub(super) fn warnings(&self, path: &Path, partial: usize) -> Vec<String> {
        let Faces { too_small, mixed, .. } = self.faces;
        let mut texts = Vec::new();
        if too_small > 0 {
            texts.push(format!("{too_small} faces with fewer than three corners are left out"));
        }
        if self.dangling {
            texts.push("faces refer to normals or texture coordinates where the file has none".into());
        }
        if mixed > 0 {
            texts.push(format!("{mixed} faces have normals or texture coordinates at some corners only: left out"));
        }
        if partial > 0 {
            texts.push(format!("{partial} meshes have normals at some corners only: shaded flat"));
        }
        for (keyword, count) in &self.passed_over {
            texts.push(format!("{count} statements `{}` are passed over", printable(keyword.as_bytes())));
        }
        texts.into_iter().map(|text| format!("{}: {text}", path.display())).collect()
    }
}

/// Checks all lines; coordinates that are not finite pass if `keep_invalid`.
///
/// # Errors
/// As those of [`super::read`], each with its line.
pub(super) fn check(path: &Path, bytes: &[u8], keep_invalid: bool) -> Result<Checked> {
    let out = Checked::default();
    let mut check = Check {
        path,
        keep_invalid,
        line: 0,
        counts: [0; 3],
        corners: Vec::new(),
        plain: true,
        named: HashSet::new(),
        out,
    };
    for line in bytes.split(|&b| b == b'\n') {
        check.line += 1;
        check.statement(line)?;
    }
    Ok(check.out)
}

struct Check<'a> {
    path: &'a Path,
    keep_invalid: bool,
    /// From 1.
    line: usize,
    /// Of positions, texture coordinates and normals so far.
    counts: [usize; 3],
    /// Position, texture coordinate and normal of the corners of the face at hand.
    corners: Vec<[u32; 3]>,
    /// The face at hand can be passed on as it is written.
    plain: bool,
    named: HashSet<String>,
    out: Checked,
}

impl Check<'_> {
    fn fail(&self, cause: impl std::fmt::Display) -> Error {
        Error::malformed(self.path, format!("line {}: {cause}", self.line))
    }

    fn statement(&mut self, line: &[u8]) -> Result<()> {
        let (keyword, rest) = split(line);
        match keyword {
            b"v" => self.vertex(rest)?,
            b"vn" => {
                let (v, n) = self.numbers::<3>(rest)?;
                if n < 3 {
                    return Err(self.fail(format_args!("{n} numbers for a normal, 3 are needed")));
                }
                let normal = Vec3::from_array(v);
                self.finite(2, normal, normal.is_finite())?;
                self.pass(b"vn ", rest, b"");
            }
            b"vt" => {
                let (v, n) = self.numbers::<3>(rest)?;
                if n < 1 {
                    return Err(self.fail("no number for a texture coordinate"));
                }
                let uv = Vec2::new(v[0], v[1]);
                self.finite(1, uv, uv.is_finite())?;
                // The second number may be left out, which `tobj` does not know.
                self.pass(b"vt ", rest, if n == 1 { b" 0" } else { b"" });
            }
            b"f" => self.face(rest)?,
            b"o" | b"g" | b"usemtl" if rest.len() > MAX_NAME => {
                return Err(self.fail(format_args!("a name of {} bytes, at most {MAX_NAME} are read", rest.len())));
            }
            b"o" | b"g" => self.out.faces.set_group(&String::from_utf8_lossy(rest)),
            b"usemtl" => self.out.faces.set_material(&name(rest), self.line),
            b"mtllib" => {
                let names = String::from_utf8_lossy(rest).into_owned();
                if self.named.insert(names.clone()) {
                    self.out.libraries.push((self.line, names));
                }
            }
            b"" | b"s" => {}
            _ if keyword.starts_with(b"#") => {}
            _ => {
                // A name of a few letters; binary rubbish is not worth keeping.
                let name = String::from_utf8_lossy(&keyword[..keyword.len().min(16)]).into_owned();
                let passed_over = &mut self.out.passed_over;
                if passed_over.len() < MAX_KEYWORDS || passed_over.contains_key(&name) {
                    *passed_over.entry(name).or_default() += 1;
                }
            }
        }
        Ok(())
    }

    fn vertex(&mut self, rest: &[u8]) -> Result<()> {
        let (v, n) = self.numbers::<6>(rest)?;
        if n < 3 || n == 5 {
            return Err(self.fail(format_args!("{n} numbers for a vertex; 3, 4 or 6 are read")));
        }
        let position = Vec3::new(v[0], v[1], v[2]) / if n == 4 { v[3] } else { 1.0 };
        self.finite(0, position, position.is_finite())?;
        match n {
            // `tobj` refuses to divide by 0; such a vertex is there only to be dropped.
            4 if v[3] == 0.0 => self.pass(b"v ", b"nan nan nan", b""),
            6 => {
                let xyz: Vec<&[u8]> = words(rest).take(3).collect();
                self.pass(b"v ", &xyz.join(&b' '), b"");
            }
            _ => self.pass(b"v ", rest, b""),
        }
        Ok(())
    }

    fn pass(&mut self, keyword: &[u8], rest: &[u8], end: &[u8]) {
        for text in [keyword, rest, end, b"\n"] {
            self.out.vertices.extend_from_slice(text);
        }
    }

    /// Up to `N` numbers, and how many there were; missing ones are 0, more are an error.
    fn numbers<const N: usize>(&self, text: &[u8]) -> Result<([f32; N], usize)> {
        let mut numbers = [0.0; N];
        let mut count = 0;
        for word in words(text) {
            let number = parse(word).ok_or_else(|| self.fail(format_args!("`{}` is no number", printable(word))))?;
            let place = numbers.get_mut(count).ok_or_else(|| self.fail(format_args!("more than {N} numbers")))?;
            *place = number;
            count += 1;
        }
        Ok((numbers, count))
    }

    /// Counts a position (`kind` 0), texture coordinate (1) or normal (2).
    fn finite<T: std::fmt::Display>(&mut self, kind: usize, value: T, is_finite: bool) -> Result<()> {
        self.counts[kind] += 1;
        if is_finite || self.keep_invalid {
            return Ok(());
        }
        Err(self.fail(format_args!("{} {}: {value} is not finite", KINDS[kind], self.counts[kind])))
    }

    fn face(&mut self, text: &[u8]) -> Result<()> {
        let mut corners = std::mem::take(&mut self.corners);
        corners.clear();
        self.plain = true;
        for word in words(text) {
            corners.push(self.corner(word)?);
        }
        self.out.faces.add(&corners, self.plain.then_some(text));
        self.corners = corners;
        Ok(())
    }

    /// Position, texture coordinate and normal of a corner such as `3/1/2`, `3//2`, `3/1` or `-1`.
    fn corner(&mut self, word: &[u8]) -> Result<[u32; 3]> {
        let mut corner = [NONE; 3];
        for (k, text) in word.split(|&b| b == b'/').enumerate() {
            let (Some(&count), Some(kind)) = (self.counts.get(k), KINDS.get(k)) else {
                return Err(self.fail(format_args!("corner `{}` has more than three indices", printable(word))));
            };
            // Some writers refer to normals and texture coordinates that they leave out altogether.
            if k > 0 && (text.is_empty() || count == 0) {
                self.out.dangling |= !text.is_empty();
                self.plain &= text.is_empty();
                continue;
            }
            let Some(index) = parse::<i64>(text) else {
                return Err(self.fail(format_args!("corner `{}` is not made of indices", printable(word))));
            };
            // From 1; negative ones count back from the last so far.
            let from_zero = if index < 0 { index.checked_add(count as i64) } else { index.checked_sub(1) };
            let good = from_zero.and_then(|i| u32::try_from(i).ok()).filter(|&i| (i as usize) < count);
            let Some(i) = good else {
                return Err(self.fail(format_args!("face refers to {kind} {index} of {count}")));
            };
            self.plain &= index > 0;
            corner[k] = i;
        }
        Ok(corner)
    }
}

const KINDS: [&str; 3] = ["vertex", "texture coordinate", "normal"];

/// The keyword of a line, and the rest.
pub(super) fn split(line: &[u8]) -> (&[u8], &[u8]) {
    let line = line.trim_ascii();
    let end = line.iter().position(u8::is_ascii_whitespace).unwrap_or(line.len());
    (&line[..end], line[end..].trim_ascii())
}

/// The name of a material; `tobj` refuses those without one.
pub(super) fn name(text: &[u8]) -> String {
    let text = String::from_utf8_lossy(text);
    let name = text.trim();
    if name.is_empty() { "unnamed".into() } else { name.into() }
}

pub(super) fn words(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    text.split(u8::is_ascii_whitespace).filter(|w| !w.is_empty())
}

pub(super) fn parse<T: std::str::FromStr>(word: &[u8]) -> Option<T> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// For messages: short, and without control characters.
pub(super) fn printable(word: &[u8]) -> String {
    let text = String::from_utf8_lossy(&word[..word.len().min(40)]).into_owned();
    text.chars().map(|c| if c.is_control() { '?' } else { c }).collect()
}
