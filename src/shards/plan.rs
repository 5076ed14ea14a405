//! How a picture is cut into shards.

use super::Place;
use crate::error::{Error, Result};
use crate::render::Crop;

/// Most shards of a plan: one line each.
pub const MAX_SHARDS: u64 = 1_000_000;

/// Tiles of `tile` columns and rows, row by row from the corner of `area`, smaller at its far edges; of each tile, ranges of
/// `samples` of its `total` samples, the last one smaller.
///
/// # Errors
/// A length is 0, or there are more than [`MAX_SHARDS`].
pub fn places(area: Crop, tile: (u32, u32), samples: u32, total: u32) -> Result<Vec<Place>> {
    let (width, height) = tile;
    if [width, height, samples, total, area.width, area.height].contains(&0) {
        return Err(Error::invalid(format!(
            "a tile of {width}x{height} pixels with {samples} of {total} samples is empty"
        )));
    }
    let counts = [area.width.div_ceil(width), area.height.div_ceil(height), total.div_ceil(samples)];
    let wanted = counts.iter().fold(1u64, |product, &n| product.saturating_mul(n.into()));
    if wanted > MAX_SHARDS {
        let [columns, rows, ranges] = counts;
        return Err(Error::invalid(format!(
            "{columns} x {rows} tiles with {ranges} ranges of samples each are {wanted} shards, at most {MAX_SHARDS}"
        )));
    }
    let [columns, rows, ranges] = counts;
    let place = |row: u32, column: u32, range: u32| {
        let (x, y, first) = (column * width, row * height, range * samples);
        let tile = Crop {
            x: area.x + x,
            y: area.y + y,
            width: width.min(area.width - x),
            height: height.min(area.height - y),
        };
        Place { tile, samples: first..first + samples.min(total - first) }
    };
    let tiles = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
    Ok(tiles.flat_map(|(row, column)| (0..ranges).map(move |range| place(row, column, range))).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_sample_of_every_pixel_is_in_one_shard() {
        let area = Crop { x: 3, y: 5, width: 10, height: 7 };
        for (tile, samples) in [((4, 3), 2), ((10, 7), 5), ((1, 1), 1), ((64, 64), 64)] {
            let mut counts = vec![0; 10 * 7 * 5];
            for Place { tile, samples } in places(area, tile, samples, 5).expect("few") {
                for y in tile.y..tile.y + tile.height {
                    for x in tile.x..tile.x + tile.width {
                        samples.clone().for_each(|s| counts[(((y - 5) * 10 + x - 3) * 5 + s) as usize] += 1);
                    }
                }
            }
            assert!(counts.iter().all(|&n| n == 1), "{tile:?} {samples}");
        }
        assert!(places(area, (0, 4), 1, 5).is_err());
        let large = Crop { x: 0, y: 0, width: 1 << 14, height: 1 << 14 };
        let message = places(large, (1, 1), 1, 16).expect_err("too many").to_string();
        assert!(message.contains("4294967296 shards, at most 1000000"), "{message}");
    }
}
