//! Linear programmes in few variables.

/// Bound on all variables: the problems are scaled to order one.
const BOX: f64 = 1e3;
/// Rows whose largest coefficient is below this do not constrain the variables.
const ZERO: f64 = 1e-13;

/// A half-space `coefficients . x <= limit`.
#[derive(Clone, Debug)]
pub(super) struct HalfSpace {
    pub(super) coefficients: Vec<f64>,
    pub(super) limit: f64,
}

impl HalfSpace {
    fn excess(&self, x: &[f64]) -> f64 {
        let product: f64 = self.coefficients.iter().zip(x).map(|(a, x)| a * x).sum();
        product - self.limit
    }

    /// The half-space within the plane of `plane`, with variable `k` eliminated.
    fn within(&self, plane: &Self, k: usize) -> Self {
        let ratio = self.coefficients[k] / plane.coefficients[k];
        let mut coefficients: Vec<f64> = self
            .coefficients
            .iter()
            .zip(&plane.coefficients)
            .map(|(a, b)| a - ratio * b)
            .collect();
        coefficients.remove(k);
        Self {
            coefficients,
            limit: self.limit - ratio * plane.limit,
        }
    }
}

/// The x that maximises `objective . x` within all half-spaces and the box of half-width `BOX`;
/// none if they have no point in common.
///
/// R. Seidel, Discrete Comput. Geom. 6 (1991) 423-434: half-spaces are added one at a time; where
/// one cuts off the best point so far, the new best lies in its plane. Expected time is linear for
/// half-spaces in random order.
pub(super) fn maximise(objective: &[f64], half_spaces: &[HalfSpace]) -> Option<Vec<f64>> {
    if let [slope] = *objective {
        return maximise_on_line(slope, half_spaces).map(|x| vec![x]);
    }
    let mut best: Vec<f64> = objective.iter().map(|c| BOX.copysign(*c)).collect();
    for (i, plane) in half_spaces.iter().enumerate() {
        if plane.excess(&best) <= ZERO {
            continue;
        }
        let size = |k: &usize| plane.coefficients[*k].abs();
        let k = (0..objective.len()).max_by(|a, b| size(a).total_cmp(&size(b)))?;
        if size(&k) < ZERO {
            return None;
        }
        let goal = HalfSpace {
            coefficients: objective.to_vec(),
            limit: 0.0,
        };
        let mut inner: Vec<HalfSpace> = half_spaces[..i]
            .iter()
            .map(|other| other.within(plane, k))
            .collect();
        for sign in [1.0, -1.0] {
            let mut side = HalfSpace {
                coefficients: vec![0.0; objective.len()],
                limit: BOX,
            };
            side.coefficients[k] = sign;
            inner.push(side.within(plane, k));
        }
        best = maximise(&goal.within(plane, k).coefficients, &inner)?;
        let rest: f64 = plane
            .coefficients
            .iter()
            .enumerate()
            .filter(|(j, _)| *j != k)
            .zip(&best)
            .map(|((_, a), x)| a * x)
            .sum();
        best.insert(k, (plane.limit - rest) / plane.coefficients[k]);
    }
    Some(best)
}

fn maximise_on_line(slope: f64, half_spaces: &[HalfSpace]) -> Option<f64> {
    let (mut low, mut high) = (-BOX, BOX);
    for half_space in half_spaces {
        let a = half_space.coefficients[0];
        let end = half_space.limit / a;
        if a > ZERO {
            high = high.min(end);
        } else if a < -ZERO {
            low = low.max(end);
        } else if half_space.limit < -ZERO * BOX {
            return None;
        }
    }
    let slack = 1e-12 * (1.0 + low.abs());
    (low <= high + slack).then_some(if slope >= 0.0 { high } else { low })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn half_space(coefficients: &[f64], limit: f64) -> HalfSpace {
        HalfSpace {
            coefficients: coefficients.to_vec(),
            limit,
        }
    }

    #[test]
    fn a_programme_solved_by_hand() {
        // Max 3 x + 2 y; x + y <= 4, x + 3 y <= 6, x <= 3, x, y >= 0: best at (3, 1).
        let limits = [
            half_space(&[-1.0, 0.0], 0.0),
            half_space(&[0.0, -1.0], 0.0),
            half_space(&[1.0, 1.0], 4.0),
            half_space(&[1.0, 3.0], 6.0),
            half_space(&[1.0, 0.0], 3.0),
        ];
        let best = maximise(&[3.0, 2.0], &limits).unwrap();
        assert!((best[0] - 3.0).abs() < 1e-12 && (best[1] - 1.0).abs() < 1e-12);
    }

    #[test]
    fn contradictions_have_no_solution() {
        let limits = [half_space(&[1.0, 0.0], 0.0), half_space(&[-1.0, 0.0], -1.0)];
        assert!(maximise(&[0.0, 1.0], &limits).is_none());
    }
}
