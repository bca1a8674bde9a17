//! Scenes and scenarios as files.

use std::fs;
use std::path::Path;

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::Error;

/// Reads a TOML file.
pub(crate) fn read<T: DeserializeOwned>(path: &Path) -> Result<T, Error> {
    parse(&text(path)?, path)
}

/// The text of a file.
pub(crate) fn text(path: &Path) -> Result<String, Error> {
    fs::read_to_string(path).map_err(|source| Error::Read {
        path: path.to_path_buf(),
        source,
    })
}

/// Reads TOML; `path` is what the error names.
pub(crate) fn parse<T: DeserializeOwned>(text: &str, path: &Path) -> Result<T, Error> {
    toml::from_str(text).map_err(|error| Error::Scene {
        path: path.to_path_buf(),
        message: error.to_string(),
    })
}

/// The value as TOML; `path` is what the error names.
pub(crate) fn write<T: Serialize>(value: &T, path: &Path) -> Result<String, Error> {
    toml::to_string(value).map_err(|error| Error::Scene {
        path: path.to_path_buf(),
        message: error.to_string(),
    })
}
