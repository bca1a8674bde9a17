//! A bed of cylinders in a tube, against X-ray tomography.

use std::fs;
use std::path::Path;
use std::thread;

use anyhow::{Context, Result};

use super::chart::{Series, svg};
use super::program::{Program, Summary, Workshop};
use super::report::{Check, Report, short};

/// Diameter and length of the cylinders, and diameter of the tube, m.
const DIAMETER: f64 = 3.42e-3;
const LENGTH: f64 = 3.46e-3;
const TUBE: f64 = 44.5e-3;

const FRICTIONS: [f64; 3] = [0.4, 0.6, 0.8];

/// Mean solid fraction of the measured bed.
const MEASURED: f64 = 0.592;

/// Largest distance from the mean that one of the frictions must reach.
const NEAR: f64 = 0.02;

/// Solid fraction of the measured bed against the distance from the wall in diameters of the cylinders, as printed by Farsi et al.
/// (2016) after Caulkin et al.
const PROFILE: [[f64; 2]; 30] = [
    [0.1, 0.199],
    [0.2, 0.375],
    [0.3, 0.501],
    [0.4, 0.588],
    [0.5, 0.646],
    [0.6, 0.675],
    [0.7, 0.675],
    [0.8, 0.638],
    [0.9, 0.551],
    [1.0, 0.499],
    [1.05, 0.483],
    [1.1, 0.507],
    [1.2, 0.549],
    [1.3, 0.588],
    [1.4, 0.614],
    [1.5, 0.617],
    [1.6, 0.609],
    [1.7, 0.588],
    [1.8, 0.562],
    [1.9, 0.551],
    [2.0, 0.554],
    [2.2, 0.585],
    [2.4, 0.588],
    [2.6, 0.575],
    [2.8, 0.570],
    [3.0, 0.575],
    [3.5, 0.580],
    [4.0, 0.577],
    [4.5, 0.580],
    [5.0, 0.575],
];

/// Where the profile turns, in diameters from the wall: maxima and minima lie between these, in turn.
const TURNS: [[f64; 2]; 4] = [[0.4, 0.9], [0.9, 1.2], [1.2, 1.7], [1.7, 2.2]];

/// Largest distance of a maximum or minimum from that of the measured bed, in diameters.
const TURNS_NEAR: f64 = 0.1;

/// A simulated bed.
struct Bed {
    friction: f64,
    summary: Summary,
    /// Distance from the wall in diameters of the cylinders, and solid fraction.
    profile: Vec<[f64; 2]>,
    /// Solid fraction over all distances.
    mean: f64,
}

/// Packs `count` cylinders at each friction.
///
/// # Errors
/// When the program cannot be built or fails.
pub(crate) fn run(workshop: &Workshop, count: u32) -> Result<Report> {
    let program = workshop.build("femdem", &[])?;
    let circumscribed = DIAMETER.hypot(LENGTH);
    let options = |friction: f64| {
        format!(
            "--shape cylinder:aspect={:.4} --diameter {circumscribed:.4e} --cylinder {TUBE}m --density 2410 --count {count} \
             --friction {friction} --seed 1 --threads 1",
            LENGTH / DIAMETER
        )
    };
    let beds = thread::scope(|scope| {
        let each = FRICTIONS.map(|friction| {
            let (program, options) = (&program, options(friction));
            let folder = workshop.results(&format!("xray-bed-{friction}"));
            scope.spawn(move || bed(program, friction, &options, &folder))
        });
        each.map(|bed| bed.join().expect("no panic in a bed"))
    });
    let beds: Vec<Bed> = beds.into_iter().collect::<Result<_>>()?;
    let picture = workshop.write("xray-bed.svg", chart(&beds).as_bytes())?;
    let commands =
        FRICTIONS.map(|friction| format!("cargo run --release -- pack {}", options(friction)));
    Ok(Report {
        name: "xray-bed",
        title: "A bed of cylinders measured by X-rays".to_owned(),
        text: TEXT.to_owned(),
        commands: commands.to_vec(),
        checks: checks(&beds),
        columns: vec![
            "friction",
            "solid_fraction",
            "measured_solid_fraction",
            "profile_rms_distance",
            "first_maximum_over_diameter",
            "first_minimum",
            "second_maximum",
            "second_minimum",
            "mean_penetration_over_d",
            "settled",
            "cpu_seconds",
        ],
        rows: beds.iter().map(row).collect(),
        attachments: vec![picture],
    })
}

const TEXT: &str = "Cylinders of 3.42 mm in diameter and 3.46 mm in length lie in a tube of 44.5 mm. The solid fraction of a real bed was \
measured by X-ray tomography (Caulkin et al., as printed by Farsi et al. 2016): its mean is 0.592, and its profile against the distance \
from the wall is the line \"X-rays\". Here they are deposited in sequence at three friction coefficients, with the program's defaults; the real \
bed had some 2,600. The solid fraction is taken over the whole width of the tube, away from floor and top, by exact clipping; the \
distance of the profiles is the root mean square over the printed points. The profiles turn where a parabola through the highest or lowest \
of these points and its neighbours does: those of the X-rays at 0.650, 1.045, 1.477 and 1.929 diameters.\n\n\
![Solid fraction against the distance from the wall](xray-bed.svg)";

fn bed(program: &Program, friction: f64, options: &str, folder: &Path) -> Result<Bed> {
    let summary = program.pack(options, folder)?;
    let analysed = folder.join("measured");
    program.measure("analyse", folder, "", &analysed)?;
    let path = analysed.join("analysis/wall-profile.csv");
    let text =
        fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))?;
    let (mut profile, mut sums) = (Vec::new(), [0.0; 2]);
    for line in text.lines().skip(1) {
        let cells: Vec<f64> = line
            .split(',')
            .map(|cell| cell.parse().unwrap_or(f64::NAN))
            .collect();
        sums[0] += cells[3];
        sums[1] += cells[2];
        profile.push([0.5 * (cells[0] + cells[1]) / DIAMETER, cells[4]]);
    }
    Ok(Bed {
        friction,
        summary,
        profile,
        mean: sums[0] / sums[1],
    })
}

impl Bed {
    /// Root mean square distance from the printed profile.
    fn distance(&self) -> f64 {
        let squares = PROFILE
            .iter()
            .map(|[x, wanted]| (self.at(*x) - wanted).powi(2));
        (squares.sum::<f64>() / PROFILE.len() as f64).sqrt()
    }

    /// Where the profile turns.
    fn turns(&self) -> [f64; 4] {
        turns(|i| self.at(PROFILE[i][0]))
    }

    /// The profile between its points, linearly.
    fn at(&self, x: f64) -> f64 {
        let next = self.profile.partition_point(|point| point[0] < x);
        let last = self.profile.len() - 1;
        let ([x0, y0], [x1, y1]) = (
            self.profile[next.saturating_sub(1).min(last)],
            self.profile[next.min(last)],
        );
        if x1 > x0 {
            y0 + (y1 - y0) * (x - x0) / (x1 - x0)
        } else {
            y1
        }
    }
}

/// The places where a profile with these values at the printed points turns: vertices of the parabolas through the highest or
/// lowest of them and its neighbours.
fn turns(value: impl Fn(usize) -> f64) -> [f64; 4] {
    let mut sign = -1.0;
    TURNS.map(|[from, to]| {
        sign = -sign;
        let within = |&i: &usize| from < PROFILE[i][0] && PROFILE[i][0] < to;
        let height = |i: &usize| sign * value(*i);
        let best = (1..PROFILE.len() - 1)
            .filter(within)
            .max_by(|a, b| height(a).total_cmp(&height(b)));
        let middle = best.expect("printed points within");
        let [(x0, y0), (x1, y1), (x2, y2)] =
            [middle - 1, middle, middle + 1].map(|i| (PROFILE[i][0], value(i)));
        let [left, right] = [(y1 - y0) / (x1 - x0), (y2 - y1) / (x2 - x1)];
        let bend = (right - left) / (x2 - x0);
        0.5 * (x0 + x1) - left / (2.0 * bend)
    })
}

fn row(bed: &Bed) -> Vec<String> {
    let number = |path| {
        bed.summary
            .number(path)
            .map_or_else(|_| "none".to_owned(), short)
    };
    let mut row = vec![
        bed.friction.to_string(),
        format!("{:.4}", bed.mean),
        MEASURED.to_string(),
        format!("{:.4}", bed.distance()),
    ];
    row.extend(bed.turns().map(|place| format!("{place:.3}")));
    row.extend([
        number("penetration.mean_over_d"),
        bed.summary.is_settled().to_string(),
        number("cpu_seconds"),
    ]);
    row
}

fn checks(beds: &[Bed]) -> Vec<Check> {
    let settled = beds.iter().all(|bed| bed.summary.is_settled());
    let nearest = beds.iter().map(|bed| (bed.mean - MEASURED).abs());
    let printed = turns(|i| PROFILE[i][1]);
    let off = beds.iter().flat_map(|bed| {
        let each = bed.turns().into_iter().zip(printed);
        each.map(|(place, wanted)| (place - wanted).abs())
    });
    vec![
        Check::holds(
            "all settled, verified with all bodies awake",
            "true",
            settled,
            settled,
        ),
        Check::at_most(
            "distance of the nearest mean solid fraction from 0.592",
            nearest.fold(f64::INFINITY, f64::min),
            NEAR,
            "",
        ),
        Check::at_most(
            "distance of the first two maxima and minima from those of the X-rays, all beds, in diameters",
            off.fold(0.0, f64::max),
            TURNS_NEAR,
            "",
        ),
    ]
}

fn chart(beds: &[Bed]) -> String {
    let mut series: Vec<Series> = beds
        .iter()
        .map(|bed| Series {
            name: format!("friction {}", bed.friction),
            points: bed
                .profile
                .iter()
                .copied()
                .filter(|point| point[0] <= 5.0)
                .collect(),
        })
        .collect();
    series.push(Series {
        name: "X-rays".to_owned(),
        points: PROFILE.to_vec(),
    });
    svg(
        ["distance from the wall / diameter", "solid fraction"],
        [0.0, 5.0],
        [0.0, 0.8],
        &series,
    )
}
