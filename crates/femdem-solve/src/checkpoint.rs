//! Files that survive crashes: a header with magic, kind, version, length and checksum, then the state. A
//! file is written beside its destination, synced, then renamed, so that the previous file stays until the
//! new one is complete. States are streamed to and from the file, so that no second copy of them is in
//! memory. All stored states of the project pass here; only tests call bincode elsewhere.

use crate::error::SolveError;
use bincode::error::EncodeError;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::fs::{self, File};
use std::io::{self, BufReader, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

const MAGIC: &[u8; 8] = b"FEMDEMCK";
pub(crate) const VERSION: u32 = 50;
const KIND_LENGTH: usize = 16;
/// Largest state that is written or read, bytes: bounds what a damaged length field can
/// make the decoder allocate.
const LIMIT: usize = u32::MAX as usize;
const HEADER: usize = 8 + 4 + KIND_LENGTH + 8 + 8;
/// Bytes that are read or written at a time.
const BUFFER: usize = 1 << 16;

/// FNV-1a of no bytes.
const EMPTY: u64 = 0xcbf2_9ce4_8422_2325;

/// FNV-1a over bytes: catches truncation and flipped bits; no defence against intent.
pub fn checksum(bytes: &[u8]) -> u64 {
    continued(EMPTY, bytes)
}

fn continued(hash: u64, bytes: &[u8]) -> u64 {
    bytes.iter().fold(hash, |hash, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

/// Counts the bytes that pass and computes their checksum.
struct Tally<T> {
    through: T,
    hash: u64,
    length: u64,
}

impl<T> Tally<T> {
    fn new(through: T) -> Self {
        Self {
            through,
            hash: EMPTY,
            length: 0,
        }
    }

    fn count(&mut self, bytes: &[u8]) {
        self.hash = continued(self.hash, bytes);
        self.length += bytes.len() as u64;
    }
}

impl<T: Write> Write for Tally<T> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let taken = self.through.write(bytes)?;
        self.count(&bytes[..taken]);
        Ok(taken)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.through.flush()
    }
}

impl<T: Read> Read for Tally<T> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let found = self.through.read(bytes)?;
        self.count(&bytes[..found]);
        Ok(found)
    }
}

fn encoding(why: String) -> SolveError {
    SolveError::Encoding {
        action: "encoded",
        why,
    }
}

/// The checksum that [`encode`] would give, without holding all bytes at once.
///
/// # Errors
/// [`SolveError::Encoding`] if the value cannot be encoded.
pub(crate) fn hash(value: &impl Serialize) -> Result<u64, SolveError> {
    let mut tally = Tally::new(io::sink());
    bincode::serde::encode_into_std_write(value, &mut tally, bincode::config::legacy())
        .map_err(|e| encoding(e.to_string()))?;
    Ok(tally.hash)
}

/// The bytes of a state, in bincode's fixed-width little-endian layout, followed by their [`checksum`] in
/// eight bytes.
///
/// # Errors
/// [`SolveError::Encoding`] if the value cannot be encoded.
pub fn encode(value: &impl Serialize) -> Result<Vec<u8>, SolveError> {
    let mut bytes = bincode::serde::encode_to_vec(value, bincode::config::legacy())
        .map_err(|e| encoding(e.to_string()))?;
    check_length(bytes.len() as u64)?;
    bytes.extend_from_slice(&checksum(&bytes).to_le_bytes());
    Ok(bytes)
}

fn check_length(length: u64) -> Result<(), SolveError> {
    if length < LIMIT as u64 {
        Ok(())
    } else {
        Err(encoding(format!(
            "it has {length} bytes, but at most {LIMIT} are supported"
        )))
    }
}

/// The state of bytes made by [`encode`].
///
/// # Errors
/// [`SolveError::Encoding`] if the bytes do not encode such a value, have trailing bytes, or have been
/// altered.
pub fn decode<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, SolveError> {
    let Some((bytes, sum)) = bytes.split_last_chunk::<8>() else {
        return Err(undecoded("it ends before its checksum".to_owned()));
    };
    if checksum(bytes) != u64::from_le_bytes(*sum) {
        return Err(undecoded(
            "its checksum does not match: bytes are missing or were altered".to_owned(),
        ));
    }
    let (value, used) =
        bincode::serde::decode_from_slice(bytes, bincode::config::legacy().with_limit::<LIMIT>())
            .map_err(|e| undecoded(e.to_string()))?;
    if used == bytes.len() {
        Ok(value)
    } else {
        let rest = bytes.len() - used;
        Err(undecoded(left_over(rest as u64, used as u64)))
    }
}

fn undecoded(why: String) -> SolveError {
    SolveError::Encoding {
        action: "decoded",
        why,
    }
}

fn left_over(rest: u64, used: u64) -> String {
    format!("{rest} bytes are left over after {used}")
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

/// Writes a checkpoint of a `kind` (a tag of at most 16 bytes).
///
/// # Errors
/// [`SolveError::Io`] if the file cannot be written; an earlier file of that name is then
/// untouched. [`SolveError::Encoding`] if the value cannot be encoded.
pub fn write_file(path: &Path, kind: &str, value: &impl Serialize) -> Result<(), SolveError> {
    write_sealed(path, kind, value).map(|_| ())
}

/// As [`write_file`], and returns what [`read_sealed`] knows the file by.
///
/// # Errors
/// As [`write_file`].
pub fn write_sealed(path: &Path, kind: &str, value: &impl Serialize) -> Result<Seal, SolveError> {
    let mut beside = PathBuf::from(path).into_os_string();
    beside.push(".tmp");
    let beside = PathBuf::from(beside);
    let written = write_all(&beside, kind, value).and_then(|seal| {
        fs::rename(&beside, path).map_err(io("cannot put in place", path))?;
        Ok(seal)
    });
    if written.is_err() {
        // Best effort: the error that matters is the first one.
        fs::remove_file(&beside).ok();
    }
    let seal = written?;
    sync_folder(path)?;
    Ok(seal)
}

fn write_all(beside: &Path, kind: &str, value: &impl Serialize) -> Result<Seal, SolveError> {
    let cannot_write = || io("cannot write", beside);
    let file = File::create(beside).map_err(io("cannot create", beside))?;
    let mut tally = Tally::new(BufWriter::with_capacity(BUFFER, file));
    // Length and checksum are written at the end.
    let room = tally.through.write_all(&[0; HEADER]);
    room.map_err(cannot_write())?;
    let config = bincode::config::legacy();
    bincode::serde::encode_into_std_write(value, &mut tally, config).map_err(|e| match e {
        EncodeError::Io { inner, .. } => cannot_write()(inner),
        other => encoding(other.to_string()),
    })?;
    check_length(tally.length)?;
    let seal = Seal {
        length: tally.length,
        checksum: tally.hash,
    };
    let mut writer = tally.through;
    // Seeking flushes the buffer.
    writer
        .seek(SeekFrom::Start(0))
        .and_then(|_| writer.write_all(&seal.header(kind)))
        .and_then(|()| writer.flush())
        .and_then(|()| writer.get_ref().sync_all())
        .map_err(cannot_write())?;
    Ok(seal)
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
    read(path, kind, None)
}

/// Reads a checkpoint of a `kind` that is part of another one, which has its seal.
///
/// # Errors
/// As [`read_file`], and [`SolveError::BadCheckpoint`] if it is another file than the one of that seal.
pub fn read_sealed<T: DeserializeOwned>(
    path: &Path,
    kind: &str,
    seal: &Seal,
) -> Result<T, SolveError> {
    read(path, kind, Some(seal))
}

fn read<T: DeserializeOwned>(
    path: &Path,
    kind: &str,
    known: Option<&Seal>,
) -> Result<T, SolveError> {
    let cannot_read = || io("cannot read", path);
    let bad = |why: String| SolveError::BadCheckpoint {
        path: path.to_owned(),
        why,
    };
    let mut file = File::open(path).map_err(cannot_read())?;
    let mut start = Vec::with_capacity(HEADER);
    let first = Read::by_ref(&mut file)
        .take(HEADER as u64)
        .read_to_end(&mut start);
    first.map_err(cannot_read())?;
    let seal = Seal::read(&start, kind).map_err(bad)?;
    if known.is_some_and(|known| *known != seal) {
        return Err(bad(
            "it is a part of another checkpoint than the one that names it".to_owned(),
        ));
    }
    // The checksum of the whole is verified before any of it is decoded.
    let mut tally = Tally::new(&file);
    let mut reader = BufReader::with_capacity(BUFFER, &mut tally);
    io::copy(&mut reader, &mut io::sink()).map_err(cannot_read())?;
    seal.check(&tally).map_err(bad)?;
    file.seek(SeekFrom::Start(HEADER as u64))
        .map_err(cannot_read())?;
    let mut tally = Tally::new(BufReader::with_capacity(BUFFER, file));
    let config = bincode::config::legacy().with_limit::<LIMIT>();
    let value = bincode::serde::decode_from_std_read(&mut tally, config)
        .map_err(|e| bad(undecoded(e.to_string()).to_string()))?;
    let rest = seal.length - tally.length.min(seal.length);
    if rest == 0 {
        Ok(value)
    } else {
        Err(bad(undecoded(left_over(rest, tally.length)).to_string()))
    }
}

/// By what a file is known to be complete, and to be the one that is meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Seal {
    length: u64,
    checksum: u64,
}

impl Seal {
    /// Length of the file, bytes.
    #[must_use]
    pub fn file_length(&self) -> u64 {
        HEADER as u64 + self.length
    }

    fn header(&self, kind: &str) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(HEADER);
        bytes.extend_from_slice(MAGIC);
        bytes.extend_from_slice(&VERSION.to_le_bytes());
        bytes.extend_from_slice(&kind_bytes(kind));
        bytes.extend_from_slice(&self.length.to_le_bytes());
        bytes.extend_from_slice(&self.checksum.to_le_bytes());
        bytes
    }

    fn read(bytes: &[u8], kind: &str) -> Result<Self, String> {
        if bytes.len() < HEADER || &bytes[..8] != MAGIC {
            return Err(
                "it does not begin with a whole femdem header; give a .ckpt file".to_owned(),
            );
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
        Ok(Self {
            length: word(12 + KIND_LENGTH, 20 + KIND_LENGTH),
            checksum: word(20 + KIND_LENGTH, HEADER),
        })
    }

    fn check<T>(&self, found: &Tally<T>) -> Result<(), String> {
        if found.length != self.length {
            return Err(format!(
                "it should hold {} bytes but has {}: it was cut short or grew; \
                 use an earlier checkpoint",
                self.length, found.length
            ));
        }
        if found.hash != self.checksum {
            return Err("its checksum does not match: bytes were altered; \
                        use an earlier checkpoint"
                .to_owned());
        }
        Ok(())
    }
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
