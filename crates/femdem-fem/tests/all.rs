//! All tests of the public interface in one program, since each test file takes longer to link than to run.

mod fracture;
mod material;
mod model;
mod statics;
