//! All tests of the public interface in one program, since each test file takes longer to link than to run.

mod packing;
mod ranks;
mod specs;
#[expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]
#[path = "../../femdem-solve/tests/common/ranks.rs"]
mod threads;
