//! Looking up textures.

use crate::scene::{Filter, Texture};
use glam::{DVec2, DVec3};

impl Texture {
    /// The colour at `uv` of the picture repeated over the plane, linear RGB. Not finite: as 0.
    ///
    /// Row 0 begins at v = 0. The texel count is `width * height`, both above 0.
    pub fn at(&self, uv: DVec2) -> DVec3 {
        let (x, y) = (place(uv.x, self.width), place(uv.y, self.height));
        match self.filter {
            Filter::Nearest => self.texel(x.floor(), y.floor()),
            Filter::Bilinear => {
                let (x, y) = (x - 0.5, y - 0.5);
                let (column, row) = (x.floor(), y.floor());
                let (s, t) = (x - column, y - row);
                let upper = self.texel(column, row).lerp(self.texel(column + 1.0, row), s);
                let lower = self.texel(column, row + 1.0).lerp(self.texel(column + 1.0, row + 1.0), s);
                upper.lerp(lower, t)
            }
        }
    }

    /// A texel by whole numbers from -1 to the size, which wrap around.
    fn texel(&self, column: f64, row: f64) -> DVec3 {
        let (x, y) = (wrap(column, self.width), wrap(row, self.height));
        self.texels[y * self.width as usize + x].as_dvec3()
    }
}

/// Texels from the start of the repetition in which `coordinate` lies, 0 to `size`.
fn place(coordinate: f64, size: u32) -> f64 {
    let fraction = coordinate - coordinate.floor();
    if fraction.is_finite() { fraction * f64::from(size) } else { 0.0 }
}

/// `index`, a whole number from -1 to `size`, as an index below `size`.
fn wrap(index: f64, size: u32) -> usize {
    if index < 0.0 {
        size as usize - 1
    } else {
        // At most `size`, so the cast is exact.
        index as usize % size as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn texture(filter: Filter) -> Texture {
        let texels = (0..6).map(|i| Vec3::splat(i as f32)).collect();
        Texture { name: "ramp".into(), width: 3, height: 2, texels, srgb: false, filter }
    }

    #[test]
    fn texel_centres_lie_half_a_texel_in() {
        for filter in [Filter::Nearest, Filter::Bilinear] {
            for i in 0..6u32 {
                for repeat in [-2.0, 0.0, 5.0] {
                    let u = (f64::from(i % 3) + 0.5) / 3.0 + repeat;
                    let v = (f64::from(i / 3) + 0.5) / 2.0 - repeat;
                    let error = texture(filter).at(DVec2::new(u, v)).x - f64::from(i);
                    // Roundings of u at 5, times 3 texels and a slope of at most 3.
                    assert!(error.abs() < 1e-13, "{filter:?} {i} {repeat} {error}");
                }
            }
        }
    }

    #[test]
    fn between_texels_colours_mix_over_the_seam_too() {
        let bilinear = texture(Filter::Bilinear);
        // Corner of all repetitions: texels 0, 2, 3 and 5.
        assert!((bilinear.at(DVec2::ZERO).x - 2.5).abs() < 1e-15);
        assert!((bilinear.at(DVec2::new(1.0 / 3.0, 0.25)).x - 0.5).abs() < 1e-15);
        assert_eq!(texture(Filter::Nearest).at(DVec2::new(0.999, 0.499)).x, 2.0);
        assert_eq!(bilinear.at(DVec2::new(f64::NAN, f64::INFINITY)), bilinear.at(DVec2::ZERO));
    }
}
