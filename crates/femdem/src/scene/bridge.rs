//! Liquid bridges, as scenes give them.

use femdem_contact::LiquidBridge;
use serde::{Deserialize, Deserializer, Serialize, de::Error};

/// The liquid between spheres, or spheres and plane walls, that have touched; see [`LiquidBridge`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct BridgeEntry {
    /// Volume of a bridge \[m³\].
    pub volume: f64,
    /// Surface tension \[N/m\]; 0 for no bridge.
    pub tension: f64,
    /// Contact angle \[degrees\].
    #[serde(default, deserialize_with = "acute")]
    pub contact_angle: f64,
}

/// An angle from 0 to below 90 degrees.
fn acute<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    let angle = f64::deserialize(from)?;
    if (0.0..90.0).contains(&angle) {
        return Ok(angle);
    }
    let message = format!("contact-angle = {angle} is not allowed: from 0 to below 90, in degrees");
    Err(D::Error::custom(message))
}

impl From<BridgeEntry> for LiquidBridge {
    fn from(entry: BridgeEntry) -> Self {
        Self {
            volume: entry.volume,
            tension: entry.tension,
            contact_angle: entry.contact_angle.to_radians(),
        }
    }
}

impl From<LiquidBridge> for BridgeEntry {
    fn from(bridge: LiquidBridge) -> Self {
        Self {
            volume: bridge.volume,
            tension: bridge.tension,
            contact_angle: bridge.contact_angle.to_degrees(),
        }
    }
}
