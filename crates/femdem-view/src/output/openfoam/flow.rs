//! Fields, fluid and solver: what `simpleFoam` asks for.

use super::case::{FlowCase, PatchKind};
use super::dictionary::{dictionary, file};

impl FlowCase {
    /// `0/U`: the velocity at the start and at the patches.
    pub(super) fn velocities(&self) -> String {
        let (low, high) = self.region.corners();
        let area = self.region.volume() / (high.z - low.z);
        let inlet = format!(
            "type flowRateInletVelocity; volumetricFlowRate {}; value uniform (0 0 0);",
            self.velocity * area
        );
        let start = format!("(0 0 {})", self.velocity);
        self.field(
            ["volVectorField", "U", "0 1 -1"],
            &start,
            |kind| match kind {
                PatchKind::Bodies | PatchKind::Wall => "type noSlip;",
                PatchKind::Slip => "type slip;",
                PatchKind::Inlet => &inlet,
                PatchKind::Outlet => {
                    "type inletOutlet; inletValue uniform (0 0 0); value uniform (0 0 0);"
                }
            },
        )
    }

    /// `0/p`: the pressure over the density of the fluid.
    pub(super) fn pressures(&self) -> String {
        self.field(["volScalarField", "p", "0 2 -2"], "0", |kind| match kind {
            PatchKind::Outlet => "type fixedValue; value uniform 0;",
            _ => "type zeroGradient;",
        })
    }

    /// A field of a class, a name and powers of kg, m and s.
    fn field<'a>(
        &self,
        [class, name, powers]: [&str; 3],
        start: &str,
        condition: impl Fn(PatchKind) -> &'a str,
    ) -> String {
        let own = self.patches.iter();
        let own = own.map(|patch| (patch.name.as_str(), condition(patch.kind)));
        let repeated = self.pairs().flatten().map(|name| (name, "type cyclic;"));
        let lines = own.chain(repeated);
        let lines: String = lines
            .map(|(name, text)| format!("    {name} {{ {text} }}\n"))
            .collect();
        file(
            class,
            name,
            &format!(
                "dimensions [{powers} 0 0 0 0];\n\ninternalField uniform {start};\n\n\
                 boundaryField\n{{\n{lines}}}\n"
            ),
        )
    }

    /// `constant/transportProperties`.
    pub(super) fn fluid(&self) -> String {
        dictionary(
            "transportProperties",
            &format!(
                "transportModel Newtonian;\nnu [0 2 -1 0 0 0 0] {};\n",
                self.viscosity
            ),
        )
    }

    /// `system/fvOptions`: what drives the flow where there is no inlet.
    pub(super) fn drive(&self) -> String {
        let content = if self.repeats[2] {
            // The mean over the void.
            format!(
                "drive\n{{\n    type meanVelocityForce;\n    active true;\n    selectionMode all;\n    \
                 fields (U);\n    Ubar (0 0 {});\n}}\n",
                self.velocity / self.porosity
            )
        } else {
            "// Nothing: the inlet drives the flow.\n".to_owned()
        };
        dictionary("fvOptions", &content)
    }

    /// `system/controlDict`, with what is printed of the result.
    pub(super) fn control(&self) -> String {
        let (name, what) = if self.repeats[2] {
            let scale = self.region.volume().recip();
            (
                "superficialVelocity",
                format!(
                    "type volFieldValue;\n        regionType all;\n        operation volIntegrate;\n        \
                     scaleFactor {scale};\n        fields (U);"
                ),
            )
        } else {
            (
                "inletPressure",
                "type surfaceFieldValue;\n        regionType patch;\n        name inlet;\n        \
                 operation areaAverage;\n        fields (p);"
                    .to_owned(),
            )
        };
        dictionary(
            "controlDict",
            &format!(
                "application simpleFoam;\nstartFrom startTime;\nstartTime 0;\nstopAt endTime;\nendTime 1000;\n\
                 deltaT 1;\nwriteControl timeStep;\nwriteInterval 1000;\n\n\
                 functions\n{{\n    {name}\n    {{\n        {what}\n        \
                 libs (\"libfieldFunctionObjects.so\");\n        writeFields false;\n        log true;\n        \
                 writeControl timeStep;\n        writeInterval 10;\n    }}\n}}\n"
            ),
        )
    }
}

/// `constant/turbulenceProperties`.
pub(super) const LAMINAR: &str = "simulationType laminar;\n";

/// `system/fvSchemes`.
pub(super) const SCHEMES: &str = "\
ddtSchemes { default steadyState; }
gradSchemes { default Gauss linear; }
divSchemes { default none; div(phi,U) bounded Gauss linearUpwind grad(U); div((nuEff*dev2(T(grad(U))))) Gauss linear; }
laplacianSchemes { default Gauss linear limited 0.5; }
interpolationSchemes { default linear; }
snGradSchemes { default limited 0.5; }
";

/// `system/fvSolution`. At these residuals the pressure drop changes by less than a hundred-thousandth of itself.
pub(super) const SOLUTION: &str = "\
solvers
{
    p { solver GAMG; smoother GaussSeidel; tolerance 1e-8; relTol 0.05; }
    U { solver smoothSolver; smoother symGaussSeidel; tolerance 1e-8; relTol 0.1; }
}
SIMPLE
{
    nNonOrthogonalCorrectors 2;
    consistent yes;
    pRefCell 0;
    pRefValue 0;
    residualControl { U 1e-6; p 1e-5; }
}
relaxationFactors { equations { U 0.7; } fields { p 0.3; } }
";
