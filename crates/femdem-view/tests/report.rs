//! The page with what a host knows of its own run.

#![expect(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use femdem_view::mesh::{Pose, catalogue::CatalogueShape};
use femdem_view::report::{FactTable, KeyFigure, Report, RunFacts};
use femdem_view::tables::{TableOptions, Tables};
use femdem_view::{Body, NamedShape, Snapshot, ViewError};

fn cube() -> Snapshot {
    let shape = "P5".parse::<CatalogueShape>().unwrap();
    Snapshot {
        shapes: vec![NamedShape {
            name: "P5".to_owned(),
            polyhedron: shape.polyhedron(0.1).unwrap(),
        }],
        bodies: vec![Body {
            shape: 0,
            pose: Pose::translation(0.0, 0.0, 0.1),
            sequence: 0,
            sleeping: false,
        }],
        ..Snapshot::default()
    }
}

#[test]
fn facts_of_a_run_stand_where_they_belong() {
    let run = RunFacts {
        lead: Some("dropped by hand".to_owned()),
        figures: vec![KeyFigure {
            label: "Height".to_owned(),
            value: "0.1 m".to_owned(),
            note: "of the centre".to_owned(),
        }],
        tables: vec![FactTable {
            title: "Parameters".to_owned(),
            rows: vec![("seed".to_owned(), "4711".to_owned())],
        }],
        versions: vec![("host".to_owned(), "3.2".to_owned())],
        command: Some("host --seed 4711".to_owned()),
    };
    let snapshot = cube();
    let tables = Tables::compute(&snapshot, &TableOptions::default()).unwrap();
    let page = Report::new(&snapshot).with_tables(&tables).with_run(run);
    let page = page.html().unwrap();
    let mut from = 0;
    for words in [
        "<title>1 bodies: cube (P5)</title>",
        "dropped by hand; 0 contacts.",
        "<dt>Height</dt><dd>0.1 m<small>of the centre</small></dd>",
        "<code>host --seed 4711</code>",
        "<h3>Parameters</h3>",
        "<th scope=\"row\">seed</th><td>4711</td>",
        "<h3>Not measured</h3>",
        "<h3>Versions</h3>",
        "<th scope=\"row\">host</th><td>3.2</td>",
    ] {
        let found = page[from..].find(words);
        from += found.unwrap_or_else(|| panic!("{words} does not follow"));
    }
}

#[test]
fn without_a_run_the_page_has_what_was_measured() {
    let snapshot = cube();
    let page = Report::new(&snapshot).html().unwrap();
    assert!(page.contains(">0 contacts.<") && !page.contains("Make it again"));
    let nothing = Snapshot::default();
    let refused = Report::new(&nothing).html().unwrap_err();
    assert!(matches!(refused, ViewError::NothingToDraw));
}
