//! femdem-pack.
