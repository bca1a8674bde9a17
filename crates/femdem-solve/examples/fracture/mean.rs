//! Means of what is seen in a run.

/// A mean with its spread.
#[derive(Default)]
pub struct Mean {
    count: f64,
    sum: f64,
    squares: f64,
}

impl Mean {
    pub fn add(&mut self, value: f64) {
        self.count += 1.0;
        self.sum += value;
        self.squares += value * value;
    }

    pub fn value(&self) -> f64 {
        self.sum / self.count
    }

    /// Standard deviation.
    pub fn spread(&self) -> f64 {
        let mean = self.value();
        (self.squares / self.count - mean * mean).max(0.0).sqrt()
    }
}
