//! Which primitives equal an earlier one in every bit.
//!
//! Each primitive has a print of 31 bits. Prints are noted in a table of bits, sixteen or more for each; what finds its bit
//! taken is looked at again, with all others whose print has the same bit: some percent, and the copies. Of these, sorted,
//! those with equal prints are compared by [`Geometry::fingerprint`], which is the truth.
//!
//! **No input makes this slow.** Prints are a multilinear hash, `(k + sum of k_i w_i mod 2^64) / 2^32` with keys of 64 bits
//! that are drawn afresh: two different lists of words have the same print with a chance of 2^-31, whatever they are (D. Lemire and
//! O. Kaser, "Strongly universal string hashing is fast", 2014). The words of a triangle are the least, the greatest and the sum
//! of its corners' coordinates along each axis, so that the order of corners does not matter; at most 36 triangles
//! agree in these (each axis may give its three numbers to the corners in six ways). So a print is shared by 36 different
//! triangles and another for each 2^31 at most, on average over the keys, and no comparison is with more.

use crate::geometry::Geometry;
use crate::parallel;
use crate::ray::{greater, lesser};
use glam::Vec3;
use std::hash::{BuildHasher, RandomState};

/// The search, in memory that the next one uses again.
#[derive(Clone, Debug)]
pub(super) struct Copies {
    keys: [u64; 10],
    prints: Vec<Option<Print>>,
    tables: Vec<Table>,
    suspects: Vec<u64>,
    found: Vec<u32>,
}

/// Where equal, primitives may be copies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Print(std::num::NonZeroU32);

/// A bit for each of some prints.
#[derive(Clone, Debug, Default)]
struct Table {
    bits: Vec<u64>,
    /// Prints whose bit was taken.
    taken: Vec<u32>,
    /// Print and index of all primitives with such a bit.
    suspects: Vec<u64>,
}

impl Default for Copies {
    fn default() -> Self {
        let random = RandomState::new();
        let keys = std::array::from_fn(|i| random.hash_one(i));
        Self { keys, prints: Vec::new(), tables: Vec::new(), suspects: Vec::new(), found: Vec::new() }
    }
}

impl Copies {
    /// A place for the print of each of `len` primitives.
    pub fn take_prints(&mut self, len: usize) -> Vec<Option<Print>> {
        let mut prints = std::mem::take(&mut self.prints);
        prints.resize(len, None);
        prints
    }

    /// The print of a primitive; `None` if it cannot be told apart from others.
    #[inline]
    pub fn print<G: Geometry>(&self, geometry: &G, prim: u32) -> Option<Print> {
        let words = match geometry.triangle(prim) {
            Some([a, b, c]) => {
                // Zeros of either sign are equal.
                let [a, b, c] = [a + Vec3::ZERO, b + Vec3::ZERO, c + Vec3::ZERO];
                let word = |f: fn(f32, f32, f32) -> u32| [f(a.x, b.x, c.x), f(a.y, b.y, c.y), f(a.z, b.z, c.z)];
                let [d, e, f] = word(|a, b, c| lesser(lesser(a, b), c).to_bits());
                let [g, h, i] = word(|a, b, c| greater(greater(a, b), c).to_bits());
                let [j, k, l] = word(|a, b, c| a.to_bits().wrapping_add(b.to_bits()).wrapping_add(c.to_bits()));
                [d, e, f, g, h, i, j, k, l]
            }
            None => geometry.fingerprint(prim)?,
        };
        let [mut sum, keys @ ..] = self.keys;
        for i in 0..9 {
            sum = sum.wrapping_add(keys[i].wrapping_mul(u64::from(words[i])));
        }
        std::num::NonZeroU32::new((sum >> 32) as u32 | 1).map(Print)
    }

    /// The primitives with these prints that equal an earlier one, ascending.
    pub fn find<G: Geometry>(&mut self, geometry: &G, prints: Vec<Option<Print>>) -> &[u32] {
        self.prints = prints;
        // Each thread has a share of the prints.
        let shares = parallel::threads().clamp(1, 64).min(self.prints.len() / 4096 + 1);
        self.tables.resize_with(shares, Table::default);
        let prints = &self.prints;
        parallel::each(self.tables.iter_mut().enumerate(), |(share, table)| {
            table.fill(prints, share as u64, shares as u64);
        });
        self.suspects.clear();
        self.tables.iter().for_each(|table| self.suspects.extend(&table.suspects));
        self.suspects.sort_unstable();
        self.found.clear();
        for alike in self.suspects.chunk_by(|a, b| a >> 32 == b >> 32).filter(|alike| alike.len() > 1) {
            let mut kept = Vec::new();
            for prim in alike.iter().map(|&suspect| suspect as u32) {
                match geometry.fingerprint(prim) {
                    Some(print) if kept.contains(&print) => self.found.push(prim),
                    Some(print) => kept.push(print),
                    None => {}
                }
            }
        }
        self.found.sort_unstable();
        &self.found
    }
}

impl Table {
    fn fill(&mut self, prints: &[Option<Print>], share: u64, shares: u64) {
        let mine = |print: &Option<Print>| {
            let print = print.as_ref()?.0.get();
            (shares == 1 || (u64::from(print) * shares) >> 32 == share).then_some(print)
        };
        let size = (prints.len() / shares as usize / 4).next_power_of_two().clamp(64, 1 << 25);
        // The lowest bit of a print is always set.
        let place = |print: u32| ((print >> 7) as usize & (size - 1), 1_u64 << (print >> 1 & 63));
        self.bits.clear();
        self.bits.resize(size, 0);
        self.taken.clear();
        for print in prints.iter().filter_map(mine) {
            let (word, bit) = place(print);
            if self.bits[word] & bit != 0 {
                self.taken.push(print);
            }
            self.bits[word] |= bit;
        }
        self.suspects.clear();
        if self.taken.is_empty() {
            return;
        }
        self.bits.fill(0);
        for &print in &self.taken {
            let (word, bit) = place(print);
            self.bits[word] |= bit;
        }
        for (prim, print) in prints.iter().enumerate() {
            let Some(print) = mine(print) else { continue };
            let (word, bit) = place(print);
            if self.bits[word] & bit != 0 {
                self.suspects.push(u64::from(print) << 32 | prim as u64);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Sieve;
    use crate::geometry::tests::Random;
    use crate::geometry::{Geometry, Triangle};
    use glam::Vec3;
    use std::collections::HashSet;

    #[test]
    fn triangles_of_the_same_coordinates_are_told_apart() {
        let mut random = Random::new(6);
        let orders = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
        let mut triangles: Vec<Triangle> = Vec::new();
        for _ in 0..40 {
            let [a, b, c] = [(); 3].map(|()| random.in_cube());
            let (x, y, z) = ([a.x, b.x, c.x], [a.y, b.y, c.y], [a.z, b.z, c.z]);
            for i in orders {
                for j in orders {
                    for k in orders {
                        triangles.push([0, 1, 2].map(|n| Vec3::new(x[i[n]], y[j[n]], z[k[n]])));
                    }
                }
            }
        }
        let mut seen = HashSet::new();
        let kept: Vec<u32> =
            (0..Geometry::len(&triangles)).filter(|&i| seen.insert(triangles.fingerprint(i))).collect();
        assert_eq!(kept.len(), 40 * 36);
        let mut sieve = Sieve::default();
        for _ in 0..3 {
            let (_, left_out) = sieve.sift(&triangles);
            assert_eq!((&sieve.prims, left_out.copies), (&kept, 40 * 180));
        }
        // In the memory of a larger search.
        triangles.truncate(216);
        sieve.sift(&triangles);
        assert_eq!(sieve.prims, kept[..36]);
    }
}
