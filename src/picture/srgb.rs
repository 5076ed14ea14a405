//! The sRGB transfer function, IEC 61966-2-1.

/// Linear light of an sRGB value; 0 to 1 becomes 0 to 1. Computed in f64. The curve goes on above 1, its straight part
/// below 0; NaN stays NaN.
pub fn decode(value: f64) -> f32 {
    let light = if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) };
    light as f32
}

/// sRGB value of linear light; 0 to 1 becomes 0 to 1. Computed in f64. The curve goes on above 1, its straight part
/// below 0; NaN stays NaN.
pub fn encode(light: f32) -> f32 {
    let light = f64::from(light);
    let value = if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 };
    value as f32
}

/// sRGB value of linear light in 8 bits, nearest; clamped to 0..1, NaN becomes 0.
pub fn to_byte(light: f32) -> u8 {
    let clamped = if light.is_nan() { 0.0 } else { light.clamp(0.0, 1.0) };
    (encode(clamped) * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_survive_the_round_trip() {
        for byte in 0..=255u8 {
            assert_eq!(to_byte(decode(f64::from(byte) / 255.0)), byte);
        }
        assert_eq!([f32::NAN, -1.0, f32::INFINITY].map(to_byte), [0, 0, 255]);
        // Middle grey of the standard: linear 0.2140 is 0.5 encoded.
        assert!((decode(0.5) - 0.214_041).abs() < 1e-6);
    }
}
