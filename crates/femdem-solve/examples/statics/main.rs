//! The static benchmarks.
mod meshes;
mod taylor;
use femdem_solve::element::Element;
fn main() {
    for (e, r, l) in [(Element::T4, 2, 24), (Element::T4NodalPressure, 2, 24), (Element::T10, 2, 24), (Element::T10Fbar, 2, 24)] {
        let t = std::time::Instant::now();
        println!("{e:?} {r} {l} {:?} {:?}", taylor::run(e, r, l), t.elapsed());
    }
}
