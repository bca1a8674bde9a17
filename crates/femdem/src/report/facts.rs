//! Numbers at the head of the page, and the tables at its foot.

use std::fmt::Write as _;

use crate::analysis::{Missing, Tables};
use crate::plot::escape;
use crate::results::short;
use crate::scene::{ContainerKind, DEFAULT_CONE, DEFAULT_OUTLET, ProtocolKind, Unit};
use crate::{Scene, Summary};

/// A number at the head of the page.
pub(super) struct Figure {
    label: &'static str,
    value: String,
    note: String,
}

/// A table of quantities and values.
pub(super) struct Facts {
    title: &'static str,
    rows: Vec<(String, String)>,
}

/// The main results of a run.
pub(super) fn figures(summary: &Summary) -> Vec<Figure> {
    let figure = |label, value, note| Figure { label, value, note };
    let mut figures = Vec::new();
    if let Some(density) = &summary.packing_density {
        let error = density
            .standard_error
            .map_or(String::new(), |e| format!(" ± {e:.4}"));
        let space = match &density.bed_reason {
            Some(reason) => format!("bed, since {reason}"),
            None => "core".to_owned(),
        };
        let note = format!("{error} of the {space}{}", by_grid(density.grid));
        figures.push(figure(
            "Packing density",
            format!("{:.4}", density.exact),
            note.trim().to_owned(),
        ));
    }
    let z = &summary.coordination;
    let note = format!("sd {:.2}, walls count", z.sd);
    figures.push(figure(
        "Coordination number",
        format!("{:.2}", z.mean),
        note,
    ));
    let p = &summary.penetration;
    let note = format!("of d; largest {:.2} %", 100.0 * p.max_over_d);
    figures.push(figure(
        "Mean penetration",
        format!("{:.2} %", 100.0 * p.mean_over_d),
        note,
    ));
    let r = &summary.residual;
    let note = format!("of the weight; largest {:.2} %", 100.0 * r.max_over_weight);
    figures.push(figure(
        "Mean residual force",
        format!("{:.2} %", 100.0 * r.mean_over_weight),
        note,
    ));
    let state = if summary.settled { "yes" } else { "no" };
    figures.push(figure(
        "At rest",
        state.to_owned(),
        "verified with all bodies awake".to_owned(),
    ));
    figures
}

/// The main results of a pack from elsewhere.
pub(super) fn measured(tables: &Tables) -> Vec<Figure> {
    let mut figures = Vec::new();
    if let Some(density) = &tables.density {
        let error = density
            .standard_error
            .map_or(String::new(), |e| format!("\u{b1} {e:.4} "));
        figures.push(Figure {
            label: "Packing density",
            value: format!("{:.4}", density.exact),
            note: format!(
                "{error}of the {}{}",
                tables.density_space(),
                by_grid(density.grid)
            ),
        });
    }
    if let Some(z) = &tables.coordination {
        figures.push(Figure {
            label: "Coordination number",
            value: format!("{:.2}", z.mean),
            note: format!("sd {:.2}, walls count", z.sd),
        });
    }
    figures
}

fn by_grid(density: Option<f64>) -> String {
    density.map_or(String::new(), |grid| format!("; by grid {grid:.4}"))
}

/// What could not be computed, with the reasons.
pub(super) fn missing(tables: &Tables) -> Option<Facts> {
    let row = |missing: &Missing| (missing.table.replace('_', " "), missing.reason.clone());
    let rows: Vec<_> = tables.missing.iter().map(row).collect();
    let title = "Not measured";
    (!rows.is_empty()).then_some(Facts { title, rows })
}

pub(super) fn figures_html(figures: &[Figure]) -> String {
    let mut html = String::from("<dl class=\"figures\">\n");
    for Figure { label, value, note } in figures {
        let [value, note] = [escape(value), escape(note)];
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

/// Labels of options of a scene, with their units; others are labelled with their keys.
const LABELS: [(&str, &str); 21] = [
    ("batch", "bodies in a batch"),
    ("cone", "half angle of the cone / degrees"),
    ("count", "number of bodies"),
    ("cylinder", "diameter of the cylinder"),
    ("damping", "fraction of critical damping"),
    ("density", "density of the bodies / kg/m\u{b3}"),
    ("diameter", "circumscribed diameter d / m"),
    ("drag", "drag of the medium / sqrt(g/d)"),
    ("friction", "friction coefficient"),
    ("gravity", "gravity / m/s\u{b2}"),
    ("local-damping", "local damping of the medium"),
    ("mass", "mass of a body / kg"),
    ("mesh-size", "edges of the tetrahedra / d"),
    ("outlet", "diameter of the outlet / d"),
    ("penalty", "penalty / Pa"),
    ("penetration", "mean penetration aimed at / d"),
    ("rate", "bodies per second / 1/s"),
    ("share", "shares of the shapes"),
    ("size", "size of the bodies / m"),
    ("tangential-stiffness", "tangential over normal stiffness"),
    ("wall-friction", "friction coefficient of the walls"),
];

/// The options of a run that apply to it.
pub(super) fn parameters(scene: &Scene) -> Facts {
    let kind = scene.container_kind().ok();
    let silo = kind == Some(ContainerKind::Silo);
    let told = Scene {
        container: kind,
        outlet: scene.outlet.or(silo.then_some(DEFAULT_OUTLET)),
        cone: scene.cone.or(silo.then_some(DEFAULT_CONE)),
        ..scene.clone()
    };
    let table = toml::Table::try_from(told).unwrap_or_default();
    let pour = scene.protocol == ProtocolKind::Pour;
    let idle = |key: &str| match key {
        "out" | "threads" | "checkpoint-every" => true,
        "rate" => !pour,
        "repair" => !scene.repair,
        "unit" => scene.unit == Unit::default(),
        "variety" => scene.variety == 1,
        "penetration" => scene.penalty.is_some(),
        _ => false,
    };
    let label = |key: String| {
        let known = LABELS.iter().find(|(name, _)| *name == key);
        known.map_or(key, |(_, label)| (*label).to_owned())
    };
    let shown = table.into_iter().filter(|(key, _)| !idle(key));
    let rows = shown
        .map(|(key, value)| (label(key), plain(&value)))
        .collect();
    Facts {
        title: "Parameters",
        rows,
    }
}

/// A TOML value without quotes.
fn plain(value: &toml::Value) -> String {
    match value {
        toml::Value::String(text) => text.clone(),
        toml::Value::Array(list) => list.iter().map(plain).collect::<Vec<_>>().join(", "),
        other => other.to_string(),
    }
}

/// Course and cost of the run.
pub(super) fn run(summary: &Summary) -> Facts {
    let mut rows: Vec<(String, String)> = Vec::new();
    let mut row = |name: &str, value: String| rows.push((name.to_owned(), value));
    row("bodies", summary.count.to_string());
    for shape in &summary.shapes {
        let kind = if shape.convex { "convex" } else { "not convex" };
        row(
            &format!("shape {}", shape.name),
            format!(
                "{} bodies, d = {} m, {} m³, {} faces, {kind}",
                shape.count,
                short(shape.diameter),
                short(shape.volume),
                shape.faces
            ),
        );
    }
    row("contact law", summary.contact.law.clone());
    row("penalty", format!("{:.4e} Pa", summary.contact.penalty));
    row(
        "height of the pack",
        format!(
            "{:.4} m, mean {:.4} m",
            summary.container.top, summary.container.mean_top
        ),
    );
    row("simulated time", summary.steps_text());
    row("last time step", format!("{:.3e} s", summary.time_step));
    let e = &summary.energy;
    row(
        "energy",
        format!(
            "{} J in; {} J to friction, {} J to damping; ledger error {:.1e}",
            short(e.initial),
            short(e.dissipated_friction),
            short(e.dissipated_damping),
            e.ledger_error_relative
        ),
    );
    row(
        "time on the clock",
        format!(
            "{:.1} s, threads: {}",
            summary.wall_seconds, summary.threads
        ),
    );
    if let Some(cpu) = summary.cpu_seconds {
        row("processor time", format!("{cpu:.1} s"));
    }
    if let Some(bytes) = summary.peak_memory_bytes {
        row("memory", format!("{} MiB", bytes >> 20));
    }
    Facts { title: "Run", rows }
}

/// The programs that made the pack and this page.
pub(super) fn versions(summary: Option<&Summary>) -> Facts {
    let mut rows = vec![("femdem".to_owned(), env!("CARGO_PKG_VERSION").to_owned())];
    if let Some(summary) = summary {
        rows.push((
            "schema of summary.json".to_owned(),
            summary.schema.to_string(),
        ));
        rows.push(("state hash".to_owned(), summary.state_hash.clone()));
    }
    let built = format!("{}, {}", std::env::consts::ARCH, std::env::consts::OS);
    rows.push(("platform of this page".to_owned(), built));
    Facts {
        title: "Versions",
        rows,
    }
}

pub(super) fn facts_html(facts: &[Facts], command: Option<&str>) -> String {
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
    for Facts { title, rows } in facts {
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
    fn every_label_names_an_option_of_a_scene() {
        let known = include_str!("../scene/mod.rs").replace('_', "-");
        for (key, _) in LABELS {
            assert!(known.contains(&format!("    pub {key}:")), "{key}");
        }
    }

    #[test]
    fn parameters_leave_out_what_has_no_meaning_for_the_run() {
        let scene = Scene {
            count: 7,
            ..Scene::default()
        };
        let html = facts_html(&[parameters(&scene)], Some("a < b"));
        assert!(
            html.contains("<th scope=\"row\">number of bodies</th><td>7</td>"),
            "{html}"
        );
        assert!(!html.contains("outlet") && !html.contains("bodies per second"));
        assert!(html.contains("a &lt; b"));
    }
}
