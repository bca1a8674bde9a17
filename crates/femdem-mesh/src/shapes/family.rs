//! The common parts of all families of shapes: a name, named parameters with ranges, a surface.

use crate::{MeshError, Polyhedron};
use std::fmt;

/// A named parameter of a shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Name, as in `cylinder:aspect=2`.
    pub name: &'static str,
    /// Meaning; lengths are ratios to the size of the shape unless stated otherwise.
    pub meaning: String,
    /// Its value.
    pub value: String,
    /// Default value.
    pub default: String,
    /// The values allowed.
    pub range: String,
}

/// A kind of number (or list) that a parameter may be.
pub(super) trait Value: Clone + PartialEq {
    /// Lowest or highest value.
    type Bound: fmt::Display;
    fn parse(text: &str) -> Option<Self>;
    fn text(&self) -> String;
    fn within(&self, low: &Self::Bound, high: &Self::Bound) -> bool;
}

macro_rules! number {
    ($($kind:ty),*) => {$(
        impl Value for $kind {
            type Bound = $kind;
            fn parse(text: &str) -> Option<Self> {
                text.parse().ok()
            }
            fn text(&self) -> String {
                self.to_string()
            }
            fn within(&self, low: &$kind, high: &$kind) -> bool {
                (low..=high).contains(&self)
            }
        }
    )*};
}
number!(f64, u32, u64, bool);

/// A family of shapes with its parameters set.
pub(super) trait Family {
    /// Name of the family.
    fn name(&self) -> String;
    /// What the family is, in one line.
    fn summary(&self) -> &'static str;
    /// The length of the body that is its size.
    fn size_meaning(&self) -> &'static str;
    /// The parameters, in order.
    fn parameters(&self) -> Vec<Parameter>;
    /// Sets a parameter from text.
    fn set(&mut self, name: &str, text: &str) -> Result<(), MeshError>;
    /// Whether every parameter lies in its range.
    fn check(&self) -> Result<(), MeshError>;
    /// The body of size 1 m, its centroid at the origin. Parameters lie in their ranges.
    fn unit(&self) -> Result<Polyhedron, MeshError>;
}

/// The error for a parameter outside its range or without a valid value.
pub(super) fn bad_value(
    shape: &str,
    parameter: &'static str,
    value: String,
    allowed: String,
) -> MeshError {
    MeshError::BadParameter {
        shape: shape.to_owned(),
        parameter,
        value: value.chars().take(80).collect(),
        allowed,
    }
}

/// Declares a family: a struct of named parameters with defaults and ranges.
/// The struct's own file defines `fn build(&self) -> Result<Polyhedron, MeshError>`, which may assume that
/// every parameter is in its range.
macro_rules! family {
    (
        $(#[doc = $doc:literal])+
        $kind:ident = $label:literal, $summary:literal, size: $size:literal {
            $(
                $(#[doc = $meaning:literal])+
                $field:ident: $number:ty = $default:expr, in $low:expr, $high:expr;
            )*
        }
    ) => {
        $(#[doc = $doc])+
        #[doc = ""]
        #[doc = concat!("The size is ", $size, ".")]
        #[derive(Clone, Debug, PartialEq)]
        pub struct $kind {
            $(
                $(#[doc = $meaning])+
                #[doc = ""]
                #[doc = concat!("From ", stringify!($low), " to ", stringify!($high), ".")]
                pub $field: $number,
            )*
        }

        impl Default for $kind {
            fn default() -> Self {
                Self { $($field: $default,)* }
            }
        }

        impl $crate::shapes::family::Family for $kind {
            fn name(&self) -> String {
                $label.to_owned()
            }

            fn summary(&self) -> &'static str {
                $summary
            }

            fn size_meaning(&self) -> &'static str {
                $size
            }

            fn parameters(&self) -> Vec<$crate::shapes::Parameter> {
                use $crate::shapes::family::Value;
                let default = Self::default();
                vec![$(
                    $crate::shapes::Parameter {
                        name: stringify!($field),
                        meaning: [$($meaning),+].map(str::trim).join(" "),
                        value: self.$field.text(),
                        default: default.$field.text(),
                        range: format!("{} to {}", $low, $high),
                    },
                )*]
            }

            fn set(&mut self, name: &str, text: &str) -> Result<(), $crate::MeshError> {
                use $crate::shapes::family::Value;
                $(
                    if name == stringify!($field) {
                        self.$field = <$number>::parse(text).ok_or_else(|| {
                            $crate::shapes::family::bad_value(
                                $label,
                                stringify!($field),
                                text.to_owned(),
                                format!("{} to {}", $low, $high),
                            )
                        })?;
                        return Ok(());
                    }
                )*
                Err($crate::MeshError::UnknownParameter {
                    shape: $label.to_owned(),
                    parameter: name.chars().take(80).collect(),
                    allowed: [$(stringify!($field)),*].join(", "),
                })
            }

            fn check(&self) -> Result<(), $crate::MeshError> {
                use $crate::shapes::family::Value;
                $(
                    if !self.$field.within(&$low, &$high) {
                        return Err($crate::shapes::family::bad_value(
                            $label,
                            stringify!($field),
                            self.$field.text(),
                            format!("{} to {}", $low, $high),
                        ));
                    }
                )*
                Ok(())
            }

            fn unit(&self) -> Result<$crate::Polyhedron, $crate::MeshError> {
                self.build()
            }
        }
    };
}
pub(super) use family;
