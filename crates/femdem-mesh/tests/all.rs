//! All tests of the public interface in one program, since each test file takes longer to link than to run.

mod catalogue;
mod cracks;
mod files;
mod hostile;
mod shapes;
mod structured;
mod tet;
