//! A capture session that lives in a device: asked over a serial line, kept through power loss.
//!
//! ```text
//! frame      packets on the line: COBS between zeros, with a checksum
//! message    what is asked and answered; versioned
//! Device     holds the session; bytes in, bytes out, never waits
//! Client     asks, and asks again where the line was silent
//! Store      keeps bytes in two slots of a flash memory; a cut at any write leaves one good
//! ```
//!
//! Whatever the line does to the bytes, the session is neither lost nor changed unasked:
//!
//! - A packet that was cut, mixed or altered fails its checksum and is dropped; the client hears
//!   nothing and asks again.
//! - What only asks may come twice. What changes the session names the session and its *revision*,
//!   the number of changes so far. A request that comes twice is answered twice and done once; one
//!   that comes late is refused with [`Refusal::Conflict`].
//! - Photos, lists of candidates and snapshots travel through one buffer, in parts that may come twice
//!   or in any order. The command that uses them names their checksum, and is refused with
//!   [`Refusal::Transfer`] until all of them are there.
//! - A change is kept in flash before it is answered. After a reset the device goes on with the last
//!   change it kept, and the client with the question it had open.
//!
//! A whole session, over a line that is a function call:
//!
//! ```
//! use vantage_core::candidates::ViewSpace;
//! use vantage_core::planner::Plan;
//! use vantage_device::message::{Answer, Next};
//! use vantage_device::{Candidates, Client, Device, Line, Memory, Store};
//! # use core::convert::Infallible;
//! # use embedded_storage::nor_flash::{ErrorType, NorFlash, ReadNorFlash};
//! # use std::collections::VecDeque;
//! # struct Flash(Vec<u8>); // stands for a driver of the board
//! # impl ErrorType for Flash { type Error = Infallible; }
//! # impl ReadNorFlash for Flash {
//! #     const READ_SIZE: usize = 1;
//! #     fn read(&mut self, from: u32, bytes: &mut [u8]) -> Result<(), Infallible> {
//! #         bytes.copy_from_slice(&self.0[from as usize..][..bytes.len()]);
//! #         Ok(())
//! #     }
//! #     fn capacity(&self) -> usize { self.0.len() }
//! # }
//! # impl NorFlash for Flash {
//! #     const WRITE_SIZE: usize = 4;
//! #     const ERASE_SIZE: usize = 4096;
//! #     fn erase(&mut self, from: u32, to: u32) -> Result<(), Infallible> {
//! #         self.0[from as usize..to as usize].fill(0xff);
//! #         Ok(())
//! #     }
//! #     fn write(&mut self, from: u32, bytes: &[u8]) -> Result<(), Infallible> {
//! #         self.0[from as usize..][..bytes.len()].copy_from_slice(bytes);
//! #         Ok(())
//! #     }
//! # }
//! # struct Call<'a> { device: Device<'a, Flash, 24, 8, 16384>, back: VecDeque<u8> }
//! # impl Line for Call<'_> {
//! #     type Error = Infallible;
//! #     fn send(&mut self, bytes: &[u8]) -> Result<(), Infallible> {
//! #         for &byte in bytes {
//! #             self.back.extend(self.device.receive(byte).unwrap_or_default());
//! #         }
//! #         Ok(())
//! #     }
//! #     fn receive(&mut self) -> Result<Option<u8>, Infallible> { Ok(self.back.pop_front()) }
//! # }
//! # let flash = Flash(vec![0xff; 1 << 16]);
//! # let model = include_bytes!("../../../lab/models/soarnet-poses.model");
//! // On the device; its memory lies in a `static`.
//! let memory = Memory::<24, 8, 16384>::new();
//! let store = Store::try_new(flash, 0, 1 << 16)?;
//! let device = Device::new(model, &memory, store);
//!
//! // On the host; the line is a serial port.
//! let line = Call { device, back: VecDeque::new() };
//! let mut client = Client::new(line, 1);
//! let space = ViewSpace::FibonacciSphere;
//! let candidates = Candidates::Pool { space, count: 20, radius_m: 3.0, target: [0.0; 3] };
//! client.open(7, Plan::ensemble(5), candidates)?;
//! while let Next::View(next) = client.next_view()? {
//!     client.observe(Some(next.index), &next.pose, None)?; // this network looks at poses alone
//! }
//! assert_eq!(client.status()?.session.map(|session| session.views), Some(5));
//! # Ok::<(), Box<dyn core::error::Error>>(())
//! ```
#![no_std]

#[cfg(test)]
extern crate std;

mod client;
mod device;
pub mod frame;
pub mod message;
mod store;

pub use client::{Client, ClientError, Frame, Line};
pub use device::{Device, Memory};
pub use message::{Candidates, Refusal, Status};
pub use store::{Store, StoreError};
