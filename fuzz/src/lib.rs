//! What all readers of surfaces must do with any bytes.

use femdem_mesh::io::{self, Format, Options, off};

/// Reads bytes with and without repair: never a panic, and what is accepted is a body that
/// encloses a volume and survives being written and read again.
///
/// # Panics
///
/// If it is not.
pub fn read_surface(bytes: &[u8], format: Format) {
    for options in [Options::default(), Options::REPAIR] {
        let Ok((body, _)) = io::parse(bytes, format, &options) else {
            continue;
        };
        assert!(body.mass_properties().volume > 0.0);
        let mut file = Vec::new();
        off::write(&body, &mut file).expect("a vector takes all bytes");
        // Flat faces put together may touch what they were clear of, by rounding: STL only.
        if format != Format::Stl {
            assert_eq!(off::parse(&file).expect("written by femdem"), body);
        }
    }
}
