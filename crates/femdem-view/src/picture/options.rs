//! Size and point of view of a picture.

use crate::ViewError;
use crate::drawing::AZIMUTH;

/// Size and point of view of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PictureOptions {
    /// Width in pixels, 16 to 8192. Default 1200.
    pub width: usize,
    /// Height in pixels, 16 to 8192. Default 1200.
    pub height: usize,
    /// Azimuth of the eye, to the right of the front, degrees. Default 24.
    pub azimuth: f64,
    /// Elevation of the eye, −90 to 90 degrees. Default 16.
    pub elevation: f64,
}

impl Default for PictureOptions {
    fn default() -> Self {
        Self {
            width: 1200,
            height: 1200,
            azimuth: AZIMUTH,
            elevation: 16.0,
        }
    }
}

impl PictureOptions {
    pub(super) fn check(&self) -> Result<(), ViewError> {
        for (name, value) in [("width", self.width), ("height", self.height)] {
            if !(16..=8192).contains(&value) {
                let allowed = "16 to 8192 pixels";
                return Err(ViewError::Option {
                    name,
                    value: value.to_string(),
                    allowed,
                });
            }
        }
        let angles = [
            ("azimuth", self.azimuth, 360.0, "-360 to 360 degrees"),
            ("elevation", self.elevation, 90.0, "-90 to 90 degrees"),
        ];
        for (name, value, most, allowed) in angles {
            if !(-most..=most).contains(&value) {
                return Err(ViewError::Option {
                    name,
                    value: value.to_string(),
                    allowed,
                });
            }
        }
        Ok(())
    }
}
