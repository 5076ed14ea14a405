//! The scene graph of a `.vox` file: which models are where.

use dot_vox::{DotVoxData, Frame, SceneNode};
use glam::I64Vec3;

/// Most levels of the graph.
const MAX_DEPTH: usize = 256;
/// Most nodes that are visited; a node under several parents counts each time.
const MAX_VISITS: usize = 1 << 20;
/// Largest coordinate of a translation.
const FARTHEST: i64 = 1 << 30;

/// A model and its place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed {
    /// Index of the model, which exists.
    pub model: usize,
    motion: Motion,
    /// Twice the point of the model that lies on the node's origin.
    pivot: I64Vec3,
}

impl Placed {
    /// The voxel in the scene, z upwards, on which a voxel of the model lies.
    pub fn place(&self, voxel: I64Vec3) -> I64Vec3 {
        // Middles of voxels are odd in halves of an edge, turned or not.
        let middle = self.motion.turn(2 * voxel + 1 - self.pivot);
        (middle - 1) / 2 + self.motion.shift
    }
}

/// A turn by right angles, perhaps with a reflection, then a translation.
#[derive(Clone, Copy, Debug)]
struct Motion {
    /// Row `i` of the matrix has `sign[i]` in column `column[i]`.
    column: [usize; 3],
    sign: [i64; 3],
    shift: I64Vec3,
}

impl Motion {
    const NONE: Motion = Motion { column: [0, 1, 2], sign: [1; 3], shift: I64Vec3::ZERO };

    fn turn(&self, p: I64Vec3) -> I64Vec3 {
        I64Vec3::from([0, 1, 2].map(|row| self.sign[row] * p[self.column[row]]))
    }

    /// First `inner`, then this one.
    fn after(&self, inner: &Motion) -> Motion {
        Motion {
            column: [0, 1, 2].map(|row| inner.column[self.column[row]]),
            sign: [0, 1, 2].map(|row| self.sign[row] * inner.sign[self.column[row]]),
            shift: self.turn(inner.shift) + self.shift,
        }
    }

    /// The motion of a frame; the error is the cause.
    fn of(frame: &Frame) -> Result<Motion, String> {
        let mut motion = Motion::NONE;
        if let Some(text) = frame.attributes.get("_t") {
            let numbers: Option<Vec<i64>> = text.split_whitespace().map(|n| n.parse().ok()).collect();
            motion.shift = match numbers.as_deref() {
                Some(&[x, y, z]) if [x, y, z].iter().all(|c| (-FARTHEST..=FARTHEST).contains(c)) => {
                    I64Vec3::new(x, y, z)
                }
                _ => return Err(format!("translation `{}` is not three whole numbers", text.escape_debug())),
            };
        }
        if let Some(text) = frame.attributes.get("_r") {
            let bits = text.trim().parse::<u8>().ok().filter(|&bits| {
                let (first, second) = (bits & 3, bits >> 2 & 3);
                first != 3 && second != 3 && first != second && bits < 128
            });
            let bits = bits.ok_or_else(|| format!("rotation `{}` is none", text.escape_debug()))?;
            let (first, second) = (usize::from(bits & 3), usize::from(bits >> 2 & 3));
            motion.column = [first, second, 3 - first - second];
            motion.sign = [4, 5, 6].map(|bit| if bits >> bit & 1 == 0 { 1 } else { -1 });
        }
        Ok(motion)
    }
}

/// All visible models in the order of the graph; what is left out goes to `notes`. The error is the cause.
pub(super) fn placed(data: &DotVoxData, notes: &mut Vec<String>) -> Result<Vec<Placed>, String> {
    let mut placed = Vec::new();
    if data.scenes.is_empty() {
        if data.models.len() > 1 {
            notes.push(format!("no scene graph: the first of {} models is shown", data.models.len()));
        }
        if !data.models.is_empty() {
            placed.push(Placed { model: 0, motion: Motion::NONE, pivot: I64Vec3::ZERO });
        }
        return Ok(placed);
    }
    let (mut visits, mut hidden, mut animated) = (0, 0, 0);
    let mut open = vec![(0_u32, Motion::NONE, 0_usize)];
    while let Some((number, motion, depth)) = open.pop() {
        visits += 1;
        let fail = |cause: String| Err(format!("node {number}: {cause}"));
        if depth > MAX_DEPTH || visits > MAX_VISITS {
            return fail(format!("more than {MAX_DEPTH} levels or {MAX_VISITS} nodes on the way, or a circle"));
        }
        let Some(node) = data.scenes.get(number as usize) else {
            return Err(format!("a node refers to node {number} of {}", data.scenes.len()));
        };
        match node {
            SceneNode::Transform { attributes, frames, child, layer_id } => {
                let layer = data.layers.get(*layer_id as usize);
                let off = attributes.get("_hidden").is_some_and(|v| v == "1");
                if off || layer.is_some_and(|layer| layer.hidden()) {
                    hidden += 1;
                    continue;
                }
                animated += usize::from(frames.len() > 1);
                // There is a frame, as checked.
                let inner = frames.first().map_or(Ok(Motion::NONE), Motion::of);
                let next = match inner {
                    Ok(inner) => motion.after(&inner),
                    Err(cause) => return fail(cause),
                };
                if next.shift.abs().max_element() > FARTHEST {
                    return fail(format!("moved to {}", next.shift));
                }
                open.push((*child, next, depth + 1));
            }
            SceneNode::Group { children, .. } => {
                if open.len() + children.len() > MAX_VISITS {
                    return fail(format!("more than {MAX_VISITS} nodes on the way"));
                }
                // The first child comes off the stack first.
                open.extend(children.iter().rev().map(|&child| (child, motion, depth + 1)));
            }
            SceneNode::Shape { models, .. } => {
                animated += usize::from(models.len() > 1);
                let Some(shape) = models.first() else { continue };
                let index = shape.model_id as usize;
                let Some(model) = data.models.get(index) else {
                    return fail(format!("refers to model {index} of {}", data.models.len()));
                };
                let size = I64Vec3::new(model.size.x.into(), model.size.y.into(), model.size.z.into());
                placed.push(Placed { model: index, motion, pivot: 2 * (size / 2) });
            }
        }
    }
    if hidden > 0 {
        notes.push(format!("{hidden} hidden nodes are left out"));
    }
    if animated > 0 {
        notes.push(format!("{animated} nodes are animated: the first frame is shown"));
    }
    Ok(placed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn motions_compose_as_matrices_do() {
        let frame = |r: &str, t: &str| {
            let mut frame = Frame::default();
            frame.attributes.insert("_r".into(), r.into());
            frame.attributes.insert("_t".into(), t.into());
            frame
        };
        // The example of the format's description: rows (0, 1, 0), (0, 0, -1), (-1, 0, 0).
        let bits = 1 | 2 << 2 | 1 << 5 | 1 << 6;
        let a = Motion::of(&frame(&bits.to_string(), "10 -2 3")).expect("a motion");
        assert_eq!(a.turn(I64Vec3::new(5, 6, 7)), I64Vec3::new(6, -7, -5));
        let b = Motion::of(&frame("4", "1 2 3")).expect("a motion");
        let p = I64Vec3::new(-3, 8, 2);
        let whole = |m: &Motion, p: I64Vec3| m.turn(p) + m.shift;
        assert_eq!(whole(&a.after(&b), p), whole(&a, whole(&b, p)));
        assert_eq!(whole(&b.after(&a), p), whole(&b, whole(&a, p)));
        for (r, t) in [("5", "0 0 0"), ("3", "0 0 0"), ("132", "0 0 0"), ("x", "0 0 0"), ("4", "1 2"), ("4", "9e9 0 0")]
        {
            assert!(Motion::of(&frame(r, t)).is_err(), "{r} {t}");
        }
    }

    #[test]
    fn odd_and_even_models_turn_within_their_box() {
        // A quarter turn about z maps a model of 3 x 2 x 1 to one of 2 x 3 x 1, each voxel to another.
        let motion = Motion { column: [1, 0, 2], sign: [-1, 1, 1], shift: I64Vec3::ZERO };
        let placed = Placed { model: 0, motion, pivot: 2 * I64Vec3::new(1, 1, 0) };
        let mut all: Vec<_> = (0..6).map(|i| placed.place(I64Vec3::new(i % 3, i / 3, 0)).to_array()).collect();
        all.sort_unstable();
        assert_eq!(all, [[-1, -1, 0], [-1, 0, 0], [-1, 1, 0], [0, -1, 0], [0, 0, 0], [0, 1, 0]]);
    }
}
