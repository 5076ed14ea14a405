//! Decodes PNG and JPEG images into linear textures, within limits.

use super::budget::Budget;
use super::{Filter, Texture};
use glam::Vec3;
use image::{DynamicImage, ImageFormat, ImageReader, Limits};
use std::io::Cursor;

/// Most pixels on a side, and in all: 64 Mi texels take 768 MiB.
const MAX_SIDE: u32 = 1 << 15;
const MAX_TEXELS: u64 = 1 << 26;
/// Most bytes for a texel while an image is decoded: 8 and 6 of 16 bits a channel, and 12.
const TEXEL_BYTES: u64 = 26;
/// Most bytes that the decoder may allocate.
const MAX_ALLOC: u64 = 1 << 30;

/// As [`decode`], for a texture that stays in the scene.
pub(super) fn keep(bytes: &[u8], name: &str, srgb: bool, filter: Filter, budget: &Budget) -> Result<Texture, String> {
    let texture = decode(bytes, name, srgb, filter, budget)?;
    budget.take_texture(&texture)?;
    Ok(texture)
}

/// Decodes `bytes`; `srgb` says whether values are encoded or linear. The error is the cause alone.
pub(super) fn decode(bytes: &[u8], name: &str, srgb: bool, filter: Filter, budget: &Budget) -> Result<Texture, String> {
    let picture = picture(bytes, budget)?;
    let (width, height) = (picture.width(), picture.height());
    let mut texels = Vec::new();
    let count = u64::from(width) * u64::from(height);
    let count = usize::try_from(count).map_err(|_| format!("{count} pixels"))?;
    texels.try_reserve_exact(count).map_err(|_| format!("no memory for {count} pixels"))?;
    let eight_bits = !has_sixteen_bits(&picture);
    if eight_bits {
        let table: Vec<f32> = (0..=255_u8).map(|v| linear(f64::from(v) / 255.0, srgb)).collect();
        let rgb = picture.into_rgb8();
        texels.extend(rgb.pixels().map(|p| Vec3::from_array(p.0.map(|v| table[usize::from(v)]))));
    } else {
        let rgb = picture.into_rgb16();
        texels.extend(rgb.pixels().map(|p| Vec3::from_array(p.0.map(|v| linear(f64::from(v) / 65535.0, srgb)))));
    }
    Ok(Texture { name: name.to_owned(), width, height, texels, srgb: srgb && eight_bits, filter })
}

/// The mean of all texels, linear RGB.
#[cfg(any(feature = "gltf", test))]
pub(super) fn mean(texture: &Texture) -> Vec3 {
    let sum = texture.texels.iter().fold(glam::DVec3::ZERO, |sum, t| sum + t.as_dvec3());
    (sum / texture.texels.len().max(1) as f64).as_vec3()
}

fn picture(bytes: &[u8], budget: &Budget) -> Result<DynamicImage, String> {
    let open = || ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|e| e.to_string());
    // The others are not compiled in, so `image` names them in its error.
    if open()?.format() == Some(ImageFormat::Hdr) {
        return Err("Radiance HDR is no texture that is read: PNG or JPEG".into());
    }
    let size = open()?.into_dimensions().map_err(|e| e.to_string())?;
    let texels = u64::from(size.0) * u64::from(size.1);
    if size.0 > MAX_SIDE || size.1 > MAX_SIDE || texels > MAX_TEXELS || texels == 0 {
        return Err(format!("{} x {} pixels; 1 to {MAX_SIDE} on a side, {MAX_TEXELS} in all are read", size.0, size.1));
    }
    // Each texel as read, as three colours and as three numbers.
    let wanted = texels * TEXEL_BYTES;
    budget.afford(wanted, || format!("{} x {} pixels", size.0, size.1)).map_err(|e| e.to_string())?;
    let mut reader = open()?;
    let mut limits = Limits::default();
    (limits.max_image_width, limits.max_image_height) = (Some(MAX_SIDE), Some(MAX_SIDE));
    limits.max_alloc = Some(MAX_ALLOC);
    reader.limits(limits);
    reader.decode().map_err(|e| e.to_string())
}

fn has_sixteen_bits(picture: &DynamicImage) -> bool {
    use image::DynamicImage::{ImageLuma16, ImageLumaA16, ImageRgb16, ImageRgba16};
    matches!(picture, ImageLuma16(_) | ImageLumaA16(_) | ImageRgb16(_) | ImageRgba16(_))
}

/// Decodes one value, 0 to 1.
fn linear(v: f64, is_srgb: bool) -> f32 {
    if is_srgb { crate::picture::srgb::decode(v) } else { v as f32 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::LoadOptions;

    fn decode(bytes: &[u8], name: &str, srgb: bool, filter: Filter) -> Result<Texture, String> {
        super::decode(bytes, name, srgb, filter, &Budget::new(&LoadOptions::default()))
    }

    fn png(picture: &DynamicImage) -> Vec<u8> {
        let mut bytes = Vec::new();
        picture.write_to(&mut Cursor::new(&mut bytes), image::ImageFormat::Png).expect("PNG can hold it");
        bytes
    }

    #[test]
    fn eight_and_sixteen_bits_decode_to_linear() {
        let rgb8 = image::RgbImage::from_raw(2, 1, vec![0, 255, 188, 10, 128, 0]).expect("six values");
        let t = decode(&png(&rgb8.into()), "t", true, Filter::Nearest).expect("decodes");
        assert_eq!((t.width, t.height, t.srgb), (2, 1, true));
        // IEC 61966-2-1: 188 is 0.5029, 10 is 10 / 255 / 12.92, 128 is 0.21586.
        for (value, right) in [(t.texels[0].z, 0.502_886), (t.texels[1].x, 0.003_035_27), (t.texels[1].y, 0.215_861)] {
            assert!((value - right).abs() < 1e-5, "{value} {right}");
        }
        let rgb16 = image::ImageBuffer::<image::Rgb<u16>, _>::from_raw(1, 1, vec![65535, 0, 13107]);
        let picture = DynamicImage::ImageRgb16(rgb16.expect("three values"));
        let t = decode(&png(&picture), "t", false, Filter::Nearest).expect("decodes");
        assert_eq!((t.texels[0], t.srgb), (Vec3::new(1.0, 0.0, 0.2), false));
        assert_eq!(mean(&t), t.texels[0]);
    }

    #[test]
    fn what_is_no_image_is_refused() {
        assert!(decode(b"", "t", true, Filter::Nearest).is_err());
        assert!(decode(b"BM no image", "t", true, Filter::Nearest).is_err());
        let radiance = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n\x80\x80\x80\x80";
        assert!(decode(radiance, "t", true, Filter::Nearest).is_err_and(|cause| cause.contains("PNG or JPEG")));
        let whole = png(&image::RgbImage::new(64, 64).into());
        assert!(decode(&whole[..whole.len() / 2], "t", true, Filter::Nearest).is_err());
        // 64 x 64 texels of 26 bytes while they are decoded, of 12 afterwards.
        let budget = Budget::new(&LoadOptions { memory: 64 * 64 * 26, ..LoadOptions::default() });
        assert!(keep(&whole, "t", true, Filter::Nearest, &budget).is_ok());
        let refusal = keep(&whole, "t", true, Filter::Nearest, &budget).expect_err("no room for a second one");
        assert!(refusal.contains("64 x 64 pixels") && refusal.contains("wants 155648 bytes"), "{refusal}");
    }
}
