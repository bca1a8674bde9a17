//! Measurements of packs: the crate femdem-analysis, and [`Tables`] of everything that can be measured of a
//! [`Snapshot`](crate::Snapshot).

// As a line of the docs: listed here, its items would come with all those of the crates below it.
#[doc(no_inline)]
pub use femdem_analysis::*;

pub use femdem_view::tables::{
    BodyTable, FOLDER, JSON, Missing, MixingSeries, Orientation, SCHEMA, TableOptions, Tables,
    telling_axes,
};
