//! Translation of names of numbers that the libraries refuse to keys of scenes.

use crate::Error;

/// Names of the libraries, and keys of scenes.
pub(super) const KEYS: [(&str, &str); 31] = [
    ("penalty", "contact.penalty"),
    ("friction", "contact.friction"),
    ("wall_friction", "contact.wall-friction"),
    ("rolling_friction", "contact.rolling-friction"),
    ("damping_ratio", "contact.damping"),
    ("tangential_ratio", "contact.tangential-ratio"),
    ("tangential_damping", "contact.tangential-damping"),
    ("cohesion", "contact.cohesion"),
    ("adhesion_energy", "contact.adhesion-energy"),
    ("liquid_bridge.volume", "contact.liquid-bridge.volume"),
    ("liquid_bridge.tension", "contact.liquid-bridge.tension"),
    (
        "liquid_bridge.contact_angle",
        "contact.liquid-bridge.contact-angle",
    ),
    ("time_step.safety", "time-step.safety"),
    ("time_step.largest", "time-step.largest"),
    ("medium.local_damping", "medium.local-damping"),
    ("angular_velocity", "spin"),
    ("yield_stress", "yield-stress"),
    ("step of mass scaling", "mass-scaling"),
    ("drive.velocity", "motion.velocity"),
    ("drive.start", "motion.start"),
    ("drive.end", "motion.end"),
    ("drive.frequency", "motion.frequency"),
    ("drive.interval", "motion.interval"),
    ("drive.axis", "motion.axis"),
    ("drive.point", "motion.point"),
    ("drive.rate", "motion.rate"),
    ("drive.stroke", "motion: the stroke or angle"),
    ("value of a curve", "pressure, or a factor of the table"),
    ("rise of a ramp", "rise"),
    ("Weibull modulus", "fracture.weibull.modulus"),
    ("Weibull volume", "fracture.weibull.volume"),
];

/// The same for the laws of pairs of materials.
pub(super) const OF_PAIRS: [(&str, &str); 12] = [
    ("penalty", "penalty"),
    ("friction", "friction"),
    ("wall_friction", "wall-friction"),
    ("rolling_friction", "rolling-friction"),
    ("damping_ratio", "damping"),
    ("tangential_ratio", "tangential-ratio"),
    ("tangential_damping", "tangential-damping"),
    ("cohesion", "cohesion"),
    ("adhesion_energy", "adhesion-energy"),
    ("liquid_bridge.volume", "liquid-bridge.volume"),
    ("liquid_bridge.tension", "liquid-bridge.tension"),
    ("liquid_bridge.contact_angle", "liquid-bridge.contact-angle"),
];

/// Adds the entry of a scenario to an error.
pub(super) fn in_entry(entry: String) -> impl FnOnce(Error) -> Error {
    |fault| Error::Entry {
        entry,
        fault: Box::new(fault.by_keys(&KEYS)),
    }
}

#[cfg(test)]
mod tests {
    use crate::run::Scenario;

    #[test]
    fn messages_have_the_keys_of_scenes() {
        let base = "[material.clay]\ndensity = 1000\nlaw = \"j2\"\nyoung = 1e6\npoisson = 0.3\n\
                    yield-stress = 5e3\n[[body]]\nblock = [1, 1, 1]\nsides = [1, 1, 1]\n\
                    material = \"clay\"\nbehaviour = \"deformable\"\n";
        let motion = |text: &str| {
            format!("{base}[[wall]]\nplane = {{ normal = [0, 0, 1] }}\nmotion = {{ {text} }}\n")
        };
        for (text, words) in [
            (
                format!("contact.damping = 2\n{base}"),
                "contact.damping = 2 is",
            ),
            (
                format!("contact.wall-friction = -2\n{base}"),
                "contact.wall-friction = -2 is",
            ),
            (
                format!("time-step.safety = 2\n{base}"),
                "time-step.safety = 2 is",
            ),
            (
                format!("medium.local-damping = 2\n{base}"),
                "medium.local-damping = 2 is",
            ),
            (base.replace("= 5e3", "= -5"), "yield-stress = -5 is"),
            (format!("{base}spin = [inf, 0, 0]"), "spin = inf is"),
            (
                motion("linear = { velocity = [0, 0, 1], start = 2, end = 1 }"),
                "motion.end = 1 is",
            ),
            (
                motion("turn = { axis = [0, 0, 0], rate = 1 }"),
                "motion.axis = 0 is",
            ),
            (
                format!("{base}[[body.boundary]]\nselect = \"skin\"\npressure = 1\nrise = -1\n"),
                "rise = -1 is",
            ),
        ] {
            let scenario = Scenario::from_toml(&text).unwrap();
            let message = scenario.build().unwrap_err().to_string();
            assert!(message.contains(words), "{words:?} is not in: {message}");
        }
    }
}
