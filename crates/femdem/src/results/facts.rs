//! What a report says of a run: its main results, its parameters and its course.

use femdem_view::output::short_number;
use femdem_view::report::{FactTable, KeyFigure, RunFacts};

use super::Summary;
use crate::Scene;
use crate::scene::{ContainerKind, DEFAULT_CONE, DEFAULT_OUTLET, ProtocolKind, Unit};

/// What a [`Report`](crate::report::Report) says of a run of `femdem pack`: its results, and the options, and thus
/// the command, of its scene. What is not given is left out.
#[must_use]
pub fn run_facts(summary: Option<&Summary>, scene: Option<&Scene>) -> RunFacts {
    let parameters = scene.map(parameters);
    RunFacts {
        lead: summary.map(lead),
        figures: summary.map(figures).unwrap_or_default(),
        tables: parameters.into_iter().chain(summary.map(run)).collect(),
        versions: summary.map(versions).unwrap_or_default(),
        command: scene.map(Scene::command),
    }
}

fn lead(summary: &Summary) -> String {
    format!(
        "d = {} m, density {} kg/m³, friction {}, seed {}",
        short_number(summary.diameter),
        short_number(summary.density),
        summary.friction,
        summary.seed
    )
}

fn versions(summary: &Summary) -> Vec<(String, String)> {
    vec![
        (
            "schema of summary.json".to_owned(),
            summary.schema.to_string(),
        ),
        ("state hash".to_owned(), summary.state_hash.clone()),
    ]
}

/// The main results of a run.
fn figures(summary: &Summary) -> Vec<KeyFigure> {
    let figure = |label: &str, value, note| KeyFigure {
        label: label.to_owned(),
        value,
        note,
    };
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
    if let Some(bed) = &summary.bed {
        let note = format!(
            "density {:.4}, from the floor to the mean top, {:.1} d high",
            bed.density,
            (bed.top - bed.floor) / summary.diameter
        );
        let value = format!("{:.4}", bed.void_fraction);
        figures.push(figure("Void fraction of the bed", value, note));
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

fn by_grid(density: Option<f64>) -> String {
    density.map_or(String::new(), |grid| format!("; by grid {grid:.4}"))
}

/// Labels of options of a scene, with their units; others are labelled with their keys.
const LABELS: [(&str, &str); 24] = [
    ("batch", "bodies in a batch"),
    ("cone", "half angle of the cone / degrees"),
    ("count", "number of bodies"),
    ("cylinder", "diameter of the cylinder"),
    ("damping", "fraction of critical damping"),
    ("density", "density of the bodies / kg/m\u{b3}"),
    ("diameter", "circumscribed diameter d / m"),
    ("drag", "drag of the medium"),
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
    ("sieve", "sieve curve of the bodies, by mass"),
    ("size", "size of the bodies / m"),
    ("sizes", "sizes of the bodies"),
    (
        "tangential-damping",
        "fraction of critical damping of friction springs",
    ),
    ("tangential-ratio", "tangential over normal stiffness"),
    ("wall-friction", "friction coefficient of the walls"),
];

/// The options of a run that apply to it.
fn parameters(scene: &Scene) -> FactTable {
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
    FactTable {
        title: "Parameters".to_owned(),
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

/// Shapes are listed one by one up to this number.
const LISTED: usize = 12;

/// Course and cost of the run.
fn run(summary: &Summary) -> FactTable {
    let mut rows: Vec<(String, String)> = Vec::new();
    let mut row = |name: &str, value: String| rows.push((name.to_owned(), value));
    row("bodies", summary.count.to_string());
    if summary.shapes.len() > LISTED {
        row("shapes and sizes", summary.shapes.len().to_string());
    }
    for shape in summary.shapes.iter().take(LISTED) {
        let kind = if shape.convex { "convex" } else { "not convex" };
        row(
            &format!("shape {}", shape.name),
            format!(
                "{} bodies, d = {} m, {} m³, {} faces, {kind}",
                shape.count,
                short_number(shape.diameter),
                short_number(shape.volume),
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
            short_number(e.initial),
            short_number(e.dissipated_friction),
            short_number(e.dissipated_damping),
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
    FactTable {
        title: "Run".to_owned(),
        rows,
    }
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
        let facts = run_facts(None, Some(&scene));
        let rows = &facts.tables[0].rows;
        assert!(rows.contains(&("number of bodies".to_owned(), "7".to_owned())));
        let has = |word: &str| rows.iter().any(|(name, _)| name.contains(word));
        assert!(!has("outlet") && !has("bodies per second"), "{rows:?}");
    }
}
