//! The page: a template into which style, script and shaders are inserted.

use std::fmt::Write as _;

use crate::plot;

const TEMPLATE: &str = include_str!("page/page.html");
/// The view in three dimensions, and its data and script: the parts of a page of bodies.
const VIEW: [(&str, &str); 2] = [
    ("{{stage}}", include_str!("page/stage.html")),
    ("{{machinery}}", include_str!("page/machinery.html")),
];
const STYLE: &str = include_str!("page/style.css");

/// Parts of the script in the order of their dependencies.
const SCRIPT: [&str; 11] = [
    include_str!("page/linear.js"),
    include_str!("page/data.js"),
    include_str!("page/colours.js"),
    include_str!("page/camera.js"),
    include_str!("page/gpu.js"),
    include_str!("page/bodies.js"),
    include_str!("page/overlay.js"),
    include_str!("page/view.js"),
    include_str!("page/gestures.js"),
    include_str!("page/details.js"),
    include_str!("page/panel.js"),
];
const START: &str = include_str!("page/main.js");

const SHADERS: [(&str, &str); 10] = [
    ("bodies-vert", include_str!("page/bodies.vert.glsl")),
    ("bodies-frag", include_str!("page/bodies.frag.glsl")),
    ("plain-vert", include_str!("page/plain.vert.glsl")),
    ("plain-frag", include_str!("page/plain.frag.glsl")),
    ("floor-frag", include_str!("page/floor.frag.glsl")),
    ("screen-vert", include_str!("page/screen.vert.glsl")),
    ("present-frag", include_str!("page/present.frag.glsl")),
    ("shade-frag", include_str!("page/shade.frag.glsl")),
    ("tubes-vert", include_str!("page/tubes.vert.glsl")),
    ("tubes-frag", include_str!("page/tubes.frag.glsl")),
];

/// The page with these parts inserted, with a view or without; each part is a name and HTML.
pub(super) fn fill(has_view: bool, parts: &[(&str, &str)]) -> String {
    let script = SCRIPT.join("\n") + "\n" + START;
    let mut shaders = String::new();
    for (name, text) in SHADERS {
        // Writing to a string cannot fail.
        let _ = writeln!(
            shaders,
            "<script type=\"text/x-shader\" id=\"shader-{name}\">\n{text}</script>"
        );
    }
    let fixed = [
        ("style", STYLE),
        ("plot-style", plot::STYLE),
        ("script", script.as_str()),
        ("shaders", shaders.as_str()),
        ("version", env!("CARGO_PKG_VERSION")),
    ];
    let value = |name: &str| {
        let mut all = fixed.iter().chain(parts);
        all.find(|part| part.0 == name).map_or("", |part| part.1)
    };
    let mut page = String::new();
    let mut template = TEMPLATE.to_owned();
    for (place, part) in VIEW {
        template = template.replace(place, if has_view { part } else { "" });
    }
    let mut rest = template.as_str();
    while let Some((before, after)) = rest.split_once("{{") {
        let (name, behind) = after.split_once("}}").unwrap_or((after, ""));
        page.push_str(before);
        page.push_str(value(name));
        rest = behind;
    }
    page + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_place_of_the_template_is_filled() {
        let page = fill(true, &[("title", "T"), ("footer", "{{no place}}")]);
        assert!(
            page.contains("<title>T</title>") && page.contains("<footer>{{no place}}</footer>")
        );
        assert_eq!(page.matches("{{").count(), 1);
        assert_eq!(
            page.matches("</script>").count(),
            page.matches("<script").count()
        );
    }

    #[test]
    fn a_page_without_a_view_has_no_script() {
        let page = fill(false, &[("title", "T"), ("course", "C")]);
        assert!(!page.contains("<script") && !page.contains("<canvas") && page.contains('C'));
    }

    /// Names that the script asks for exist in the page.
    #[test]
    fn script_and_template_agree_on_names() {
        let page = fill(true, &[]);
        for (start, id) in [("getElementById(\"", "id=\""), ("this.on(\"", "id=\"")] {
            for found in page.split(start).skip(1) {
                let name = found.split('"').next().unwrap();
                assert!(page.contains(&format!("{id}{name}\"")), "{name}");
            }
        }
    }
}
