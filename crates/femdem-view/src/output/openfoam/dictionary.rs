//! Files of OpenFOAM as text.

/// A file of a class and a name, with its head.
pub(super) fn file(class: &str, object: &str, content: &str) -> String {
    format!(
        "FoamFile\n{{\n    version 2.0;\n    format ascii;\n    class {class};\n    object {object};\n}}\n\n{content}"
    )
}

/// A file of settings.
pub(super) fn dictionary(object: &str, content: &str) -> String {
    file("dictionary", object, content)
}
