//! Bodies of other shapes than the catalogue's: boulders, armour units, a scan.

use anyhow::Result;

use super::pack::rows;
use super::program::{Summary, Workshop};
use super::report::{Check, Report};
use super::scan;

/// Dumps different boulders of 40 kg into the bin of the founding paper.
///
/// # Errors
/// When the program cannot be built or fails.
pub(crate) fn boulders(workshop: &Workshop, count: u32) -> Result<Report> {
    let options = format!(
        "--shape boulder --variety {count} --count {count} --mass 40 --density 2700 \
         --box 5.26x5.3x3.87m --protocol pour --height 3.87m --rate 50 --seed 1 --threads 2"
    );
    let text = "All boulders differ (as many seeds as bodies) and weigh 40 kg each. They fall from the \
                height of the rim, in layers, and are rigid.";
    run(
        workshop,
        "boulders",
        format!("{count} boulders of 40 kg in a bin of 5.26 m x 5.3 m x 3.87 m"),
        text,
        &options,
        |summary| {
            let above = summary.number("container.above_rim")?;
            Ok(vec![
                settled(summary),
                Check::at_most("boulders above the rim", above, 0.0, ""),
                penetration(summary)?,
            ])
        },
    )
}

/// Pours dolosse into a cylinder.
///
/// # Errors
/// When the program cannot be built or fails.
pub(crate) fn dolosse(workshop: &Workshop, count: u32) -> Result<Report> {
    let options = format!(
        "--shape dolos --count {count} --cylinder 7 --protocol pour --rate 100 --seed 1 --threads 2"
    );
    let text = "Dolosse are not convex: a pair may touch in several patches, each with its own \
                friction, and counts once in the coordination number. d is the diameter of the sphere \
                around a dolos; its height is 0.749 d.";
    run(
        workshop,
        "dolosse",
        format!("{count} dolosse poured into a cylinder"),
        text,
        &options,
        |summary| {
            // The size of a unit is its height.
            let height = 0.749;
            let mean = summary.number("penetration.mean_over_d")? / height;
            let patches = summary.number("coordination.patches_per_pair")?;
            Ok(vec![
                settled(summary),
                Check::at_most(
                    "mean penetration over the height of a unit",
                    mean,
                    0.005,
                    "",
                ),
                Check::holds(
                    "pairs may touch in several patches",
                    "over 1 patch for each pair",
                    super::report::short(patches),
                    patches > 1.0,
                ),
            ])
        },
    )
}

/// Packs a body from a surface file as a scanner writes it.
///
/// # Errors
/// When the program cannot be built or fails, or the file cannot be written.
pub(crate) fn scanned(workshop: &Workshop, count: u32) -> Result<Report> {
    let path = workshop.write("stone.stl", &scan::binary_stl(&scan::stone()))?;
    let options = |file: &str| {
        format!("--shape {file} --unit mm --count {count} --cylinder 5 --seed 1 --threads 2")
    };
    let text = "A bent stone of 2,000 irregular triangles with rough and hollow sides, in millimetres \
                and single precision, as a scanner writes it ([stone.stl](stone.stl); made by \
                `cargo studies validate scan`). It is not convex.";
    let mut report = run(
        workshop,
        "scan",
        format!("{count} stones from a scan-like surface of 2,000 triangles"),
        text,
        &options(&path.display().to_string()),
        |summary| Ok(vec![settled(summary), penetration(summary)?]),
    )?;
    report.commands = vec![format!(
        "cargo run --release -- pack {}",
        options("records/stone.stl")
    )];
    report.attachments.push(path);
    Ok(report)
}

fn run(
    workshop: &Workshop,
    name: &'static str,
    title: String,
    text: &str,
    options: &str,
    checks: impl Fn(&Summary) -> Result<Vec<Check>>,
) -> Result<Report> {
    let program = workshop.build("femdem", &[])?;
    let folder = workshop.results(name);
    let summary = program.pack(options, &folder)?;
    let picture = workshop.named(&folder.join("pack.png"), &format!("{name}.png"))?;
    let mut rows = rows(&summary)?;
    for path in ["container.mean_top", "coordination.patches_per_pair"] {
        rows.push(vec![
            path.to_owned(),
            super::report::short(summary.number(path)?),
        ]);
    }
    Ok(Report {
        name,
        title,
        text: format!("{text}\n\n![The pack]({name}.png)"),
        commands: vec![format!("cargo run --release -- pack {options}")],
        checks: checks(&summary)?,
        columns: vec!["quantity", "value"],
        rows,
        attachments: vec![picture],
    })
}

fn settled(summary: &Summary) -> Check {
    let settled = summary.is_settled();
    Check::holds(
        "settled, verified with all bodies awake",
        "true",
        settled,
        settled,
    )
}

fn penetration(summary: &Summary) -> Result<Check> {
    let mean = summary.number("penetration.mean_over_d")?;
    Ok(Check::at_most("mean penetration over d", mean, 0.005, ""))
}
