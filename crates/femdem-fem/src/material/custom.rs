//! A law from outside this crate.

use super::Material;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::sync::Arc;

/// A law from outside this crate. Files contain only its name, so after reading one the law must be bound
/// again by [`super::AnyMaterial::bind`]; an unbound law has no stress.
#[derive(Debug, Clone)]
pub struct CustomMaterial {
    name: String,
    law: Option<Arc<dyn Material>>,
}

impl CustomMaterial {
    /// A bound law; its name is that of the law.
    #[must_use]
    pub fn new(law: Arc<dyn Material>) -> Self {
        Self {
            name: law.name().to_owned(),
            law: Some(law),
        }
    }

    /// The name of a law to be bound later.
    #[must_use]
    pub fn named(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            law: None,
        }
    }

    /// The name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The law; `None` if it is not bound yet.
    #[must_use]
    pub fn law(&self) -> Option<&dyn Material> {
        self.law.as_deref()
    }
}

/// Equal by name.
impl PartialEq for CustomMaterial {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Serialize for CustomMaterial {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.name.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for CustomMaterial {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        String::deserialize(deserializer).map(|name| Self::named(&name))
    }
}
