//! What a report shows of the course of a run: its tables over time as plots.

use std::path::Path;

use femdem_view::input::{PlainTable, read_plain};
use femdem_view::output::short_number;
use femdem_view::plot::{LineChart, Plot};
use femdem_view::report::FactTable;

use super::{HISTORY_COLUMNS, Run};
use crate::Error;

/// Lines of a chart: names and points.
type Lines = Vec<(String, Vec<[f64; 2]>)>;

/// Energies that bodies, contacts and bonds hold, with the columns of `history.csv` of which each is the sum.
const HELD: [(&str, &[&str]); 5] = [
    ("kinetic", &["kinetic"]),
    ("potential", &["potential"]),
    ("strain", &["strain"]),
    ("contacts", &["contact", "friction_springs"]),
    ("cracks and bonds", &["cracks", "bonds"]),
];

/// Energies that have been put in or dissipated.
const PASSED: [(&str, &[&str]); 6] = [
    ("work in", &["work_in", "by_hand"]),
    ("friction", &["dissipated_friction"]),
    ("damping of contacts", &["dissipated_damping", "frozen"]),
    ("medium", &["dissipated_medium"]),
    (
        "viscosity and plasticity",
        &["dissipated_viscous", "dissipated_plastic"],
    ),
    (
        "breaking",
        &[
            "dissipated_bridges",
            "dissipated_fracture",
            "dissipated_bonds",
            "dissipated_release",
        ],
    ),
];

/// The course of a run, as plots and tables.
#[derive(Clone, Debug, Default)]
pub struct Course {
    /// Energies, flow, walls and cells over time or strain.
    pub plots: Vec<Plot>,
    /// Peaks and ends of the stresses of cells.
    pub tables: Vec<FactTable>,
}

impl Run {
    /// What a report shows of the tables over time in the folder of the run; nothing of those that are not there.
    ///
    /// # Errors
    ///
    /// [`Error::View`] with the table that cannot be read.
    pub fn course(&self, folder: &Path) -> Result<Course, Error> {
        let read = |name: &str| {
            let path = folder.join(name);
            let table = path.is_file().then(|| read_plain(path)).transpose()?;
            Ok::<_, Error>(table.unwrap_or_default())
        };
        let history = read("history.csv")?;
        let mut charts = energies(&history);
        charts.extend(flow(&read("flow.csv")?));
        charts.extend(self.wall_forces(&history));
        charts.extend(wall_places(&read("wall_history.csv")?));
        let mut course = Course::default();
        for (number, (cell, rows)) in grouped(&read("cells.csv")?, "cell").iter().enumerate() {
            let Some((chart, table)) = stresses(cell, rows, number) else {
                continue;
            };
            charts.push(chart);
            course.tables.push(table);
        }
        course.plots = charts.iter().filter_map(LineChart::plot).collect();
        Ok(course)
    }

    /// Sizes of the forces on the walls.
    fn wall_forces(&self, history: &PlainTable) -> Option<LineChart> {
        let first = HISTORY_COLUMNS.len();
        let walls = self.simulation().walls.iter().zip((first..).step_by(3));
        let lines = walls.map(|(wall, at)| {
            let size = |row: &[String]| {
                let [x, y, z] = [at, at + 1, at + 2].map(|k| PlainTable::number(row, k));
                (x * x + y * y + z * z).sqrt()
            };
            Some((wall.name.clone(), over_time(history, &size)?))
        });
        let lines: Option<Lines> = lines.collect();
        Some(chart(
            ["wall-forces", "Forces on the walls", "force / N"],
            "Size of the force of the bodies on each wall.",
            lines?,
        ))
    }
}

fn chart([name, title, y]: [&str; 3], caption: &str, lines: Lines) -> LineChart {
    LineChart {
        name: name.to_owned(),
        title: title.to_owned(),
        x: "time / s".to_owned(),
        y: y.to_owned(),
        caption: caption.to_owned(),
        lines,
    }
}

/// A quantity of each row over its time; `None` without a column of the time.
fn over_time(table: &PlainTable, of: &dyn Fn(&[String]) -> f64) -> Option<Vec<[f64; 2]>> {
    let time = table.column("time")?;
    let point = |row: &Vec<String>| [PlainTable::number(row, time), of(row)];
    Some(table.rows.iter().map(point).collect())
}

fn energies(history: &PlainTable) -> Vec<LineChart> {
    let lines = |kinds: &[(&str, &[&str])]| -> Option<Lines> {
        let line = |(name, columns): &(&str, &[&str])| {
            let columns = columns.iter().map(|column| history.column(column));
            let columns: Vec<usize> = columns.collect::<Option<_>>()?;
            let sum = |row: &[String]| columns.iter().map(|k| PlainTable::number(row, *k)).sum();
            Some(((*name).to_owned(), over_time(history, &sum)?))
        };
        kinds.iter().map(line).collect()
    };
    let held = lines(&HELD).map(|lines| {
        let caption = "What the bodies, their contacts and bonds hold; potential energy in gravity relative to the origin.";
        chart(["energies", "Energies", "energy / J"], caption, lines)
    });
    let passed = lines(&PASSED).map(|lines| {
        let caption = "Up to a time: work of motions and loads, less what bodies that left took with them, and what was dissipated.";
        let name = ["dissipated", "Work and dissipation", "energy / J"];
        chart(name, caption, lines)
    });
    held.into_iter().chain(passed).collect()
}

/// The rows of a table that share their text in a column, in the order of their first rows.
fn grouped(table: &PlainTable, by: &str) -> Vec<(String, PlainTable)> {
    let Some(by) = table.column(by) else {
        return Vec::new();
    };
    let mut groups: Vec<(String, PlainTable)> = Vec::new();
    for row in &table.rows {
        let at = groups.iter().position(|(name, _)| *name == row[by]);
        let at = at.unwrap_or_else(|| {
            let columns = table.columns.clone();
            let rows = Vec::new();
            groups.push((row[by].clone(), PlainTable { columns, rows }));
            groups.len() - 1
        });
        groups[at].1.rows.push(row.clone());
    }
    groups
}

/// A column of each group over time.
fn column_lines(groups: &[(String, PlainTable)], column: &str) -> Option<Lines> {
    let line = |(name, rows): &(String, PlainTable)| {
        let at = rows.column(column)?;
        let points = over_time(rows, &|row| PlainTable::number(row, at))?;
        Some((name.clone(), points))
    };
    groups.iter().map(line).collect()
}

fn flow(table: &PlainTable) -> Vec<LineChart> {
    let groups = grouped(table, "name");
    let mass = column_lines(&groups, "mass").map(|lines| {
        let caption =
            "Mass that has passed gauges, left at sinks and come from sources up to a time.";
        chart(["flow", "Flow", "mass / kg"], caption, lines)
    });
    let rate = column_lines(&groups, "rate").map(|lines| {
        let caption = "Mass between two rows of flow.csv, over the time between them.";
        chart(["flow-rate", "Rate of flow", "rate / kg/s"], caption, lines)
    });
    mass.into_iter().chain(rate).collect()
}

/// Displacements of the walls that move, along each axis.
fn wall_places(table: &PlainTable) -> Option<LineChart> {
    let groups = grouped(table, "wall");
    let mut lines = Lines::new();
    for axis in ["x", "y", "z"] {
        let along = column_lines(&groups, axis)?.into_iter();
        lines.extend(along.map(|(name, points)| (format!("{name} {axis}"), points)));
    }
    Some(chart(
        ["wall-places", "Displacements of walls", "displacement / m"],
        "How far the walls are from where the scene places them, along each axis.",
        lines,
    ))
}

/// Stresses of a cell over the largest of its strains, and their peaks and ends.
fn stresses(cell: &str, rows: &PlainTable, number: usize) -> Option<(LineChart, FactTable)> {
    let numbers = |name: &str| -> Option<Vec<f64>> {
        let at = rows.column(name)?;
        Some(
            rows.rows
                .iter()
                .map(|row| PlainTable::number(row, at))
                .collect(),
        )
    };
    let reach = |values: &[f64]| {
        let finite = values.iter().filter(|v| v.is_finite());
        finite.fold(0.0_f64, |most, v| most.max(v.abs()))
    };
    let strains = ["strain_x", "strain_y", "strain_z", "shear_strain"];
    let strains = strains.map(|name| Some((name, numbers(name)?)));
    let (over, strain) = strains
        .into_iter()
        .flatten()
        .max_by(|a, b| reach(&a.1).total_cmp(&reach(&b.1)))?;
    let mut lines = Lines::new();
    let mut told = Vec::new();
    for name in ["stress_x", "stress_y", "stress_z", "shear_stress"] {
        let stress = numbers(name)?;
        let points: Vec<[f64; 2]> = strain.iter().zip(&stress).map(|(x, y)| [*x, *y]).collect();
        let finite = || points.iter().filter(|p| p.iter().all(|x| x.is_finite()));
        let peak = finite().max_by(|a, b| a[1].abs().total_cmp(&b[1].abs()));
        if let (Some([at, most]), Some([end, last])) = (peak, finite().next_back()) {
            let [at, most, end, last] = [at, most, end, last].map(|x| short_number(*x));
            let text = format!("peak {most} at {over} {at}; {last} at the end, {end}");
            told.push((
                format!("{} / Pa", name.replace('_', " ")),
                text.replace('_', " "),
            ));
        }
        lines.push((name.replace('_', " "), points));
    }
    let chart = LineChart {
        name: format!("stress-strain-{number}"),
        title: format!("Stress over strain of {cell}"),
        x: over.replace('_', " "),
        y: "stress / Pa".to_owned(),
        caption: "Mean stresses, positive in compression, over the strain that became largest."
            .to_owned(),
        lines,
    };
    let title = format!("Stresses of {cell}");
    Some((chart, FactTable { title, rows: told }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(text: &str) -> PlainTable {
        let mut lines = text.lines().map(|line| line.split(',').map(str::to_owned));
        let columns = lines.next().unwrap().collect();
        let rows = lines.map(Iterator::collect).collect();
        PlainTable { columns, rows }
    }

    #[test]
    fn stresses_stand_over_the_largest_strain_with_their_peak() {
        let rows = table(
            "time,cell,stress_x,stress_y,stress_z,strain_x,strain_y,strain_z,shear_stress,shear_strain\n\
             0,c,1,1,1,0,0,0,,\n1,c,1,1,5,-0.01,0,0.02,,\n2,c,1,1,3,-0.02,0,0.05,,",
        );
        let (chart, table) = stresses("c", &rows, 0).unwrap();
        assert_eq!(chart.x, "strain z");
        let told = table.rows.iter().find(|(name, _)| name == "stress z / Pa");
        assert_eq!(
            told.unwrap().1,
            "peak 5 at strain z 0.02; 3 at the end, 0.05"
        );
        // A box has no shear.
        assert_eq!(table.rows.len(), 3);
    }

    #[test]
    fn rows_are_grouped_by_name() {
        let rows = table("time,name,mass,rate\n0,a,0,0\n0,b,0,0\n1,a,2,2\n1,b,3,3");
        let charts = flow(&rows);
        let (name, points) = &charts[0].lines[1];
        assert_eq!((name.as_str(), points[1]), ("b", [1.0, 3.0]));
        assert!(
            flow(&PlainTable::default())
                .iter()
                .all(|c| c.lines.is_empty())
        );
    }
}
