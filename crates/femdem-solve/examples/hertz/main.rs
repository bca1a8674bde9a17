//! Elastic balls in contact against Hertz's theory, for `cargo studies validate hertz` and `spheres`.
//!
//! Prints lines of columns separated by tabs; each begins with the name of its table.

mod ball;
mod collide;
mod law;
mod press;
mod setting;

use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let mut out = std::io::stdout().lock();
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let quick = arguments.iter().any(|a| a == "quick");
    match arguments.first().map(String::as_str) {
        Some("plane") => press::run(&mut out, false, quick),
        Some("shallow") => press::shallow(&mut out, false),
        Some("two") => press::run(&mut out, true, quick),
        Some(table) if collide::TABLES.contains(&table) => collide::run(&mut out, table, quick),
        _ => Err("say which: plane, shallow (its smallest depths alone), two, glass, laws, slow or aluminium, and quick for the first meshes alone".into()),
    }
}
