//! A run of `femdem pack` by its options, and the sizes of runs.

use std::fmt::Write;

use super::Scale;

/// A pack to be made, without its number of threads, which does not change the result.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Job {
    /// Options of `femdem pack`, without threads and folder.
    pub(super) options: String,
    pub(super) bodies: u32,
}

/// Number of bodies, width of the square box and inset of the core.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Size {
    pub(super) bodies: u32,
    /// In d.
    pub(super) width: f64,
    /// In d.
    pub(super) inset: f64,
}

/// A kind of pack used in the studies of the paper's packs.
#[derive(Debug, Clone, Copy)]
pub(super) struct Kind {
    pub(super) name: &'static str,
    /// Size by volume over d³.
    pub(super) size: fn(f64) -> Size,
    /// Seeds 1 to this.
    pub(super) seeds: u32,
}

/// Packs as large as the paper's, and small ones with several seeds; for a trial, very small ones.
pub(super) fn kinds(scale: Scale) -> Vec<Kind> {
    let kind = |name, size, seeds| Kind { name, size, seeds };
    match scale {
        Scale::Quick => vec![kind("quick", Size::quick as fn(f64) -> Size, 1)],
        Scale::Full => vec![
            kind("full-size", Size::full, 1),
            kind("small", Size::small, 3),
        ],
    }
}

/// Packing density from which numbers and boxes are computed: few packs are denser.
const DENSITY: f64 = 0.62;

impl Size {
    /// As in the paper: about 11,000 bodies and a core 5 d from walls, floor and top. The box is 14 to 20
    /// d wide; where 11,000 bodies would not fill it to 16 d, there are more of them.
    pub(super) fn full(volume: f64) -> Self {
        let height = 16.0;
        let width = tenths((11_000.0 * volume / (DENSITY * height)).sqrt()).clamp(14.0, 20.0);
        let filled = DENSITY * width * width * height / volume;
        Self {
            bodies: ((filled / 100.0).ceil() * 100.0).max(11_000.0) as u32,
            width,
            inset: 5.0,
        }
    }

    /// `least` bodies in a box as wide as the pack is high, but not narrower than `narrowest`: more bodies if
    /// they are needed to fill it.
    pub(super) fn cube(volume: f64, least: f64, narrowest: f64, inset: f64) -> Self {
        let width = tenths((least * volume / DENSITY).cbrt()).max(narrowest);
        let filled = DENSITY * width.powi(3) / volume;
        Self {
            bodies: ((filled / 10.0).ceil() * 10.0).max(least) as u32,
            width,
            inset,
        }
    }

    /// About 900 bodies.
    pub(super) fn small(volume: f64) -> Self {
        Self::cube(volume, 900.0, 7.0, 2.0)
    }

    /// About 120 bodies, for a trial of the command.
    pub(super) fn quick(volume: f64) -> Self {
        Self::cube(volume, 120.0, 3.1, 0.8)
    }

    /// The options for a shape at a friction coefficient, with a seed and more options.
    pub(super) fn job(&self, shape: &str, friction: f64, seed: u32, more: &str) -> Job {
        let Self { bodies, width, .. } = *self;
        let options = format!(
            "--shape {shape} --count {bodies} --box {width}x{width} --friction {friction} --seed {seed} {more}"
        );
        Job {
            options: options.trim_end().to_owned(),
            bodies,
        }
    }
}

fn tenths(value: f64) -> f64 {
    (10.0 * value).round() / 10.0
}

impl Job {
    /// The name of the folder: the options in short, and a fingerprint of their text.
    pub(super) fn key(&self) -> String {
        let mut name = String::new();
        for word in self.options.split_whitespace() {
            let word = word.strip_prefix("--").map_or(word, |option| {
                name.push('_');
                option
            });
            name.extend(word.chars().map(|c| {
                if c.is_ascii_alphanumeric() || c == '.' {
                    c
                } else {
                    '-'
                }
            }));
        }
        name.truncate(120);
        let _ = write!(name, "_{:08x}", fingerprint(&self.options));
        name.trim_start_matches('_').to_owned()
    }
}

/// FNV-1a, folded to 32 bits.
pub(super) fn fingerprint(text: &str) -> u32 {
    let hash = text.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    });
    (hash ^ (hash >> 32)) as u32
}

#[cfg(test)]
mod tests {
    use super::super::paper::{SOLIDS, solid};
    use super::*;

    #[test]
    fn keys_are_readable_and_differ_with_every_option() {
        let size = Size {
            bodies: 900,
            width: 8.5,
            inset: 2.0,
        };
        let key = |friction, seed, more| size.job("A10", friction, seed, more).key();
        let one = key(0.6, 1, "");
        assert!(
            one.starts_with("shapeA10_count900_box8.5x8.5_friction0.6_seed1_"),
            "{one}"
        );
        assert_eq!(one, key(0.6, 1, ""));
        for other in [
            key(0.4, 1, ""),
            key(0.6, 2, ""),
            key(0.6, 1, "--drag 0.6/fall"),
        ] {
            assert_ne!(one, other);
        }
        // Options that are alike but for a sign that is dropped.
        let job = |options: &str| Job {
            options: options.to_owned(),
            bodies: 1,
        };
        assert_ne!(job("--shape a:b").key(), job("--shape a,b").key());
        assert!(job("--shape ../x").key().chars().all(|c| c != '/'));
    }

    /// Even a dense pack leaves a core of 3 d.
    #[test]
    fn full_packs_have_a_core_five_diameters_away() {
        for solid in SOLIDS {
            let size = Size::full(solid.volume);
            let high =
                |density| f64::from(size.bodies) * solid.volume / (density * size.width.powi(2));
            assert!(
                size.width >= 14.0 && size.bodies >= 11_000,
                "{solid:?} {size:?}"
            );
            assert!(
                high(0.62) >= 15.9 && high(0.74) > 13.0,
                "{solid:?} {size:?}"
            );
            assert!(size.bodies < 11_100 || size.width <= 14.0 || high(0.62) < 16.5);
        }
        let a10 = Size::full(solid("A10").unwrap().volume);
        assert_eq!((a10.bodies, a10.width), (11_000, 20.0));
    }

    #[test]
    fn small_packs_are_as_high_as_wide() {
        for solid in SOLIDS {
            for size in [Size::small(solid.volume), Size::quick(solid.volume)] {
                let high = f64::from(size.bodies) * solid.volume / (DENSITY * size.width.powi(2));
                assert!(
                    (high / size.width - 1.0).abs() < 0.1,
                    "{solid:?} {size:?} {high}"
                );
                assert!(size.width - 2.0 * size.inset >= 1.5);
            }
        }
        assert_eq!(Size::small(0.4).bodies, 900);
        assert!(Size::small(0.064).bodies > 3000);
    }
}
