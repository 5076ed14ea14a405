//! POV-Ray 3.7.

use super::output;
use crate::converge::run::Shot;
use crate::error::{Error, Result};
use crate::measure::wall_seconds;
use crate::picture::{Picture, io};
use std::path::Path;
use std::process::{Command, Stdio};

pub(super) fn version() -> std::result::Result<String, String> {
    let done = Command::new("povray").arg("--version").stdin(Stdio::null()).output();
    let done = done.map_err(|e| format!("povray: {e}"))?;
    // The version may be on either stream, and beside a remark on a missing file of settings.
    let words = [done.stdout, done.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).concat();
    let line = words.lines().find(|line| line.starts_with("POV-Ray"));
    line.map(|line| line.trim().to_string()).ok_or_else(|| "povray does not tell its version".to_string())
}

/// Renders a picture n times as wide and high, whose n x n points are averaged for every pixel. EXR, since its half
/// floats do not end at 1; they are 2^-11 apart. Its time cannot be told from that of reading the scene: all is tracing.
pub(super) fn render(file: &Path, samples: u32, (width, height): (u32, u32)) -> Result<Shot> {
    let grid = samples.isqrt();
    let wide = |side: u32| {
        side.checked_mul(grid)
            .ok_or_else(|| Error::invalid(format!("{grid} x {grid} points in {side} pixels are too many")))
    };
    let (wide, high) = (wide(width)?, wide(height)?);
    let folder = file.parent().unwrap_or(Path::new("."));
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    let mut command = Command::new("povray");
    command.current_dir(folder).arg(format!("+I{name}")).arg("+Opovray.exr").args(["+FE", "File_Gamma=1.0"]);
    command.arg(format!("+W{wide}")).arg(format!("+H{high}")).args(["-D", "-A", "-GA", "Verbose=off", "+WT1"]);
    let start = wall_seconds();
    output(&mut command)?;
    let trace = wall_seconds() - start;
    let points = io::read(folder.join("povray.exr"))?;
    if (points.width, points.height) != (wide, high) {
        let (w, h) = (points.width, points.height);
        return Err(Error::malformed(folder.join("povray.exr"), format!("is {w} x {h} instead of {wide} x {high}")));
    }
    Ok(Shot { halves: vec![averaged(&points, grid)], build: 0.0, trace, wall: trace })
}

/// The means of squares of `grid` x `grid` points, which the picture's sides are multiples of.
fn averaged(points: &Picture, grid: u32) -> Picture {
    let (width, height) = (points.width / grid, points.height / grid);
    let mut picture = Picture::new(width, height);
    let (columns, n) = (points.width as usize, grid as usize);
    for (i, pixel) in picture.pixels.iter_mut().enumerate() {
        let (x, y) = (i % width as usize, i / width as usize);
        let mut sum = [0.0f64; 3];
        for row in y * n..(y + 1) * n {
            for point in &points.pixels[row * columns + x * n..][..n] {
                (0..3).for_each(|c| sum[c] += f64::from(point[c]));
            }
        }
        *pixel = sum.map(|s| (s / f64::from(grid * grid)) as f32);
    }
    picture
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_averaged_pixel_by_pixel() {
        let pixels = (0..8).map(|i| [i as f32, 0.0, 1.0]).collect();
        let small = averaged(&Picture { width: 4, height: 2, pixels }, 2);
        assert_eq!(small, Picture { width: 2, height: 1, pixels: vec![[2.5, 0.0, 1.0], [4.5, 0.0, 1.0]] });
    }
}
