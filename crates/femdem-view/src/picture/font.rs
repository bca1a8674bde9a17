//! A small stroke font for labels: ASCII letters, digits and the marks that numbers need.

/// A straight piece of a line, in pixels.
pub(super) type Segment = [[f64; 2]; 2];

/// Height of capitals in units.
const CAPITAL: f64 = 10.0;

/// Space between letters, in units.
const SPACING: f64 = 2.6;

/// Width of a space, in units.
const SPACE: f64 = 3.2;

/// The bowl shared by several small letters: a loop, see [`strokes`].
const BOWL: &str = "~0k0d6d6k0k";

/// The strokes of a character, separated by spaces.
///
/// A point is a digit for x and a letter for y: d is the baseline, k the height of small letters,
/// n that of capitals. `~` makes the stroke smooth: a quadratic B-spline over the points, closed if
/// the last point is the first.
fn strokes(c: char) -> Option<&'static [&'static str]> {
    Some(match c {
        '0' => &["~0n0d6d6n0n"],
        '1' => &["1l3n3d"],
        '2' => &["~0k0n6n6i3g0d", "0d6d"],
        '3' => &["~0l0n6n6i2i", "~2i7i7d0d0f"],
        '4' => &["5d5n0g7g"],
        '5' => &["6n1n0i", "~0i1j6k7d0d0e"],
        '6' => &["~5n1m0g", "~0j0d6d6j0j"],
        '7' => &["0n6n2d"],
        '8' => &["~1n1i5i5n1n", "~0i0d6d6i0i"],
        '9' => &["~6k5e1d", "~0n0h6h6n0n"],
        'a' => &[BOWL, "6k6d"],
        'b' => &[BOWL, "0n0d"],
        'c' => &["~6j5k0k0d5d6e"],
        'd' => &[BOWL, "6n6d"],
        'e' => &["0h6h", "~6h6k0k0d5d6e"],
        'f' => &["~5n2n2k", "2k2d", "0k4k"],
        'g' => &[BOWL, "6k6d", "~6d6a1a0b"],
        'h' => &["0n0d", "~0g0k6k6g", "6g6d"],
        'i' => &["0k0d", "0m0n"],
        'j' => &["2k2c", "~2c2a0a", "2m2n"],
        'k' => &["0n0d", "5k0f", "2h5d"],
        'l' => &["0n0d"],
        'm' => &["0k0d", "~0h0k4k4h", "4h4d", "~4h4k8k8h", "8h8d"],
        'n' => &["0k0d", "~0g0k6k6g", "6g6d"],
        'o' => &[BOWL],
        'p' => &[BOWL, "0k0a"],
        'q' => &[BOWL, "6k6a"],
        'r' => &["0k0d", "~0g0k4k"],
        's' => &["~5j5k0k0h5g6d1d0e"],
        't' => &["2m2f", "~2f2d4d", "0k4k"],
        'u' => &["0k0g", "~0g0d6d6g", "6k6d"],
        'v' => &["0k3d6k"],
        'w' => &["0k2d4k6d8k"],
        'x' => &["0k5d", "5k0d"],
        'y' => &["0k3d", "6k2a"],
        'z' => &["0k5k0d5d"],
        'A' => &["0d4n8d", "1g7g"],
        'B' => &["0d0n", "~0n7n7i0i", "~0i8i8d0d"],
        'C' => &["~7l7n0n0d7d7f"],
        'D' => &["0n0d", "~0n8n8d0d"],
        'E' => &["6n0n0d6d", "0i5i"],
        'F' => &["6n0n0d", "0i5i"],
        'G' => &["~7l7n0n0d7d7h", "7h4h"],
        'H' => &["0n0d", "7n7d", "0i7i"],
        'I' => &["0n0d"],
        'J' => &["5n5f", "~5f5d0d0f"],
        'K' => &["0n0d", "6n0g", "2i6d"],
        'L' => &["0n0d5d"],
        'M' => &["0d0n4f8n8d"],
        'N' => &["0d0n7d7n"],
        'O' => &["~0n0d8d8n0n"],
        'P' => &["0d0n", "~0n7n7h0h"],
        'Q' => &["~0n0d8d8n0n", "5f8c"],
        'R' => &["0d0n", "~0n7n7h0h", "3h7d"],
        'S' => &["~6l6n0n0i7i7d0d0f"],
        'T' => &["0n8n", "4n4d"],
        'U' => &["0n0g", "~0g0d7d7g", "7g7n"],
        'V' => &["0n4d8n"],
        'W' => &["0n2d5n7d9n"],
        'X' => &["0n7d", "7n0d"],
        'Y' => &["0n4i8n", "4i4d"],
        'Z' => &["0n7n0d7d"],
        '.' => &["0d0d"],
        ',' => &["1d0b"],
        ':' => &["0d0d", "0j0j"],
        '-' => &["0h4h"],
        '+' => &["0h6h", "3k3e"],
        '=' => &["0i6i", "0g6g"],
        '/' => &["0c4n"],
        '_' => &["0c6c"],
        '(' => &["~2n0l0d2b"],
        ')' => &["~0n2l2d0b"],
        _ => return None,
    })
}

/// The line pieces of a character, with the left end of its baseline at `at` and y downward.
/// Characters that the font lacks are blank.
pub(super) fn segments(c: char, at: [f64; 2], height: f64) -> Vec<Segment> {
    let scale = height / CAPITAL;
    let mut segments = Vec::new();
    for stroke in strokes(c).unwrap_or_default() {
        let line: Vec<[f64; 2]> = outline(stroke)
            .into_iter()
            .map(|[x, y]| [at[0] + scale * x, at[1] - scale * y])
            .collect();
        segments.extend(line.windows(2).map(|pair| [pair[0], pair[1]]));
    }
    segments
}

/// Distance to the next character.
pub(super) fn advance(c: char, height: f64) -> f64 {
    let right = |stroke: &&str| {
        outline(stroke)
            .into_iter()
            .map(|p| p[0])
            .fold(0.0, f64::max)
    };
    let width = strokes(c).map_or(SPACE, |strokes| {
        strokes.iter().map(right).fold(0.0, f64::max)
    });
    (width + SPACING) * height / CAPITAL
}

/// Width of a line of text, without the space after the last letter.
pub(super) fn width(text: &str, height: f64) -> f64 {
    let sum: f64 = text.chars().map(|c| advance(c, height)).sum();
    (sum - SPACING * height / CAPITAL).max(0.0)
}

/// The points of a stroke, in units, y upward.
fn outline(stroke: &str) -> Vec<[f64; 2]> {
    let (smooth, code) = match stroke.strip_prefix('~') {
        Some(code) => (true, code),
        None => (false, stroke),
    };
    let points: Vec<[f64; 2]> = code
        .as_bytes()
        .chunks_exact(2)
        .map(|p| {
            [
                f64::from(p[0]) - f64::from(b'0'),
                f64::from(p[1]) - f64::from(b'd'),
            ]
        })
        .collect();
    if smooth {
        (0..3).fold(points, |points, _| cut_corners(&points))
    } else {
        points
    }
}

/// One round of Chaikin's corner cutting (1974), which converges to a quadratic B-spline.
fn cut_corners(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mix = |a: &[f64; 2], b: &[f64; 2]| [0.75 * a[0] + 0.25 * b[0], 0.75 * a[1] + 0.25 * b[1]];
    let mut cut = Vec::with_capacity(2 * points.len());
    for pair in points.windows(2) {
        cut.push(mix(&pair[0], &pair[1]));
        cut.push(mix(&pair[1], &pair[0]));
    }
    let closed = points.first() == points.last();
    if closed {
        cut.extend(cut.first().copied());
    } else if let (Some(first), Some(last)) = (points.first(), points.last()) {
        // An open curve starts and ends where its points do.
        if let Some(start) = cut.first_mut() {
            *start = *first;
        }
        if let Some(end) = cut.last_mut() {
            *end = *last;
        }
    }
    cut
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_letter_and_digit_has_ink_within_its_width() {
        for c in ('a'..='z').chain('A'..='Z').chain('0'..='9') {
            let segments = segments(c, [0.0, 0.0], 10.0);
            assert!(!segments.is_empty(), "{c}");
            for [x, y] in segments.iter().flatten() {
                assert!((0.0..advance(c, 10.0)).contains(x), "{c}");
                assert!((-10.0..=3.0).contains(y), "{c}");
            }
        }
    }

    #[test]
    fn loops_are_closed_and_open_curves_keep_their_ends() {
        let bowl = outline(BOWL);
        assert_eq!(bowl.first(), bowl.last());
        let curve = outline("~0g0k4k");
        assert_eq!(curve.first(), Some(&[0.0, 3.0]));
        assert_eq!(curve.last(), Some(&[4.0, 7.0]));
    }

    #[test]
    fn a_line_of_text_is_as_wide_as_its_ink() {
        let text = "Hk";
        let h = advance('H', 20.0);
        let right = segments('k', [h, 0.0], 20.0)
            .iter()
            .flatten()
            .map(|p| p[0])
            .fold(0.0, f64::max);
        assert!((width(text, 20.0) - right).abs() < 1e-9);
        assert_eq!(width("", 20.0), 0.0);
    }
}
