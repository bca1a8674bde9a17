//! The stereonet: a Schmidt net coloured by Kamb density.

use std::fmt::Write as _;

use super::{Plot, chart};
use crate::analysis::{BodyAxes, Stereonet, Tables};
use crate::output::base64;
use crate::picture::viridis_png;
use crate::results::short;
use crate::ticks::even;

/// Centre and radius of the net, and the colour bar, in SVG units.
const CENTRE: [f64; 2] = [148.0, 134.0];
const RADIUS: f64 = 112.0;
const BAR: [f64; 4] = [300.0, 50.0, 14.0, 180.0];

/// The stereonet of body axes or face normals.
pub(super) fn stereonet(tables: &Tables) -> Option<Plot> {
    let orientation = tables.orientation.as_ref()?;
    let net = orientation.net.as_ref()?;
    let most = net
        .nodes
        .iter()
        .map(|node| node.density)
        .fold(0.0, f64::max);
    // A uniform net shows as one colour in the middle of the scale.
    let top = most.max(2.0);
    let content = content(net, top)?;
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
        "Directions of {what}, {} in all, on a lower-hemisphere equal-area net seen from above (x to the right, \
         y up, the vertical in the middle). Colour: density over that of uniform directions by Kamb's method; \
         1 is chance, with a scatter of {:.2} from node to node.{orders}",
        net.directions, net.noise,
    );
    Some(Plot {
        name: "stereonet",
        title: "Orientation".to_owned(),
        caption,
        width: chart::WIDTH,
        height: chart::HEIGHT,
        content,
    })
}

/// The net as a small picture that is scaled smoothly and cut to the disc, and a colour bar.
fn content(net: &Stereonet, top: f64) -> Option<String> {
    let across = net.nodes.iter().filter(|node| node.place[1] == 0.0).count();
    let pixels = raster(net, across);
    let disc = viridis_png(across, pixels.iter().map(|density| density / top)).ok()?;
    let bar = viridis_png(1, (0..64).map(|k| 1.0 - f64::from(k) / 63.0)).ok()?;
    let [x, y] = CENTRE;
    // The outer nodes are the centres of the outer pixels.
    let half = RADIUS * across as f64 / (across as f64 - 1.0);
    let [left, high, wide, tall] = BAR;
    let mut svg = format!(
        "<clipPath id=\"net-disc\"><circle cx=\"{x}\" cy=\"{y}\" r=\"{RADIUS}\"/></clipPath>\n\
         <image x=\"{:.2}\" y=\"{:.2}\" width=\"{:.2}\" height=\"{:.2}\" preserveAspectRatio=\"none\" \
         clip-path=\"url(#net-disc)\" href=\"data:image/png;base64,{}\"/>\n\
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
            short(tick)
        );
    }
    Some(svg)
}

/// Densities row by row from the top; outside the disc that of the nearest node of the row.
fn raster(net: &Stereonet, across: usize) -> Vec<f64> {
    let last = across.saturating_sub(1).max(1) as f64;
    let cell =
        |x: f64| ((0.5 * (x + 1.0) * last).round().max(0.0) as usize).min(across.saturating_sub(1));
    let mut pixels = vec![f64::NAN; across * across];
    for node in &net.nodes {
        let (column, row) = (cell(node.place[0]), cell(-node.place[1]));
        if let Some(pixel) = pixels.get_mut(row * across + column) {
            *pixel = node.density;
        }
    }
    for row in pixels.chunks_mut(across.max(1)) {
        let known = |row: &[f64], ahead: bool| {
            let mut values = row.iter().copied().filter(|v| !v.is_nan());
            if ahead {
                values.next()
            } else {
                values.next_back()
            }
        };
        let ends = [known(row, true), known(row, false)].map(|end| end.unwrap_or(1.0));
        let middle = row.len() / 2;
        for (column, pixel) in row
            .iter_mut()
            .enumerate()
            .filter(|(_, pixel)| pixel.is_nan())
        {
            *pixel = if column < middle { ends[0] } else { ends[1] };
        }
    }
    pixels
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::{StereonetOptions, stereonet};

    /// Axes along +x lie at the right and left edges, and all rows are filled.
    #[test]
    fn the_net_shows_axes_where_they_are() {
        let net = stereonet(&[[1.0, 0.0, 0.0]], &StereonetOptions::default()).unwrap();
        let pixels = raster(&net, 41);
        assert!(pixels.iter().all(|p| p.is_finite()));
        let at = |column: usize, row: usize| pixels[row * 41 + column];
        assert!(at(40, 20) > at(20, 0) && at(0, 20) > at(20, 40));
        assert!(content(&net, 2.0).unwrap().contains("<image"));
    }
}
