//! The one checksum of files and snapshots.

use crc::{CRC_32_ISO_HDLC, Crc};

/// CRC-32 (ISO-HDLC, as in zip and PNG): finds every change within 32 bits in a row. Its table is
/// 1 KiB of constants.
pub(crate) static CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);
