//! What a ray has dealt with: filters are asked about each triangle once, instances are entered once.

use std::collections::HashSet;

/// Primitives that a query has dealt with.
#[derive(Debug, Default)]
pub struct Seen {
    few: [u32; 8],
    count: usize,
    /// All, once they are more than a few.
    many: Option<HashSet<u32>>,
}

impl Seen {
    /// True if `prim` is new.
    pub fn insert(&mut self, prim: u32) -> bool {
        if let Some(many) = &mut self.many {
            return many.insert(prim);
        }
        if self.few[..self.count].contains(&prim) {
            return false;
        }
        if let Some(place) = self.few.get_mut(self.count) {
            (*place, self.count) = (prim, self.count + 1);
            return true;
        }
        self.many.insert(self.few.into()).insert(prim)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_primitive_is_new_once() {
        let mut seen = Seen::default();
        assert!((0..100).all(|prim| seen.insert(prim * 7)));
        assert!((0..100).all(|prim| !seen.insert(prim * 7)));
        assert!(seen.insert(1));
    }
}
