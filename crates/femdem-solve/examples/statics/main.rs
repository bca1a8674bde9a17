//! The static benchmarks.
mod cantilever;
mod cook;
mod loads;
mod meshes;
mod sphere;
#[allow(dead_code)]
mod taylor;
use femdem_solve::element::Element;
use femdem_solve::statics::*;
fn main() {
    let opt = |linear| StaticOptions {
        method: Method::Newton(NewtonOptions {
            linear,
            ..Default::default()
        }),
        ..Default::default()
    };
    for l in [Linear::Cg, Linear::Cholesky] {
        for (e, c) in [
            (Element::T10, [20, 2, 2]),
            (Element::T10Fbar, [20, 2, 2]),
            (Element::T4, [40, 4, 4]),
        ] {
            let t = std::time::Instant::now();
            match cantilever::run(e, c, &opt(l)) {
                Ok((r, s)) => println!("{l:?} {e:?} {c:?} {r} {:?} {:?}", s.report, t.elapsed()),
                Err(e) => println!("{e}"),
            }
        }
        for nu in [0.3, 0.499, 0.4999] {
            for (e, n, m) in [
                (Element::T10Fbar, 6, 4),
                (Element::T10, 6, 4),
                (Element::T4, 6, 4),
                (Element::T4NodalPressure, 6, 4),
            ] {
                let t = std::time::Instant::now();
                match sphere::run(e, nu, n, m, &opt(l)) {
                    Ok((r, s)) => {
                        println!("{l:?} {e:?} {nu} {n} {r} {:?} {:?}", s.report, t.elapsed())
                    }
                    Err(e) => println!("{e}"),
                }
            }
        }
        for nu in [0.3333, 0.4999] {
            for (e, n) in [
                (Element::T10Fbar, 8),
                (Element::T10, 8),
                (Element::T4, 8),
                (Element::T4NodalPressure, 8),
            ] {
                let t = std::time::Instant::now();
                match cook::run(e, nu, [n, n, 1], &opt(l)) {
                    Ok((r, s)) => {
                        println!("{l:?} {e:?} {nu} {n} {r} {:?} {:?}", s.report, t.elapsed())
                    }
                    Err(e) => println!("{e}"),
                }
            }
        }
    }
}
