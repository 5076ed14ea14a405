//! Trees of boxes: what the builder makes of a leaf with more than one pack.
//!
//! Top down: the list of a group is split in two where the surfaces of both halves, times the packs that they need, are least, and
//! so on the largest of the parts, until there are eight. A part of eight primitives or fewer is a pack, any other one a group.

use super::boxes::Boxes;
use crate::geometry::NO_PRIM;
use glam::Vec3A;

/// Groups above one another at most.
pub(super) const LEVELS: u32 = 5;

/// A primitive of a leaf: the box around what it has in the cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Member {
    low: Vec3A,
    high: Vec3A,
    prim: u32,
}

impl Member {
    /// One with the box from `low` to `high`.
    pub fn new(prim: u32, low: Vec3A, high: Vec3A) -> Self {
        Self { low, high, prim }
    }
}

/// Some that follow one another, and the box around them.
#[derive(Clone, Copy)]
struct Run {
    begin: usize,
    end: usize,
    low: Vec3A,
    high: Vec3A,
}

impl Run {
    fn around(members: &[Member], begin: usize) -> Self {
        let (mut low, mut high) = (Vec3A::INFINITY, Vec3A::NEG_INFINITY);
        for member in members {
            (low, high) = (low.min(member.low), high.max(member.high));
        }
        Self { begin, end: begin + members.len(), low, high }
    }

    fn len(&self) -> usize {
        self.end - self.begin
    }
}

/// Half the surface of a box.
fn surface(low: Vec3A, high: Vec3A) -> f32 {
    let edges = high - low;
    edges.dot(Vec3A::new(edges.y, edges.z, edges.x))
}

/// What a tree is put into.
pub(super) struct Grower<'a> {
    pub boxes: &'a mut Vec<Boxes>,
    /// Eight for each pack.
    pub lanes: &'a mut Vec<u32>,
    /// Lists of at most so many are split in halves.
    pub halved: usize,
}

impl Grower<'_> {
    /// Puts trees over all members behind what is there; the first of the groups at their roots, and how many there are.
    pub fn plant(&mut self, members: &mut [Member]) -> [u32; 2] {
        const MOST: usize = 8 << (3 * LEVELS);
        let first = self.boxes.len();
        let roots = members.len().div_ceil(MOST);
        self.boxes.resize(first + roots, Boxes::NONE);
        for (i, members) in members.chunks_mut(MOST).enumerate() {
            let all = Run::around(members, 0);
            self.group(first + i, members, all, LEVELS - 1);
        }
        [first as u32, roots as u32]
    }

    /// Makes the group `index` of a run, with as many levels below.
    fn group(&mut self, index: usize, members: &mut [Member], all: Run, below: u32) {
        let most = 8_usize << (3 * below);
        let mut runs = [all; 8];
        let mut count = 1;
        while count < 8 {
            // The largest of those that may be split.
            let mut largest = None;
            for (i, run) in runs[..count].iter().enumerate() {
                let size = if run.len() > most { f32::INFINITY } else { surface(run.low, run.high) };
                if run.len() > 8 && largest.is_none_or(|(_, most)| size > most) {
                    largest = Some((i, size));
                }
            }
            let Some((i, _)) = largest else { break };
            let run = runs[i];
            let some = &mut members[run.begin..run.end];
            let halves = if run.len() > most || run.len() <= self.halved { None } else { split(some, &run) };
            [runs[i], runs[count]] = halves.unwrap_or_else(|| halve(some, &run));
            count += 1;
        }
        // Groups first.
        runs[..count].sort_by_key(|run| run.len() <= 8);
        let inner = runs[..count].iter().filter(|run| run.len() > 8).count();
        let mut boxes = Boxes {
            first: ((self.lanes.len() / 8) as u32).wrapping_sub(inner as u32),
            below: self.boxes.len() as u32,
            inner: inner as u32,
            ..Boxes::NONE
        };
        for (lane, run) in runs[..count].iter().enumerate() {
            boxes.set(lane, &[run.low.to_array(), run.high.to_array()]);
        }
        self.boxes[index] = boxes;
        for run in &runs[inner..count] {
            self.lanes.extend(members[run.begin..run.end].iter().map(|member| member.prim));
            self.lanes.resize(self.lanes.len().next_multiple_of(8), NO_PRIM);
        }
        let first = self.boxes.len();
        self.boxes.resize(first + inner, Boxes::NONE);
        for (i, run) in runs[..inner].iter().enumerate() {
            self.group(first + i, members, *run, below - 1);
        }
    }
}

const BINS: usize = 16;

#[derive(Clone, Copy)]
struct Bin {
    low: Vec3A,
    high: Vec3A,
    count: u32,
}

impl Bin {
    const EMPTY: Bin = Bin { low: Vec3A::INFINITY, high: Vec3A::NEG_INFINITY, count: 0 };

    #[inline(always)]
    fn join(&mut self, other: &Bin) {
        self.low = self.low.min(other.low);
        self.high = self.high.max(other.high);
        self.count += other.count;
    }

    /// What testing it costs.
    #[inline(always)]
    fn cost(&self) -> f32 {
        surface(self.low, self.high) * self.count.div_ceil(8) as f32
    }
}

/// Twice the middle of a member.
#[inline(always)]
fn middle(member: &Member) -> Vec3A {
    member.low + member.high
}

/// Bins for each axis: those of members are whole numbers in the last bits.
struct Binning {
    low: Vec3A,
    scale: Vec3A,
}

impl Binning {
    #[inline(always)]
    fn places(&self, member: &Member) -> [usize; 3] {
        // The last place is 1.
        let shifted = (middle(member) - self.low) * self.scale + 8_388_608.0;
        shifted.to_array().map(|x| x.to_bits() as usize & (BINS - 1))
    }
}

/// Splits a run where that is best, if it can be told where.
fn split(some: &mut [Member], run: &Run) -> Option<[Run; 2]> {
    let (mut low, mut high) = (Vec3A::INFINITY, Vec3A::NEG_INFINITY);
    for member in &*some {
        (low, high) = (low.min(middle(member)), high.max(middle(member)));
    }
    let count = if some.len() <= 64 { 8 } else { BINS };
    // Rounded to the nearest: from 0 to one less than there are.
    let binning = Binning { low, scale: ((count - 1) as f32 + 0.49) / (high - low).max(Vec3A::splat(1e-30)) };
    let mut bins = [[Bin::EMPTY; BINS]; 3];
    for member in &*some {
        let [x, y, z] = binning.places(member);
        let one = Bin { low: member.low, high: member.high, count: 1 };
        bins[0][x].join(&one);
        bins[1][y].join(&one);
        bins[2][z].join(&one);
    }
    let mut best = (f32::INFINITY, 0, 0);
    for (axis, bins) in bins.iter().enumerate() {
        let mut costs = [0.0; BINS];
        let mut all = Bin::EMPTY;
        for i in (1..count).rev() {
            all.join(&bins[i]);
            costs[i] = all.cost();
        }
        let mut all = Bin::EMPTY;
        for i in 1..count {
            all.join(&bins[i - 1]);
            let cost = costs[i] + all.cost();
            // A NaN or minus infinity where one side is empty.
            if cost < best.0 && cost >= 0.0 && all.count > 0 && (all.count as usize) < some.len() {
                best = (cost, axis, i);
            }
        }
    }
    let (cost, axis, border) = best;
    if cost == f32::INFINITY {
        return None;
    }
    let mut sides = [Bin::EMPTY; 2];
    for (i, bin) in bins[axis].iter().enumerate() {
        sides[usize::from(i >= border)].join(bin);
    }
    let (mut begin, mut end) = (0, some.len());
    while begin < end {
        if binning.places(&some[begin])[axis] < border {
            begin += 1;
        } else {
            end -= 1;
            some.swap(begin, end);
        }
    }
    let (begin, end) = ([run.begin, run.begin + begin], [run.begin + begin, run.end]);
    Some([0, 1].map(|i| Run { begin: begin[i], end: end[i], low: sides[i].low, high: sides[i].high }))
}

/// Splits a run in halves, in whole packs.
fn halve(some: &mut [Member], run: &Run) -> [Run; 2] {
    let edges = run.high - run.low;
    let axis = if edges.x >= edges.y && edges.x >= edges.z { 0 } else { 1 + usize::from(edges.z > edges.y) };
    let half = some.len().div_ceil(2).next_multiple_of(8);
    let half = if half < some.len() { half } else { 8 };
    some.select_nth_unstable_by(half, |a, b| middle(a)[axis].total_cmp(&middle(b)[axis]));
    let (before, behind) = some.split_at(half);
    [Run::around(before, run.begin), Run::around(behind, run.begin + half)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::tests::Random;
    use std::ops::Range;

    /// The members below a group, all of which must lie in their boxes; and the levels.
    fn visit(boxes: &[Boxes], lanes: &[u32], index: u32, members: &[Member], found: &mut Vec<u32>) -> u32 {
        let group = &boxes[index as usize];
        let mut levels = 1;
        for lane in 0..8 {
            let corner = |side: usize| Vec3A::from([0, 1, 2].map(|a| group.planes[side][a].0[lane as usize]));
            let (low, high) = (corner(0), corner(1));
            if !low.cmple(high).all() {
                assert!(lane >= group.inner, "groups have boxes");
                continue;
            }
            let begin = found.len();
            if lane < group.inner {
                levels = levels.max(1 + visit(boxes, lanes, group.below + lane, members, found));
            } else {
                let pack = 8 * group.first.wrapping_add(lane) as usize;
                found.extend(lanes[pack..pack + 8].iter().filter(|&&prim| prim != NO_PRIM));
            }
            assert!(found.len() > begin, "boxes hold something");
            for &prim in &found[begin..] {
                let member = &members[prim as usize];
                assert!(low.cmple(member.low).all() && high.cmpge(member.high).all(), "{member:?}");
            }
        }
        levels
    }

    fn random(count: usize, size: Range<f32>) -> Vec<Member> {
        let mut random = Random::new(count as u64);
        let member = |prim| {
            let low = Vec3A::from(random.in_cube());
            Member::new(prim as u32, low, low + size.start + Vec3A::from(random.in_cube()).abs() * size.end)
        };
        (0..count).map(member).collect()
    }

    #[test]
    fn all_members_are_there_once_and_in_their_boxes() {
        for halved in [usize::MAX, 16, 8] {
            for count in [9, 16, 17, 64, 65, 513, 5000, 300_000] {
                let mut copies = random(count, 0.0..0.0);
                copies.iter_mut().for_each(|member| (member.low, member.high) = (Vec3A::ONE, Vec3A::ONE));
                let far = |member: &mut Member| {
                    let away = 2.0_f32.powi((member.prim % 60) as i32);
                    (member.low, member.high) = (member.low * away, member.low * away);
                };
                let mut spread = random(count, 0.0..0.0);
                spread.iter_mut().for_each(far);
                for members in [random(count, 0.0..0.01), random(count, 0.5..1.0), copies, spread] {
                    let (mut boxes, mut lanes) = (Vec::new(), Vec::new());
                    let mut order = members.clone();
                    let [first, roots] = Grower { boxes: &mut boxes, lanes: &mut lanes, halved }.plant(&mut order);
                    let mut found = Vec::new();
                    for root in first..first + roots {
                        let levels = visit(&boxes, &lanes, root, &members, &mut found);
                        assert!(levels <= LEVELS, "{levels} levels over {count}");
                    }
                    found.sort_unstable();
                    assert!(found.iter().copied().eq(0..count as u32), "{count} members");
                    assert!(lanes.len() < 4 * count + 64, "{} lanes for {count}", lanes.len());
                }
            }
        }
    }

    #[test]
    fn splits_separate_what_is_apart() {
        // Two clouds of unequal size, shuffled.
        let mut members = random(300, 0.0..0.01);
        for member in &mut members {
            let aside = Vec3A::X * if member.prim % 5 == 0 { 100.0 } else { 0.0 };
            (member.low, member.high) = (member.low + aside, member.high + aside);
        }
        let all = Run::around(&members, 0);
        let [near, far] = split(&mut members, &all).expect("a split");
        assert_eq!([near.len(), far.len()], [240, 60]);
        assert!(near.high.x < 2.0 && far.low.x > 98.0);
    }
}
