//! The one checksum of files and snapshots.

use crc::{CRC_32_ISO_HDLC, Crc, NoTable};

/// CRC-32 (ISO-HDLC, as in zip and PNG): finds every change within 32 bits in a row. Bit by bit: a table
/// would take 1 KiB of a controller's flash to be faster where a model is opened and a snapshot kept.
pub(crate) static CRC: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);
