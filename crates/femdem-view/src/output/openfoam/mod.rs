//! A case of OpenFOAM for the flow through the void of a pack: what its programs `blockMesh`, `snappyHexMesh` and
//! `simpleFoam` ask for beside the surfaces.

mod case;
mod dictionary;
mod flow;
mod mesh;

pub use case::{CasePatch, FlowCase, PatchKind};

use dictionary::dictionary;

impl FlowCase {
    /// The files of the case except the surfaces, which belong into `constant/triSurface`, as path within it and
    /// contents.
    #[must_use]
    pub fn files(&self) -> Vec<(&'static str, String)> {
        vec![
            ("system/blockMeshDict", self.blocks()),
            ("system/snappyHexMeshDict", self.snappy()),
            ("system/controlDict", self.control()),
            ("system/fvSchemes", dictionary("fvSchemes", flow::SCHEMES)),
            (
                "system/fvSolution",
                dictionary("fvSolution", flow::SOLUTION),
            ),
            ("system/fvOptions", self.drive()),
            ("constant/transportProperties", self.fluid()),
            (
                "constant/turbulenceProperties",
                dictionary("turbulenceProperties", flow::LAMINAR),
            ),
            ("0/U", self.velocities()),
            ("0/p", self.pressures()),
        ]
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use femdem_analysis::Region;
    use femdem_mesh::Point3;

    use super::*;

    /// A case with walls or open sides, and with sides that repeat themselves.
    fn case(side: (&str, PatchKind), repeats: [bool; 3]) -> FlowCase {
        let all = [
            (("bodies", PatchKind::Bodies), true),
            (side, !(repeats[0] && repeats[1])),
            (("inlet", PatchKind::Inlet), !repeats[2]),
            (("outlet", PatchKind::Outlet), !repeats[2]),
        ];
        let patches = all.into_iter().filter(|(_, is_there)| *is_there);
        FlowCase {
            region: Region::Box {
                min: Point3::origin(),
                max: Point3::new(0.5, 0.25, 2.0),
            },
            repeats,
            patches: patches
                .map(|((name, kind), _)| CasePatch {
                    name: name.to_owned(),
                    kind,
                })
                .collect(),
            inside: Point3::new(0.2, 0.1, 1.5),
            cell: 0.1,
            level: 1,
            velocity: 0.5,
            viscosity: 1e-6,
            porosity: 0.4,
        }
    }

    /// Entries of a file that are a name with something in braces on one line.
    fn entries(text: &str) -> BTreeMap<&str, &str> {
        let lines = text.lines().map(str::trim);
        let parts = lines.filter_map(|line| line.strip_suffix('}')?.split_once('{'));
        parts
            .map(|(name, rest)| (name.trim(), rest.trim()))
            .collect()
    }

    fn combinations() -> impl Iterator<Item = FlowCase> {
        let sides = [("wall", PatchKind::Wall), ("sides", PatchKind::Slip)];
        let repeats = (0..8).map(|bits| [1, 2, 4].map(|bit| bits & bit != 0));
        repeats.flat_map(move |repeats| sides.map(|side| case(side, repeats)))
    }

    #[test]
    fn the_fields_have_a_condition_for_every_patch_of_the_mesh_and_no_other() {
        for case in combinations() {
            let files: BTreeMap<_, _> = case.files().into_iter().collect();
            let [blocks, snappy] = ["blockMeshDict", "snappyHexMeshDict"]
                .map(|name| entries(&files[format!("system/{name}").as_str()]));
            // The surfaces have levels, and of the block only the sides that repeat are left.
            let cut = snappy.iter().filter(|(_, text)| text.contains("patchInfo"));
            let repeated = blocks.iter().filter(|(_, text)| text.contains("cyclic"));
            let mut of_mesh: Vec<&str> =
                cut.chain(repeated.clone()).map(|(name, _)| *name).collect();
            of_mesh.sort_unstable();
            let count = case.repeats.iter().filter(|repeats| **repeats).count();
            assert_eq!(repeated.clone().count(), 2 * count);
            for field in ["0/U", "0/p"] {
                let fields = entries(&files[field]);
                assert!(
                    fields.keys().eq(&of_mesh),
                    "{field}: {fields:?} {of_mesh:?}"
                );
                for (name, text) in &fields {
                    assert_eq!(
                        text.contains("cyclic"),
                        repeated.clone().any(|(of_block, _)| of_block == name)
                    );
                }
            }
            for (name, text) in repeated {
                let (_, other) = text.split_once("neighbourPatch ").unwrap();
                let (other, _) = other.split_once(';').unwrap();
                assert!(other != *name && blocks[other].contains(name));
            }
            // What is measured is there.
            let of_inlet = files["system/controlDict"].contains("name inlet;");
            assert_eq!(of_inlet, of_mesh.contains(&"inlet"));
            let is_driven = files["system/fvOptions"].contains("Ubar (0 0 1.25);");
            assert_eq!(is_driven, !of_inlet);
        }
    }

    #[test]
    fn the_files_have_heads_and_are_balanced() {
        for case in combinations() {
            for (name, text) in case.files() {
                for [open, close] in [['{', '}'], ['(', ')']] {
                    let count = |c: char| text.matches(c).count();
                    assert_eq!(count(open), count(close), "{name}");
                }
                let (_, object) = name.rsplit_once('/').unwrap();
                assert!(
                    text.starts_with("FoamFile\n{") && text.contains(&format!("object {object};"))
                );
                // Every line ends an entry, opens or closes a list, or is a name or a comment.
                for line in text.lines().filter(|line| line.contains(' ')) {
                    let line = line.trim();
                    let ends = [';', '}', ')'].iter().any(|end| line.ends_with(*end));
                    assert!(
                        ends || !line.contains(' ') || line.starts_with("//"),
                        "{name}: {line}"
                    );
                }
            }
        }
    }

    #[test]
    fn the_inlet_has_the_superficial_velocity_over_the_whole_section() {
        let case = case(("wall", PatchKind::Wall), [false; 3]);
        // 0.5 m/s over 0.5 m x 0.25 m.
        assert!(case.velocities().contains("volumetricFlowRate 0.0625;"));
        assert!(case.fluid().contains("nu [0 2 -1 0 0 0 0] 0.000001;"));
    }
}
