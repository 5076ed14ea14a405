//! Sorts faces by group, material and kind of corner, so that `tobj` makes one model of each.

use std::collections::HashMap;

/// An index that a corner does not have.
pub(super) const NONE: u32 = u32::MAX;

/// All faces so far.
#[derive(Default)]
pub(super) struct Faces {
    /// Faces with fewer than three corners.
    pub too_small: usize,
    /// Faces with normals or texture coordinates at some corners only.
    pub mixed: usize,
    /// Of all faces that are kept.
    pub corners: u64,
    /// Names, each with the line of its first use.
    pub materials: Vec<(String, usize)>,
    /// In the order of their first faces.
    pub sets: Vec<Set>,
    groups: Vec<String>,
    group_numbers: HashMap<String, usize>,
    material_numbers: HashMap<String, usize>,
    numbers: HashMap<Key, usize>,
    at_hand: Option<Key>,
    current: usize,
    group: Option<usize>,
    material: Option<usize>,
}

/// Faces that are of a kind.
pub(super) struct Set {
    pub key: Key,
    text: Vec<u8>,
}

/// What faces have in common.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct Key {
    /// A number; none before the first group.
    pub group: Option<usize>,
    /// A number; none before the first material.
    material: Option<usize>,
    pub has_uvs: bool,
    pub has_normals: bool,
}

impl Faces {
    pub(super) fn set_group(&mut self, name: &str) {
        self.group = (!name.is_empty()).then(|| match self.group_numbers.get(name) {
            Some(&known) => known,
            None => {
                self.groups.push(name.to_owned());
                self.group_numbers.insert(name.to_owned(), self.groups.len() - 1);
                self.groups.len() - 1
            }
        });
    }

    pub(super) fn set_material(&mut self, name: &str, line: usize) {
        self.material = Some(match self.material_numbers.get(name) {
            Some(&known) => known,
            None => {
                self.materials.push((name.to_owned(), line));
                self.material_numbers.insert(name.to_owned(), self.materials.len() - 1);
                self.materials.len() - 1
            }
        });
    }

    /// Adds a face whose indices are from 0 and in range; `written` is its text if that can be kept.
    pub(super) fn add(&mut self, corners: &[[u32; 3]], written: Option<&[u8]>) {
        if corners.len() < 3 {
            self.too_small += 1;
            return;
        }
        self.corners += corners.len() as u64;
        let count = |k: usize| corners.iter().filter(|c| c[k] != NONE).count();
        let (uvs, normals) = (count(1), count(2));
        let (has_uvs, has_normals) = (uvs == corners.len(), normals == corners.len());
        let is_mixed = (uvs > 0 && !has_uvs) || (normals > 0 && !has_normals);
        self.mixed += usize::from(is_mixed);
        let text = self.set(Key { group: self.group, material: self.material, has_uvs, has_normals });
        text.extend_from_slice(b"f");
        if let Some(written) = written.filter(|_| !is_mixed) {
            text.push(b' ');
            text.extend_from_slice(written);
        } else {
            for corner in corners {
                let [v, vt, vn] = corner.map(|i| u64::from(i) + 1);
                let corner = match (has_uvs, has_normals) {
                    (true, true) => format!(" {v}/{vt}/{vn}"),
                    (true, false) => format!(" {v}/{vt}"),
                    (false, true) => format!(" {v}//{vn}"),
                    (false, false) => format!(" {v}"),
                };
                text.extend(corner.bytes());
            }
        }
        text.push(b'\n');
    }

    fn set(&mut self, key: Key) -> &mut Vec<u8> {
        if self.at_hand != Some(key) {
            self.at_hand = Some(key);
            self.current = *self.numbers.entry(key).or_insert(self.sets.len());
            if self.current == self.sets.len() {
                self.sets.push(Set { key, text: Vec::new() });
            }
        }
        &mut self.sets[self.current].text
    }

    /// Appends the faces; group names are replaced by the numbers of the sets.
    pub(super) fn write(&self, text: &mut Vec<u8>) {
        for (n, set) in self.sets.iter().enumerate() {
            text.extend(format!("g {n}\n").bytes());
            if let Some((name, _)) = set.key.material.and_then(|m| self.materials.get(m)) {
                text.extend(format!("usemtl {name}\n").bytes());
            }
            text.extend_from_slice(&set.text);
        }
    }

    pub(super) fn group_name(&self, group: Option<usize>) -> Option<&str> {
        group.and_then(|g| self.groups.get(g)).map(String::as_str)
    }
}
