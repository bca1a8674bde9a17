//! A case of OpenFOAM that meshes the void of a pack: `blockMeshDict`, `snappyHexMeshDict` and what its programs
//! ask for beside them.

use std::fmt::Write as _;

use femdem_analysis::Region;
use femdem_mesh::Point3;

/// A surface file of the case.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CasePatch {
    /// Name of the patch, and of its file without `.stl`.
    pub name: String,
    /// Whether it gets the finer cells of the bodies.
    pub fine: bool,
    /// Whether it is a wall, and not an opening.
    pub wall: bool,
}

/// What a case is made for.
#[derive(Clone, Debug, PartialEq)]
pub struct FlowCase {
    /// The space that the surfaces lie in.
    pub region: Region,
    /// The surfaces.
    pub patches: Vec<CasePatch>,
    /// A point in the void, away from all surfaces and not in a face of the cells (m).
    pub inside: Point3,
    /// Width of the cells far from the surfaces (m).
    pub cell: f64,
    /// How often cells at the bodies are halved.
    pub level: u32,
}

/// Files of a case, as path within it and contents.
type Files = Vec<(&'static str, String)>;

impl FlowCase {
    /// The files of the case except the surfaces, which belong into `constant/triSurface`.
    #[must_use]
    pub fn files(&self) -> Files {
        vec![
            ("system/blockMeshDict", self.blocks()),
            ("system/snappyHexMeshDict", self.snappy()),
            ("system/controlDict", control()),
            ("system/fvSchemes", dictionary("fvSchemes", SCHEMES)),
            ("system/fvSolution", dictionary("fvSolution", SOLUTION)),
        ]
    }

    /// A block a little larger than the region, so that no surface lies in its sides.
    fn blocks(&self) -> String {
        let (low, high) = self.region.corners();
        let counts = [0, 1, 2].map(|k| ((high[k] - low[k]) / self.cell).ceil() as u64 + 2);
        let margin = [0, 1, 2].map(|k| 0.5 * (counts[k] as f64 * self.cell - (high[k] - low[k])));
        let [a, b] = [(low, -1.0), (high, 1.0)].map(|(corner, sign): (Point3, f64)| {
            Point3::from([0, 1, 2].map(|k| corner[k] + sign * margin[k]))
        });
        let mut vertices = String::new();
        for z in [a.z, b.z] {
            for [x, y] in [[a.x, a.y], [b.x, a.y], [b.x, b.y], [a.x, b.y]] {
                // Writing to a string cannot fail.
                let _ = writeln!(vertices, "    ({x} {y} {z})");
            }
        }
        let [nx, ny, nz] = counts;
        dictionary(
            "blockMeshDict",
            &format!(
                "scale 1;\n\nvertices\n(\n{vertices});\n\n\
                 blocks (hex (0 1 2 3 4 5 6 7) ({nx} {ny} {nz}) simpleGrading (1 1 1));\n\nedges ();\n\n\
                 // Nothing of it is left in the mesh of the void.\nboundary\n(\n    background\n    {{\n        \
                 type patch;\n        faces ((0 3 2 1) (4 5 6 7) (0 1 5 4) (2 3 7 6) (0 4 7 3) (1 2 6 5));\n    }}\n);\n\n\
                 mergePatchPairs ();\n"
            ),
        )
    }

    fn snappy(&self) -> String {
        let mut geometry = String::new();
        let mut refinement = String::new();
        for CasePatch { name, fine, wall } in &self.patches {
            let level = if *fine {
                self.level
            } else {
                self.level.saturating_sub(1)
            };
            let kind = if *wall { "wall" } else { "patch" };
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

fn dictionary(object: &str, content: &str) -> String {
    format!(
        "FoamFile\n{{\n    version 2.0;\n    format ascii;\n    class dictionary;\n    object {object};\n}}\n\n{content}"
    )
}

fn control() -> String {
    dictionary(
        "controlDict",
        "application simpleFoam;\nstartFrom startTime;\nstartTime 0;\nstopAt endTime;\nendTime 1000;\n\
         deltaT 1;\nwriteControl timeStep;\nwriteInterval 100;\n",
    )
}

const SCHEMES: &str = "\
ddtSchemes { default steadyState; }
gradSchemes { default Gauss linear; }
divSchemes { default none; div(phi,U) bounded Gauss linearUpwind grad(U); div((nuEff*dev2(T(grad(U))))) Gauss linear; }
laplacianSchemes { default Gauss linear limited 0.5; }
interpolationSchemes { default linear; }
snGradSchemes { default limited 0.5; }
";

const SOLUTION: &str = "\
solvers
{
    p { solver GAMG; smoother GaussSeidel; tolerance 1e-8; relTol 0.05; }
    U { solver smoothSolver; smoother symGaussSeidel; tolerance 1e-8; relTol 0.1; }
}
SIMPLE { nNonOrthogonalCorrectors 2; consistent yes; }
relaxationFactors { equations { U 0.7; } fields { p 0.3; } }
";

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
    use super::*;

    #[test]
    fn the_files_name_every_patch_and_are_balanced() {
        let case = FlowCase {
            region: Region::Cylinder {
                centre: [0.0; 2],
                radius: 0.5,
                z_min: 0.0,
                z_max: 2.0,
            },
            patches: [("bodies", true, true), ("inlet", false, false)]
                .map(|(name, fine, wall)| CasePatch {
                    name: name.to_owned(),
                    fine,
                    wall,
                })
                .to_vec(),
            inside: Point3::new(0.25, 0.0, 1.5),
            cell: 0.1,
            level: 1,
        };
        let files = case.files();
        for (name, text) in &files {
            for [open, close] in [['{', '}'], ['(', ')']] {
                let count = |c: char| text.matches(c).count();
                assert_eq!(count(open), count(close), "{name}");
            }
        }
        let text = |name: &str| &files.iter().find(|file| file.0 == name).unwrap().1;
        let snappy = text("system/snappyHexMeshDict");
        assert!(snappy.contains("bodies.stl { type triSurfaceMesh; name bodies; }"));
        assert!(snappy.contains("bodies { level (1 1); patchInfo { type wall; } }"));
        assert!(snappy.contains("inlet { level (0 0); patchInfo { type patch; } }"));
        assert!(snappy.contains("locationInMesh (0.25 0 1.5);"));
        // 12 cells across the tube, 22 along it: one more on either side.
        assert!(text("system/blockMeshDict").contains("(12 12 22)"));
    }
}
