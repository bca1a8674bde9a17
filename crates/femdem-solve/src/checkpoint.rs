//! Files that survive crashes: a header with magic, kind, version, length and checksum;
//! written beside, synced, then renamed, so that the previous file stays until the new
//! one is whole. The only file of the project that uses bincode.

use crate::error::SolveError;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fs::{self, File};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

const MAGIC: &[u8; 8] = b"FEMDEMCK";
const VERSION: u32 = 5;
const KIND_LENGTH: usize = 16;
/// Largest state that is written or read, bytes: bounds what a damaged length field can
/// make the decoder allocate.
const LIMIT: usize = u32::MAX as usize;
const HEADER: usize = 8 + 4 + KIND_LENGTH + 8 + 8;

/// FNV-1a over bytes: catches truncation and flipped bits; no defence against intent.
pub fn checksum(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

/// The bytes of a state, in bincode's fixed-width little-endian layout.
///
/// # Errors
/// [`SolveError::Encoding`] if the value cannot be encoded.
pub fn encode(value: &impl Serialize) -> Result<Vec<u8>, SolveError> {
    let fail = |why: String| SolveError::Encoding {
        action: "encoded",
        why,
    };
    let bytes = bincode::serde::encode_to_vec(value, bincode::config::legacy())
        .map_err(|e| fail(e.to_string()))?;
    if bytes.len() < LIMIT {
        Ok(bytes)
    } else {
        Err(fail(format!(
            "it has {} bytes, but at most {LIMIT} are supported",
            bytes.len()
        )))
    }
}

/// The state of bytes made by [`encode`].
///
/// # Errors
/// [`SolveError::Encoding`] if the bytes do not hold such a value, or hold more.
pub fn decode<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, SolveError> {
    let fail = |why: String| SolveError::Encoding {
        action: "decoded",
        why,
    };
    let (value, used) =
        bincode::serde::decode_from_slice(bytes, bincode::config::legacy().with_limit::<LIMIT>())
            .map_err(|e| fail(e.to_string()))?;
    if used == bytes.len() {
        Ok(value)
    } else {
        Err(fail(format!(
            "{} bytes are left over after {used}",
            bytes.len() - used
        )))
    }
}

fn kind_bytes(kind: &str) -> [u8; KIND_LENGTH] {
    let mut bytes = [0; KIND_LENGTH];
    for (to, from) in bytes.iter_mut().zip(kind.bytes()) {
        *to = from;
    }
    bytes
}

fn io<'a>(action: &'static str, path: &'a Path) -> impl Fn(std::io::Error) -> SolveError + 'a {
    move |source| SolveError::Io {
        action,
        path: path.to_owned(),
        source,
    }
}

/// Writes a checkpoint of a `kind` (at most 16 bytes tell kinds apart).
///
/// # Errors
/// [`SolveError::Io`] if the file cannot be written; an earlier file of that name is then
/// untouched. [`SolveError::Encoding`] if the value cannot be encoded.
pub fn write_file(path: &Path, kind: &str, value: &impl Serialize) -> Result<(), SolveError> {
    let payload = encode(value)?;
    let mut beside = PathBuf::from(path).into_os_string();
    beside.push(".tmp");
    let beside = PathBuf::from(beside);
    let written = write_all(&beside, kind, &payload)
        .and_then(|()| fs::rename(&beside, path).map_err(io("cannot put in place", path)));
    if written.is_err() {
        // Best effort: the error that matters is the first one.
        fs::remove_file(&beside).ok();
    }
    written?;
    sync_folder(path)
}

fn write_all(beside: &Path, kind: &str, payload: &[u8]) -> Result<(), SolveError> {
    let mut file = File::create(beside).map_err(io("cannot create", beside))?;
    let mut header = Vec::with_capacity(HEADER);
    header.extend_from_slice(MAGIC);
    header.extend_from_slice(&VERSION.to_le_bytes());
    header.extend_from_slice(&kind_bytes(kind));
    header.extend_from_slice(&(payload.len() as u64).to_le_bytes());
    header.extend_from_slice(&checksum(payload).to_le_bytes());
    file.write_all(&header)
        .and_then(|()| file.write_all(payload))
        .and_then(|()| file.sync_all())
        .map_err(io("cannot write", beside))
}

/// Makes the rename durable where folders can be synced.
fn sync_folder(path: &Path) -> Result<(), SolveError> {
    let folder = match path.parent() {
        Some(p) if !p.as_os_str().is_empty() => p,
        _ => Path::new("."),
    };
    if cfg!(unix) {
        File::open(folder)
            .and_then(|f| f.sync_all())
            .map_err(io("cannot sync", folder))?;
    }
    Ok(())
}

/// Reads a checkpoint of a `kind`.
///
/// # Errors
/// [`SolveError::Io`] if the file cannot be read, [`SolveError::BadCheckpoint`] if it is
/// truncated, altered, of another kind or from another version.
pub fn read_file<T: DeserializeOwned>(path: &Path, kind: &str) -> Result<T, SolveError> {
    let mut bytes = Vec::new();
    File::open(path)
        .and_then(|mut f| f.read_to_end(&mut bytes))
        .map_err(io("cannot read", path))?;
    let bad = |why: String| SolveError::BadCheckpoint {
        path: path.to_owned(),
        why,
    };
    let payload = payload(&bytes, kind).map_err(bad)?;
    decode(payload).map_err(|e| bad(e.to_string()))
}

/// Checks the header and returns the bytes behind it.
fn payload<'a>(bytes: &'a [u8], kind: &str) -> Result<&'a [u8], String> {
    if bytes.len() < HEADER || &bytes[..8] != MAGIC {
        return Err(format!(
            "it has {} bytes and does not begin with a femdem header; give a .ckpt file",
            bytes.len()
        ));
    }
    let word = |from: usize, to: usize| {
        bytes[from..to]
            .iter()
            .rev()
            .fold(0u64, |w, b| w << 8 | u64::from(*b))
    };
    let version = word(8, 12);
    if version != u64::from(VERSION) {
        return Err(format!(
            "it is of version {version}, but this program reads version {VERSION}"
        ));
    }
    if bytes[12..12 + KIND_LENGTH] != kind_bytes(kind) {
        let name = String::from_utf8_lossy(&bytes[12..12 + KIND_LENGTH]);
        return Err(format!(
            "it holds a \"{}\", not a \"{kind}\"",
            name.trim_end_matches('\0')
        ));
    }
    let payload = &bytes[HEADER..];
    let length = word(12 + KIND_LENGTH, 20 + KIND_LENGTH);
    if payload.len() as u64 != length {
        return Err(format!(
            "it should hold {length} bytes but has {}: it was cut short or grew; \
             use an earlier checkpoint",
            payload.len()
        ));
    }
    if checksum(payload) != word(20 + KIND_LENGTH, HEADER) {
        return Err("its checksum does not match: bytes were altered; \
             use an earlier checkpoint"
            .to_owned());
    }
    Ok(payload)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn round_trip_and_every_kind_of_damage() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.ckpt");
        let value = (1.5_f64, vec![1_u32, 2, 3], "name".to_owned());
        write_file(&path, "test", &value).unwrap();
        let read = |kind| read_file::<(f64, Vec<u32>, String)>(&path, kind);
        assert_eq!(read("test").unwrap(), value);
        assert!(read("other").unwrap_err().to_string().contains("\"test\""));
        let good = fs::read(&path).unwrap();
        for cut in [0, 7, HEADER - 1, HEADER, good.len() - 1] {
            fs::write(&path, &good[..cut]).unwrap();
            assert!(read("test").is_err(), "cut at {cut}");
        }
        for at in 0..good.len() {
            let mut bad = good.clone();
            bad[at] ^= 4;
            fs::write(&path, &bad).unwrap();
            assert!(read("test").is_err(), "bit flipped at {at}");
        }
    }

    #[test]
    fn a_failed_write_leaves_the_old_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("gone").join("x.ckpt");
        let error = write_file(&path, "test", &1_u8).unwrap_err().to_string();
        assert!(error.contains("cannot create") && error.contains("x.ckpt"));
    }
}
