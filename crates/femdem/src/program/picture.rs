//! `femdem picture`: a picture of a pack, for papers.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueEnum};
use femdem::analysis::{TableOptions, Tables};
use femdem::picture::{Image, PictureOptions, draw_by};
use femdem::{Colouring, output};

use super::running::{Outcome, in_pool};
use super::source::{self, ForeignArgs, FrameArgs};
use super::{folder, say};

/// Where the eye stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Standpoint {
    /// In front, level
    Front,
    /// At the right, level
    Side,
    /// Above
    Top,
    /// In front to the right, a little above
    Iso,
}

impl Standpoint {
    /// Azimuth and elevation in degrees.
    fn angles(self) -> [f64; 2] {
        let usual = PictureOptions::default();
        match self {
            Self::Front => [0.0, 0.0],
            Self::Side => [90.0, 0.0],
            Self::Top => [0.0, 90.0],
            Self::Iso => [usual.azimuth, usual.elevation],
        }
    }
}

/// Options of `femdem picture`.
#[derive(Debug, Args)]
pub(crate) struct PictureArgs {
    /// Folder of a run, which holds pack.ckpt or run.ckpt (drawn as it stands there, by its stresses, unless
    /// --colour, --frame or --time is given), or of a pack from elsewhere, which holds bodies.csv
    pub folder: PathBuf,

    /// Where the eye stands
    #[arg(long, value_enum, default_value = "iso")]
    pub view: Standpoint,

    /// Degrees that the eye goes round to the right of the front, instead of --view
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true)]
    pub azimuth: Option<f64>,

    /// Degrees that the eye looks down, instead of --view
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true)]
    pub elevation: Option<f64>,

    /// What the bodies are coloured by [default: sequence; the end of a run: stress]
    #[arg(long, value_parser = colouring(), alias = "color")]
    pub colour: Option<Colouring>,

    /// Width and height in pixels, 16 to 8192 each
    #[arg(long, value_name = "WxH", default_value = "1200x1200", value_parser = size)]
    pub size: [usize; 2],

    /// The picture: a .png file, or an .svg file that holds the same pixels
    #[arg(long, value_name = "FILE", default_value = "picture.png")]
    pub out: PathBuf,

    #[command(flatten)]
    pub frame: FrameArgs,

    #[command(flatten)]
    pub foreign: ForeignArgs,

    /// Threads, 1 or more [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,

    /// Nothing on the terminal; errors are still shown
    #[arg(long, short)]
    pub quiet: bool,
}

/// The colourings by name.
fn colouring() -> impl TypedValueParser<Value = Colouring> {
    let values = Colouring::ALL.map(|colouring| {
        PossibleValue::new(colouring.name()).help(match colouring {
            Colouring::Sequence => {
                "Number in the order of placement; bodies placed together share one. If all are, the number of the body"
            }
            Colouring::Coordination => "Number of bodies and walls that touch the body",
            Colouring::Force => "Sum of the normal forces on the body",
            Colouring::Density => "Volume of the body over the volume of its Set-Voronoi cell",
            Colouring::Orientation => {
                "Angle between the body's axis, or its nearest face normal, and the vertical"
            }
            Colouring::Shape => "Number of the body's shape, where there are several",
            Colouring::Size => "Circumscribed diameter of the body, where they differ",
        })
    });
    PossibleValuesParser::new(values).try_map(|name| {
        let mut all = Colouring::ALL.into_iter();
        all.find(|colouring| colouring.name() == name)
            .ok_or("there is no such colour")
    })
}

/// "1200x800" as two numbers.
fn size(text: &str) -> Result<[usize; 2], String> {
    let both = text
        .split_once('x')
        .and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]));
    both.ok_or_else(|| "give a width and a height in pixels, such as 1200x800".to_owned())
}

pub(crate) fn run(args: &PictureArgs) -> Result<Outcome> {
    let vector = is_svg(&args.out)?;
    in_pool(args.threads.map(usize::from), |_| {
        let as_pack = args.colour.is_some() || args.foreign.is_given() || args.frame.is_given();
        if folder::holds_run(&args.folder) && !as_pack {
            let (run, _) = femdem::run::Run::read(&args.folder)?;
            let image = run.picture(&args.options())?;
            if !args.quiet && run.simulation().world.body_count() == 0 {
                say("the end of the run holds no body: its walls are drawn");
            }
            return args.write(&image, vector);
        }
        let snapshot = source::read(&args.folder, &args.foreign, &args.frame)?.snapshot;
        let colour = args.colour.unwrap_or_default();
        let cells = match colour {
            Colouring::Density => Tables::compute(&snapshot, &TableOptions::default())?.set_voronoi,
            _ => None,
        };
        let values = colour.values(&snapshot, cells.as_ref())?.with_context(|| {
            format!(
                "the pack does not hold what the colour {} needs: choose another with --colour",
                colour.name()
            )
        })?;
        let image = draw_by(&snapshot, &values, &args.options())?;
        args.write(&image, vector)
    })
}

impl PictureArgs {
    fn options(&self) -> PictureOptions {
        let [azimuth, elevation] = self.view.angles();
        let [width, height] = self.size;
        PictureOptions {
            width,
            height,
            azimuth: self.azimuth.unwrap_or(azimuth),
            elevation: self.elevation.unwrap_or(elevation),
        }
    }

    fn write(&self, image: &Image, vector: bool) -> Result<Outcome> {
        output::write_file(&self.out, |w| {
            if vector {
                image.write_svg(w)
            } else {
                image.write_png(w)
            }
        })?;
        if !self.quiet {
            say(&format!("wrote {}", self.out.display()));
        }
        Ok(Outcome::Finished)
    }
}

/// Whether a file is SVG by its ending; PNG otherwise, and nothing else.
fn is_svg(path: &Path) -> Result<bool> {
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    match ending.as_deref() {
        Some("svg") => Ok(true),
        Some("png") => Ok(false),
        _ => bail!(
            "{} is neither .png nor .svg: give another file with --out",
            path.display()
        ),
    }
}
