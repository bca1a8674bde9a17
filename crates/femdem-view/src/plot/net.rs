//! The stereonet: a Schmidt net coloured by Kamb density.

use std::fmt::Write as _;

use femdem_analysis::{BodyAxes, Stereonet};

use super::chart;
use super::svg::Plot;
use crate::output::{base64, short_number};
use crate::picture::viridis_png;
use crate::tables::Tables;
use crate::ticks::even;

/// Centre and radius of the net, and the colour bar, in SVG units.
const CENTRE: [f64; 2] = [148.0, 134.0];
const RADIUS: f64 = 112.0;
const BAR: [f64; 4] = [300.0, 50.0, 14.0, 180.0];

/// The stereonet of body axes or face normals.
pub(super) fn stereonet(tables: &Tables) -> Option<Plot> {
    let orientation = tables.orientation.as_ref()?;
    let net = orientation.net.as_ref()?;
    let what = match &orientation.axes {
        BodyAxes::Long => "the bodies' long axes".to_owned(),
        BodyAxes::Short => "the bodies' short axes".to_owned(),
        BodyAxes::Principal => "the bodies' principal axes".to_owned(),
        BodyAxes::Fixed(_) => "axes fixed in the bodies".to_owned(),
        BodyAxes::FaceNormals { sides: Some(n) } => format!("the normals of faces with {n} sides"),
        BodyAxes::FaceNormals { sides: None } => "the face normals".to_owned(),
    };
    let order = &orientation.order;
    let whose = if orientation.order_axes == orientation.axes {
        ""
    } else {
        " of the axes of the bodies' frames"
    };
    let named = [("Nematic", &order.nematic), ("Cubatic", &order.cubatic)];
    // Axes of high symmetry have no order of these kinds, whatever their orientation.
    let told = named
        .iter()
        .filter(|(_, order)| order.random_deviation > 1e-6);
    let orders: String = told
        .map(|(name, order)| {
            format!(
                " {name} order{whose} {:.3}; at random {:.3} \u{b1} {:.3}.",
                order.value, order.random_mean, order.random_deviation
            )
        })
        .collect();
    let caption = format!(
        "Directions of {what}, {} in all{}{orders}",
        net.directions,
        legend(net)
    );
    plot("stereonet", "Orientation", caption, net)
}

/// What the net and its colours are, after the directions that it shows.
pub(super) fn legend(net: &Stereonet) -> String {
    format!(
        ", on a lower-hemisphere equal-area net seen from above (x to the right, y up, the vertical in the middle). \
         Colour: density over that of uniform directions by Kamb's method; 1 is chance, with a scatter of {:.2} from \
         node to node.",
        net.noise
    )
}

/// A net with its colours. `None` for one that was not made by [`stereonet`](femdem_analysis::stereonet).
pub(super) fn plot(
    name: &'static str,
    title: &str,
    caption: String,
    net: &Stereonet,
) -> Option<Plot> {
    let densities = net.nodes.iter().map(|node| node.density);
    // A uniform net shows as one colour in the middle of the scale.
    let top = densities.fold(2.0, f64::max);
    Some(Plot {
        name: name.to_owned(),
        title: title.to_owned(),
        caption,
        width: chart::WIDTH,
        height: chart::HEIGHT,
        content: content(name, net, top)?,
    })
}

/// The net as a small picture that is scaled smoothly and cut to the disc, and a colour bar.
fn content(name: &str, net: &Stereonet, top: f64) -> Option<String> {
    let across = net.nodes_across as usize;
    let pixels = raster(net, across)?;
    let disc = viridis_png(across, pixels.iter().map(|density| density / top)).ok()?;
    let bar = viridis_png(1, (0..64).map(|k| 1.0 - f64::from(k) / 63.0)).ok()?;
    let [x, y] = CENTRE;
    // The outer nodes are the centres of the outer pixels.
    let half = RADIUS * across as f64 / (across as f64 - 1.0);
    let [left, high, wide, tall] = BAR;
    let mut svg = format!(
        "<clipPath id=\"{name}-disc\"><circle cx=\"{x}\" cy=\"{y}\" r=\"{RADIUS}\"/></clipPath>\n\
         <image x=\"{:.2}\" y=\"{:.2}\" width=\"{:.2}\" height=\"{:.2}\" preserveAspectRatio=\"none\" \
         clip-path=\"url(#{name}-disc)\" href=\"data:image/png;base64,{}\"/>\n\
         <circle class=\"axes\" cx=\"{x}\" cy=\"{y}\" r=\"{RADIUS}\"/>\n\
         <path class=\"rule\" d=\"M{:.1} {y}h6M{:.1} {y}h-6M{x} {:.1}v6M{x} {:.1}v-6\"/>\n\
         <text class=\"label\" x=\"{:.1}\" y=\"{:.1}\">x</text>\n\
         <text class=\"label\" x=\"{x}\" y=\"{:.1}\" text-anchor=\"middle\">y</text>\n\
         <image x=\"{left}\" y=\"{high}\" width=\"{wide}\" height=\"{tall}\" preserveAspectRatio=\"none\" \
         href=\"data:image/png;base64,{}\"/>\n\
         <text class=\"label\" x=\"{left}\" y=\"{:.1}\">density /</text>\n\
         <text class=\"label\" x=\"{left}\" y=\"{:.1}\">uniform</text>\n",
        x - half,
        y - half,
        2.0 * half,
        2.0 * half,
        base64(&disc),
        x - RADIUS,
        x + RADIUS,
        y - RADIUS,
        y + RADIUS,
        x + RADIUS + 6.0,
        y + 4.0,
        y - RADIUS - 6.0,
        base64(&bar),
        high - 22.0,
        high - 8.0,
    );
    for tick in even(0.0, top, 0.0) {
        let at = high + tall * (1.0 - tick / top);
        let _ = writeln!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\">{}</text>",
            left + wide + 5.0,
            at + 4.0,
            short_number(tick)
        );
    }
    Some(svg)
}

/// Densities row by row from the top; outside the disc that of the nearest node of the row, and in a row without
/// nodes that of the next row towards the middle. `None` for a net that was not made by
/// [`stereonet`](femdem_analysis::stereonet) and has no nodes in its middle, or too many across.
fn raster(net: &Stereonet, across: usize) -> Option<Vec<f64>> {
    if !(3..=1001).contains(&across) {
        return None;
    }
    let last = across as f64 - 1.0;
    let cell = |x: f64| ((0.5 * (x + 1.0) * last).round() as usize).min(across - 1);
    let mut pixels = vec![None; across * across];
    for node in &net.nodes {
        let (column, row) = (cell(node.place[0]), cell(-node.place[1]));
        pixels[row * across + column] = Some(node.density);
    }
    for row in pixels.chunks_mut(across) {
        let ends = [
            row.iter().flatten().next().copied(),
            row.iter().flatten().next_back().copied(),
        ];
        for (column, pixel) in row.iter_mut().enumerate() {
            *pixel = pixel.or(ends[usize::from(column >= across / 2)]);
        }
    }
    let middle = across / 2;
    for row in (0..middle).rev() {
        for [row, inner] in [[row, row + 1], [across - 1 - row, across - 2 - row]] {
            for column in 0..across {
                let inner = pixels[inner * across + column];
                let pixel = &mut pixels[row * across + column];
                *pixel = pixel.or(inner);
            }
        }
    }
    pixels.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use femdem_analysis::{StereonetOptions, stereonet};
    use proptest::prelude::*;

    /// Axes along +x lie at the right and left edges, and all rows are filled.
    #[test]
    fn the_net_shows_axes_where_they_are() {
        let net = stereonet(&[[1.0, 0.0, 0.0]], &StereonetOptions::default()).unwrap();
        let pixels = raster(&net, 41).unwrap();
        assert!(pixels.iter().all(|p| p.is_finite()));
        let at = |column: usize, row: usize| pixels[row * 41 + column];
        assert!(at(40, 20) > at(20, 0) && at(0, 20) > at(20, 40));
        assert!(content("net", &net, 2.0).unwrap().contains("<image"));
    }

    fn wild() -> impl Strategy<Value = f64> {
        prop_oneof![
            4 => -1.0..1.0_f64,
            1 => Just(0.0),
            1 => Just(5e-324),
            1 => Just(-1e-300),
            1 => Just(1e200),
            1 => Just(-f64::MAX),
            1 => Just(f64::NAN),
            1 => Just(f64::NEG_INFINITY),
        ]
    }

    proptest! {
        /// Directions of any length are drawn with finite numbers, whatever the options; one without a direction
        /// is an error that names it.
        #[test]
        fn a_net_is_drawn_with_finite_numbers(
            one in prop::array::uniform3(wild()),
            copies in 1_usize..50,
            others in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 0..10),
            sigmas in prop_oneof![Just(5e-324), Just(1e-150), 0.1..10.0_f64, Just(1e3)],
            least_circle in prop_oneof![Just(1e-9), Just(0.01), Just(1.0 - f64::EPSILON / 2.0)],
            nodes_across in 3_u32..30,
        ) {
            let mut directions = vec![one; copies];
            directions.extend(others);
            let options = StereonetOptions { sigmas, least_circle, nodes_across };
            let largest = one.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
            let is_direction = one.iter().all(|x| x.is_finite()) && largest > 0.0;
            let net = match stereonet(&directions, &options) {
                Ok(net) => net,
                Err(error) => {
                    prop_assert!(!is_direction, "{}", error);
                    prop_assert!(error.to_string().contains("direction 0"), "{}", error);
                    return Ok(());
                }
            };
            prop_assert!(is_direction);
            let numbers = net.nodes.iter().flat_map(|n| [n.density, n.sigmas, n.place[0], n.place[1]]);
            prop_assert!(numbers.chain([net.noise, net.angle]).all(f64::is_finite));
            let across = nodes_across as usize;
            let pixels = raster(&net, across).unwrap();
            prop_assert_eq!(pixels.len(), across * across);
            let top = pixels.iter().copied().fold(2.0, f64::max);
            prop_assert!(pixels.iter().all(|p| (0.0..=1.0).contains(&(p / top))));
            let svg = content("net", &net, top).unwrap();
            let text: String = svg.split('>').filter(|part| !part.contains("base64")).collect();
            prop_assert!(!text.contains("NaN") && !text.contains("inf"), "{}", text);
        }
    }
}
