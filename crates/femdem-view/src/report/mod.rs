//! One page that shows a pack: `report.html`.
//!
//! The page is self-contained and opens offline in any browser: a 3-D view of the pack drawn with WebGL 2
//! (rotate, zoom, cut by a plane, colour, force chains, the numbers of a body), plots as SVG, and tables of
//! parameters and results. Without WebGL the page says so and shows the rest.
//!
//! ```
//! use femdem_mesh::{Pose, catalogue::Solid, catalogue::CatalogueShape};
//! use femdem_view::report::Report;
//! use femdem_view::{Body, NamedShape, Snapshot};
//!
//! let polyhedron = CatalogueShape::from(Solid::A10).polyhedron(0.1)?;
//! let body = Body { shape: 0, pose: Pose::identity(), sequence: 0, sleeping: false };
//! let shapes = vec![NamedShape { name: "A10".to_owned(), polyhedron }];
//! let snapshot = Snapshot { shapes, bodies: vec![body], ..Snapshot::default() };
//! let page = Report::new(&snapshot).html()?;
//! assert!(page.starts_with("<!DOCTYPE html>"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod block;
mod facts;
mod fracture;
mod mesh;
mod page;
mod view;

use femdem_mesh::catalogue::CatalogueShape;

pub use facts::{FactTable, KeyFigure, RunFacts};

use crate::output::counted;
use crate::plot::{Plot, escape, fracture_plots, plots};
use crate::tables::Tables;
use crate::{BodyValues, Colouring, Fracture, Snapshot, ViewError};

/// The contents of a report. Only the snapshot is required; what is not given is left out.
#[derive(Clone, Debug)]
pub struct Report<'a> {
    snapshot: &'a Snapshot,
    run: RunFacts,
    tables: Option<&'a Tables>,
    fracture: Option<&'a Fracture>,
    course: Vec<Plot>,
}

impl<'a> Report<'a> {
    /// A report of a pack from anywhere.
    #[must_use]
    pub fn new(snapshot: &'a Snapshot) -> Self {
        Self {
            snapshot,
            run: RunFacts::default(),
            tables: None,
            fracture: None,
            course: Vec::new(),
        }
    }

    /// Adds what is known of the run that made the pack.
    #[must_use]
    pub fn with_run(mut self, run: RunFacts) -> Self {
        self.run = run;
        self
    }

    /// Adds the measurements, and thus the plots.
    #[must_use]
    pub fn with_tables(mut self, tables: &'a Tables) -> Self {
        self.tables = Some(tables);
        self
    }

    /// Adds what is known of fracture, as a section.
    #[must_use]
    pub fn with_fracture(mut self, fracture: &'a Fracture) -> Self {
        self.fracture = Some(fracture);
        self
    }

    /// Adds plots of the course of the run, such as [`LineChart`](crate::plot::LineChart)s over time, as a section.
    #[must_use]
    pub fn with_course(mut self, course: Vec<Plot>) -> Self {
        self.course = course;
        self
    }

    /// The page. Without bodies it has no view.
    ///
    /// # Errors
    ///
    /// [`ViewError::NothingToDraw`] without bodies and without a course, as [`Snapshot::check`], and [`ViewError::Quantity`] for a crack
    /// facet with a number out of its range.
    pub fn html(&self) -> Result<String, ViewError> {
        self.snapshot.check()?;
        let has_view = !self.snapshot.bodies.is_empty();
        if !has_view && self.course.is_empty() {
            return Err(ViewError::NothingToDraw);
        }
        let (mut index, mut numbers) = Default::default();
        if has_view {
            let of_bodies = view::of(self.snapshot, &self.fields()?);
            // No "<" may end the element that holds the index.
            index = of_bodies.0.to_string().replace('<', "\\u003c");
            numbers = of_bodies.1;
        }
        let figures = if self.run.figures.is_empty() {
            self.tables.map(facts::measured).unwrap_or_default()
        } else {
            self.run.figures.clone()
        };
        let mut tables = self.run.tables.clone();
        tables.extend(self.tables.and_then(facts::missing));
        tables.push(facts::versions(&self.run));
        let command = self.run.command.as_deref();
        let broken = self.fracture.map(fracture::html).transpose()?;
        let measured = self.tables.map(plots).unwrap_or_default();
        let parts: [(&str, &str); 10] = [
            ("title", &escape(&self.title())),
            ("lead", &escape(&self.lead())),
            ("figures", &facts::figures_html(&figures)),
            ("course", &section("Over time", "", &self.course)),
            ("fracture", &broken.unwrap_or_default()),
            ("plots", &section("Measured", "", &measured)),
            ("facts", &facts::facts_html(&tables, command)),
            (
                "footer",
                "Units are SI: m, kg, s, N, Pa. d is the circumscribed diameter of a body.",
            ),
            ("index", &index),
            ("numbers", &numbers),
        ];
        Ok(page::fill(has_view, &parts))
    }

    /// The plots, for files.
    #[must_use]
    pub fn plots(&self) -> Vec<Plot> {
        let mut all = self.course.clone();
        all.extend(self.tables.map(plots).unwrap_or_default());
        all.extend(self.fracture.map(fracture_plots).unwrap_or_default());
        all
    }

    fn fields(&self) -> Result<Vec<(&'static str, BodyValues)>, ViewError> {
        let mut fields = Vec::new();
        let cells = self.tables.and_then(|tables| tables.set_voronoi.as_ref());
        for colouring in Colouring::ALL {
            if let Some(values) = colouring.values(self.snapshot, cells)? {
                fields.push((colouring.name(), values));
            }
        }
        Ok(fields)
    }

    /// Such as "500 bodies: truncated dodecahedron (A10)".
    fn title(&self) -> String {
        let name = self.snapshot.shape_name();
        let bodies = counted(self.snapshot.bodies.len(), "body", "bodies");
        match name.parse::<CatalogueShape>() {
            _ if self.snapshot.bodies.is_empty() => bodies,
            Ok(shape) => format!("{bodies}: {} ({name})", shape.solid.name()),
            Err(_) => format!("{bodies}: {name}"),
        }
    }

    fn lead(&self) -> String {
        let contacts = counted(self.snapshot.contacts.len(), "contact.", "contacts.");
        match &self.run.lead {
            Some(lead) => format!("{lead}; {contacts}"),
            None => contacts,
        }
    }
}

/// Plots side by side under a heading and what belongs to all of them; empty without either.
fn section(heading: &str, lead: &str, plots: &[Plot]) -> String {
    if lead.is_empty() && plots.is_empty() {
        return String::new();
    }
    let figure = |plot: &Plot| {
        format!(
            "<figure class=\"card\"><h3>{}</h3>\n{}\n<figcaption>{}</figcaption></figure>\n",
            escape(&plot.title),
            plot.svg(),
            escape(&plot.caption)
        )
    };
    let figures: String = plots.iter().map(figure).collect();
    format!("<h2>{heading}</h2>\n{lead}<div class=\"plots\">\n{figures}</div>")
}
