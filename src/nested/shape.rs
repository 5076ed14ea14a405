//! What is built: parts, their grids, nodes and packs. No geometry: the walk is compiled once for all of them.

use super::boxes::Boxes;
use super::frame::Frame;
use super::pack::{List, Pack};
use super::spheres::SpherePack;
use super::triangles::TrianglePack;
use glam::Vec3A;

/// What a cell holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Slot {
    /// The first pack, or the first group of boxes, or the node.
    pub first: u32,
    /// 1 for a pack, or the number of groups of boxes with [`Slot::BOXED`] added; [`Slot::NODE`] says that it is a node.
    pub count: u32,
}

impl Slot {
    const NODE: u32 = u32::MAX;
    const BOXED: u32 = 1 << 31;

    /// Nothing.
    pub const EMPTY: Slot = Slot { first: 0, count: 0 };

    /// The node of an index.
    pub fn node(index: u32) -> Self {
        Self { first: index, count: Self::NODE }
    }

    /// Groups of boxes around packs.
    pub fn boxed(first: u32, groups: u32) -> Self {
        Self { first, count: Self::BOXED | groups }
    }

    /// True if it holds groups of boxes, or a node.
    #[inline(always)]
    pub fn is_boxed(self) -> bool {
        self.count & Self::BOXED != 0
    }

    /// How many groups of boxes there are, or packs: one at most.
    #[inline(always)]
    pub fn groups(self) -> u32 {
        self.count & !Self::BOXED
    }

    /// True if it holds a node.
    #[inline(always)]
    pub fn is_node(self) -> bool {
        self.count == Self::NODE
    }
}

/// A box cut into 4 x 4 x 4 cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Node {
    /// Bit `x + 4 y + 16 z` is set if that cell holds something.
    pub mask: u64,
    /// Where its planes in the middle cross.
    pub centre: [f32; 3],
    /// Edges of a cell.
    pub cell: [f32; 3],
    /// Slot of the first cell that holds something; those of the others follow in their order.
    pub base: u32,
}

/// The uniform grid on top of a part.
///
/// Plane `i` of an axis lies at `i * cell - half`. The grid is as large as the part's box, about its middle: seen along a ray
/// that moves backwards it is the same grid with the signs of coordinates changed.
#[derive(Clone, Debug)]
pub(super) struct Top {
    pub half: Vec3A,
    /// Edges of a cell.
    pub cell: Vec3A,
    /// Cells for each unit.
    pub per_unit: Vec3A,
    pub cells: [u32; 3],
    /// These less one.
    pub last: Vec3A,
    /// For each octant of directions a byte for each cell, x varying fastest: 0 if it holds something, else the edge of the
    /// cube of empty cells that begins with it and reaches along the octant; 255 means "255 or more". Bit `a` of an octant is
    /// set if rays move backwards along axis `a`.
    pub free: Vec<u8>,
    /// One for each cell.
    pub slots: Vec<Slot>,
}

impl Default for Top {
    /// No cell.
    fn default() -> Self {
        Self {
            half: Vec3A::ONE,
            cell: Vec3A::ZERO,
            per_unit: Vec3A::ZERO,
            cells: [0; 3],
            last: Vec3A::ZERO,
            free: Vec::new(),
            slots: Vec::new(),
        }
    }
}

impl Top {
    /// A grid of one cell.
    pub fn one(half: Vec3A, slot: Slot) -> Self {
        let free = vec![if slot.count > 0 { 0 } else { u8::MAX }; 8];
        let mut top = Self { free, slots: vec![slot], ..Self::default() };
        top.cut(half, [1; 3]);
        top
    }

    /// Sets the sizes of cells.
    pub fn cut(&mut self, half: Vec3A, cells: [u32; 3]) {
        let count = Vec3A::from(cells.map(|n| n as f32));
        self.half = half;
        (self.cell, self.per_unit) = (2.0 * self.half / count, count / (2.0 * self.half));
        (self.cells, self.last) = (cells, count - 1.0);
    }

    /// Place of a cell in the grid, x varying fastest.
    #[inline(always)]
    pub fn index(&self, [x, y, z]: [i32; 3]) -> u32 {
        ((z as u32) * self.cells[1] + y as u32) * self.cells[0] + x as u32
    }
}

/// A number of primitives with a box of their own, and one kind of packs.
#[derive(Clone, Debug)]
pub(super) struct Part<K> {
    pub frame: Frame,
    pub top: Top,
    pub nodes: Vec<Node>,
    /// Cells of nodes that hold something.
    pub slots: Vec<Slot>,
    pub boxes: Vec<Boxes>,
    pub packs: Vec<K>,
}

/// A part of any kind.
#[derive(Clone, Debug)]
pub(super) enum AnyPart {
    Triangles(Part<TrianglePack>),
    Spheres(Part<SpherePack>),
    Lists(Part<List>),
}

/// A kind of packs, and of parts.
pub(super) trait Kind: Pack {
    /// The part as one of any kind.
    fn any(part: Part<Self>) -> AnyPart;

    /// Takes the first part of this kind out of a list.
    fn take(parts: &mut Vec<AnyPart>) -> Option<Part<Self>>;
}

macro_rules! kinds {
    ($($pack:ident $variant:ident),*) => {$(
        impl Kind for $pack {
            fn any(part: Part<Self>) -> AnyPart {
                AnyPart::$variant(part)
            }
            fn take(parts: &mut Vec<AnyPart>) -> Option<Part<Self>> {
                let place = parts.iter().position(|part| matches!(part, AnyPart::$variant(_)))?;
                match parts.remove(place) {
                    AnyPart::$variant(part) => Some(part),
                    _ => unreachable!("it has just been looked at"),
                }
            }
        }
    )*};
}
kinds!(TrianglePack Triangles, SpherePack Spheres, List Lists);

/// All parts, in the order in which rays are sent through them.
#[derive(Clone, Debug, Default)]
pub(super) struct Shape {
    pub parts: Vec<AnyPart>,
}

impl<K: Pack> Part<K> {
    /// Nothing yet, in this frame.
    pub fn new(frame: Frame) -> Self {
        Self { frame, top: Top::default(), nodes: Vec::new(), slots: Vec::new(), boxes: Vec::new(), packs: Vec::new() }
    }

    fn describe(&self, what: &str) -> String {
        let [x, y, z] = self.top.cells;
        let (cells, filled) = (self.top.slots.len(), self.top.slots.iter().filter(|s| s.count > 0).count());
        format!(
            "{what}: {x} x {y} x {z} cells, {:.1} % empty, {} nodes, {} packs",
            100.0 * (cells - filled) as f64 / cells as f64,
            self.nodes.len(),
            self.packs.len()
        )
    }

    /// Bytes of grid and nodes, of packs, and of skip bytes.
    pub fn bytes(&self) -> [u64; 3] {
        let of = |len: usize, size: usize| len as u64 * size as u64;
        let slots = of(self.top.slots.len() + self.slots.len(), size_of::<Slot>());
        [
            slots + of(self.nodes.len(), size_of::<Node>()) + of(self.boxes.len(), size_of::<Boxes>()),
            of(self.packs.len(), size_of::<K>()),
            self.top.free.len() as u64,
        ]
    }
}

impl AnyPart {
    /// As [`Part::bytes`].
    pub fn bytes(&self) -> [u64; 3] {
        match self {
            AnyPart::Triangles(part) => part.bytes(),
            AnyPart::Spheres(part) => part.bytes(),
            AnyPart::Lists(part) => part.bytes(),
        }
    }

    /// What was built, for people.
    pub fn describe(&self) -> String {
        match self {
            AnyPart::Triangles(part) => part.describe("triangles"),
            AnyPart::Spheres(part) => part.describe("spheres"),
            AnyPart::Lists(part) => part.describe("others"),
        }
    }
}
