//! Shadow voxels: two bits for each light and voxel, "surely lit" and "surely dark".
//!
//! Amanatides & Woo 1987, last section, which announces them in a paragraph: whole voxels may lie in shadow, and nothing may
//! lie between others and the light; neither bit means that the ray must be shot. Here a bit is set only where it is proved,
//! so that pictures are equal to the bit with and without.
//!
//! - **Dark**: one triangle or one sphere has the whole voxel in its umbra ([`umbra`]). A union of several occluders may well
//!   hide a voxel that none of them hides alone; no such voxel is marked.
//! - **Lit**: all that lies between the voxel and the light ([`hull`]) lies behind the surface that the ray starts on
//!   ([`facing`]). The paper asks for nothing between; but a point to be shaded lies on a surface, whose neighbours reach into
//!   the voxels beside it, so that next to no voxel would be marked.
//! - **Near**, the fourth state of two bits, which the paper does not have: nothing lies between but in the voxel and its
//!   neighbours. The ray must be shot, but no further than these.
//!
//! What the proofs assume of a ray (that it starts in the voxel, before the plane of its surface, and ends at the light) is
//! checked when it is asked about: a ray for which it does not hold is traced. Lights with extent have no such bits.

mod facing;
mod hull;
mod umbra;

use super::frame::{Frame, PADDING};
use super::{Grid, GridOptions};
use crate::accel::{Accel, Memory, PointShadows, Shadow};
use crate::error::{Error, Result};
use crate::geometry::Geometry;
use crate::parallel;
use crate::ray::{Cell, Ray};
use facing::{Facing, Plane};
use glam::DVec3;

/// A light and how exactly rays end there.
#[derive(Clone, Copy, Debug)]
struct PointLight {
    position: DVec3,
    /// Where rays to the light may end, around its position, world units.
    target: Cell,
    /// The same in voxel coordinates.
    local: Cell,
}

/// Voxels that know which point lights surely reach them and which surely do not: the two bits for each light and voxel of
/// Amanatides & Woo 1987, last section, set only where it is proved.
///
/// Memory: a quarter of a byte for each voxel and light, beside a plain grid of its own.
#[derive(Clone, Debug)]
pub struct ShadowVoxels<G> {
    grid: Grid<G>,
    lights: Vec<PointLight>,
    /// Two bits for each light of each voxel, lights varying fastest.
    bits: Vec<u8>,
    /// Number of pairs of a filled voxel and a light in each state.
    pairs: [u64; 4],
}

const LIT: u8 = 1;
const DARK: u8 = 2;
const NEAR: u8 = 3;

/// Share of the distance between ray and light by which a ray may miss its end: the rounding of its direction, 2^-24, and
/// what a tracer shortens it by so that a surface at the light hides nothing, 2^-23.
const END: f64 = 1.0 / (1u64 << 22) as f64;

impl<G: Geometry> ShadowVoxels<G> {
    /// Decides every voxel of a grid over `geometry` for every light at `lights`, world units.
    ///
    /// # Errors
    /// As [`Grid::build`]; or the bits would take more than `options.memory` with the grid; or a light is not finite.
    pub fn build(geometry: G, lights: &[DVec3], options: &GridOptions) -> Result<Self> {
        if let Some(i) = lights.iter().position(|light| !light.is_finite()) {
            return Err(Error::invalid(format!("light {i} at {} is not finite", lights[i])));
        }
        let grid = Grid::build(geometry, options)?;
        let voxels = grid.voxels.0.voxels();
        let bytes = (voxels as u64).saturating_mul(lights.len() as u64).div_ceil(4);
        let wanted = bytes.saturating_add(grid.memory().total());
        if wanted > options.memory {
            let what = format!("shadow voxels of {} lights over {voxels} voxels", lights.len());
            return Err(Error::TooLarge { what, wanted, allowed: options.memory });
        }
        let lights = lights.iter().map(|&position| point_light(&grid, position)).collect();
        let mut shadows = Self { grid, lights, bits: vec![0; bytes as usize], pairs: [0; 4] };
        shadows.decide();
        Ok(shadows)
    }

    /// Sets all bits.
    fn decide(&mut self) {
        let lights = self.lights.len();
        if lights == 0 {
            return;
        }
        let mut bits = std::mem::take(&mut self.bits);
        // Four voxels begin at a whole byte, whatever the number of lights.
        const CHUNK: usize = 256;
        let chunks: Vec<_> = bits.chunks_mut(CHUNK / 4 * lights).enumerate().collect();
        let pairs = parallel::map(chunks, |(chunk, bits)| {
            let mut pairs = [0; 4];
            let voxels = chunk * CHUNK..((chunk + 1) * CHUNK).min(self.grid.voxels.0.voxels());
            for (i, voxel) in voxels.enumerate().filter(|(_, v)| !self.grid.voxels.0.list(*v).is_empty()) {
                for light in 0..lights {
                    let state = self.judge(voxel, light);
                    let place = i * lights + light;
                    bits[place / 4] |= state << (place % 4 * 2);
                    pairs[usize::from(state)] += 1;
                }
            }
            pairs
        });
        self.bits = bits;
        self.pairs = pairs.into_iter().fold([0; 4], |sum, part| [0, 1, 2, 3].map(|i| sum[i] + part[i]));
    }

    /// What is known of a voxel and a light.
    fn judge(&self, voxel: usize, light: usize) -> u8 {
        match self.between(voxel, light) {
            0 if self.surely_dark(voxel, light) => DARK,
            state => state,
        }
    }

    /// [`LIT`], [`NEAR`] or 0 by what lies between a voxel and a light.
    fn between(&self, voxel: usize, light: usize) -> u8 {
        /// More primitives than this between voxel and light, or in the voxel: not worth the time.
        const MOST: usize = 64;
        let (geometry, frame) = (&self.grid.geometry, &self.grid.frame);
        let (own, light) = (self.grid.voxels.0.list(voxel), &self.lights[light]);
        let slack = self.slack(voxel);
        let facings: Option<Vec<_>> = if own.len() > MOST {
            None
        } else {
            own.iter().map(|&prim| Facing::new(geometry, prim, &light.target, slack)).collect()
        };
        let place = frame.coordinates(voxel);
        let (mut lit, mut near) = (facings.is_some(), true);
        let facings = facings.unwrap_or_default();
        let mut seen = Vec::with_capacity(MOST);
        let judged = hull::all_voxels(frame, place, &light.local, &mut |v| {
            let list = self.grid.voxels.0.list(v);
            if list.is_empty() {
                return true;
            }
            let at = frame.coordinates(v);
            near = near && (0..3).all(|axis| at[axis].abs_diff(place[axis]) <= 1);
            lit = lit
                && list.iter().all(|&prim| {
                    seen.contains(&prim) || {
                        seen.push(prim);
                        seen.len() <= MOST && facings.iter().all(|facing| facing.clears(geometry, prim, slack))
                    }
                });
            lit || near
        });
        match (judged, lit) {
            (false, _) => 0,
            (true, true) => LIT,
            (true, false) => NEAR,
        }
    }

    fn surely_dark(&self, voxel: usize, light: usize) -> bool {
        let light = &self.lights[light];
        let cell = self.grid.frame.cell(self.grid.frame.coordinates(voxel));
        let centre = 0.5 * (cell.min + cell.max);
        let first = |from: DVec3, to: DVec3| {
            let ray = Ray::new(from.as_vec3(), (to - from).as_vec3()).with_range(0.0, 1.0);
            self.grid.closest_hit(&ray).map(|hit| hit.prim)
        };
        // If no primitive hides the centre, none hides all of the voxel. The one nearest to the light has the widest umbra.
        let Some(near) = first(light.position, centre) else { return false };
        umbra::holds(&self.grid.geometry, near, &cell, &light.target)
            || first(centre, light.position)
                .is_some_and(|far| far != near && umbra::holds(&self.grid.geometry, far, &cell, &light.target))
    }

    /// How far a primitive may reach before a plane and still count as behind it, world units: less than rays are lifted off
    /// their surfaces, so that flat surfaces of rounded vertices count as flat. A function of the voxel, so that build and
    /// query agree.
    fn slack(&self, voxel: usize) -> f64 {
        let cell = self.grid.frame.cell(self.grid.frame.coordinates(voxel));
        let least = cell.min.max(-cell.max).max(DVec3::ZERO).max_element();
        least * (1.0 / (1u64 << 24) as f64) + self.reach() * (1.0 / (1u64 << 46) as f64)
    }

    /// The largest coordinate of all primitives.
    fn reach(&self) -> f64 {
        self.grid.bounds.reach()
    }

    /// Whether light reaches a point on `prim` in a surely lit voxel from where `ray` starts: whether the proof holds for it.
    fn starts_clear(&self, voxel: usize, prim: u32, ray: &Ray) -> bool {
        if !self.grid.voxels.0.list(voxel).contains(&prim) {
            return false;
        }
        let (origin, geometry) = (ray.origin.as_dvec3(), &self.grid.geometry);
        if let Some(triangle) = geometry.triangle(prim) {
            let Some(plane) = Plane::of(&triangle) else { return false };
            let height = plane.height(origin);
            let end = plane.height(ray.at(f64::from(ray.t_max)));
            // On the light's side: both have the same sign.
            height * end > 0.0 && height.abs() > self.slack(voxel) + facing::error(self.reach())
        } else {
            geometry.sphere(prim).is_some_and(|sphere| facing::leaves(&sphere, ray))
        }
    }
}

/// Where a ray leaves a voxel and its neighbours, with more than rounding to spare.
fn leaves_neighbours(frame: &Frame, voxel: usize, ray: &Ray) -> f32 {
    let place = DVec3::from(frame.coordinates(voxel).map(f64::from));
    let (origin, direction) = (frame.local(ray.origin.as_dvec3()), ray.direction.as_dvec3() * frame.inverse);
    let face = DVec3::select(direction.cmpgt(DVec3::ZERO), place + 2.0 + PADDING, place - 1.0 - PADDING);
    // Infinite, of either sign, along an axis of no movement; the origin is off the face.
    let leave = ((face - origin) / direction).abs().min_element();
    (leave as f32).next_up().min(ray.t_max)
}

impl<G: Geometry> PointShadows for ShadowVoxels<G> {
    fn ask(&self, light: usize, prim: u32, ray: &Ray) -> Shadow {
        let Some(voxel) = self.grid.frame.voxel_at(ray.origin.as_dvec3()) else { return Shadow::Unknown };
        let place = voxel * self.lights.len() + light;
        let state = self.bits[place / 4] >> (place % 4 * 2) & 3;
        if state == 0 {
            return Shadow::Unknown;
        }
        let (end, target) = (ray.at(f64::from(ray.t_max)), &self.lights[light].target);
        let ends = end.cmpge(target.min).all() && end.cmple(target.max).all();
        match state {
            _ if !(ends && ray.t_min == 0.0) => Shadow::Unknown,
            DARK => Shadow::Dark,
            LIT if self.starts_clear(voxel, prim, ray) => Shadow::Lit,
            LIT => Shadow::Unknown,
            _ => Shadow::Until(leaves_neighbours(&self.grid.frame, voxel, ray)),
        }
    }

    fn decided(&self) -> f64 {
        let decided = self.pairs[usize::from(LIT)] + self.pairs[usize::from(DARK)];
        decided as f64 / self.pairs.iter().sum::<u64>().max(1) as f64
    }

    fn memory(&self) -> Memory {
        let mut memory = self.grid.memory();
        memory.tables += self.bits.len() as u64;
        memory
    }

    fn describe(&self) -> String {
        let [x, y, z] = self.grid.frame.resolution;
        let all = self.pairs.iter().sum::<u64>().max(1);
        let share = |state: u8| 100.0 * self.pairs[usize::from(state)] as f64 / all as f64;
        format!(
            "{x} x {y} x {z} voxels, {} lights: of the filled voxels {:.1} % surely lit, {:.1} % surely dark, {:.1} % shaded by \
             neighbours only",
            self.lights.len(),
            share(LIT),
            share(DARK),
            share(NEAR)
        )
    }
}

/// A light with the places where rays to it may end.
fn point_light<G: Geometry>(grid: &Grid<G>, position: DVec3) -> PointLight {
    let frame = &grid.frame;
    let (lo, hi) = (frame.lo, frame.lo + frame.size() / frame.inverse);
    let farthest = (position - lo).abs().max((position - hi).abs());
    // What f64 adds when the end is computed from the ray.
    let rounding = (position.abs() + farthest) * 1e-15;
    let half = farthest * END + rounding;
    let target = Cell { min: position - half, max: position + half };
    PointLight { position, target, local: Cell { min: frame.local(target.min), max: frame.local(target.max) } }
}

#[cfg(test)]
mod tests;
