//! Shared by the examples.

use std::error::Error;

/// Runs on one thread, so that processor time is that of the work.
pub fn on_one_thread(run: fn() -> Result<(), Box<dyn Error>>) -> Result<(), Box<dyn Error>> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .use_current_thread()
        .build()?;
    pool.install(|| run().map_err(|e| e.to_string()))?;
    Ok(())
}
