//! A line to a device: a serial port, or a TCP connection to an emulator.
//!
//! A port that is lost, because the cable was pulled or the emulator ended, is opened again as soon as
//! it is back: to the conversation it is silence.

use std::convert::Infallible;
use std::io::{self, Read, Write};
use std::net::TcpStream;
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, Result};
use serial2::SerialPort;
use vantage_device::Line;

/// Where a device is.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Address {
    Tcp(String),
    Serial(String, u32), // and bits a second
}

/// A lost port is looked for so often.
const RETRY: Duration = Duration::from_millis(100);

/// An open line.
pub struct Port {
    address: Address,
    patience: Duration,
    stream: Option<Box<dyn Stream>>,
    waiting: Vec<u8>, // came and was not taken yet, the next byte last
}

trait Stream: Read + Write {}
impl<T: Read + Write> Stream for T {}

impl Address {
    fn open(&self, patience: Duration) -> io::Result<Box<dyn Stream>> {
        match self {
            Self::Tcp(address) => {
                let stream = TcpStream::connect(address)?;
                stream.set_nodelay(true)?;
                stream.set_read_timeout(Some(patience))?;
                Ok(Box::new(stream))
            }
            Self::Serial(path, baud) => {
                let mut port = SerialPort::open(path, *baud)?;
                port.set_read_timeout(patience)?;
                port.discard_buffers()?;
                Ok(Box::new(port))
            }
        }
    }
}

impl Port {
    /// Opens `tcp:HOST:PORT`, or a serial port by the system's name for it, such as `/dev/ttyACM0` or
    /// `COM3`. An answer may take as long as `patience`.
    pub fn open(name: &str, baud: u32, patience: Duration) -> Result<Self> {
        let address = match name.strip_prefix("tcp:") {
            Some(address) => Address::Tcp(address.to_owned()),
            None => Address::Serial(name.to_owned(), baud),
        };
        let stream = address.open(patience).with_context(|| {
            format!(
                "cannot open the port {name}: is the device plugged in, and may you use the port?"
            )
        })?;
        Ok(Self { address, patience, stream: Some(stream), waiting: Vec::new() })
    }

    /// Waits until a lost port is back, or patience is at its end.
    fn await_return(&mut self) {
        let lost = Instant::now();
        while self.stream.is_none() && lost.elapsed() < self.patience {
            thread::sleep(RETRY.min(self.patience));
            self.stream = self.address.open(self.patience).ok();
        }
    }
}

impl Line for Port {
    type Error = Infallible;

    fn send(&mut self, bytes: &[u8]) -> Result<(), Infallible> {
        if self.stream.is_none() {
            // What is still to come belongs to the lost one.
            self.waiting.clear();
            self.stream = self.address.open(self.patience).ok();
        }
        let sent = match &mut self.stream {
            Some(stream) => stream.write_all(bytes).and_then(|()| stream.flush()),
            None => Err(io::ErrorKind::NotConnected.into()),
        };
        if sent.is_err() {
            self.stream = None;
        }
        Ok(())
    }

    fn receive(&mut self) -> Result<Option<u8>, Infallible> {
        if let Some(byte) = self.waiting.pop() {
            return Ok(Some(byte));
        }
        let mut bytes = [0; 256];
        let Some(stream) = &mut self.stream else {
            self.await_return();
            return Ok(None);
        };
        match stream.read(&mut bytes) {
            Ok(count) if count > 0 => {
                self.waiting.extend(bytes[..count].iter().rev());
                Ok(self.waiting.pop())
            }
            Err(error)
                if matches!(error.kind(), io::ErrorKind::TimedOut | io::ErrorKind::WouldBlock) =>
            {
                Ok(None)
            }
            Err(error) if error.kind() == io::ErrorKind::Interrupted => Ok(None),
            Ok(_) | Err(_) => {
                self.stream = None;
                Ok(None)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::net::TcpListener;

    #[test]
    fn a_port_that_is_not_there_is_named() {
        let error = Port::open("/dev/no-such-port", 9600, Duration::from_millis(10)).err().unwrap();
        assert!(error.to_string().contains("/dev/no-such-port"), "{error}");
    }

    #[test]
    fn a_lost_connection_is_silence_and_comes_back() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let name = format!("tcp:{}", listener.local_addr().unwrap());
        let mut port = Port::open(&name, 0, Duration::from_millis(50)).unwrap();
        let (mut first, _) = listener.accept().unwrap();
        first.write_all(b"ab").unwrap();
        assert_eq!(port.receive(), Ok(Some(b'a')));
        assert_eq!(port.receive(), Ok(Some(b'b')));
        assert_eq!(port.receive(), Ok(None));
        drop(first);
        assert_eq!(port.receive(), Ok(None)); // notices
        port.send(b"x").unwrap(); // opens again
        let (mut second, _) = listener.accept().unwrap();
        let mut byte = [0];
        second.read_exact(&mut byte).unwrap();
        assert_eq!(byte, *b"x");
        second.write_all(b"c").unwrap();
        assert_eq!(port.receive(), Ok(Some(b'c')));
    }

    #[test]
    fn a_port_that_is_gone_is_awaited_no_longer_than_it_is_gone() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap();
        let patience = Duration::from_secs(600);
        let mut port = Port::open(&format!("tcp:{address}"), 0, patience).unwrap();
        drop(listener.accept().unwrap());
        drop(listener);
        assert_eq!(port.receive(), Ok(None)); // notices
        port.send(b"lost").unwrap();
        let back = thread::spawn(move || {
            thread::sleep(2 * RETRY);
            TcpListener::bind(address).unwrap().accept().unwrap().0
        });
        assert_eq!(port.receive(), Ok(None));
        port.send(b"x").unwrap();
        let mut byte = [0];
        back.join().unwrap().read_exact(&mut byte).unwrap();
        assert_eq!(byte, *b"x");
    }

    #[cfg(unix)]
    #[test]
    fn a_serial_port_carries_bytes_both_ways() {
        let (mut device, host) = SerialPort::pair().unwrap();
        device.set_read_timeout(Duration::from_millis(500)).unwrap();
        let mut host = host;
        host.set_read_timeout(Duration::from_millis(500)).unwrap();
        let mut port = Port {
            address: Address::Serial("pair".to_owned(), 115_200),
            patience: Duration::from_millis(500),
            stream: Some(Box::new(host)),
            waiting: Vec::new(),
        };
        port.send(&[0, 1, 255]).unwrap();
        let mut bytes = [0; 3];
        device.read_exact(&mut bytes).unwrap();
        assert_eq!(bytes, [0, 1, 255]);
        device.write_all(&[7, 0]).unwrap();
        assert_eq!(port.receive(), Ok(Some(7)));
        assert_eq!(port.receive(), Ok(Some(0)));
    }
}
