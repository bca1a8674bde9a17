//! Numbers in text for people.

/// A number to four digits, without trailing zeros; with an exponent if it is small or large.
#[must_use]
pub fn short_number(value: f64) -> String {
    // Adding zero makes -0, such as a sum over nothing, 0.
    let scientific = format!("{:.3e}", value + 0.0);
    match scientific.parse::<f64>() {
        Ok(rounded) if rounded == 0.0 || (1e-3..1e6).contains(&rounded.abs()) => {
            rounded.to_string()
        }
        _ => scientific,
    }
}

/// A number of things by their name: "1 body", "2 bodies".
#[must_use]
pub fn counted(count: usize, one: &str, several: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { several })
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
            (-0.0, "0"),
            (1.234_567e-7, "1.235e-7"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(short_number(value), text);
        }
    }
}
