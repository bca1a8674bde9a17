//! Interpretations ("readings") of the paper's protocol and its "damping coefficient 0.6".

/// A reading, with one set of options for all shapes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Reading {
    /// Name in tables and files.
    pub(super) key: &'static str,
    pub(super) meaning: &'static str,
    /// Options of `femdem pack` in addition to shape, number, box, friction and seed.
    pub(super) options: &'static str,
}

/// The readings; the first is the program's default.
pub(super) const READINGS: [Reading; 4] = [
    Reading {
        key: "contact",
        meaning: "dashpot of the normal contact alone, 0.6 of critical; bodies in sequence",
        options: "",
    },
    Reading {
        key: "drag",
        meaning: "the same, and a drag on all motion at the rate 0.6 sqrt(g/d)",
        options: "--drag 0.6/fall",
    },
    Reading {
        key: "local",
        meaning: "Cundall's local damping 0.6 instead of the dashpot; packs that ring on in the verification, where it \
                  is off, do not count",
        options: "--damping 0 --local-damping 0.6",
    },
    Reading {
        key: "release",
        meaning: "dashpot of the contact alone; all bodies released at once, at the penetration of the others",
        options: "--protocol release --penetration 0.0035 --explicit",
    },
];

/// The lines of a page that explain them.
pub(super) fn explained() -> String {
    let line = |r: &Reading| {
        let options = match r.options {
            "" => "no options".to_owned(),
            options => format!("`{options}`"),
        };
        format!("- **{}** ({options}): {}\n", r.key, r.meaning)
    };
    READINGS.iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_reading_differs_and_is_explained() {
        let text = explained();
        for (i, a) in READINGS.iter().enumerate() {
            assert!(text.contains(&format!("**{}**", a.key)));
            for b in READINGS.iter().skip(i + 1) {
                assert!(a.key != b.key && a.options != b.options, "{a:?} {b:?}");
            }
        }
        assert!(READINGS[0].options.is_empty());
    }
}
