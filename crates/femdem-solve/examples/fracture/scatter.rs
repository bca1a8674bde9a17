//! What strengths that scatter follow.

/// A line through points: its slope, and half of the interval that holds it at 95 %.
pub struct Line {
    pub slope: f64,
    pub half: f64,
}

impl Line {
    /// By least squares, with the quantile of Student's distribution for ν = n − 2 in its expansion z + (z³ + z)/4ν (Abramowitz and
    /// Stegun, 26.7.5).
    pub fn through(points: &[[f64; 2]]) -> Self {
        const Z: f64 = 1.959_964;
        let count = points.len() as f64;
        let mean = |k: usize| points.iter().map(|p| p[k]).sum::<f64>() / count;
        let (x, y) = (mean(0), mean(1));
        let square: f64 = points.iter().map(|p| (p[0] - x).powi(2)).sum();
        let mixed: f64 = points.iter().map(|p| (p[0] - x) * (p[1] - y)).sum();
        let slope = mixed / square;
        let rest = points
            .iter()
            .map(|p| (p[1] - y - slope * (p[0] - x)).powi(2));
        let free = count - 2.0;
        let error = (rest.sum::<f64>() / free / square).sqrt();
        let student = Z + (Z.powi(3) + Z) / (4.0 * free);
        Self {
            slope,
            half: student * error,
        }
    }
}

/// The modulus m of Weibull's law that is most likely for groups of strengths, each of a scale of its own: the root of
/// 1/m + mean of ln x − Σ n_g/n (Σ x^m ln x/Σ x^m)_g.
pub fn modulus(groups: &[Vec<f64>]) -> f64 {
    let count: f64 = groups.iter().map(|g| g.len() as f64).sum();
    let excess = |m: f64| {
        let of = |group: &Vec<f64>| {
            let largest = group.iter().copied().fold(0.0, f64::max);
            let (mut sum, mut powers, mut mixed) = (0.0, 0.0, 0.0);
            for x in group {
                let log = (x / largest).ln();
                let power = (m * log).exp();
                sum += log;
                powers += power;
                mixed += power * log;
            }
            sum - group.len() as f64 * mixed / powers
        };
        1.0 / m + groups.iter().map(of).sum::<f64>() / count
    };
    // Falls from infinity to below 0.
    let (mut low, mut high) = (0.1, 1000.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if excess(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}
