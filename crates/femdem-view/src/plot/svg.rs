//! A finished plot as an SVG element and as a file.

use std::io::{self, Write};

use super::chart::{Chart, HEIGHT, WIDTH};

/// Style of the plots; colours are custom properties with fallbacks.
pub(crate) const STYLE: &str = include_str!("plot.css");

/// A finished plot.
#[derive(Clone, Debug, PartialEq)]
pub struct Plot {
    /// Short name for files, such as "coordination".
    pub name: String,
    /// Title.
    pub title: String,
    /// What the plot shows and means, in a few sentences.
    pub caption: String,
    pub(super) width: f64,
    pub(super) height: f64,
    pub(super) content: String,
}

impl Plot {
    pub(super) fn of(name: impl Into<String>, title: &str, caption: String, chart: Chart) -> Self {
        let title = title.to_owned();
        Self {
            name: name.into(),
            title,
            caption,
            width: WIDTH,
            height: HEIGHT,
            content: chart.finish(),
        }
    }

    /// The SVG element for a page that contains the style of the plots.
    #[must_use]
    pub fn svg(&self) -> String {
        self.element("")
    }

    fn element(&self, inside: &str) -> String {
        let Self {
            name,
            width,
            height,
            ..
        } = self;
        let [title, caption] = [&self.title, &self.caption].map(|text| escape(text));
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"plot\" viewBox=\"0 0 {width} {height}\" \
             role=\"img\" aria-labelledby=\"{name}-title {name}-words\">\n\
             <title id=\"{name}-title\">{title}</title><desc id=\"{name}-words\">{caption}</desc>\n\
             {inside}{}</svg>",
            self.content
        )
    }

    /// Writes the plot as a separate file.
    ///
    /// # Errors
    ///
    /// If writing fails.
    pub fn write_svg(&self, mut writer: impl Write) -> io::Result<()> {
        let paper = "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n";
        let inside = format!("<style>\n{STYLE}</style>\n{paper}");
        writeln!(
            writer,
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n{}",
            self.element(&inside)
        )
    }
}

/// Text within SVG and HTML, in elements and in quoted attributes.
pub(crate) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            other => out.push(other),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_cannot_leave_its_element() {
        assert_eq!(escape("<b a=\"1\">&"), "&lt;b a=&quot;1&quot;&gt;&amp;");
    }
}
