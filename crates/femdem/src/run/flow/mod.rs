//! Flow: walls that open, sources, and gates at which bodies are counted or leave.
//!
//! Before a step walls open and bodies come; after it those that have passed a gate are counted, and those beyond a sink leave. A
//! body keeps its number among the members when others leave, and these are not given again.

mod begin;
mod bring;
mod entry;
mod kinds;
mod ranks;
mod rows;
mod state;
mod step;

pub use entry::{GateEntry, SourceEntry};
pub(super) use ranks::SharedFlow;
pub use rows::{FLOW_COLUMNS, FlowSummary};
pub use state::Flow;
pub(super) use state::{Kind, Supply};
