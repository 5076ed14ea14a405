//! The branchless listing of the DDA article as printed, in two dimensions, and in the form that is right.

use crate::random::Random;
use glam::DVec2;

/// A walk by the listing, in f64. It is wrong where the article is: see the tests of [`super::dda`]'s claims.
#[derive(Clone, Copy, Debug)]
pub struct Printed {
    direction: DVec2,
    step: DVec2,
    size: DVec2,
    next: DVec2,
    /// The voxel, by whole numbers.
    pub voxel: DVec2,
    /// `currPos`, which accumulates distances from the origin as if they were distances from the last position.
    pub position: DVec2,
    /// The normal; of length 0, 1 or the root of 2.
    pub normal: DVec2,
    /// Where the ray really is after the same crossing: `origin + direction * closest`.
    pub right: DVec2,
    origin: DVec2,
}

impl Printed {
    /// The listing's set-up without branches: `nextDist = (sign 0.5 + 0.5 - fract(origin)) / direction`.
    pub fn new(origin: DVec2, direction: DVec2) -> Self {
        // As in shaders: the sign of 0 is 0.
        let step = DVec2::from(direction.to_array().map(|x| if x == 0.0 { 0.0 } else { x.signum() }));
        let next = (step * 0.5 + 0.5 - (origin - origin.floor())) / direction;
        let (size, voxel) = (1.0 / direction.abs(), origin.floor());
        Self { direction, step, size, next, voxel, position: origin, normal: DVec2::ZERO, right: origin, origin }
    }

    /// The listing's loop, once.
    pub fn step(&mut self) {
        // As in shaders: min(x, y) is y if y < x, else x.
        let closest = if self.next.y < self.next.x { self.next.y } else { self.next.x };
        let mask = DVec2::from(self.next.to_array().map(|t| f64::from(u8::from(t <= closest))));
        self.voxel += mask * self.step;
        self.position += self.direction * closest;
        self.right = self.origin + self.direction * closest;
        self.next += self.size * mask;
        self.normal = -mask * self.step;
    }
}

/// How many of `count` rays along x from random origins do not leave their voxel in the first step.
pub fn stalled(count: u32, seed: u64) -> u32 {
    let mut random = Random::new(seed);
    let stalls = (0..count).filter(|_| {
        let origin = DVec2::new(random.within(-4.0, 4.0), random.within(-4.0, 4.0));
        let mut walk = Printed::new(origin, DVec2::X);
        walk.step();
        walk.voxel == origin.floor()
    });
    stalls.count() as u32
}

/// Of `steps` steps along the diagonal from a voxel's middle, those that cross two planes at once.
pub fn double_steps(steps: u32) -> u32 {
    let mut walk = Printed::new(DVec2::splat(0.5), DVec2::ONE);
    let double = (0..steps).filter(|_| {
        walk.step();
        walk.normal.abs() == DVec2::ONE
    });
    double.count() as u32
}
