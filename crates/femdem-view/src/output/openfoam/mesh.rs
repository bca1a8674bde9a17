//! Dictionaries of `blockMesh` and `snappyHexMesh`.

use std::fmt::Write as _;

use femdem_mesh::{Point3, Vector3};

use super::case::{FlowCase, PAIRS, PatchKind};
use super::dictionary::dictionary;

/// Faces of the block by its vertices: the lower and the upper one along each axis.
const FACES: [[&str; 2]; 3] = [
    ["(0 4 7 3)", "(1 2 6 5)"],
    ["(0 1 5 4)", "(2 3 7 6)"],
    ["(0 3 2 1)", "(4 5 6 7)"],
];

impl FlowCase {
    /// `system/blockMeshDict`: a block a little larger than the region, so that no surface lies in its sides; along
    /// axes that repeat themselves exactly as long.
    pub(super) fn blocks(&self) -> String {
        let (low, high) = self.region.corners();
        let along = |k: usize| {
            let length = high[k] - low[k];
            if self.repeats[k] {
                // No cell is its own neighbour.
                return ((length / self.cell).round().max(2.0) as u64, 0.0);
            }
            let count = (length / self.cell).ceil() as u64 + 2;
            (count, 0.5 * (count as f64 * self.cell - length))
        };
        let [(nx, x), (ny, y), (nz, z)] = [0, 1, 2].map(along);
        let margin = Vector3::new(x, y, z);
        let [a, b] = [low - margin, high + margin];
        let mut vertices = String::new();
        for z in [a.z, b.z] {
            for [x, y] in [[a.x, a.y], [b.x, a.y], [b.x, b.y], [a.x, b.y]] {
                // Writing to a string cannot fail.
                let _ = writeln!(vertices, "    ({x} {y} {z})");
            }
        }
        let mut repeated = String::new();
        let mut others = String::new();
        for ((names, faces), repeats) in PAIRS.into_iter().zip(FACES).zip(self.repeats) {
            for (side, face) in faces.into_iter().enumerate() {
                let _ = if repeats {
                    let [own, other] = [names[side], names[1 - side]];
                    writeln!(
                        repeated,
                        "    {own} {{ type cyclic; neighbourPatch {other}; faces ({face}); }}"
                    )
                } else {
                    writeln!(others, "            {face}")
                };
            }
        }
        if !others.is_empty() {
            others = format!(
                "    // Nothing of it is left in the mesh of the void.\n    background\n    {{\n        \
                 type patch;\n        faces\n        (\n{others}        );\n    }}\n"
            );
        }
        dictionary(
            "blockMeshDict",
            &format!(
                "scale 1;\n\nvertices\n(\n{vertices});\n\n\
                 blocks (hex (0 1 2 3 4 5 6 7) ({nx} {ny} {nz}) simpleGrading (1 1 1));\n\nedges ();\n\n\
                 boundary\n(\n{repeated}{others});\n\nmergePatchPairs ();\n"
            ),
        )
    }

    /// `system/snappyHexMeshDict`.
    pub(super) fn snappy(&self) -> String {
        let mut geometry = String::new();
        let mut refinement = String::new();
        for patch in &self.patches {
            let name = &patch.name;
            let level = match patch.kind {
                PatchKind::Bodies => self.level,
                _ => self.level.saturating_sub(1),
            };
            let kind = match patch.kind {
                PatchKind::Bodies | PatchKind::Wall => "wall",
                PatchKind::Slip | PatchKind::Inlet | PatchKind::Outlet => "patch",
            };
            // Writing to a string cannot fail.
            let _ = writeln!(
                geometry,
                "    {name}.stl {{ type triSurfaceMesh; name {name}; }}"
            );
            let _ = writeln!(
                refinement,
                "        {name} {{ level ({level} {level}); patchInfo {{ type {kind}; }} }}"
            );
        }
        let Point3 { coords: p } = self.inside;
        dictionary(
            "snappyHexMeshDict",
            &format!(
                "castellatedMesh true;\nsnap            true;\naddLayers       false;\n\n\
                 geometry\n{{\n{geometry}}};\n\n\
                 castellatedMeshControls\n{{\n    maxLocalCells 100000000;\n    maxGlobalCells 200000000;\n    \
                 minRefinementCells 0;\n    nCellsBetweenLevels 2;\n    features ();\n    \
                 refinementSurfaces\n    {{\n{refinement}    }}\n    resolveFeatureAngle 180;\n    \
                 refinementRegions {{}}\n    locationInMesh ({} {} {});\n    \
                 allowFreeStandingZoneFaces true;\n}}\n\n{SNAPPY}",
                p.x, p.y, p.z
            ),
        )
    }
}

const SNAPPY: &str = "\
snapControls
{
    nSmoothPatch 3;
    tolerance 2.0;
    nSolveIter 50;
    nRelaxIter 5;
    nFeatureSnapIter 10;
    implicitFeatureSnap true;
    explicitFeatureSnap false;
    multiRegionFeatureSnap false;
}

addLayersControls
{
    relativeSizes true;
    layers {}
    expansionRatio 1.2;
    finalLayerThickness 0.3;
    minThickness 0.1;
    nGrow 0;
    featureAngle 60;
    nRelaxIter 3;
    nSmoothSurfaceNormals 1;
    nSmoothNormals 3;
    nSmoothThickness 10;
    maxFaceThicknessRatio 0.5;
    maxThicknessToMedialRatio 0.3;
    minMedianAxisAngle 90;
    nBufferCellsNoExtrude 0;
    nLayerIter 50;
}

meshQualityControls
{
    maxNonOrtho 70;
    maxBoundarySkewness 20;
    maxInternalSkewness 4;
    maxConcave 80;
    minVol 1e-30;
    minTetQuality 1e-20;
    minArea -1;
    minTwist 0.02;
    minDeterminant 0.001;
    minFaceWeight 0.02;
    minVolRatio 0.01;
    minTriangleTwist -1;
    nSmoothScale 4;
    errorReduction 0.75;
}

mergeTolerance 1e-6;
";

#[cfg(test)]
mod tests {
    use femdem_analysis::Region;

    use super::*;
    use crate::output::openfoam::CasePatch;

    #[test]
    fn a_tube_has_cells_to_spare_and_a_period_has_none() {
        let patches = [("bodies", PatchKind::Bodies), ("inlet", PatchKind::Inlet)];
        let mut case = FlowCase {
            region: Region::Cylinder {
                centre: [0.0; 2],
                radius: 0.5,
                z_min: 0.0,
                z_max: 2.0,
            },
            repeats: [false; 3],
            patches: patches
                .map(|(name, kind)| CasePatch {
                    name: name.to_owned(),
                    kind,
                })
                .to_vec(),
            inside: Point3::new(0.25, 0.0, 1.5),
            cell: 0.1,
            level: 1,
            velocity: 0.5,
            viscosity: 1e-6,
            porosity: 0.4,
        };
        let snappy = case.snappy();
        assert!(snappy.contains("bodies.stl { type triSurfaceMesh; name bodies; }"));
        assert!(snappy.contains("bodies { level (1 1); patchInfo { type wall; } }"));
        assert!(snappy.contains("inlet { level (0 0); patchInfo { type patch; } }"));
        assert!(snappy.contains("locationInMesh (0.25 0 1.5);"));
        // 12 cells across the tube, 22 along it: one more on either side.
        assert!(case.blocks().contains("(12 12 22)"));
        case.region = Region::Box {
            min: Point3::origin(),
            max: Point3::new(1.04, 0.1, 2.0),
        };
        case.repeats = [true, true, false];
        let blocks = case.blocks();
        assert!(blocks.contains("(10 2 22)") && blocks.contains("(1.04 0.1 2.1)"));
    }
}
