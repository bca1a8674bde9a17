//! femdem.
