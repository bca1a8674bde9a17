//! Round numbers for axes and colour scales.

/// Round numbers between two, evenly spaced, at least `least` apart.
pub(crate) fn even(low: f64, high: f64, least: f64) -> Vec<f64> {
    let rough = (high - low).max(f64::MIN_POSITIVE) / 6.0;
    let power = 10.0_f64.powi(rough.log10().floor() as i32);
    let steps = [1.0, 2.0, 5.0, 10.0].map(|digit| digit * power);
    let step = steps
        .into_iter()
        .find(|step| *step >= rough)
        .unwrap_or(rough)
        .max(least);
    let first = (low / step - 1e-9).ceil() as i64;
    let last = (high / step + 1e-9).floor() as i64;
    // Products of the index, so that rounding does not add up.
    (first..=last).map(|k| k as f64 * step).collect()
}

/// Round numbers from 0, and the last number itself in the place of one too near to it.
pub(crate) fn to_the_last(last: f64) -> Vec<f64> {
    let mut ticks = even(0.0, last, 1.0);
    let step = ticks.get(1).copied().unwrap_or(last);
    ticks.retain(|tick| *tick == 0.0 || last - tick >= 0.5 * step);
    ticks.push(last);
    ticks
}

/// Powers of ten between two numbers, with 3 between them, or 2 and 5 if the range is short.
pub(crate) fn decades(low: f64, high: f64) -> Vec<f64> {
    let span = (high / low).log10();
    let digits: &[f64] = match span {
        s if s < 1.2 => &[1.0, 2.0, 5.0],
        s if s < 2.5 => &[1.0, 3.0],
        _ => &[1.0],
    };
    let powers = low.log10().floor() as i32..=high.log10().ceil() as i32;
    powers
        .flat_map(|power| digits.iter().map(move |digit| digit * 10.0_f64.powi(power)))
        .filter(|tick| (low * 0.999..=high * 1.001).contains(tick))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_a_sequence_ends_with_the_last() {
        assert_eq!(to_the_last(499.0), [0.0, 100.0, 200.0, 300.0, 400.0, 499.0]);
        assert_eq!(to_the_last(520.0), [0.0, 100.0, 200.0, 300.0, 400.0, 520.0]);
        assert_eq!(even(0.0, 3.0, 1.0), [0.0, 1.0, 2.0, 3.0]);
        assert_eq!(even(0.52, 0.69, 0.0).len(), 3);
        assert_eq!(decades(0.5, 30.0), [1.0, 3.0, 10.0, 30.0]);
        assert_eq!(decades(1e-3, 5.0), [1e-3, 1e-2, 0.1, 1.0]);
    }
}
