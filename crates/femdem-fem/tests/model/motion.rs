//! Bars and blocks in motion: waves, frequencies, energy.

use super::*;
use femdem_fem::material::J2;
use femdem_fem::{Boundary, Curve, DeformableBody, DeformableState, Selection};
use std::f64::consts::PI;

const YOUNG: f64 = 1e7;
const DENSITY: f64 = 1000.0;

/// A bar along x of `cells` cubes of side 0.1 m.
fn bar(cells: u32, element: Element) -> Arc<DeformableModel> {
    let size = Vector3::new(0.1 * f64::from(cells), 0.1, 0.1);
    let mesh = TetMesh::block([cells, 1, 1], &size).unwrap();
    Arc::new(model(&mesh, element, neo_hookean(YOUNG, 0.3)))
}

/// A pulse of pressure on one end travels along the bar at sqrt(E/rho), from the times at which its centre of
/// energy passes two sections. Target: 0.5 %.
#[test]
fn a_pulse_runs_at_the_speed_of_the_bar() {
    for (element, cells) in [
        (Element::T4, 80),
        (Element::T10, 40),
        (Element::T10Fbar, 40),
    ] {
        let model = bar(cells, element);
        let c = (YOUNG / DENSITY).sqrt();
        let length = 0.1 * f64::from(cells);
        let rise = 0.5 * length / c;
        let end = Selection::Plane {
            normal: Vector3::x(),
            offset: 0.0,
            tolerance: 1e-9,
        };
        // sin^2, piecewise linear.
        let table = (0..=40).map(|k| {
            let part = f64::from(k) / 40.0;
            [part * rise, 1e3 * (PI * part).sin().powi(2)]
        });
        let mut boundary = Boundary::default();
        boundary
            .press(&model, &end, Curve::Table(table.collect()))
            .unwrap();
        let mut body = DeformableBody::new(model.clone(), boundary).unwrap();
        let dt = 0.9 * body.critical_step().unwrap();
        let sections = [0.25 * length, 0.65 * length];
        let nodes = sections.map(|s| model.select_by(|x| (x.x - s).abs() < 1e-9));
        assert!(nodes.iter().all(|n| n.len() >= 4));
        let mut moments = [[0.0; 2]; 2];
        // Until the pulse has passed the second section, before it returns from the far end.
        while body.time() < 1.2 * length / c {
            body.step(dt).unwrap();
            for (moment, nodes) in moments.iter_mut().zip(&nodes) {
                let v: f64 = nodes.iter().map(|&n| body.state().v[n as usize].x).sum();
                moment[0] += v * v;
                moment[1] += v * v * body.time();
            }
        }
        let [first, second] = moments.map(|m| m[1] / m[0]);
        let speed = (sections[1] - sections[0]) / (second - first);
        println!("{element:?}: {}", speed / c - 1.0);
        assert!(
            (speed / c - 1.0).abs() < 0.005,
            "{element:?}: {speed} against {c}"
        );
    }
}

/// A bar without supports oscillates longitudinally with c/(2 L): 0.5 %.
#[test]
fn a_free_bar_swings_at_its_frequency() {
    for (element, cells) in [
        (Element::T4, 40),
        (Element::T4NodalPressure, 40),
        (Element::T10, 20),
        (Element::T10Fbar, 20),
    ] {
        let model = bar(cells, element);
        let c = (YOUNG / DENSITY).sqrt();
        let length = 0.1 * f64::from(cells);
        let shape = |x: &Vector3| (PI * x.x / length).cos();
        let mut state = DeformableState::reference(&model);
        for (v, x) in state.v.iter_mut().zip(model.nodes()) {
            v.x = 0.01 * shape(x);
        }
        let mut body =
            DeformableBody::with_state(model.clone(), Boundary::default(), state, 0.0).unwrap();
        let dt = 0.5 * body.critical_step().unwrap();
        let amplitude = |body: &DeformableBody| -> f64 {
            let nodes = body.state().x.iter().zip(model.nodes()).zip(model.masses());
            nodes
                .map(|((x, reference), m)| m * (x - reference).x * shape(reference))
                .sum()
        };
        // Upward zero crossings, by linear interpolation.
        let (mut before, mut crossings) = (0.0, Vec::new());
        while crossings.len() < 2 {
            body.step(dt).unwrap();
            let now = amplitude(&body);
            if before < 0.0 && now >= 0.0 {
                crossings.push(body.time() - dt * now / (now - before));
            }
            before = now;
        }
        let frequency = 1.0 / (crossings[1] - crossings[0]);
        let expected = c / (2.0 * length);
        println!("{element:?}: {}", frequency / expected - 1.0);
        assert!(
            (frequency / expected - 1.0).abs() < 0.005,
            "{element:?}: {frequency} against {expected}"
        );
    }
}

/// A block released from a strained state keeps its energy: at 0.2 of the critical step it fluctuates by
/// under 0.4 %, and its mean over the last quarter equals that over the second to 2e-4. (In the first one the
/// motion changes from low to high frequencies, to which the leapfrog assigns slightly less energy.)
#[test]
fn free_vibration_has_no_trend_of_energy() {
    for element in ELEMENTS {
        let model = Arc::new(two_regions(&crooked(), element));
        let mut state = DeformableState::reference(&model);
        state.x = placed(&model, &strained(), 0.003);
        let mut body = DeformableBody::with_state(model, Boundary::default(), state, 0.0).unwrap();
        let dt = 0.2 * body.critical_step().unwrap();
        let steps = 8000;
        let energies: Vec<f64> = (0..steps)
            .map(|_| {
                body.step(dt).unwrap();
                (body.ledger().kinetic + body.ledger().elastic) / body.ledger().initial - 1.0
            })
            .collect();
        let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
        let quarter = steps / 4;
        let trend = mean(&energies[3 * quarter..]) - mean(&energies[quarter..2 * quarter]);
        let swing = energies.iter().fold(0.0_f64, |m, e| m.max(e.abs()));
        println!("{element:?}: trend {trend:e}, swing {swing:e}");
        assert!(trend.abs() < 2e-4, "{element:?}: {trend:e}");
        assert!(swing < 4e-3, "{element:?}: {swing:e}");
    }
}

/// At 0.95 of the bound a block is stable for thousands of steps; well above the true limit it is not.
#[test]
fn the_bound_is_a_stable_step() {
    for element in ELEMENTS {
        let model = Arc::new(model(&crooked(), element, neo_hookean(1e6, 0.45)));
        let mut state = DeformableState::reference(&model);
        for (i, v) in state.v.iter_mut().enumerate() {
            *v = noisy(i, 9) * 0.02;
        }
        let run = |factor: f64| {
            let mut body =
                DeformableBody::with_state(model.clone(), Boundary::default(), state.clone(), 0.0)
                    .unwrap();
            let dt = factor * body.critical_step().unwrap();
            (0..2000).try_for_each(|_| body.step(dt)).map(|()| body)
        };
        let body = run(0.95).unwrap();
        assert!(body.ledger().error_relative().abs() < 0.1);
        let error = run(2.2).unwrap_err().to_string();
        assert!(
            error.contains("step") && error.contains("element"),
            "{error}"
        );
    }
}

/// Viscous and plastic work are in the ledger: oscillating blocks that are damped, and one that is squeezed.
#[test]
fn dissipation_is_accounted_for() {
    for element in ELEMENTS {
        let viscous = Arc::new(model(&crooked(), element, split(4e5, 2e6, 200.0)));
        let mut state = DeformableState::reference(&viscous);
        state.x = placed(&viscous, &strained(), 0.0);
        let mut body =
            DeformableBody::with_state(viscous, Boundary::default(), state, 0.0).unwrap();
        let dt = 0.2 * body.critical_step().unwrap();
        while body.time() < 0.2 {
            body.step(dt).unwrap();
        }
        let ledger = *body.ledger();
        assert!(
            ledger.viscous > 0.5 * ledger.initial,
            "{element:?}: {ledger:?}"
        );
        assert!(
            ledger.error_relative().abs() < 2e-3,
            "{element:?}: {}",
            ledger.error_relative()
        );

        let metal = J2::new(1e7, 0.3, 1e5, 1e5).unwrap();
        let plastic = Arc::new(model(&crooked(), element, metal.into()));
        let mut state = DeformableState::reference(&plastic);
        for (v, x) in state.v.iter_mut().zip(plastic.nodes()) {
            v.x = -10.0 * (x.x - 0.25);
        }
        let mut body =
            DeformableBody::with_state(plastic, Boundary::default(), state, 0.0).unwrap();
        let dt = 0.15 * body.critical_step().unwrap();
        while body.time() < 0.05 {
            body.step(dt).unwrap();
        }
        let ledger = *body.ledger();
        assert!(
            ledger.plastic > 0.3 * ledger.initial,
            "{element:?}: {ledger:?}"
        );
        assert!(
            ledger.error_relative().abs() < 2e-3,
            "{element:?}: {}",
            ledger.error_relative()
        );
    }
}
