//! The pages docs/scene*.md list every key of a scene, and docs/run.md every column and key of the results.

#![expect(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

mod walls;

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use femdem::run::{
    Axes, AxisEntry, Behaviour, BodyEntry, BodySummary, BondEntry, BondSummary, BoundaryEntry,
    BridgeEntry, CELL_COLUMNS, CellEntry, CellState, ContactEntry, ControlEntry, Copies, Ending,
    FLOW_COLUMNS, FidelitySummary, FlowSummary, FocusEntry, FractureEntry, FractureSummary,
    GateEntry, HISTORY_COLUMNS, Law, LoadEntry, MEMBER_COLUMNS, MaterialEntry, MediumEntry,
    MotionEntry, PairEntry, Penalty, PenetrationSummary, Reached, ReactionSummary, RegionEntry,
    RelaxEntry, RelaxSummary, RestEntry, RestSummary, RotationEntry, RunEnergy, RunSummary,
    Scenario, SelectEntry, ShearEntry, Sides, SourceEntry, StepEntry, StrainSummary, UntilEntry,
    WALL_HISTORY_COLUMNS, WallSummary, WeibullEntry, Zone,
};
use femdem::scene::Unit;
use serde::Serialize;

use walls::{cone, cylinder, hopper, plane, plate, silo, space, wall};

const V: [f64; 3] = [1.0, 2.0, 3.0];
const SHAKE: MotionEntry = MotionEntry::Shake {
    stroke: V,
    frequency: 1.0,
    start: 0.0,
    periods: 1,
};

/// With every field written out, so that a new one stops this file from compiling.
fn body() -> BodyEntry {
    BodyEntry {
        name: "b".to_owned(),
        shape: Some("cube".to_owned()),
        mesh: Some(PathBuf::from("b.msh")),
        block: Some([1, 1, 1]),
        sides: Some(V),
        diameter: Some(1.0),
        size: Some(1.0),
        unit: Unit::M,
        repair: true,
        material: "m".to_owned(),
        region: vec![region()],
        behaviour: Behaviour::Rigid,
        element: femdem::fem::element::Element::T4,
        mesh_size: Some(0.1),
        focus: Some(focus()),
        contact_ratio: Some(1.0),
        self_contact: Some(true),
        mass_scaling: Some(1.0),
        position: V,
        rotation: Some(rotation()),
        velocity: V,
        spin: V,
        copies: Some(copies()),
        poses: Some(PathBuf::from("p.csv")),
        motion: Some(SHAKE),
        boundary: vec![boundary()],
    }
}

fn rotation() -> RotationEntry {
    RotationEntry {
        axis: Some(V),
        angle: Some(30.0),
        quaternion: Some([1.0, 0.0, 0.0, 0.0]),
        euler: Some(V),
    }
}

fn focus() -> FocusEntry {
    FocusEntry {
        direction: V,
        ratio: 2.0,
    }
}

fn copies() -> Copies {
    Copies {
        count: [1, 2, 3],
        spacing: V,
        seed: Some(1),
        rotation: Some(rotation()),
        stagger: true,
    }
}

fn region() -> RegionEntry {
    RegionEntry {
        material: "m".to_owned(),
        within: Zone::Sphere {
            centre: V,
            radius: 1.0,
        },
    }
}

fn boundary() -> BoundaryEntry {
    BoundaryEntry {
        name: "b".to_owned(),
        select: SelectEntry::All,
        fix: true,
        motion: Some(SHAKE),
        directions: [true; 3],
        pressure: Some(1.0),
        traction: Some(V),
        rise: Some(1.0),
        table: Some(vec![[0.0, 1.0]]),
    }
}

fn material() -> MaterialEntry {
    MaterialEntry {
        density: Some(1.0),
        law: Some(Law::J2),
        young: Some(1.0),
        poisson: Some(0.1),
        share: Some(0.1),
        yield_stress: Some(1.0),
        hardening: Some(1.0),
        saturation_stress: Some(1.0),
        saturation_rate: Some(1.0),
        cohesion: Some(1.0),
        friction_angle: Some(1.0),
        dilatancy_angle: Some(1.0),
        cap_eccentricity: Some(1.0),
        yield_pressure: Some(vec![[0.0, 1.0]]),
        shear_viscosity: Some(1.0),
        bulk_viscosity: Some(1.0),
        fracture: Some(fracture()),
    }
}

fn fracture() -> FractureEntry {
    FractureEntry {
        tensile: 1.0,
        cohesion: 1.0,
        friction_angle: 1.0,
        energy: [1.0, 2.0],
        mix: Some(1.0),
        softening: Some(femdem::contact::glue::Softening::Bilinear),
        weibull: Some(WeibullEntry {
            modulus: 8.0,
            volume: 1e-9,
            seed: 1,
        }),
        every: Some(1),
        stiffness: Some(1.0),
        coarse: true,
        fragments: femdem::solve::Fragments::Pieces,
    }
}

fn gate() -> GateEntry {
    GateEntry {
        name: "g".to_owned(),
        plane: Some(plane()),
        r#box: Some(space()),
    }
}

fn source() -> SourceEntry {
    SourceEntry {
        name: "s".to_owned(),
        shape: "cube".to_owned(),
        diameter: Some(1.0),
        size: Some(1.0),
        sizes: Some("1m".to_owned()),
        sieve: Some("1m:1".to_owned()),
        unit: Unit::M,
        repair: true,
        mesh_size: Some(0.1),
        material: "m".to_owned(),
        lower: V,
        upper: V,
        places: vec![V],
        rate: Some(1.0),
        mass_rate: Some(1.0),
        number: Some(1),
        mass: Some(1.0),
        start: 1.0,
        end: Some(2.0),
        velocity: V,
        seed: 1,
    }
}

fn control() -> ControlEntry {
    ControlEntry {
        force: Some(1.0),
        pressure: Some(1.0),
        area: Some(1.0),
        direction: Some(V),
        speed: Some(1.0),
        table: Some(vec![[0.0, 1.0]]),
        x: Some(axis()),
        y: Some(axis()),
        z: Some(axis()),
        shear: Some(shear()),
    }
}

fn shear() -> ShearEntry {
    ShearEntry {
        rate: 1.0,
        table: Some(vec![[0.0, 1.0]]),
    }
}

fn cell() -> CellEntry {
    CellEntry {
        lower: V,
        upper: V,
        axes: "xy".to_owned(),
        control: Some(control()),
    }
}

fn axis() -> AxisEntry {
    AxisEntry {
        stress: Some(1.0),
        force: Some(1.0),
        strain_rate: Some(1.0),
        speed: Some(1.0),
        sides: Sides::Upper,
        table: Some(vec![[0.0, 1.0]]),
    }
}

fn pair() -> PairEntry {
    PairEntry {
        materials: ["m".to_owned(), "n".to_owned()],
        penalty: Some(1.0),
        friction: Some(0.1),
        wall_friction: Some(0.1),
        rolling_friction: Some(0.1),
        damping: Some(0.1),
        tangential_ratio: Some(0.1),
        tangential_damping: Some(0.1),
        wall_response: Some(femdem::contact::WallResponse::Rigid),
        cohesion: Some(0.1),
        adhesion_energy: Some(0.1),
        liquid_bridge: Some(bridge()),
    }
}

fn bridge() -> BridgeEntry {
    BridgeEntry {
        volume: 1e-9,
        tension: 0.07,
        contact_angle: 10.0,
    }
}

fn load() -> LoadEntry {
    LoadEntry {
        bodies: vec!["b".to_owned()],
        force: Some(V),
        torque: Some(V),
        acceleration: Some(V),
        force_density: Some(V),
        point: Some(V),
        axes: Axes::Body,
        rise: Some(1.0),
        table: Some(vec![[0.0, 1.0]]),
    }
}

fn bond() -> BondEntry {
    BondEntry {
        between: ["a".to_owned(), "b".to_owned()],
        gap: 1.0,
        ratio: Some(0.5),
        tensile: 1.0,
        cohesion: 1.0,
        energy: [1.0, 2.0],
        stiffness: 1.0,
        friction: Some(0.1),
        mix: Some(1.0),
        softening: Some(femdem::contact::glue::Softening::Linear),
        damping: Some(0.1),
    }
}

fn rest() -> RestEntry {
    RestEntry {
        energy: 1.0,
        time: 1.0,
    }
}

fn step() -> StepEntry {
    StepEntry {
        safety: 0.5,
        largest: Some(1.0),
    }
}

fn until() -> UntilEntry {
    UntilEntry {
        column: "px".to_owned(),
        of: Some("w".to_owned()),
        above: Some(1.0),
        below: Some(1.0),
        after: 1.0,
        lasting: 1.0,
    }
}

fn scenario() -> Scenario {
    Scenario {
        title: "t".to_owned(),
        duration: 1.0,
        every: Some(1.0),
        history_every: Some(1.0),
        track: true,
        pictures: true,
        tables: true,
        rest: Some(rest()),
        until: vec![until()],
        relax: Some(RelaxEntry::default()),
        gravity: Some(V),
        contact: ContactEntry::default(),
        pair: vec![pair()],
        time_step: step(),
        medium: MediumEntry::default(),
        energy_error_limit: 0.5,
        sleeping: true,
        sleeping_deformables: true,
        cell: Some(cell()),
        material: BTreeMap::from([("m".to_owned(), material())]),
        wall: vec![wall()],
        body: vec![body()],
        bond: vec![bond()],
        load: vec![load()],
        source: vec![source()],
        sink: vec![gate()],
        gauge: vec![gate()],
        from: Some(PathBuf::from("f")),
        remove: vec!["x+".to_owned()],
        out: PathBuf::from("o"),
        threads: Some(1),
        checkpoint_every: 1.0,
    }
}

fn keys(value: &impl Serialize) -> BTreeSet<String> {
    let value = serde_json::to_value(value).unwrap();
    value.as_object().unwrap().keys().cloned().collect()
}

fn guide(name: &str) -> String {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../../docs")
        .join(name);
    std::fs::read_to_string(path).unwrap()
}

/// The pages of the keys of a scene, one after another.
fn scene_guide() -> String {
    ["scenes.md", "scene-walls.md", "scene-bodies.md"]
        .map(guide)
        .concat()
}

/// Rows of the tables under a heading, as cells, headers and rulers left out.
fn rows(text: &str, heading: &str) -> Vec<Vec<String>> {
    let start = text
        .find(&format!("\n{heading}\n"))
        .unwrap_or_else(|| panic!("{heading}"));
    let section = &text[start + heading.len() + 1..];
    let end = section.find("\n#").unwrap_or(section.len());
    let lines: Vec<&str> = section[..end].lines().collect();
    let is_header = |i: usize| {
        lines
            .get(i + 1)
            .is_some_and(|next| next.starts_with("|---"))
    };
    let table = (0..lines.len())
        .filter(|&i| lines[i].starts_with('|') && !lines[i].starts_with("|---") && !is_header(i));
    let cells = |i: usize| {
        lines[i]
            .trim_matches('|')
            .split('|')
            .map(|c| c.trim().to_owned())
    };
    table.map(|i| cells(i).collect()).collect()
}

/// Words in backticks.
fn ticked(cell: &str) -> Vec<String> {
    cell.split('`')
        .skip(1)
        .step_by(2)
        .map(str::to_owned)
        .collect()
}

/// The keys of the rows with `columns` cells whose first cell is one key.
fn documented(text: &str, heading: &str) -> BTreeSet<String> {
    rows(text, heading)
        .iter()
        .flat_map(|row| ticked(&row[0]))
        .collect()
}

#[test]
fn every_key_of_every_table_is_documented_and_no_other() {
    let text = scene_guide();
    for (heading, wanted) in [
        ("## The scene", keys(&scenario())),
        ("## `[rest]`", keys(&rest())),
        ("## `[relax]`", keys(&RelaxEntry::default())),
        ("## `[contact]`", keys(&ContactEntry::default())),
        ("## `[[pair]]`", keys(&pair())),
        ("## `[time-step]`", keys(&step())),
        ("## `[medium]`", keys(&MediumEntry::default())),
        ("## `[[wall]]`", keys(&wall())),
        ("### `control`", keys(&control())),
        ("### `control.z`", keys(&axis())),
        ("## `[cell]`", keys(&cell())),
        ("### `shear`", keys(&shear())),
        ("### `plane`", keys(&plane())),
        ("### `box`", keys(&space())),
        ("### `cylinder`", keys(&cylinder())),
        ("### `cone`", keys(&cone())),
        ("### `silo`", keys(&silo())),
        ("### `hopper`", keys(&hopper())),
        ("### `plate`", keys(&plate())),
        ("## `[[body]]`", keys(&body())),
        ("## `[[bond]]`", keys(&bond())),
        ("## `[[load]]`", keys(&load())),
        ("## `[[source]]`", keys(&source())),
        ("## `[[sink]]`", keys(&gate())),
        ("## `[[gauge]]`", keys(&gate())),
        ("### `[material.NAME.fracture]`", keys(&fracture())),
        ("### `rotation`", keys(&rotation())),
        ("### `copies`", keys(&copies())),
        ("### `focus`", keys(&focus())),
    ] {
        let mut found = documented(&text, heading);
        if heading == "## The scene" {
            // It is laid over the scene, which does not have it.
            assert!(found.remove("stage"));
        }
        assert_eq!(found, wanted, "{heading}");
    }
    let laws = [
        Law::NeoHookean,
        Law::Hencky,
        Law::MooneyRivlin,
        Law::J2,
        Law::DruckerPrager,
        Law::DruckerPragerCap,
    ];
    let laws = laws.map(|law| {
        serde_json::to_value(law)
            .unwrap()
            .as_str()
            .unwrap()
            .to_owned()
    });
    let mut wanted = keys(&material());
    wanted.extend(laws);
    assert_eq!(documented(&text, "## `[material.NAME]`"), wanted);
}

/// Variants of an enum with the keys of each.
fn variants(values: &[impl Serialize]) -> BTreeMap<String, BTreeSet<String>> {
    let variant = |value: serde_json::Value| match value {
        serde_json::Value::String(name) => (name, BTreeSet::new()),
        other => {
            let (name, inner) = other.as_object().unwrap().iter().next().unwrap();
            let keys = inner.as_object().map(|o| o.keys().cloned().collect());
            (name.clone(), keys.unwrap_or_default())
        }
    };
    values
        .iter()
        .map(|v| variant(serde_json::to_value(v).unwrap()))
        .collect()
}

fn choices(
    text: &str,
    heading: &str,
    skip: &BTreeSet<String>,
) -> BTreeMap<String, BTreeSet<String>> {
    let rows = rows(text, heading);
    let row = |row: &Vec<String>| {
        (
            ticked(&row[0]).concat(),
            ticked(&row[1]).into_iter().collect(),
        )
    };
    rows.iter()
        .map(row)
        .filter(|(name, _)| !skip.contains(name))
        .collect()
}

#[test]
fn every_choice_is_documented_with_its_keys() {
    let text = scene_guide();
    let none = BTreeSet::new();
    let motions = [
        MotionEntry::Linear {
            velocity: V,
            start: 0.0,
            end: 1.0,
        },
        SHAKE,
        MotionEntry::Tap {
            stroke: V,
            frequency: 1.0,
            interval: 1.0,
            start: 0.0,
            taps: 1,
        },
        MotionEntry::Turn {
            axis: V,
            point: V,
            rate: 1.0,
            start: 0.0,
            end: 1.0,
        },
        MotionEntry::Rock {
            axis: V,
            point: V,
            angle: 1.0,
            frequency: 1.0,
            start: 0.0,
            periods: 1,
        },
    ];
    assert_eq!(choices(&text, "## Motions", &none), variants(&motions));
    let selections = [
        SelectEntry::All,
        SelectEntry::Skin,
        SelectEntry::Nodes(vec![1]),
        SelectEntry::Box { lower: V, upper: V },
        SelectEntry::Plane {
            normal: V,
            offset: 0.0,
            tolerance: Some(1.0),
        },
        SelectEntry::Sphere {
            centre: V,
            radius: 1.0,
        },
    ];
    let found = choices(&text, "### `[[body.boundary]]`", &keys(&boundary()));
    assert_eq!(found, variants(&selections));
    let zones = [
        Zone::Box { lower: V, upper: V },
        Zone::HalfSpace {
            normal: V,
            offset: 0.0,
        },
        region().within,
    ];
    let found = choices(&text, "### `[[body.region]]`", &keys(&region()));
    assert_eq!(found, variants(&zones));
    let all: BTreeSet<String> = documented(&text, "### `[[body.boundary]]`");
    assert!(keys(&boundary()).is_subset(&all));
}

#[test]
fn a_full_scene_reads_back_equal() {
    let text = scenario().to_toml().unwrap();
    assert_eq!(Scenario::from_toml(&text).unwrap(), scenario());
}

#[test]
fn every_column_and_key_of_the_results_is_documented() {
    let text = guide("run.md");
    let columns = |heading: &str| -> Vec<String> {
        rows(&text, heading)
            .iter()
            .flat_map(|row| ticked(&row[0]))
            .collect()
    };
    let sorted = |mut names: Vec<String>| {
        names.sort();
        names
    };
    let owned = |names: &[&str]| sorted(names.iter().map(|&s| s.to_owned()).collect());
    assert_eq!(sorted(columns("## history.csv")), owned(&HISTORY_COLUMNS));
    assert_eq!(sorted(columns("## members.csv")), owned(&MEMBER_COLUMNS));
    assert_eq!(
        sorted(columns("## wall_history.csv")),
        owned(&WALL_HISTORY_COLUMNS)
    );
    assert_eq!(sorted(columns("## cells.csv")), owned(&CELL_COLUMNS));
    assert_eq!(sorted(columns("## flow.csv")), owned(&FLOW_COLUMNS));

    let summary = summary();
    let mut wanted = BTreeSet::new();
    for (key, inner) in serde_json::to_value(&summary).unwrap().as_object().unwrap() {
        match inner.as_object() {
            Some(inner) => wanted.extend(inner.keys().map(|k| format!("{key}.{k}"))),
            None => {
                wanted.insert(key.clone());
            }
        }
    }
    let mut found = BTreeSet::new();
    for row in rows(&text, "## summary.json") {
        let names = ticked(&row[0]);
        let group = names[0].split('.').next().unwrap().to_owned();
        found.extend(names.iter().map(|name| match name.strip_prefix('.') {
            Some(rest) => format!("{group}.{rest}"),
            None => name.clone(),
        }));
    }
    assert_eq!(found, wanted);
    let lists = [
        keys(&summary.bodies[0]),
        keys(&summary.walls[0]),
        keys(&summary.cells[0]),
        keys(&summary.reactions[0]),
        keys(&summary.flow["NAME"]),
    ];
    for key in lists.iter().flatten() {
        assert!(text.contains(&format!("`{key}`")), "{key}");
    }
}

fn summary() -> RunSummary {
    RunSummary {
        schema: 1,
        title: String::new(),
        ending: Some(Ending::Time),
        relaxed: Some(RelaxSummary::default()),
        reached: Some(Reached {
            column: String::new(),
            of: Some(String::new()),
            value: 0.0,
        }),
        rest: RestSummary {
            at_rest: true,
            driven: false,
            frozen: 0,
            residual: 0.0,
            worst: Some(String::new()),
            motion: Some(0.0),
            force_balance: 0.0,
        },
        bodies: vec![BodySummary {
            name: String::new(),
            number: 0,
            behaviour: String::new(),
            mass: 1.0,
            added_mass: 1.0,
            nodes: 0,
            tetrahedra: 0,
            centroid: V,
            velocity: V,
            max_plastic_strain: Some(1.0),
        }],
        walls: vec![WallSummary {
            name: String::new(),
            force: V,
            peak_force: 1.0,
            peak_time: 1.0,
        }],
        cells: vec![CellState {
            name: String::new(),
            sides: V,
            stress: V,
            strain: V,
            shear_stress: Some(1.0),
            shear_strain: Some(1.0),
            solid_fraction: 1.0,
            errors: [Some(0.0); 3],
        }],
        flow: BTreeMap::from([(
            "NAME".to_owned(),
            FlowSummary {
                kind: "gauge".to_owned(),
                bodies: 1,
                mass: 1.0,
                mean_rate: Some(1.0),
            },
        )]),
        reactions: vec![ReactionSummary {
            body: String::new(),
            boundary: String::new(),
            force: V,
            peak_force: 1.0,
            peak_time: 1.0,
        }],
        penalty: Penalty {
            value: 1.0,
            reason: String::new(),
        },
        warnings: vec![String::new()],
        penetration: Some(PenetrationSummary {
            now: 1.0,
            peak: 1.0,
            peak_time: 1.0,
            peak_between: [String::new(), String::new()],
        }),
        duration: 1.0,
        simulated_time: 1.0,
        steps: 1,
        time_step: 1.0,
        frames: 1,
        tetrahedra: 1,
        energy: RunEnergy {
            initial: 1.0,
            work_in: 1.0,
            by_hand: 1.0,
            lent: 1.0,
            fidelity: 1.0,
            kinetic: 1.0,
            potential: 1.0,
            strain: 1.0,
            contact: 1.0,
            friction_springs: 1.0,
            cracks: 1.0,
            bonds: 1.0,
            dissipated_friction: 1.0,
            dissipated_damping: 1.0,
            dissipated_medium: 1.0,
            dissipated_viscous: 1.0,
            dissipated_plastic: 1.0,
            dissipated_bridges: 1.0,
            dissipated_fracture: 1.0,
            dissipated_bonds: 1.0,
            dissipated_release: 1.0,
            frozen: 1.0,
            ledger_error_relative: 1.0,
        },
        momentum: V,
        strain: Some(StrainSummary {
            max_von_mises: 1.0,
            min_volume_ratio: 1.0,
            max_volume_ratio: 1.0,
        }),
        fracture: Some(FractureSummary {
            bodies: 1,
            fragments: 1,
            largest_share: 1.0,
            cut_area: 1.0,
            broken_area: 1.0,
            highest: 1.0,
        }),
        fidelity: Some(FidelitySummary {
            bodies: 1,
            softened: 1,
            hardened: 1,
            highest: 1.0,
            deformable_share: 1.0,
            largest_share: 1.0,
        }),
        bonds: Some(BondSummary {
            count: 1,
            whole: 1,
            broken: 1,
            broken_area: 1.0,
            pieces: 1,
            largest_share: 1.0,
        }),
        contacts: 1,
        threads: 1,
        wall_seconds: 1.0,
        cpu_seconds: Some(1.0),
        nanoseconds_per_tet_step: Some(1.0),
        peak_memory_bytes: Some(1),
        state_hash: String::new(),
    }
}
