//! All tests of the public interface in one program: each by itself takes longer to link than to run.

mod report;
mod round_trip;
