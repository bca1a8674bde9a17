//! Contact laws of pairs of materials in scenes.

#![expect(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use crate::common::{femdem, run};
use femdem::contact::{ContactParameters, MaterialId};
use femdem::run::{Run, Scenario, Simulation};
use tempfile::tempdir;

/// Boxes of steel and of ice, and one of rubber, on a floor of stone under gravity that is turned by 20 degrees.
const SCENE: &str = r#"
duration = 0.2
sleeping = false
gravity = [3.355, 0, -9.218]
contact = { friction = 0.9, wall-friction = 0.8, damping = 0.5, penalty = 1e6 }
[material.stone]
[material.steel]
density = 7800
[material.ice]
density = 900
[material.rubber]
density = 1100
law = "neo-hookean"
young = 1e6
poisson = 0.3
[[pair]]
materials = ["stone", "steel"]
friction = 0.5
damping = 0.3
[[pair]]
materials = ["ice", "stone"]
penalty = 4e6
friction = 0.1
[[pair]]
materials = ["rubber", "stone"]
friction = 0.2
[[pair]]
materials = ["steel", "steel"]
rolling-friction = 0.1
[[wall]]
name = "floor"
plane = { normal = [0, 0, 1] }
material = "stone"
[[body]]
name = "sticks"
shape = "box:width=1,height=0.5"
size = 0.04
material = "steel"
position = [0, 0, 0.01]
[[body]]
name = "slides"
shape = "box:width=1,height=0.5"
size = 0.04
material = "ice"
position = [0, 0.2, 0.01]
[[body]]
name = "gives way"
block = [3, 3, 2]
sides = [0.04, 0.04, 0.02]
material = "rubber"
behaviour = "deformable"
position = [0, 0.4, 0.01]
"#;

fn scene(from: &str, to: &str) -> Scenario {
    assert!(SCENE.contains(from), "{from}");
    Scenario::from_toml(&SCENE.replacen(from, to, 1)).unwrap()
}

/// Speeds of the three down the slope, m/s.
fn speeds(simulation: &Simulation) -> Vec<f64> {
    let world = &simulation.world;
    let speed = |id| world.velocity(id).unwrap().x;
    simulation.members.iter().map(|m| speed(m.id)).collect()
}

/// On one slope of tan 0.364 the body with 0.5 sticks, those with 0.1 and 0.2 slide with g (sin - mu cos).
#[test]
fn bodies_slide_by_their_own_pairs() {
    let mut simulation = scene("", "").build().unwrap();
    let mut until = |time: f64| {
        while simulation.world.time() < time {
            simulation.step().unwrap();
        }
        (simulation.world.time(), speeds(&simulation))
    };
    let ((start, early), (end, late)) = (until(0.08), until(0.2));
    assert!(late[0].abs() < 1e-3, "{late:?}");
    for (k, mu) in [(1, 0.1), (2, 0.2)] {
        let got = (late[k] - early[k]) / (end - start);
        let want = 3.355 - mu * 9.218;
        assert!((got / want - 1.0).abs() < 0.02, "{k}: {got} for {want}");
    }
}

/// What a pair does not give is that of `[contact]`, the chosen penalty too; with a friction of its own, walls have that.
#[test]
fn pairs_inherit() {
    let simulation = scene(", penalty = 1e6", "").build().unwrap();
    let world = &simulation.world;
    let usual = world.parameters().contact;
    assert_eq!(usual.penalty, simulation.penalty.value);
    // In alphabetical order, from 1.
    let [ice, rubber, steel, stone] = [1, 2, 3, 4].map(MaterialId);
    assert_eq!(world.wall_material(0), Some(stone));
    let own = ContactParameters {
        friction: 0.5,
        wall_friction: None,
        damping_ratio: 0.3,
        ..usual
    };
    assert_eq!(world.laws().between([steel, stone]), &own);
    let cold = world.laws().between([stone, ice]);
    assert_eq!((cold.penalty, cold.damping_ratio), (4e6, 0.5));
    let rolls = world.laws().between([steel, steel]);
    assert_eq!(
        (rolls.rolling_friction, rolls.wall_friction),
        (0.1, Some(0.8))
    );
    assert_eq!(world.laws().between([rubber, steel]), &usual);
}

/// A run goes on under other pairs: what slid sticks, and inherited numbers follow `[contact]`.
#[test]
fn pairs_change_in_a_run() {
    let folder = tempdir().unwrap();
    let mut job = Run::new(scene("", "")).unwrap();
    job.advance(folder.path(), 50).unwrap();
    let mut new = scene("friction = 0.1\n", "friction = 0.7\n");
    new.pair.truncate(2);
    new.contact.damping = Some(0.4);
    let changed = job.apply(new).unwrap();
    let named = |word: &str| changed.iter().any(|name| name.contains(word));
    assert!(named("[[pair]]") && named("contact.damping"), "{changed:?}");
    let laws = job.simulation().world.laws();
    let [ice, rubber, steel, stone] = [1, 2, 3, 4].map(MaterialId);
    let cold = laws.between([ice, stone]);
    assert_eq!((cold.friction, cold.damping_ratio), (0.7, 0.4));
    for gone in [[rubber, stone], [steel, steel]] {
        assert_eq!(laws.between(gone), laws.usual());
    }
    let same = scene("material = \"stone\"", "material = \"steel\"");
    assert!(
        job.apply(same)
            .unwrap_err()
            .to_string()
            .contains("material")
    );
}

/// Faults are named with their entry and what is known or allowed.
#[test]
fn faults_of_pairs_are_named() {
    for (from, to, words) in [
        (
            "[\"ice\", \"stone\"]",
            "[\"ice\", \"brass\"]",
            ["\"ice\" and \"brass\"", "ice, rubber, steel, stone"],
        ),
        (
            "material = \"stone\"",
            "material = \"brass\"",
            ["wall \"floor\"", "ice, rubber, steel, stone"],
        ),
        (
            "friction = 0.1\n",
            "friction = -0.1\n",
            ["pair \"ice\" and \"stone\": friction = -0.1", "at least 0"],
        ),
        (
            "damping = 0.3",
            "damping = 0.9",
            ["damping = 0.9", "0.7071"],
        ),
        ("penalty = 4e6", "penalty = 0", ["penalty = 0", "Pa"]),
        (
            "[\"steel\", \"steel\"]",
            "[\"steel\", \"stone\"]",
            ["given twice", "one [[pair]]"],
        ),
        (
            "rolling-friction = 0.1\n",
            "",
            [
                "\"steel\" and \"steel\"",
                "differs from the law of all others",
            ],
        ),
        (
            "[material.stone]",
            "[material.stone]\ndensity = 2600",
            ["material.stone", "leave its table empty"],
        ),
        (
            "material = \"stone\"\n",
            "",
            ["material.stone", "no body, source or wall is made of it"],
        ),
        ("density = 900", "", ["density = none", "kg/m³"]),
    ] {
        let error = scene(from, to).build().map(|_| ()).unwrap_err().to_string();
        let told = words.iter().all(|word| error.contains(word));
        assert!(told, "{to}: {error}");
    }
    let text = SCENE.replacen("penalty = 4e6", "restitution = 0.5", 1);
    let error = Scenario::from_toml(&text).unwrap_err().to_string();
    assert!(
        error.contains("restitution") && error.contains("tangential-ratio"),
        "{error}"
    );
    let many: String = (0..256).map(|k| format!("[material.m{k}]\n")).collect();
    let error = scene("[material.stone]", &format!("{many}[material.stone]"));
    let error = error.build().map(|_| ()).unwrap_err().to_string();
    assert!(error.contains("at most 255"), "{error}");
}

/// Attraction of all contacts and of pairs: bodies hang under a plate by it, and where it means nothing it is refused.
#[test]
fn pairs_attract() {
    let text = |law: &str, shape: &str| {
        format!(
            "duration = 0.1\nsleeping = false\ncontact.penalty = 1e7\n[material.m]\ndensity = 2000\n\
             [material.plate]\n[[pair]]\nmaterials = [\"m\", \"plate\"]\n{law}\n\
             [[wall]]\nplane = {{ normal = [0, 0, -1] }}\nmaterial = \"plate\"\n\
             [[body]]\nshape = \"{shape}\"\nsize = 0.02\nmaterial = \"m\"\nposition = [0, 0, -0.0099999]\n"
        )
    };
    // Twice the weight of a brick of 20 x 20 x 20 mm and of a ball.
    let weight = 2000.0 * 9.81 * 0.02_f64.powi(3);
    let brick = "box:width=1,height=1";
    let held = format!("cohesion = {}", 2.0 * weight / 0.02_f64.powi(2));
    let round = format!(
        "adhesion-energy = {}",
        2.0 * weight / (1.5 * std::f64::consts::PI * 0.01)
    );
    for (law, shape) in [
        (&*held, brick),
        (&*round, "sphere"),
        ("friction = 0", brick),
    ] {
        let mut simulation = Scenario::from_toml(&text(law, shape))
            .unwrap()
            .build()
            .unwrap();
        while simulation.world.time() < 0.1 {
            simulation.step().unwrap();
        }
        let id = simulation.members[0].id;
        let falls = simulation.world.velocity(id).unwrap().z < -0.9;
        assert_eq!(falls, law == "friction = 0", "{law}");
        let rows = simulation.snapshot().unwrap().contacts;
        if !falls {
            // What the wall bears is the weight, though it pulls.
            let up: f64 = rows
                .iter()
                .map(|c| -(c.normal * c.normal_force + c.friction).z)
                .sum();
            let own = weight
                * if shape == brick {
                    1.0
                } else {
                    std::f64::consts::FRAC_PI_6
                };
            assert!((up / own - 1.0).abs() < 0.01, "{up} {own}");
            assert!(rows[0].normal_force < 0.0);
        }
    }
    let refused = |text: &str| {
        let built = Scenario::from_toml(text).unwrap().build();
        built.and_then(|mut s| s.step()).unwrap_err().to_string()
    };
    assert!(refused(&text("cohesion = -1", brick)).contains("cohesion = -1"));
    assert!(refused(&text("adhesion-energy = 1", brick)).contains("materials of spheres"));
    let soft = text("cohesion = 1", "cube").replace(
        "density = 2000",
        "density = 2000\nlaw = \"hencky\"\nyoung = 1e6\npoisson = 0.3",
    );
    let soft = soft.replace(
        "shape = \"cube\"",
        "shape = \"cube\"\nbehaviour = \"deformable\"",
    );
    assert!(refused(&soft).contains("deformable bodies"));
}

/// A pack has laws of its materials, and a run from it has them, too, but for pairs that it gives itself.
#[test]
fn materials_of_a_pack_are_those_of_a_run_from_it() {
    let folder = tempdir().unwrap();
    let (scene, pack) = (folder.path().join("pack.toml"), folder.path().join("pack"));
    let text = "shape = [\"P5\", \"A10\"]\ncount = 6\nbox = \"3x3\"\npenetration = 0.02\n\
                material = [\"steel\", \"ice\"]\nwall-material = \"wood\"\n\
                [[pair]]\nmaterials = [\"steel\", \"wood\"]\nfriction = 0.2\n\
                [[pair]]\nmaterials = [\"ice\", \"wood\"]\nfriction = 0.9\n";
    std::fs::write(&scene, text).unwrap();
    let output = run(femdem("pack").arg(&scene).arg("--out").arg(&pack));
    assert!(output.status.success(), "{output:?}");
    let text = format!(
        "from = {:?}\nduration = 0.01\n[material.wood]\n[material.steel]\ndensity = 7800\n\
         [[pair]]\nmaterials = [\"steel\", \"wood\"]\nfriction = 0.25\n",
        pack.display()
    );
    let simulation = Scenario::from_toml(&text).unwrap().build().unwrap();
    let world = &simulation.world;
    let [ice, steel, wood] = [1, 2, 3].map(MaterialId);
    assert_eq!(world.wall_material(0), Some(wood));
    assert_eq!(world.laws().between([wood, steel]).friction, 0.25);
    assert_eq!(world.laws().between([wood, ice]).friction, 0.9);
    assert_eq!(world.laws().all().count(), 3);
    let of_steel = world
        .body_ids()
        .filter(|&id| world.material(id) == Some(steel))
        .count();
    assert_eq!(of_steel, 3);
}

/// The chosen penalty is for the contacts that have it, and `--check` forecasts with the one of each pair: only the ball of ice
/// touches with the adhesion of its pair, and a pair with a penalty of its own asks for none.
#[test]
fn the_chosen_penalty_is_for_the_pairs_that_have_it() {
    let text = |own: &str, big: &str| {
        let steel = match big {
            "steel" => "[material.steel]\ndensity = 7800\n",
            _ => "",
        };
        format!(
            "duration = 0.1\ngravity = [0, 0, 0]\n[material.ice]\ndensity = 900\n{steel}\
             [material.stone]\n[[pair]]\nmaterials = [\"ice\", \"stone\"]\nadhesion-energy = 10\n{own}\
             [[wall]]\nplane = {{ normal = [0, 0, 1] }}\nmaterial = \"stone\"\n\
             [[body]]\nname = \"small\"\nshape = \"sphere\"\ndiameter = 0.02\nmaterial = \"ice\"\nposition = [0, 0, 0.1]\n\
             [[body]]\nname = \"other\"\nshape = \"sphere\"\ndiameter = 0.002\nmaterial = \"{big}\"\nposition = [0, 1, 0.1]\n"
        )
    };
    let chosen = |own: &str, big: &str| {
        let scenario = Scenario::from_toml(&text(own, big)).unwrap();
        let simulation = scenario.build().unwrap();
        let forecast = scenario.forecast(&simulation).at_rest;
        (simulation.penalty.value, forecast)
    };
    // 3/4 w R/depth² of a radius of 10 mm and a depth of 0.1 mm; a ball of a tenth of the size asks for ten times as much.
    let (penalty, at_rest) = chosen("", "steel");
    assert!((penalty / 7.5e6 - 1.0).abs() < 0.02, "{penalty}");
    assert!((at_rest.depth / 0.005 - 1.0).abs() < 0.02, "{at_rest:?}");
    assert_eq!(at_rest.body, "small");
    let (penalty, _) = chosen("", "ice");
    assert!((penalty / 7.5e7 - 1.0).abs() < 0.03, "{penalty}");
    // sqrt(3/4 w R/p) is 0.0866 mm, of 20 mm.
    let (penalty, at_rest) = chosen("penalty = 1e7\n", "steel");
    assert_eq!(penalty, 1e6);
    assert!((at_rest.depth / 0.00433 - 1.0).abs() < 0.01, "{at_rest:?}");
}

/// Liquid bridges are keys of contacts and of pairs, in scenes of runs and of packs, and the chosen penalty foresees their pull.
#[test]
fn liquid_bridges_are_keys() {
    let text = "duration = 0.01\ngravity = [0, 0, 0]\n\
        contact.liquid-bridge = { volume = 1e-9, tension = 0.07, contact-angle = 60 }\n\
        [material.glass]\ndensity = 2500\n[material.wax]\ndensity = 900\n\
        [[pair]]\nmaterials = [\"wax\", \"wax\"]\nliquid-bridge = { volume = 1e-9, tension = 0 }\n\
        [[wall]]\nplane = { normal = [0, 0, 1] }\nmaterial = \"glass\"\n\
        [[body]]\nshape = \"sphere\"\ndiameter = 0.02\nmaterial = \"glass\"\nposition = [0, 0, 0.00999]\n\
        [[body]]\nshape = \"sphere\"\ndiameter = 0.02\nmaterial = \"wax\"\nposition = [0, 1, 0.1]\n";
    let scenario = Scenario::from_toml(text).unwrap();
    let told = Scenario::from_toml(&scenario.to_toml().unwrap()).unwrap();
    assert_eq!(told, scenario);
    let mut simulation = scenario.build().unwrap();
    let laws = simulation.world.laws();
    let [glass, wax] = [1, 2].map(MaterialId);
    let wet = laws.between([glass, wax]).liquid_bridge.unwrap();
    assert!((wet.contact_angle - std::f64::consts::FRAC_PI_3).abs() < 1e-12);
    assert_eq!(laws.between([wax, wax]).liquid_bridge.unwrap().tension, 0.0);
    simulation.step().unwrap();
    // 4 pi R gamma cos(60 degrees) of the ball that touches.
    let pull = simulation.world.contacts()[0].adhesion.force.z;
    assert!((pull / -4.398_23e-3 - 1.0).abs() < 1e-5, "{pull}");
    let soft = "contact = { penetration = 1e-4, liquid-bridge";
    let chosen = text.replacen("contact.liquid-bridge", soft, 1);
    let chosen = chosen.replacen("= 60 }", "= 60 } }", 1);
    let penalty = Scenario::from_toml(&chosen)
        .unwrap()
        .build()
        .unwrap()
        .penalty;
    // 3/4 w R/depth² with 3/2 pi w R = 4 pi R gamma cos.
    let work = 8.0 / 3.0 * 0.07 * 0.5;
    let wanted = 0.75 * work * 0.01 / 2e-6_f64.powi(2);
    // Rounded up to two digits.
    assert!(
        (1.0..1.1).contains(&(penalty.value / wanted)),
        "{penalty:?}"
    );

    for (from, to, words) in [
        ("= 60", "= 95", "contact-angle = 95"),
        (
            "volume = 1e-9, tension = 0.07",
            "volume = 0, tension = 0.07",
            "contact.liquid-bridge.volume = 0",
        ),
        (
            "volume = 1e-9, tension = 0 ",
            "volume = 1e-9, tension = -1 ",
            "liquid-bridge.tension = -1",
        ),
        ("volume = 1e-9, tension = 0.07", "volume = 1e-9", "tension"),
    ] {
        assert!(text.contains(from), "{from}");
        let built =
            Scenario::from_toml(&text.replacen(from, to, 1)).and_then(|scene| scene.build());
        let message = built.map(|_| ()).unwrap_err().to_string();
        assert!(message.contains(words), "{to}: {message}");
    }
    let pack = "shape = \"sphere\"\nmaterial = \"glass\"\nliquid-bridge = { volume = 1e-9, tension = 0.07 }\n\
        [[pair]]\nmaterials = [\"glass\", \"glass\"]\nliquid-bridge = { volume = 2e-9, tension = 0.07 }\n";
    let pack = femdem::Scene::from_toml(pack).unwrap();
    assert_eq!(
        femdem::Scene::from_toml(&pack.to_toml().unwrap()).unwrap(),
        pack
    );
    let spec = pack.spec().unwrap();
    assert_eq!(spec.liquid_bridge.unwrap().volume, 1e-9);
    assert_eq!(spec.pairs[0].liquid_bridge.unwrap().volume, 2e-9);
}
