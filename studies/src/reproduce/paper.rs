//! Published values, and the solids.
//!
//! Table 1 and Figures 1, 6 and 7d are those of J. Xiang, J.-P. Latham and A. Farsi, "Algorithms and
//! capabilities of Solidity to simulate interactions and packing of complex shapes", DEM7 (2016): Table 1
//! as printed, the figures read off their vector drawings (Figure 6 to 0.001, 7d to 0.2 %, 1 to a
//! minute). Dice: J. Baker and A. Kudrolli, Phys. Rev. E 82, 061304 (2010), to 0.01.

/// A solid, with the paper's packing density where it states one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Solid {
    pub(super) name: &'static str,
    /// Volume over d³, d the circumscribed diameter; as in `femdem shapes --json`.
    pub(super) volume: f64,
    /// Table 1: at friction 0.6, "damping coefficient" 0.6 and 2560 kg/m³.
    pub(super) density: Option<f64>,
}

const fn listed(name: &'static str, volume: f64, density: f64) -> Solid {
    Solid {
        name,
        volume,
        density: Some(density),
    }
}

const fn other(name: &'static str, volume: f64) -> Solid {
    Solid {
        name,
        volume,
        density: None,
    }
}

/// The 18 solids: those of Table 1 first.
pub(super) const SOLIDS: [Solid; 18] = [
    listed("P1", 0.064_150_029_909_958_45, 0.52),
    listed("P2", 0.317_018_838_765_051_16, 0.56),
    listed("P3", 0.348_145_482_890_327_65, 0.56),
    listed("P4", 0.166_666_666_666_666_66, 0.55),
    listed("P5", 0.192_450_089_729_875_35, 0.52),
    listed("A1", 0.210_144_270_463_289_82, 0.57),
    listed("A3", 0.406_479_203_143_030_4, 0.55),
    listed("A5", 0.467_224_919_879_047_85, 0.57),
    listed("A7", 0.419_714_736_761_285, 0.56),
    listed("A10", 0.405_979_339_202_952_3, 0.54),
    listed("A13", 0.357_770_876_399_966_4, 0.56),
    other("A2", 0.454_176_920_592_916_3),
    other("A4", 0.469_290_905_701_691_1),
    other("A6", 0.470_214_660_967_391_3),
    other("A8", 0.408_265_578_177_034_96),
    other("A9", 0.397_839_627_058_174_1),
    other("A11", 0.294_627_825_494_394_7),
    other("A12", 0.302_022_631_679_472_13),
];

/// Error of a density printed with two digits: the standard deviation of its rounding.
pub(super) const ROUNDING: f64 = 0.002_9;

/// Figure 6: friction coefficient and packing density of A1.
pub(super) const FIGURE6: [(f64, f64); 5] = [
    (0.2, 0.6679),
    (0.4, 0.6082),
    (0.6, 0.5743),
    (0.8, 0.5256),
    (1.0, 0.4981),
];

/// Error of reading Figure 6.
pub(super) const FIGURE6_ERROR: f64 = 0.001;

/// Figure 7d: bodies by their number of contacts, 0 to 10.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Contacts {
    pub(super) name: &'static str,
    /// Percent of the bodies.
    pub(super) percent: [f64; 11],
    /// The stated mean.
    pub(super) mean: f64,
}

pub(super) const FIGURE7: [Contacts; 3] = [
    Contacts {
        name: "A5",
        percent: [0.0, 0.0, 2.0, 11.7, 23.9, 30.2, 21.5, 9.0, 1.8, 0.2, 0.0],
        mean: 4.92,
    },
    Contacts {
        name: "A10",
        percent: [0.0, 0.0, 2.9, 15.7, 29.0, 29.8, 17.0, 4.9, 0.5, 0.0, 0.0],
        mean: 4.59,
    },
    Contacts {
        name: "P3",
        percent: [0.0, 0.0, 1.5, 6.8, 17.5, 27.9, 26.6, 14.6, 4.6, 0.5, 0.0],
        mean: 5.36,
    },
];

/// Figure 1: threads and minutes, 288 deformable rocks. The older serial code took 202 minutes.
pub(super) const FIGURE1: [(f64, f64); 5] = [
    (1.0, 93.2),
    (2.0, 47.5),
    (4.0, 26.3),
    (8.0, 15.0),
    (12.0, 11.6),
];

/// The speedups that the paper's text states: 8 and 12 threads.
pub(super) const FIGURE1_TEXT: [(f64, f64); 2] = [(8.0, 6.5), (12.0, 9.0)];

/// Random packs of plastic dice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Dice {
    pub(super) name: &'static str,
    pub(super) loose: f64,
    pub(super) close: f64,
}

const fn dice(name: &'static str, loose: f64, close: f64) -> Dice {
    Dice { name, loose, close }
}

pub(super) const DICE: [Dice; 5] = [
    dice("P1", 0.51, 0.64),
    dice("P5", 0.54, 0.67),
    dice("P4", 0.52, 0.64),
    dice("P3", 0.51, 0.63),
    dice("P2", 0.50, 0.59),
];

/// Error of the densities of dice.
pub(super) const DICE_ERROR: f64 = 0.01;

/// The solid of a name.
pub(super) fn solid(name: &str) -> Option<&'static Solid> {
    SOLIDS.iter().find(|solid| solid.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Volumes by edge a and circumradius of textbooks, for solids of edge 1.
    #[test]
    fn volumes_are_those_of_textbooks() {
        let root = f64::sqrt;
        let golden = 0.5 * (1.0 + root(5.0));
        let forms = [
            ("P1", 1.0 / (6.0 * root(2.0)), root(6.0) / 4.0),
            ("P4", root(2.0) / 3.0, root(0.5)),
            ("P5", 1.0, 0.5 * root(3.0)),
            (
                "P3",
                (15.0 + 7.0 * root(5.0)) / 4.0,
                0.5 * root(3.0) * golden,
            ),
            (
                "P2",
                5.0 * (3.0 + root(5.0)) / 12.0,
                0.5 * root(golden * root(5.0)),
            ),
            ("A1", 23.0 * root(2.0) / 12.0, root(22.0) / 4.0),
            (
                "A10",
                5.0 * (99.0 + 47.0 * root(5.0)) / 12.0,
                root(74.0 + 30.0 * root(5.0)) / 4.0,
            ),
            ("A11", 5.0 * root(2.0) / 3.0, 1.0),
            ("A13", 8.0 * root(2.0), root(10.0) / 2.0),
            (
                "A7",
                22.0 + 14.0 * root(2.0),
                root(13.0 + 6.0 * root(2.0)) / 2.0,
            ),
        ];
        for (name, volume, radius) in forms {
            let found = solid(name).unwrap().volume;
            let wanted = volume / (2.0 * radius).powi(3);
            assert!((found - wanted).abs() < 1e-12, "{name}: {found} {wanted}");
        }
    }

    #[test]
    fn eleven_solids_are_listed_and_every_name_is_there_once() {
        let names: std::collections::BTreeSet<_> = SOLIDS.iter().map(|s| s.name).collect();
        assert_eq!(names.len(), 18);
        assert_eq!(SOLIDS.iter().filter(|s| s.density.is_some()).count(), 11);
    }

    /// The digitised bars add up, and have the means that the paper states.
    #[test]
    fn histograms_agree_with_their_means() {
        for Contacts {
            name,
            percent,
            mean,
        } in FIGURE7
        {
            let sum: f64 = percent.iter().sum();
            assert!((sum - 100.0).abs() < 0.5, "{name}: {sum}");
            let weighed: f64 = (0..).zip(percent).map(|(k, p)| f64::from(k) * p).sum();
            assert!(
                (weighed / sum - mean).abs() < 0.02,
                "{name}: {}",
                weighed / sum
            );
        }
    }
}
