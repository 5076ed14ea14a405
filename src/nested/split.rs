//! Which primitives share a grid: a few large ones are tested first, in no grid, and what is dense and small beside the rest gets
//! a grid of its own.
//!
//! A uniform grid cannot see a teapot in a stadium: all of it lies in one cell. A level of nodes zooms four times, a grid of its
//! own at once. The ground that carries both would bridge them, hence the list of large primitives; without these the box is
//! often much smaller.

use crate::ray::Aabb;
use glam::DVec3;

/// Primitives that belong together, by their place in the list of boxes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Group {
    pub members: Vec<u32>,
    /// True if they are tested without a grid.
    pub loose: bool,
}

/// Splits at most this often below one another.
const DEPTH: u32 = 6;

/// At most so many groups are split off a group at once: every ray is asked whether it meets each of them.
const MOST: usize = 6;

/// Groups of the primitives in `boxes`; every primitive is in one.
pub(super) fn split(boxes: &[Aabb]) -> Vec<Group> {
    let mut groups = Vec::new();
    split_further(boxes, (0..boxes.len() as u32).collect(), DEPTH, &mut groups);
    groups
}

fn split_further(boxes: &[Aabb], members: Vec<u32>, depth: u32, groups: &mut Vec<Group>) {
    if depth == 0 || members.len() < 64 {
        groups.push(Group { members, loose: false });
        return;
    }
    let members = without_large(boxes, members, groups);
    let whole = around(boxes, &members);
    let objects = dense_objects(boxes, &members, &whole);
    if objects.is_empty() {
        groups.push(Group { members, loose: false });
        return;
    }
    let mut apart = vec![false; boxes.len()];
    for object in objects {
        object.iter().for_each(|&i| apart[i as usize] = true);
        split_further(boxes, object, depth - 1, groups);
    }
    let rest: Vec<u32> = members.into_iter().filter(|&i| !apart[i as usize]).collect();
    if !rest.is_empty() {
        split_further(boxes, rest, depth - 1, groups);
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

/// Takes out a pack of primitives that are more than half as long as the box along two axes, if the box gets smaller for it.
fn without_large(boxes: &[Aabb], members: Vec<u32>, groups: &mut Vec<Group>) -> Vec<u32> {
    let whole = around(boxes, &members);
    let size = extent(&whole);
    // Along a flat axis everything is as long as the box.
    let flat = size.cmplt(DVec3::splat(size.max_element() / 1024.0));
    let flat = [flat.x, flat.y, flat.z];
    let needed = 3 - flat.iter().filter(|&&f| f).count();
    let is_large = |i: u32| {
        let e = extent(&boxes[i as usize]);
        let long = (0..3).filter(|&a| !flat[a] && e[a] > 0.5 * size[a]).count();
        long >= needed.min(2)
    };
    let large: Vec<u32> = members.iter().copied().filter(|&i| is_large(i)).take(17).collect();
    if large.is_empty() || large.len() > 16 {
        return members;
    }
    let rest: Vec<u32> = members.iter().copied().filter(|i| large.binary_search(i).is_err()).collect();
    let left = around(boxes, &rest);
    let share = area(&left) / area(&whole);
    let wanted = if members.len() > 4096 { 0.9 } else { 0.6 };
    // Two packs only if there is something small in what remains.
    let pays = share < wanted && (large.len() <= 8 || !dense_objects(boxes, &rest, &left).is_empty());
    if !pays {
        return members;
    }
    groups.push(Group { members: large, loose: true });
    rest
}

/// Cells of the probe along each axis.
const PROBE: usize = 16;

/// What is connected in a coarse grid, small beside it and rich in primitives; nothing if that is not much of it all.
fn dense_objects(boxes: &[Aabb], members: &[u32], whole: &Aabb) -> Vec<Vec<u32>> {
    let size = extent(whole).max(DVec3::splat(extent(whole).max_element() / 1024.0));
    if size.max_element() == 0.0 {
        return Vec::new();
    }
    let per_unit = DVec3::splat(PROBE as f64) / size;
    let place = |p: glam::Vec3| {
        let p = (p.as_dvec3() - whole.min.as_dvec3()) * per_unit;
        [p.x, p.y, p.z].map(|x| (x as usize).min(PROBE - 1))
    };
    let index = |x: usize, y: usize, z: usize| (z * PROBE + y) * PROBE + x;
    let mut object = vec![EMPTY; PROBE * PROBE * PROBE];
    for &i in members {
        let (low, high) = (place(boxes[i as usize].min), place(boxes[i as usize].max));
        for z in low[2]..=high[2] {
            for y in low[1]..=high[1] {
                object[index(low[0], y, z)..=index(high[0], y, z)].fill(FULL);
            }
        }
    }
    let count = number(&mut object);
    let mut found = vec![(0_usize, Aabb::EMPTY); count];
    let of = |i: u32| {
        let [x, y, z] = place(boxes[i as usize].min);
        object[index(x, y, z)] as usize
    };
    for &i in members {
        let (number, all) = &mut found[of(i)];
        (*number, *all) = (*number + 1, all.union(&boxes[i as usize]));
    }
    let mut dense: Vec<usize> =
        (0..count).filter(|&c| found[c].0 * 25 >= members.len() && area(&found[c].1) < 0.2 * area(whole)).collect();
    dense.sort_by_key(|&c| std::cmp::Reverse(found[c].0));
    dense.truncate(MOST);
    let primitives: usize = dense.iter().map(|&c| found[c].0).sum();
    let surface: f64 = dense.iter().map(|&c| area(&found[c].1)).sum();
    if primitives * 4 < members.len() || surface > 0.4 * area(whole) {
        return Vec::new();
    }
    let mut objects = vec![Vec::new(); dense.len()];
    for &i in members {
        if let Some(place) = dense.iter().position(|&c| c == of(i)) {
            objects[place].push(i);
        }
    }
    objects
}

const EMPTY: u32 = u32::MAX;
const FULL: u32 = u32::MAX - 1;

/// Numbers the full cells from 0, alike where they touch one another; how many numbers there are.
fn number(cells: &mut [u32]) -> usize {
    let mut count = 0;
    let mut open = Vec::new();
    for first in 0..cells.len() {
        if cells[first] != FULL {
            continue;
        }
        cells[first] = count;
        open.push(first);
        while let Some(cell) = open.pop() {
            let at = [cell % PROBE, cell / PROBE % PROBE, cell / (PROBE * PROBE)];
            let [x, y, z] = at.map(|i| i.saturating_sub(1)..(i + 2).min(PROBE));
            for z in z {
                for y in y.clone() {
                    for x in x.clone() {
                        let next = (z * PROBE + y) * PROBE + x;
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
    use glam::Vec3;

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
        assert_eq!(split(&boxes), [Group { members: (0..1000).collect(), loose: false }]);
        assert_eq!(split(&[]), [Group { members: vec![], loose: false }]);
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
        let groups = split(&boxes);
        let mut all: Vec<u32> = groups.iter().flat_map(|g| g.members.clone()).collect();
        all.sort_unstable();
        assert_eq!(all, (0..3003).collect::<Vec<_>>(), "each is in one group");
        let sizes: Vec<(usize, bool)> = groups.iter().map(|g| (g.members.len(), g.loose)).collect();
        assert_eq!(sizes, [(2, true), (1000, false), (1000, false), (1000, false), (1, false)]);
    }
}
