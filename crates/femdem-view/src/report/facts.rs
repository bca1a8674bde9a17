//! Numbers at the head of the page, and the tables at its foot.

use std::fmt::Write as _;

use crate::plot::escape;
use crate::tables::{Missing, Tables};

/// A number at the head of the page.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct KeyFigure {
    /// Name of the quantity.
    pub label: String,
    /// The number, with its unit.
    pub value: String,
    /// What belongs to it, in small print.
    pub note: String,
}

/// A table of quantities and values.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FactTable {
    /// Title.
    pub title: String,
    /// Names and values.
    pub rows: Vec<(String, String)>,
}

/// What is known of the run that made a pack; what is empty is left out of the page.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RunFacts {
    /// The pack in a line, below the title; the number of contacts is added to it.
    pub lead: Option<String>,
    /// The main results, in the place of those that the measurements give.
    pub figures: Vec<KeyFigure>,
    /// Parameters and course of the run.
    pub tables: Vec<FactTable>,
    /// Further rows of the table of versions, such as a fingerprint of the state.
    pub versions: Vec<(String, String)>,
    /// The command that makes the pack again, to the same bits.
    pub command: Option<String>,
}

/// The main results of a pack from elsewhere.
pub(super) fn measured(tables: &Tables) -> Vec<KeyFigure> {
    let mut figures = Vec::new();
    if let Some(density) = &tables.density {
        let grid = density.grid;
        let grid = grid.map_or(String::new(), |grid| format!("; by grid {grid:.4}"));
        let error = density
            .standard_error
            .map_or(String::new(), |e| format!("\u{b1} {e:.4} "));
        figures.push(KeyFigure {
            label: "Packing density".to_owned(),
            value: format!("{:.4}", density.exact),
            note: format!("{error}of the {}{grid}", tables.density_space()),
        });
    }
    if let Some(bed) = &tables.bed {
        figures.push(KeyFigure {
            label: "Void fraction of the bed".to_owned(),
            value: format!("{:.4}", bed.void_fraction),
            note: format!(
                "from the floor to the mean top, {:.1} d high, over the whole width",
                (bed.top - bed.floor) / tables.diameter
            ),
        });
    }
    if let Some(z) = &tables.coordination {
        figures.push(KeyFigure {
            label: "Coordination number".to_owned(),
            value: format!("{:.2}", z.mean),
            note: format!("sd {:.2}, walls count", z.sd),
        });
    }
    figures
}

/// What could not be computed, with the reasons.
pub(super) fn missing(tables: &Tables) -> Option<FactTable> {
    let row = |missing: &Missing| (missing.table.replace('_', " "), missing.reason.clone());
    let rows: Vec<_> = tables.missing.iter().map(row).collect();
    let title = "Not measured".to_owned();
    (!rows.is_empty()).then_some(FactTable { title, rows })
}

pub(super) fn figures_html(figures: &[KeyFigure]) -> String {
    let mut html = String::from("<dl class=\"figures\">\n");
    for KeyFigure { label, value, note } in figures {
        let [label, value, note] = [label, value, note].map(|text| escape(text));
        let _ = writeln!(
            html,
            "<div class=\"card\"><dt>{label}</dt><dd>{value}<small>{note}</small></dd></div>"
        );
    }
    if figures.is_empty() {
        String::new()
    } else {
        html + "</dl>"
    }
}

/// The programs that made the pack and this page.
pub(super) fn versions(run: &RunFacts) -> FactTable {
    let mut rows = vec![("femdem".to_owned(), env!("CARGO_PKG_VERSION").to_owned())];
    rows.extend(run.versions.iter().cloned());
    let built = format!("{}, {}", std::env::consts::ARCH, std::env::consts::OS);
    rows.push(("platform of this page".to_owned(), built));
    FactTable {
        title: "Versions".to_owned(),
        rows,
    }
}

pub(super) fn facts_html(facts: &[FactTable], command: Option<&str>) -> String {
    let mut html = String::new();
    if let Some(command) = command {
        let command = escape(command);
        let _ = writeln!(
            html,
            "<section><h2>Make it again</h2>\n<pre><code>{command}</code></pre>\n<p class=\"note\">The \
             same version gives the same bodies bit for bit, on any number of threads; compare the \
             state hash.</p></section>"
        );
    }
    html.push_str("<h2>Parameters and run</h2>\n<div class=\"card facts\">\n");
    for FactTable { title, rows } in facts {
        let title = escape(title);
        let _ = writeln!(html, "<section><h3>{title}</h3>\n<table><tbody>");
        for (name, value) in rows {
            let [name, value] = [escape(name), escape(value)];
            let _ = writeln!(
                html,
                "<tr><th scope=\"row\">{name}</th><td>{value}</td></tr>"
            );
        }
        html.push_str("</tbody></table></section>\n");
    }
    html + "</div>"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_of_the_run_cannot_leave_its_element() {
        let wild = || "a < b".to_owned();
        let figure = KeyFigure {
            label: wild(),
            value: wild(),
            note: wild(),
        };
        let table = FactTable {
            title: wild(),
            rows: vec![(wild(), wild())],
        };
        let html = figures_html(&[figure]) + &facts_html(&[table], Some("a < b"));
        assert_eq!(html.matches("a &lt; b").count(), 7, "{html}");
        assert!(!html.contains("a < b"));
    }

    #[test]
    fn a_page_without_figures_has_no_list_of_them() {
        assert_eq!(figures_html(&[]), "");
    }
}
