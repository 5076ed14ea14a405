//! A ray at a leaf: trees of boxes, packs, and what survives of a pack, until the winner is known.

use super::{GROUPS, Group, Next, Trace};
use crate::accel::Probe;
use crate::nested::crowd::{self, Aside, Beaten, Crowd, Met};
use crate::nested::exact::Known;
use crate::nested::lanes::{Lanes, Row};
use crate::nested::pack::{Pack, Seen, Verdict};
use crate::nested::shape::{Part, Slot};
use crate::ray::lesser;

/// More than the rounding of a parameter to f32, relative to it.
const EASE: f64 = 1.0 / (1 << 23) as f64;

/// Parameters known to f64 are known within this, relative to them.
const CLOSE: f64 = 1.0 / (1 << 30) as f64;

impl<'a, S: Lanes, K: Pack, P: Probe, const EXACT: bool> Trace<'a, S, K, P, EXACT> {
    /// The packs of a cell that the ray leaves at `far`: one, or those that the ray meets of trees, packs before groups and
    /// nearer groups before others.
    #[inline(always)]
    pub(super) fn test(&mut self, slot: Slot, far: f32) -> Next {
        if slot.groups() == 0 {
            return Next::Cell;
        }
        let part: &'a Part<K> = self.part;
        let (boxed, last) = (slot.is_boxed(), slot.first + (slot.groups() - 1));
        let (mut root, mut index, mut waiting) = (slot.first, slot.first, 0_usize);
        'groups: loop {
            let (first, below, inner, enters, mut met) = if boxed {
                self.probe.step();
                let boxes = &part.boxes[index as usize];
                let (enters, met) = boxes.look(&self.boxes, self.limit);
                (boxes.first, boxes.below, (1_u32 << (boxes.inner & 15)) - 1, enters, met)
            } else {
                (slot.first, 0, 0, S::splat(0.0), 1)
            };
            let mut packs = met & !inner;
            while packs != 0 {
                let pack = &part.packs[first.wrapping_add(packs.trailing_zeros()) as usize];
                packs &= packs - 1;
                self.probe.leaf();
                if self.crowd.thick && self.aside(pack) {
                    continue;
                }
                let (ray, end) = (&self.ray, S::splat(self.limit));
                let seen = if EXACT { pack.look::<S>(ray, end) } else { pack.look_rounded::<S>(ray, end) };
                if seen.survivors != 0 {
                    if self.meet(pack, seen) {
                        return Next::Nothing;
                    }
                    met &= !S::bits(S::splat(self.limit).less(enters));
                    packs &= met;
                }
            }
            met &= inner;
            if met != 0 {
                index = below + met.trailing_zeros();
                met &= met - 1;
                if met != 0 {
                    let Row(enters) = enters.row();
                    let mut near = enters[(index - below) as usize & 7];
                    while met != 0 {
                        let lane = met.trailing_zeros();
                        met &= met - 1;
                        let mut other = Group { enter: enters[lane as usize & 7], index: below + lane };
                        if other.enter < near {
                            std::mem::swap(&mut other.enter, &mut near);
                            std::mem::swap(&mut other.index, &mut index);
                        }
                        self.groups[waiting % GROUPS] = other;
                        waiting += 1;
                    }
                }
                continue;
            }
            while waiting != 0 {
                waiting -= 1;
                let Group { enter, index: next } = self.groups[waiting % GROUPS];
                if enter <= self.limit {
                    index = next;
                    continue 'groups;
                }
            }
            if root == last {
                break;
            }
            root += 1;
            index = root;
        }
        if self.end < far { Next::Part } else { Next::Cell }
    }

    /// What survives of a pack; true if that is all the ray wants.
    #[inline(always)]
    fn meet(&mut self, pack: &'a K, seen: Seen<S>) -> bool {
        if !EXACT {
            return self.meet_rounded(pack, seen);
        }
        let (from, to) = (seen.p - seen.bound, seen.p + seen.bound);
        let in_range = to.less(S::splat(self.sure)) & self.ray.begin.less(from);
        let certain = if K::CERTAIN { S::bits(seen.certain & in_range) } else { 0 };
        if self.any && certain != 0 {
            self.found = true;
            return true;
        }
        let (Row(from), Row(to)) = (from.row(), to.row());
        let mut survivors = seen.survivors;
        if !crowd::few(survivors & !certain) {
            survivors &= !self.crowd(pack, survivors & !certain);
        }
        while survivors != 0 {
            let lane = survivors.trailing_zeros() as usize & 7;
            survivors &= survivors - 1;
            let prim = pack.prims()[lane];
            if prim == self.winner {
                continue;
            }
            let known = if K::CERTAIN && certain >> lane & 1 != 0 {
                Some((from[lane], to[lane]))
            } else {
                match pack.judge(lane, &self.entry.sight, self.limit) {
                    Verdict::Miss => continue,
                    Verdict::Hit { p, bound } => {
                        let ease = bound + EASE * p.abs();
                        Some(((p - ease) as f32, (p + ease) as f32))
                    }
                    Verdict::Open => None,
                }
            };
            if let Some((from, to)) = known {
                if self.any {
                    self.found = true;
                    return true;
                }
                if to < self.sure {
                    // Before all that was met so far: the winner, whose exact parameter can wait.
                    (self.pending, self.limit, self.sure) = (Some((pack, lane)), to, from);
                    self.winner = prim;
                    self.end = lesser(self.end, self.entry.walked(self.limit));
                    continue;
                }
                if from > self.limit {
                    continue;
                }
            }
            self.settle();
            if self.exactly(prim) {
                self.crowd.met = pack.corner(lane, &self.entry.sight).map(|corner| Met { corner, prim });
                let met = self.crowd.met;
                survivors &= !S::apart(Beaten { pack, met: &met });
            }
            if self.any && self.found {
                return true;
            }
        }
        false
    }

    /// As [`Trace::meet`], of hits as f32 has them.
    #[inline(always)]
    fn meet_rounded(&mut self, pack: &'a K, seen: Seen<S>) -> bool {
        let Row(p) = seen.p.row();
        let mut survivors = seen.survivors;
        while survivors != 0 && !(self.any && self.found) {
            let lane = survivors.trailing_zeros() as usize & 7;
            survivors &= survivors - 1;
            if p[lane] <= self.limit {
                (self.pending, self.limit, self.found) = (Some((pack, lane)), p[lane], true);
            }
        }
        self.end = lesser(self.end, self.entry.walked(self.limit));
        self.any && self.found
    }

    /// The lanes that need not be looked at one by one, where many primitives are near the ray.
    #[inline(always)]
    fn crowd(&mut self, pack: &K, open: u32) -> u32 {
        // One that waits is nearer than the one that has been.
        let winner = if self.pending.is_some() { None } else { self.exact.known().map(|known| known.prim) };
        // A copy: what is lent out of `self` would keep all of it in memory.
        let mut known = self.crowd;
        let before = known.met.map(|met| met.prim);
        let done = S::apart(Crowd { pack, sight: &self.entry.sight, end: self.limit, open, winner, known: &mut known });
        if let Some(met) = known.met.filter(|met| Some(met.prim) != before) {
            self.exact.rename(met.prim);
        }
        self.crowd = known;
        done
    }

    /// True if nothing of a pack is left, of one after a pack of which nothing was.
    #[inline(always)]
    fn aside(&mut self, pack: &K) -> bool {
        let mut known = self.crowd;
        let aside = S::apart(Aside { pack, known: &mut known });
        self.crowd = known;
        aside
    }

    /// Finds the parameter of the winner that waits, if one does.
    #[inline(always)]
    pub(super) fn settle(&mut self) {
        if let Some((pack, lane)) = self.pending.take() {
            let prim = pack.prims()[lane];
            if !EXACT {
                let (t, err) = self.entry.parameter(self.limit.into(), 0.0);
                self.exact.replace(prim, t, err);
                return;
            }
            let found = match pack.judge(lane, &self.entry.sight, f32::INFINITY) {
                Verdict::Hit { p, bound } => Some(self.entry.parameter(p, bound)),
                _ => None,
            };
            let known = match found {
                // Good enough to be rounded to f32; next to the ray's origin it may not be.
                Some((t, err)) if err < t.abs() * CLOSE => self.exact.replace(prim, t, err),
                _ => {
                    self.probe.test();
                    self.exact.settle(prim)
                }
            };
            self.know(known);
        }
    }

    /// Tests a primitive exactly; true if it wins.
    #[inline(always)]
    fn exactly(&mut self, prim: u32) -> bool {
        self.probe.test();
        let known = self.exact.test(prim);
        self.know(known);
        known.is_some_and(|known| known.prim == prim)
    }

    /// Lowers the end to the winner.
    #[inline(always)]
    fn know(&mut self, known: Option<Known>) {
        if let Some(Known { prim, lower, upper }) = known {
            (self.found, self.winner) = (true, prim);
            self.limit = lesser(self.limit, self.entry.around(upper)[1]);
            self.sure = lesser(self.sure, self.entry.around(lower)[0]);
            self.end = lesser(self.end, self.entry.walked(self.limit));
        }
    }
}
