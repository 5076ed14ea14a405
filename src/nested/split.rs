//! Which primitives share a grid: a few large ones are tested first, in no grid, and what is dense and small beside the rest gets
//! a grid of its own.
//!
//! A uniform grid cannot see a teapot in a stadium: all of it lies in one cell. A level of nodes zooms four times, a grid of its
//! own at once. The ground that carries both would bridge them, hence the list of large primitives; without these the box is
//! often much smaller.

use crate::ray::Aabb;
use glam::{DVec3, Vec3};
use std::borrow::Cow;

/// Primitives that belong together.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Group<'a> {
    /// Indices of boxes, ascending.
    pub members: Cow<'a, [u32]>,
    /// The box around them.
    pub bounds: Aabb,
    /// True if they are tested without a grid.
    pub loose: bool,
}

/// Splits at most this often below one another.
const DEPTH: u32 = 6;

/// At most so many groups are split off a group at once: every ray is asked whether it meets each of them.
const MOST: usize = 6;

/// Groups of the primitives `members`; every one is in one. Boxes are by index.
pub(super) fn split<'a>(boxes: &[Aabb], members: &'a [u32]) -> Vec<Group<'a>> {
    let mut groups = Vec::new();
    split_further(boxes, Cow::Borrowed(members), DEPTH, &mut groups);
    groups
}

fn split_further<'a>(boxes: &[Aabb], members: Cow<'a, [u32]>, depth: u32, groups: &mut Vec<Group<'a>>) {
    let bounds = around(boxes, &members);
    if depth == 0 || members.len() < 64 {
        groups.push(Group { members, bounds, loose: false });
        return;
    }
    let (members, bounds) = without_large(boxes, members, bounds, groups);
    let mut objects = dense_objects(boxes, &members, &bounds, &Probe::WHOLE);
    if objects.is_empty() {
        objects = dense_objects(boxes, &members, &bounds, &Probe::UNBRIDGED);
    }
    if objects.is_empty() {
        groups.push(Group { members, bounds, loose: false });
        return;
    }
    let mut apart = vec![false; boxes.len()];
    for object in objects {
        object.iter().for_each(|&i| apart[i as usize] = true);
        split_further(boxes, Cow::Owned(object), depth - 1, groups);
    }
    let rest: Vec<u32> = members.iter().copied().filter(|&i| !apart[i as usize]).collect();
    if !rest.is_empty() {
        split_further(boxes, Cow::Owned(rest), depth - 1, groups);
    }
}

fn around(boxes: &[Aabb], members: &[u32]) -> Aabb {
    members.iter().fold(Aabb::EMPTY, |all, &i| all.union(&boxes[i as usize]))
}

fn extent(aabb: &Aabb) -> DVec3 {
    if aabb.is_empty() { DVec3::ZERO } else { aabb.max.as_dvec3() - aabb.min.as_dvec3() }
}

/// Half the surface of a box.
fn area(aabb: &Aabb) -> f64 {
    let e = extent(aabb);
    e.x * e.y + e.y * e.z + e.z * e.x
}

/// Takes out a pack of primitives that are more than half as long as the box along two axes, if the box gets smaller for it; what
/// remains and its box.
fn without_large<'a>(
    boxes: &[Aabb],
    members: Cow<'a, [u32]>,
    whole: Aabb,
    groups: &mut Vec<Group<'a>>,
) -> (Cow<'a, [u32]>, Aabb) {
    let size = extent(&whole);
    // Along a flat axis everything is as long as the box.
    let flat = size.cmplt(DVec3::splat(size.max_element() / 1024.0));
    let needed = (3 - flat.bitmask().count_ones()).min(2);
    let half = (0.5 * size).as_vec3();
    let is_large = |&i: &u32| {
        let Aabb { min, max } = boxes[i as usize];
        ((max - min).cmpgt(half).bitmask() & !flat.bitmask()).count_ones() >= needed
    };
    let large: Vec<u32> = members.iter().copied().filter(is_large).take(17).collect();
    if large.is_empty() || large.len() > 16 {
        return (members, whole);
    }
    let rest: Vec<u32> = members.iter().copied().filter(|i| large.binary_search(i).is_err()).collect();
    let left = around(boxes, &rest);
    let share = area(&left) / area(&whole);
    let wanted = if members.len() > 4096 { 0.9 } else { 0.6 };
    // Two packs only if there is something small in what remains.
    let pays = share < wanted && (large.len() <= 8 || !dense_objects(boxes, &rest, &left, &Probe::WHOLE).is_empty());
    if !pays {
        return (members, whole);
    }
    let bounds = around(boxes, &large);
    groups.push(Group { members: Cow::Owned(large), bounds, loose: true });
    (Cow::Owned(rest), left)
}

/// How objects are looked for.
struct Probe {
    /// Cells along each axis.
    cells: usize,
    /// True if primitives longer than a cell belong to no object and connect none.
    unbridged: bool,
    /// An object's surface is less than this, in parts of that of all.
    object: f64,
    /// And that of all objects together.
    together: f64,
}

impl Probe {
    /// Objects with space around them.
    const WHOLE: Probe = Probe { cells: 16, unbridged: false, object: 0.2, together: 0.4 };

    /// Objects on a floor of many pieces, which reach from one to the next: only such as are tiny beside the whole.
    const UNBRIDGED: Probe = Probe { cells: 32, unbridged: true, object: 1.0 / 256.0, together: 1.0 / 64.0 };
}

/// So many primitives are enough to see what is connected, and how all of them lie.
pub(super) const ENOUGH: usize = 1 << 15;

/// What is connected in a coarse grid, small beside it and rich in primitives; nothing if that is not much of it all.
///
/// Of many primitives only some are looked at, at equal distances in the list. Then a primitive may begin where none was seen: it
/// stays with the rest.
fn dense_objects(boxes: &[Aabb], members: &[u32], whole: &Aabb, probe: &Probe) -> Vec<Vec<u32>> {
    let size = extent(whole).max(DVec3::splat(extent(whole).max_element() / 1024.0));
    if size.max_element() == 0.0 {
        return Vec::new();
    }
    let n = probe.cells;
    let (begin, per_unit) = (whole.min.as_dvec3(), DVec3::splat(n as f64) / size);
    let longest = (size / n as f64).as_vec3();
    let counts = |aabb: &Aabb| !probe.unbridged || (aabb.max - aabb.min).cmple(longest).all();
    let place = |p: Vec3| {
        let p = (p.as_dvec3() - begin) * per_unit;
        [p.x, p.y, p.z].map(|x| (x as u32 as usize).min(n - 1))
    };
    let index = |x: usize, y: usize, z: usize| (z * n + y) * n + x;
    let mut object = vec![EMPTY; n * n * n];
    // How many primitives begin in each cell, and the box around them.
    let mut begun = vec![(0_usize, Aabb::EMPTY); n * n * n];
    let stride = (members.len() / ENOUGH).max(1);
    for &i in members.iter().step_by(stride) {
        let aabb = &boxes[i as usize];
        if !counts(aabb) {
            continue;
        }
        let (low, high) = (place(aabb.min), place(aabb.max));
        let (number, all) = &mut begun[index(low[0], low[1], low[2])];
        (*number, *all) = (*number + 1, all.union(aabb));
        for z in low[2]..=high[2] {
            for y in low[1]..=high[1] {
                object[index(low[0], y, z)..=index(high[0], y, z)].fill(FULL);
            }
        }
    }
    let seen = members.len().div_ceil(stride);
    let count = number(&mut object, n);
    let mut found = vec![(0_usize, Aabb::EMPTY); count];
    for (&object, (number, all)) in object.iter().zip(&begun).filter(|(_, begun)| begun.0 > 0) {
        let found = &mut found[object as usize];
        *found = (found.0 + number, found.1.union(all));
    }
    let mut dense: Vec<usize> =
        (0..count).filter(|&c| found[c].0 * 25 >= seen && area(&found[c].1) < probe.object * area(whole)).collect();
    dense.sort_by_key(|&c| std::cmp::Reverse(found[c].0));
    dense.truncate(MOST);
    let primitives: usize = dense.iter().map(|&c| found[c].0).sum();
    let surface: f64 = dense.iter().map(|&c| area(&found[c].1)).sum();
    if primitives * 4 < seen || surface > probe.together * area(whole) {
        return Vec::new();
    }
    let mut objects = vec![Vec::new(); dense.len()];
    for &i in members.iter().filter(|&&i| counts(&boxes[i as usize])) {
        let [x, y, z] = place(boxes[i as usize].min);
        let of = object[index(x, y, z)] as usize;
        if let Some(place) = dense.iter().position(|&c| c == of) {
            objects[place].push(i);
        }
    }
    objects
}

const EMPTY: u32 = u32::MAX;
const FULL: u32 = u32::MAX - 1;

/// Numbers the full cells from 0, alike where they touch one another; how many numbers there are.
fn number(cells: &mut [u32], n: usize) -> usize {
    let mut count = 0;
    let mut open = Vec::new();
    for first in 0..cells.len() {
        if cells[first] != FULL {
            continue;
        }
        cells[first] = count;
        open.push(first);
        while let Some(cell) = open.pop() {
            let at = [cell % n, cell / n % n, cell / (n * n)];
            let [x, y, z] = at.map(|i| i.saturating_sub(1)..(i + 2).min(n));
            for z in z {
                for y in y.clone() {
                    for x in x.clone() {
                        let next = (z * n + y) * n + x;
                        if cells[next] == FULL {
                            cells[next] = count;
                            open.push(next);
                        }
                    }
                }
            }
        }
        count += 1;
    }
    count as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sizes of the groups of all boxes, and which are loose.
    fn groups(boxes: &[Aabb]) -> Vec<(usize, bool)> {
        let all: Vec<u32> = (0..boxes.len() as u32).collect();
        let groups = split(boxes, &all);
        let mut together: Vec<u32> = groups.iter().flat_map(|group| group.members.to_vec()).collect();
        together.sort_unstable();
        assert_eq!(together, all, "each is in one group");
        for group in &groups {
            assert!(group.members.is_sorted());
            assert_eq!(group.bounds, around(boxes, &group.members));
        }
        groups.iter().map(|group| (group.members.len(), group.loose)).collect()
    }

    /// `n^3` small boxes in a cube.
    fn lattice(n: usize, centre: Vec3, size: f32) -> Vec<Aabb> {
        let step = size / n as f32;
        (0..n * n * n)
            .map(|i| {
                let at = Vec3::new((i % n) as f32, (i / n % n) as f32, (i / n / n) as f32);
                let min = centre + at * step - size / 2.0;
                Aabb { min, max: min + step }
            })
            .collect()
    }

    #[test]
    fn one_object_stays_whole() {
        let boxes = lattice(10, Vec3::ZERO, 1.0);
        assert_eq!(groups(&boxes), [(1000, false)]);
        assert_eq!(groups(&[]), [(0, false)]);
    }

    #[test]
    fn objects_on_a_large_ground_get_grids_of_their_own() {
        let mut boxes = lattice(10, Vec3::ZERO, 1.0);
        boxes.extend(lattice(10, Vec3::new(500.0, 0.5, 100.0), 1.0));
        boxes.extend(lattice(10, Vec3::new(-300.0, 0.5, 700.0), 1.0));
        let ground = Aabb { min: Vec3::new(-1e3, -0.6, -1e3), max: Vec3::new(1e3, -0.5, 1e3) };
        boxes.extend([ground, ground]);
        let far = Aabb { min: Vec3::splat(900.0), max: Vec3::splat(901.0) };
        boxes.push(far);
        let sizes = groups(&boxes);
        assert_eq!(sizes, [(2, true), (1000, false), (1000, false), (1000, false), (1, false)]);
    }

    #[test]
    fn a_floor_of_many_pieces_bridges_nothing() {
        let mut boxes = lattice(10, Vec3::ZERO, 1.0);
        // A field of 96 slices that meet under the object, and blocks around it that they reach.
        let at = |i: usize, radius: f32| {
            let (sin, cos) = (std::f32::consts::TAU * i as f32 / 96.0).sin_cos();
            Vec3::new(radius * cos, -1.0, radius * sin)
        };
        let slice = |i| [Vec3::NEG_Y, at(i, 400.0), at(i + 1, 400.0)].map(|p| Aabb { min: p, max: p });
        boxes.extend((0..96).map(|i| slice(i).iter().fold(Aabb::EMPTY, |all, p| all.union(p))));
        for tier in 0..10 {
            let min = |i| at(i, 400.0 + 160.0 * tier as f32) + 90.0 * tier as f32 * Vec3::Y;
            boxes.extend((0..96).map(|i| Aabb { min: min(i), max: min(i) + 90.0 }));
        }
        assert_eq!(groups(&boxes), [(1000, false), (96 + 960, false)]);
    }
}
