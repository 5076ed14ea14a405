//! Which cells of the grid on top each primitive meets.
//!
//! Most are in one: their box says so. The others are asked window by window of 4 x 4 x 4 cells, from coarse to fine, so that
//! a long sliver costs as much as it meets and not as much as its box.

use super::frame::{Frame, PADDING};
use super::lanes::Lanes;
use super::limit::Limit;
use super::raster::Window;
use super::shape::Top;
use super::simd::Work;
use super::source::Source;
use crate::grid::lists::References;
use crate::ray::Aabb;
use std::ops::Range;

/// Cells that a primitive meets in a window of the grid on top.
#[derive(Clone, Copy, Debug)]
struct Met {
    cells: u64,
    /// Cell of the grid where the window begins.
    first: u32,
    /// Whether the next window is of the same primitive.
    more: bool,
}

/// Where some primitives in a row are.
#[derive(Clone, Debug)]
pub(super) struct Placed<L> {
    /// Their places in the list of members.
    pub range: Range<usize>,
    /// The cell of each, or [`MANY`] and the place of its first window.
    codes: Vec<u32>,
    met: Vec<Met>,
    /// Those that may be in several cells, by their place in the range and by their index; then as they are.
    several: Vec<u32>,
    prims: Vec<u32>,
    locals: Vec<L>,
    open: Vec<([i32; 3], i32)>,
}

const MANY: u32 = 1 << 31;

/// In no cell.
const NOWHERE: u32 = u32::MAX;

impl<L> Default for Placed<L> {
    fn default() -> Self {
        Self {
            range: 0..0,
            codes: Vec::new(),
            met: Vec::new(),
            several: Vec::new(),
            prims: Vec::new(),
            locals: Vec::new(),
            open: Vec::new(),
        }
    }
}

/// Finds where some members are.
pub(super) struct Place<'a, Src: Source> {
    pub source: &'a Src,
    pub frame: &'a Frame,
    pub top: &'a Top,
    /// All members, by index in the geometry.
    pub members: &'a [u32],
    /// Boxes by index in the geometry.
    pub boxes: &'a [Aabb],
    pub limit: &'a Limit,
    /// Says which members, and takes the answer.
    pub placed: &'a mut Placed<Src::Local>,
}

impl<Src: Source> Work for Place<'_, Src> {
    type Output = ();

    #[inline(always)]
    fn run<S: Lanes>(self) {
        let Self { source, frame, top, members, boxes, limit, placed } = self;
        let Placed { range, codes, met, several, prims, locals, open } = placed;
        let members = &members[range.clone()];
        let ruler = Ruler::new(frame, top);
        codes.clear();
        met.clear();
        several.clear();
        prims.clear();
        for (i, &prim) in members.iter().enumerate() {
            let [low, high] = ruler.ends(&boxes[prim as usize]);
            if low == high {
                codes.push(top.index(low));
            } else {
                codes.push(NOWHERE);
                several.push(i as u32);
                prims.push(prim);
            }
        }
        if !limit.take(4 * members.len() as u64) {
            return;
        }
        source.gather(prims, locals);
        for ((&i, &prim), local) in several.iter().zip(&*prims).zip(&*locals) {
            let [low, high] = ruler.ends(&boxes[prim as usize]);
            let first = met.len();
            let mut references = 0;
            open.clear();
            open.push((low, scale(&low, &high)));
            while let Some((at, scale)) = open.pop() {
                let (mut begin, mut size) = ([0.0; 3], [0.0; 3]);
                for axis in 0..3 {
                    begin[axis] = at[axis] as f32 * top.cell[axis] - top.half[axis];
                    size[axis] = top.cell[axis] * scale as f32;
                }
                let window = Window::new(begin, size);
                let mut cells = source.cells::<S>(local, &window) & within(&at, scale, &top.cells);
                if scale == 1 {
                    if cells != 0 {
                        met.push(Met { cells, first: top.index(at), more: true });
                        references += cells.count_ones();
                    }
                    continue;
                }
                while cells != 0 {
                    let bit = cells.trailing_zeros() as i32;
                    cells &= cells - 1;
                    let next = scale / 4;
                    let [x, y, z] = at;
                    let at = [x + scale * (bit & 3), y + scale * (bit >> 2 & 3), z + scale * (bit >> 4)];
                    open.push((at, next));
                }
            }
            if let Some(last) = met[first..].last_mut() {
                last.more = false;
                codes[i as usize] = MANY | first as u32;
            }
            if !limit.take(4 * u64::from(references) + (size_of::<Met>() * (met.len() - first)) as u64) {
                return;
            }
        }
    }
}

/// Finds the cells where boxes begin and end: eight numbers at a time, those of both ends.
struct Ruler {
    centre: [f64; 8],
    scale: f64,
    padding: [f32; 8],
    half: [f32; 8],
    per_unit: [f32; 8],
    last: [f32; 8],
}

impl Ruler {
    #[inline(always)]
    fn new(frame: &Frame, top: &Top) -> Self {
        let mut ruler = Self {
            centre: [0.0; 8],
            scale: frame.scale,
            padding: [0.0; 8],
            half: [0.0; 8],
            per_unit: [0.0; 8],
            last: [0.0; 8],
        };
        for i in [0, 1, 2, 4, 5, 6] {
            let axis = i & 3;
            ruler.centre[i] = frame.centre[axis];
            ruler.padding[i] = if i < 4 { -2.0 * PADDING } else { 2.0 * PADDING };
            ruler.half[i] = top.half[axis];
            ruler.per_unit[i] = top.per_unit[axis];
            ruler.last[i] = (top.cells[axis] - 1) as f32;
        }
        ruler
    }

    /// The cells of the grid where a box begins and ends, padded.
    #[inline(always)]
    fn ends(&self, aabb: &Aabb) -> [[i32; 3]; 2] {
        let Aabb { min, max } = aabb;
        let points = [min.x, min.y, min.z, 0.0, max.x, max.y, max.z, 0.0];
        let mut cells = [0; 8];
        for i in 0..8 {
            let x = ((f64::from(points[i]) - self.centre[i]) * self.scale) as f32 + self.padding[i];
            let cell = (x + self.half[i]) * self.per_unit[i];
            let cell = if cell < self.last[i] { cell } else { self.last[i] };
            cells[i] = (if cell > 0.0 { cell } else { 0.0 }) as i32;
        }
        [[cells[0], cells[1], cells[2]], [cells[4], cells[5], cells[6]]]
    }
}

/// Cells of the grid along an edge of a coarse one, 4 x 4 x 4 of which reach from `low` to `high`: a power of four.
#[inline(always)]
fn scale(low: &[i32; 3], high: &[i32; 3]) -> i32 {
    let mut scale = 1;
    for axis in 0..3 {
        while high[axis] - low[axis] >= 4 * scale {
            scale *= 4;
        }
    }
    scale
}

/// The cells of a window, as large as `scale` cells of the grid, that begin in the grid.
#[inline(always)]
fn within(at: &[i32; 3], scale: i32, cells: &[u32; 3]) -> u64 {
    let room = [0, 1, 2].map(|a| (cells[a] as i32 - at[a] + scale - 1) / scale);
    let mut mask = u64::MAX;
    if room[0] < 4 {
        mask &= ((1_u64 << room[0]) - 1) * 0x1111_1111_1111_1111;
    }
    if room[1] < 4 {
        mask &= ((1_u64 << (4 * room[1])) - 1) * 0x0001_0001_0001_0001;
    }
    if room[2] < 4 {
        mask &= (1 << (16 * room[2])) - 1;
    }
    mask
}

/// Where all members are.
pub(super) struct Placements<'a, L> {
    pub members: &'a [u32],
    pub placed: &'a [Placed<L>],
    pub cells: &'a [u32; 3],
}

impl<L: Sync> References for Placements<'_, L> {
    #[inline]
    fn each(&self, share: &Range<usize>, mut refer: impl FnMut(usize, u32)) {
        let [nx, ny, nz] = self.cells.map(|n| n as usize);
        let all = *share == (0..nx * ny * nz);
        for Placed { range, codes, met, .. } in self.placed {
            for (&prim, &code) in self.members[range.clone()].iter().zip(codes) {
                if code < MANY {
                    let cell = code as usize;
                    if all || share.contains(&cell) {
                        refer(cell, prim);
                    }
                } else if code != NOWHERE {
                    let mut next = (code - MANY) as usize;
                    loop {
                        let Met { mut cells, first, more } = met[next];
                        while cells != 0 {
                            let bit = cells.trailing_zeros() as usize;
                            cells &= cells - 1;
                            let cell = first as usize + (bit & 3) + nx * ((bit >> 2 & 3) + ny * (bit >> 4));
                            if all || share.contains(&cell) {
                                refer(cell, prim);
                            }
                        }
                        next += 1;
                        if !more {
                            break;
                        }
                    }
                }
            }
        }
    }
}
