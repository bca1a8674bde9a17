//! femdem-solve.
