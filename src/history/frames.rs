//! Frames in a file: the length of what follows, a number, a record, the CRC-32 of both mixed into the identity of the run, which tells
//! frames of other runs, and the length again for the way back.

use super::flat::Flat;
use std::fmt;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;

/// First bytes of every file, before the two numbers of its run.
pub(super) const KIND: &[u8; 16] = b"costate run 14\r\n";
/// The part of them that files of other versions have, too.
pub(super) const ANY_KIND: &[u8] = b"costate run ";
pub(super) const HEADER: u64 = KIND.len() as u64 + 16;
/// Bytes of a frame beside its number and record: length, checksum, length.
pub(super) const FRAME: u64 = 24;
/// Added to the number of steps before it, the number of the frame of a pause; the start has 0, a step its own.
pub(super) const PAUSE: u64 = 1 << 63;

/// Writes a frame over what a buffer holds.
pub(super) fn write_frame(frame: &mut Vec<u8>, identity: u64, number: u64, record: &impl Flat) {
    frame.clear();
    0_u64.put(frame);
    number.put(frame);
    record.put(frame);
    let length = frame.len() as u64 - 8;
    frame[..8].copy_from_slice(&length.to_le_bytes());
    (u64::from(crc32fast::hash(&frame[8..])) ^ identity).put(frame);
    length.put(frame);
}

pub(super) enum Damage {
    CutOff { size: u64, needed: u64 },
    OtherKind,
    OtherVersion,
    Checksum,
    Unreadable,
    Io(io::Error),
}

impl fmt::Display for Damage {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Damage::CutOff { size, needed } => write!(f, "ends after {size} bytes, but at least {needed} are needed"),
            Damage::OtherKind => f.write_str("is no file of a run"),
            Damage::OtherVersion => f.write_str("is a file of a run of another version of this program"),
            Damage::Checksum => f.write_str("its record is damaged: the checksum differs"),
            Damage::Unreadable => f.write_str("its record is damaged: it is not that of a run of this program"),
            Damage::Io(cause) => write!(f, "cannot be read: {cause}"),
        }
    }
}

/// Whether a regular file stands at a place, or nothing: others hang when they are opened, or would be replaced by a file.
pub fn check_place(path: &Path) -> io::Result<()> {
    let what = match std::fs::symlink_metadata(path) {
        // what cannot be there is told by the one who makes it
        Err(cause) if matches!(cause.kind(), io::ErrorKind::NotFound | io::ErrorKind::NotADirectory) => return Ok(()),
        Err(cause) => return Err(cause),
        Ok(own) if own.is_file() => return Ok(()),
        Ok(own) if own.is_symlink() => match std::fs::metadata(path) {
            Ok(end) if end.is_file() => return Ok(()),
            _ => "a link that does not lead to a regular file",
        },
        Ok(own) if own.is_dir() => "a folder",
        Ok(_) => "a device, a pipe or a socket",
    };
    Err(io::Error::other(format!("{} is {what}; name a regular file, or one that is not there", path.display())))
}

pub(super) struct Reader {
    file: File,
    pub(super) size: u64,
    /// Of the run.
    pub(super) identity: u64,
    /// What it simulates.
    pub(super) run: u64,
    /// Bytes of the frame that was loaded last.
    pub(super) length: u64,
    bytes: Vec<u8>,
}

impl Reader {
    pub(super) fn open(path: &Path) -> io::Result<Self> {
        check_place(path)?;
        let file = File::open(path)?;
        let size = file.metadata()?.len();
        Ok(Reader { file, size, identity: 0, run: 0, length: 0, bytes: Vec::new() })
    }

    /// Reads the header: the identity of the run.
    pub(super) fn identity(&mut self) -> Result<u64, Damage> {
        self.load(0, HEADER).map_err(|_| Damage::OtherKind)?;
        let (kind, mut numbers) = self.bytes.split_at(KIND.len());
        if kind != KIND {
            return Err(if kind.starts_with(ANY_KIND) { Damage::OtherVersion } else { Damage::OtherKind });
        }
        (self.identity, self.run) = Flat::take(&mut numbers).ok_or(Damage::OtherKind)?;
        Ok(self.identity)
    }

    fn load(&mut self, begin: u64, count: u64) -> Result<(), Damage> {
        let needed = begin.saturating_add(count);
        if needed > self.size {
            return Err(Damage::CutOff { size: self.size, needed });
        }
        self.bytes.resize(count as usize, 0);
        let read = self.file.seek(SeekFrom::Start(begin)).and_then(|_| self.file.read_exact(&mut self.bytes));
        read.map_err(Damage::Io)
    }

    /// Loads the frame that begins at a place and returns its number.
    pub(super) fn load_frame(&mut self, begin: u64) -> Result<u64, Damage> {
        self.load(begin, 8)?;
        let length = u64::take(&mut &self.bytes[..]).ok_or(Damage::Checksum)?;
        // a damaged length may ask for more than there is: that is no file cut off
        if length > self.size {
            return Err(Damage::Checksum);
        }
        self.load(begin, length + FRAME)?;
        let (body, mut tail) = self.bytes[8..].split_at(length as usize);
        let own = (u64::take(&mut tail), u64::take(&mut tail));
        if own != (Some(u64::from(crc32fast::hash(body)) ^ self.identity), Some(length)) {
            return Err(Damage::Checksum);
        }
        self.length = length + FRAME;
        u64::take(&mut &body[..]).ok_or(Damage::Checksum)
    }

    pub(super) fn record(&self) -> &[u8] {
        &self.bytes[16..self.bytes.len() - 16]
    }

    /// The record in the frame that begins at a place, if it has the expected number.
    pub(super) fn frame_at(&mut self, begin: u64, number: usize) -> Result<&[u8], Damage> {
        if self.load_frame(begin)? != number as u64 {
            return Err(Damage::Checksum);
        }
        Ok(self.record())
    }

    /// The same behind a pause that may stand at the place, which then is moved to the frame's begin.
    pub(super) fn step_from(&mut self, begin: &mut u64, number: usize) -> Result<&[u8], Damage> {
        if self.load_frame(*begin)? == PAUSE + number as u64 - 1 {
            *begin += self.length;
        }
        self.frame_at(*begin, number)
    }

    /// The record of a step in the frame that ends at a place, behind which a pause may stand; the place is moved to the frame's begin.
    pub(super) fn step_before(&mut self, end: &mut u64, number: usize) -> Result<&[u8], Damage> {
        *end = self.begin_before(*end)?;
        if self.load_frame(*end)? == PAUSE + number as u64 {
            *end = self.begin_before(*end)?;
        }
        self.frame_at(*end, number)
    }

    /// Where the frame begins that ends at a place.
    fn begin_before(&mut self, end: u64) -> Result<u64, Damage> {
        self.load(end.saturating_sub(8), 8)?;
        let length = u64::take(&mut &self.bytes[..]).ok_or(Damage::Checksum)?;
        end.checked_sub(length.saturating_add(FRAME)).ok_or(Damage::Checksum)
    }
}
