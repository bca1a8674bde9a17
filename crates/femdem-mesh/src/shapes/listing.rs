//! The list of shapes as text.

use super::Shape;
use std::fmt::Write;

/// Every family of shapes with its parameters, their defaults and ranges, as text of several lines.
pub fn listing() -> String {
    let mut text = String::new();
    for shape in Shape::all() {
        // Writing to a string does not fail.
        let _ = writeln!(text, "{}: {}", shape.name(), shape.summary());
        let _ = writeln!(text, "    size: {}", shape.size_meaning());
        for parameter in shape.parameters() {
            let _ = writeln!(
                text,
                "    {} = {} ({})",
                parameter.name, parameter.default, parameter.range
            );
            let _ = writeln!(text, "        {}", parameter.meaning);
        }
    }
    text
}
