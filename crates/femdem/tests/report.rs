//! `femdem report`, `femdem pack --report` and `femdem picture` on a tiny pack.

use crate::common::{TINY, code, fails, femdem, run, stdout};
use std::fs;
use std::path::Path;
use tempfile::tempdir;

fn pack(out: &Path, options: &[&str]) {
    let result = run(femdem("pack")
        .args(TINY)
        .args(options)
        .arg("--out")
        .arg(out));
    assert_eq!(code(&result), 0, "{result:?}");
}

/// The page is self-contained: no address of another file or host.
fn stands_alone(page: &str) {
    for word in ["src=\"", "@import", "fetch(", "XMLHttpRequest"] {
        assert!(!page.contains(word), "{word}");
    }
    for (word, own) in [("href=\"", "data:"), ("url(", "#")] {
        assert!(
            page.split(word).skip(1).all(|rest| rest.starts_with(own)),
            "{word}"
        );
    }
}

#[test]
fn a_report_has_the_view_the_plots_the_parameters_and_the_command() {
    let folder = tempdir().unwrap();
    let out = folder.path().join("pack");
    pack(&out, &["--report"]);
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    stands_alone(&page);
    for part in [
        "<title>8 bodies: cube (P5)</title>",
        "femdem pack --box 3x3 --count 8",
        "id=\"numbers\"",
        "Coordination number",
        "<td>0.6</td>",
        "state hash",
    ] {
        assert!(page.contains(part), "{part}");
    }
    let plots: Vec<_> = fs::read_dir(out.join("plots")).unwrap().collect();
    assert!(plots.len() >= 3, "{plots:?}");
    for plot in plots {
        let text = fs::read_to_string(plot.unwrap().path()).unwrap();
        assert!(text.contains("<desc") && text.ends_with("</svg>\n"));
    }

    // The same page again, elsewhere.
    let copy = folder.path().join("copy");
    let result = run(femdem("report").arg(&out).arg("--out").arg(&copy));
    assert_eq!(code(&result), 0, "{result:?}");
    assert!(stdout(&result).contains("report.html"));
    assert_eq!(fs::read_to_string(copy.join("report.html")).unwrap(), page);
}

#[test]
fn pictures_from_every_side_by_every_colour() {
    let folder = tempdir().unwrap();
    let out = folder.path().join("pack");
    pack(&out, &[]);
    let mut seen = Vec::new();
    let sides = ["front", "side", "top", "iso", "iso"];
    let colours = [
        "sequence",
        "coordination",
        "force",
        "orientation",
        "density",
    ];
    for (side, colour) in sides.into_iter().zip(colours) {
        let file = folder.path().join(format!("{side}.png"));
        let result = run(femdem("picture")
            .arg(&out)
            .args([
                "--view", side, "--colour", colour, "--size", "90x60", "--out",
            ])
            .arg(&file));
        assert_eq!(code(&result), 0, "{result:?}");
        let bytes = fs::read(&file).unwrap();
        assert!(bytes.starts_with(b"\x89PNG") && !seen.contains(&bytes));
        seen.push(bytes);
    }
    let svg = folder.path().join("a.svg");
    let result = run(femdem("picture")
        .arg(&out)
        .args(["--size", "90x60", "--out"])
        .arg(&svg));
    assert_eq!(code(&result), 0, "{result:?}");
    assert!(
        fs::read_to_string(&svg)
            .unwrap()
            .contains("viewBox=\"0 0 90 60\"")
    );
    let jpg = folder.path().join("a.jpg");
    fails(
        femdem("picture").arg(&out).arg("--out").arg(jpg),
        &[".png", "--out"],
    );
    fails(
        femdem("picture").arg(&out).args(["--size", "90"]),
        &["1200x800"],
    );
    fails(femdem("report").arg(folder.path()), &["pack.ckpt"]);
}

/// Without the checkpoint the tables are read; the page lists what they do not contain.
#[test]
fn a_pack_from_elsewhere_has_a_report_and_pictures_too() {
    let folder = tempdir().unwrap();
    let out = folder.path().join("pack");
    pack(&out, &[]);
    for name in ["pack.ckpt", "scene.toml", "summary.json"] {
        fs::remove_file(out.join(name)).unwrap();
    }
    let result = run(femdem("report").arg(&out));
    assert_eq!(code(&result), 0, "{result:?}");
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains("Not measured") && page.contains("container is not known"));
    assert!(page.contains("Coordination number") && !page.contains("Make it again"));
    let png = folder.path().join("a.png");
    let result = run(femdem("picture")
        .arg(&out)
        .args(["--inside", "-0.08,-0.08,0,0.08,0.08,0.3"])
        .args(["--size", "40x40", "--out"])
        .arg(&png));
    assert_eq!(code(&result), 0, "{result:?}");
}
