//! Colours: a perceptually uniform map, and conversions between light and screen.

use std::fmt;

/// Red, green, blue as amounts of light (linear), 0 to 1.
pub(super) type Light = [f32; 3];

/// Viridis at 0, 0.1, ..., 1 (S. van der Walt and N. Smith, 2015, for matplotlib; public domain, CC0).
const VIRIDIS: [u32; 11] = [
    0x44_01_54, 0x48_24_75, 0x41_44_87, 0x35_5f_8d, 0x2a_78_8e, 0x21_91_8c, 0x22_a8_84, 0x44_bf_70,
    0x7a_d1_51, 0xbd_df_26, 0xfd_e7_25,
];

/// An opaque colour of the screen (sRGB).
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) struct Srgb(pub [u8; 3]);

impl fmt::Debug for Srgb {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [r, g, b] = self.0;
        write!(f, "#{r:02x}{g:02x}{b:02x}")
    }
}

impl Srgb {
    fn hex(code: u32) -> Self {
        let [_, r, g, b] = code.to_be_bytes();
        Self([r, g, b])
    }

    /// The corresponding amount of light.
    pub fn to_light(self) -> Light {
        self.0.map(|byte| {
            let value = f32::from(byte) / 255.0;
            if value <= 0.040_45 {
                value / 12.92
            } else {
                ((value + 0.055) / 1.055).powf(2.4)
            }
        })
    }

    /// The colour that shows an amount of light, clipped to the range of a screen.
    pub fn of_light(light: Light) -> Self {
        Self(light.map(|value| {
            let value = value.clamp(0.0, 1.0);
            let shown = if value <= 0.003_130_8 {
                12.92 * value
            } else {
                1.055 * value.powf(1.0 / 2.4) - 0.055
            };
            (shown * 255.0).round() as u8
        }))
    }

    /// A colour between two, at `amount` 0 to 1 of the way to the other.
    pub fn towards(self, other: Self, amount: f32) -> Self {
        let mix = |k: usize| {
            let (a, b) = (f32::from(self.0[k]), f32::from(other.0[k]));
            (a + (b - a) * amount).round() as u8
        };
        Self([mix(0), mix(1), mix(2)])
    }
}

/// The colour of `value`, 0 to 1, from dark violet over green to yellow.
pub(super) fn viridis(value: f64) -> Srgb {
    let at = if value.is_finite() {
        value.clamp(0.0, 1.0) * 10.0
    } else {
        0.0
    };
    let low = (at as usize).min(9);
    Srgb::hex(VIRIDIS[low]).towards(Srgb::hex(VIRIDIS[low + 1]), (at - low as f64) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_map_ends_where_viridis_ends_and_brightens_all_the_way() {
        assert_eq!(
            format!("{:?} {:?}", viridis(0.0), viridis(1.0)),
            "#440154 #fde725"
        );
        let luminance = |value: f64| {
            let [r, g, b] = viridis(value).to_light();
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        assert!(
            (0..50).all(|i| luminance(f64::from(i) / 50.0) < luminance(f64::from(i + 1) / 50.0))
        );
    }

    #[test]
    fn light_and_screen_are_inverse() {
        for byte in 0..=255 {
            assert_eq!(Srgb::of_light(Srgb([byte; 3]).to_light()), Srgb([byte; 3]));
        }
    }

    #[test]
    fn values_out_of_range_are_clipped() {
        assert_eq!(viridis(-1.0), viridis(0.0));
        assert_eq!(viridis(7.0), viridis(1.0));
        assert_eq!(viridis(f64::NAN), viridis(0.0));
    }
}
