//! The page with what a host knows of its own run.

#![expect(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use femdem_view::analysis::{FragmentationOptions, fragmentation};
use femdem_view::mesh::{Point3, Pose, catalogue::CatalogueShape};
use femdem_view::plot::LineChart;
use femdem_view::report::{FactTable, KeyFigure, Report, RunFacts};
use femdem_view::tables::{TableOptions, Tables};
use femdem_view::{Body, CrackFacet, CrackMode, Fracture, NamedShape, Snapshot, ViewError};

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
        "<title>1 body: cube (P5)</title>",
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
    // What a run that has run empty has measured is a page, without a view.
    let chart = LineChart {
        title: "Flow".to_owned(),
        lines: vec![("outlet".to_owned(), vec![[0.0, 0.0], [1.0, 2.0]])],
        ..LineChart::default()
    };
    let course = vec![chart.plot().unwrap()];
    let page = Report::new(&nothing).with_course(course).html().unwrap();
    assert!(page.contains("<h3>Flow</h3>") && page.contains("<title>0 bodies</title>"));
    assert!(!page.contains("<canvas") && !page.contains("<script"));
}

#[test]
fn fracture_has_a_section_if_something_is_known() {
    let pieces = [
        (0.09, 5.0),
        (0.05, 2.0),
        (0.04, 1.0),
        (0.03, 1.0),
        (0.01, 1.0),
    ];
    let options = FragmentationOptions {
        parent_size: Some(0.1),
        ..FragmentationOptions::default()
    };
    let facet = |damage, mode| CrackFacet {
        body: 0,
        points: [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(Point3::from),
        opening: 0.0,
        slip: 0.0,
        damage,
        mode,
        birth: 0.0,
        dissipated: 0.1,
    };
    let mut fracture = Fracture {
        fragmentation: Some(fragmentation(&pieces, &options).unwrap()),
        dissipated: vec![[0.0, 0.0], [0.5, 12.0]],
        cracks: vec![
            facet(1.0, CrackMode::Shear),
            facet(1.0, CrackMode::Tension),
            facet(0.5, CrackMode::Tension),
        ],
    };
    let snapshot = cube();
    let page = |fracture: &Fracture| Report::new(&snapshot).with_fracture(fracture).html();
    let words = page(&fracture).unwrap();
    for part in [
        "<h2>Fracture</h2>",
        "<dt>Fragments</dt><dd>5<small>10 kg in all</small></dd>",
        "<dt>t10</dt><dd>10.0 %<small>",
        "<dt>Energy of fracture</dt><dd>12 J<small>",
        "<dt>Broken facets</dt><dd>2<small>1 of them in shear; 1 more are damaged</small></dd>",
        "<h3>Sizes of the fragments</h3>",
        "<h3>Energy of fracture</h3>",
    ] {
        assert!(words.contains(part), "{part}");
    }
    let plots = Report::new(&snapshot).with_fracture(&fracture).plots();
    assert_eq!(plots.len(), 2);
    assert!(!page(&Fracture::default()).unwrap().contains("Fracture"));
    fracture.cracks[1].damage = -0.5;
    let refused = page(&fracture).unwrap_err().to_string();
    assert!(
        refused.contains("crack facet 1: its damage = -0.5"),
        "{refused}"
    );
}
