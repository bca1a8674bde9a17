//! The OBJ reader.

#![no_main]

use femdem_fuzz::read_surface;
use femdem_mesh::io::Format;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| read_surface(bytes, Format::Obj));
