//! The report page in a real browser, drawn by the processor.
//!
//! Without Chromium these tests say so and pass, unless the variable FEMDEM_BROWSER is "required", as
//! in `cargo xtask browser`, which installs it.

#![expect(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]
#![expect(
    clippy::print_stderr,
    reason = "a test that is skipped says so, and prints its figures"
)]

mod chromium;
mod pack;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::Duration;

use chromium::{Page, Screen};
use femdem_view::Snapshot;
use femdem_view::report::Report;
use femdem_view::tables::{TableOptions, Tables};
use tempfile::{TempDir, tempdir};

const DESK: Screen = Screen {
    width: 1280,
    height: 1000,
    dark: false,
};
const PHONE: Screen = Screen {
    width: 390,
    height: 844,
    dark: true,
};

/// Tiles of the reference picture.
const COLUMNS: usize = 16;
const ROWS: usize = 12;

fn browser() -> Option<PathBuf> {
    let found = chromium::find();
    if found.is_none() {
        assert!(
            std::env::var("FEMDEM_BROWSER").as_deref() != Ok("required"),
            "there is no Chromium: install it, or name it in the variable CHROMIUM"
        );
        eprintln!("skipped: there is no Chromium (cargo xtask browser installs it)");
    }
    found
}

fn write(snapshot: &Snapshot, tables: bool) -> (TempDir, PathBuf, u64) {
    let folder = tempdir().unwrap();
    let path = folder.path().join("report.html");
    let tables = tables.then(|| Tables::compute(snapshot, &TableOptions::default()).unwrap());
    let mut report = Report::new(snapshot);
    if let Some(tables) = &tables {
        report = report.with_tables(tables);
    }
    std::fs::write(&path, report.html().unwrap()).unwrap();
    let size = std::fs::metadata(&path).unwrap().len();
    (folder, path, size)
}

fn set(page: &mut Page, id: &str, value: &str) {
    page.evaluate(&format!(
        "(() => {{ const input = document.getElementById('{id}'); input.value = '{value}'; \
         input.dispatchEvent(new Event('input')); input.dispatchEvent(new Event('change')); }})()"
    ));
    page.rest();
}

/// The middle of the canvas.
fn middle(page: &mut Page) -> [f64; 2] {
    let found = page.evaluate(
        "(() => { const b = document.getElementById('view').getBoundingClientRect(); \
         return [b.x + b.width / 2, b.y + b.height / 2]; })()",
    );
    [found[0].as_f64().unwrap(), found[1].as_f64().unwrap()]
}

fn text(page: &mut Page, id: &str) -> String {
    let found = page.evaluate(&format!("document.getElementById('{id}').textContent"));
    found.as_str().unwrap().to_owned()
}

#[test]
fn the_view_rotates_changes_colour_and_tells_of_a_body() {
    let Some(browser) = browser() else { return };
    let (_folder, path, _) = write(&pack::jittered([6, 5, 7]), true);
    let (mut page, _) = Page::open(&browser, &path, DESK);
    let first = page.settled();
    page.keep("first");
    resembles(&first.tiles(COLUMNS, ROWS));

    let [x, y] = middle(&mut page);
    page.mouse("mousePressed", [x, y]);
    for k in 1..=6 {
        page.mouse(
            "mouseMoved",
            [x + 20.0 * f64::from(k), y + 6.0 * f64::from(k)],
        );
    }
    page.mouse("mouseReleased", [x + 120.0, y + 36.0]);
    assert!(
        page.comes_to(|now| first.difference(now) > 0.1),
        "rotating changes the picture"
    );
    assert_eq!(
        page.evaluate("femdem.view.state.chosen"),
        0,
        "dragging is no click"
    );

    for colour in ["force", "coordination", "density", "orientation"] {
        let before = page.settled();
        set(&mut page, "colour", colour);
        assert!(
            page.comes_to(|now| before.difference(now) > 0.05),
            "{colour} changes the picture"
        );
    }
    assert!(text(&mut page, "scale-title").contains("tilt"));

    let before = page.settled();
    page.mouse("mousePressed", [x, y]);
    page.mouse("mouseReleased", [x, y]);
    assert!(
        page.comes_to(|now| before.difference(now) > 0.001),
        "the chosen body is marked"
    );
    let details = text(&mut page, "details");
    assert!(
        details.contains("A10") && details.contains("contact with"),
        "{details}"
    );
    let chosen = page.evaluate("Number(document.getElementById('number').value)");
    let listed = page.evaluate("femdem.view.state.chosen - 1");
    assert_eq!(chosen, listed, "one shape: bodies are listed in order");

    let before = page.settled();
    set(&mut page, "cut-axis", "y");
    assert!(
        page.comes_to(|now| before.difference(now) > 0.05),
        "a cut opens the pack"
    );
    page.keep("cut");
    set(&mut page, "cut-axis", "none");
    assert!(
        page.comes_to(|now| before.difference(now) < 0.001),
        "without the cut all is as before"
    );
    page.evaluate("document.getElementById('chains').click()");
    assert!(
        page.comes_to(|now| before.difference(now) > 0.05),
        "chains show within see-through bodies"
    );
    assert!(
        page.evaluate("femdem.view.overlay.tubeCount")
            .as_u64()
            .unwrap()
            > 10
    );
    page.keep("chains");
    page.evaluate("document.getElementById('chains').click()");
    page.evaluate("document.querySelector('[data-look=iso]').click()");
    set(&mut page, "colour", "sequence");
    set(&mut page, "number", "");
    let back = page.comes_to(|now| first.difference(now) < 0.002);
    assert!(back, "the way back leads to the first picture");
    assert_eq!(page.complaints, Vec::<serde_json::Value>::new());
}

#[test]
fn the_page_fits_a_phone_and_the_dark() {
    let Some(browser) = browser() else { return };
    let (_folder, path, _) = write(&pack::jittered([4, 4, 5]), true);
    let (mut page, _) = Page::open(&browser, &path, PHONE);
    page.rest();
    page.keep("phone");
    assert_eq!(page.evaluate("document.documentElement.scrollWidth"), 390);
    let plots = page.evaluate("document.querySelectorAll('svg.plot[role=img] > title').length");
    assert!(plots.as_u64().unwrap() >= 5, "{plots}");
    // Every control has a name.
    let nameless = page.evaluate(
        "[...document.querySelectorAll('select, input, button, canvas')].filter((e) => \
         !(e.getAttribute('aria-label') || e.closest('label') || e.textContent)).map((e) => e.id)",
    );
    assert_eq!(nameless, serde_json::json!([]));
    let corner = page.canvas().pixels[0];
    assert!(corner.iter().all(|c| *c < 60), "dark paper: {corner:?}");
    assert_eq!(page.complaints, Vec::<serde_json::Value>::new());
}

#[test]
fn without_webgl_the_page_says_so_and_keeps_the_plots() {
    let Some(browser) = browser() else { return };
    let (_folder, path, _) = write(&pack::jittered([3, 3, 3]), true);
    let page = std::fs::read_to_string(&path).unwrap();
    let without = page.replace("canvas.getContext(\"webgl2\", options)", "null");
    assert_ne!(page, without);
    std::fs::write(&path, without).unwrap();
    let (mut page, _) = Page::open(&browser, &path, DESK);
    assert!(text(&mut page, "excuse").contains("no WebGL 2"));
    assert_eq!(
        page.evaluate("document.getElementById('stage').hidden"),
        true
    );
    assert!(
        page.evaluate("document.querySelector('svg.plot').getBoundingClientRect().width > 200")
            == true
    );
    assert_eq!(page.complaints, Vec::<serde_json::Value>::new());
}

/// Targets: under 10 MB, and open within 3 s when the processor draws.
#[test]
fn eleven_thousand_bodies_open_soon() {
    let Some(browser) = browser() else { return };
    let (_folder, path, size) = write(&pack::jittered([22, 22, 23]), false);
    assert!(size < 10_000_000, "{size} bytes");
    let (mut page, time) = Page::open(&browser, &path, DESK);
    let frame = page.evaluate("Math.round(femdem.view.time)");
    eprintln!(
        "11,132 bodies: {size} bytes, open in {:.2} s, a plain picture in {frame} ms",
        time.as_secs_f64()
    );
    // Three times the target, as other work may keep the machine busy.
    assert!(time < Duration::from_secs(9), "{time:?}");
    page.rest();
    page.keep("eleven-thousand");
    assert_eq!(page.complaints, Vec::<serde_json::Value>::new());
}

/// Compares mean colours of tiles with those of the reference; writes them anew if FEMDEM_REFERENCE is set.
fn resembles(tiles: &[[f64; 3]]) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/browser/view.csv");
    if std::env::var_os("FEMDEM_REFERENCE").is_some() {
        let mut csv = String::from("red,green,blue\n");
        for [r, g, b] in tiles {
            writeln!(csv, "{r:.0},{g:.0},{b:.0}").unwrap();
        }
        std::fs::write(&path, csv).unwrap();
    }
    let csv = std::fs::read_to_string(&path).unwrap();
    let rows = csv
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|x| x.parse::<f64>().unwrap()));
    let reference: Vec<f64> = rows.flatten().collect();
    assert_eq!(reference.len(), 3 * tiles.len());
    let off = |(a, b): (&f64, &f64)| (a - b).abs();
    let worst = tiles
        .as_flattened()
        .iter()
        .zip(&reference)
        .map(off)
        .fold(0.0, f64::max);
    assert!(worst < 20.0, "a tile is off by {worst:.0} of 255");
}
