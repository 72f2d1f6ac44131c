//! Packets on a line of bytes.
//!
//! ```text
//! 00  COBS( message, CRC-32 of the message (ISO-HDLC, little-endian) )  00
//! ```
//!
//! COBS (Cheshire and Baker, 1999) writes the bytes between without a zero, so that whatever was lost
//! or added, the next zero begins anew. Between two zeros may be nothing.

use cobs::{DecodeResult, DecoderState, max_encoding_length, try_encode};
use crc::{CRC_32_ISO_HDLC, Crc};
use serde::Serialize;

/// The checksum of packets and transfers, as of snapshots and model files.
pub static CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// Bytes of a transfer that one message carries at most.
pub const CHUNK: usize = 512;

/// Bytes of the longest message: a chunk, and what says where it belongs.
pub const MESSAGE: usize = CHUNK + 64;

const CHECKSUM: usize = 4;

/// Bytes of the longest packet on the line, with both zeros.
pub const PACKET: usize = max_encoding_length(MESSAGE + CHECKSUM) + 2;

/// Writes a message as a packet; `None` where it is longer than [`MESSAGE`].
pub fn write<'b>(message: &impl Serialize, packet: &'b mut [u8; PACKET]) -> Option<&'b [u8]> {
    let mut plain = [0; MESSAGE + CHECKSUM];
    let length = postcard::to_slice(message, plain.get_mut(..MESSAGE)?).ok()?.len();
    let (written, rest) = plain.split_at_mut_checked(length)?;
    *rest.first_chunk_mut::<CHECKSUM>()? = CRC.checksum(written).to_le_bytes();
    let (first, rest) = packet.split_first_mut()?;
    *first = 0;
    let used = try_encode(plain.get(..length + CHECKSUM)?, rest).ok()?;
    *rest.get_mut(used)? = 0;
    packet.get(..used + 2)
}

/// What comes of a byte that ends a packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Packet<'a> {
    /// A message as it was sent.
    Message(&'a [u8]),
    /// Something that was no packet, or not any more.
    Damaged,
}

/// Gathers bytes into messages.
#[derive(Debug)]
pub struct Reader {
    state: DecoderState,
    buffer: [u8; MESSAGE + CHECKSUM],
    used: usize, // of `buffer`, or more where it is too short
}

impl Default for Reader {
    fn default() -> Self {
        Self::new()
    }
}

impl Reader {
    /// A reader between packets.
    pub const fn new() -> Self {
        Self { state: DecoderState::Idle, buffer: [0; MESSAGE + CHECKSUM], used: 0 }
    }

    /// Takes in a byte; `Some` where it ends a packet.
    pub fn push(&mut self, byte: u8) -> Option<Packet<'_>> {
        match self.state.feed(byte) {
            Ok(DecodeResult::NoData) => None,
            Ok(DecodeResult::DataStart) => {
                self.used = 0;
                None
            }
            Ok(DecodeResult::DataContinue(byte)) => {
                if let Some(place) = self.buffer.get_mut(self.used) {
                    *place = byte;
                }
                self.used = self.used.saturating_add(1);
                None
            }
            Ok(DecodeResult::DataComplete) => {
                let message = self.buffer.get(..self.used).and_then(checked);
                Some(message.map_or(Packet::Damaged, Packet::Message))
            }
            // A zero where there should be none.
            Err(_) => Some(Packet::Damaged),
        }
    }
}

/// The message in front of its checksum, if that is right.
fn checked(bytes: &[u8]) -> Option<&[u8]> {
    let (message, checksum) = bytes.split_last_chunk::<CHECKSUM>()?;
    (CRC.checksum(message) == u32::from_le_bytes(*checksum)).then_some(message)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::vec::Vec;

    fn messages(reader: &mut Reader, bytes: &[u8]) -> Vec<Option<Vec<u8>>> {
        let mut found = Vec::new();
        for &byte in bytes {
            match reader.push(byte) {
                Some(Packet::Message(message)) => found.push(Some(message.to_vec())),
                Some(Packet::Damaged) => found.push(None),
                None => {}
            }
        }
        found
    }

    /// The message that `write` makes of bytes: postcard puts their number in front.
    fn body(bytes: &[u8]) -> Vec<u8> {
        let mut buffer = [0; MESSAGE];
        postcard::to_slice(bytes, &mut buffer).unwrap().to_vec()
    }

    #[test]
    fn the_packet_of_two_bytes_in_hexadecimal() {
        let mut packet = [0; PACKET];
        // Length 2, then 0 and 5; the CRC-32 of 02 00 05 is 0x8caff9f3.
        let expected = [0, 2, 2, 6, 5, 0xf3, 0xf9, 0xaf, 0x8c, 0];
        assert_eq!(CRC.checksum(&[2, 0, 5]), 0x8caf_f9f3);
        assert_eq!(write(&[0u8, 5].as_slice(), &mut packet), Some(expected.as_slice()));
    }

    #[test]
    fn what_is_too_long_is_neither_written_nor_read() {
        let mut packet = [0; PACKET];
        assert!(write(&[7u8; MESSAGE - 2].as_slice(), &mut packet).is_some());
        assert!(write(&[7u8; PACKET].as_slice(), &mut packet).is_none());
        let mut reader = Reader::new();
        let mut line = std::vec![9; 3 * PACKET];
        line.push(0);
        assert_eq!(messages(&mut reader, &line), [None]);
        let good = write(&[1u8, 2].as_slice(), &mut packet).unwrap();
        assert_eq!(messages(&mut reader, good), [Some(body(&[1, 2]))]);
    }

    proptest! {
        #[test]
        fn a_message_comes_out_as_it_went_in(bytes in prop::collection::vec(any::<u8>(), 0..=CHUNK)) {
            let mut packet = [0; PACKET];
            let packet = write(&bytes.as_slice(), &mut packet).unwrap();
            prop_assert!(!packet[1..packet.len() - 1].contains(&0));
            prop_assert_eq!(messages(&mut Reader::new(), packet), [Some(body(&bytes))]);
        }

        #[test]
        fn noise_before_a_packet_costs_at_most_the_noise(
            noise in prop::collection::vec(any::<u8>(), 0..2000),
            bytes in prop::collection::vec(any::<u8>(), 0..50),
        ) {
            let mut reader = Reader::new();
            let lost = messages(&mut reader, &noise);
            prop_assert!(lost.iter().all(Option::is_none));
            let mut packet = [0; PACKET];
            let packet = write(&bytes.as_slice(), &mut packet).unwrap();
            prop_assert_eq!(messages(&mut reader, packet).pop(), Some(Some(body(&bytes))));
        }

        #[test]
        fn a_changed_byte_is_found(
            bytes in prop::collection::vec(any::<u8>(), 0..300),
            place in any::<prop::sample::Index>(),
            change in 1u8..,
        ) {
            let mut packet = [0; PACKET];
            let mut packet = write(&bytes.as_slice(), &mut packet).unwrap().to_vec();
            let place = place.index(packet.len());
            packet[place] ^= change;
            packet.push(0);
            let whole = body(&bytes);
            for found in messages(&mut Reader::new(), &packet) {
                // A first zero that turns into something else can only damage the packet.
                prop_assert!(found.is_none() || found == Some(whole.clone()) && place + 2 >= packet.len());
            }
        }
    }
}
