//! Numbers in text for people.

/// A number to four digits, without trailing zeros; with an exponent if it is small or large.
#[must_use]
pub fn short_number(value: f64) -> String {
    let scientific = format!("{value:.3e}");
    match scientific.parse::<f64>() {
        Ok(rounded) if rounded == 0.0 || (1e-3..1e6).contains(&rounded.abs()) => {
            rounded.to_string()
        }
        _ => scientific,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_keep_four_digits() {
        for (value, text) in [
            (0.050_000_000_000_000_02, "0.05"),
            (10.604_9, "10.6"),
            (-123.456, "-123.5"),
            (0.0, "0"),
            (1.234_567e-7, "1.235e-7"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(short_number(value), text);
        }
    }
}
