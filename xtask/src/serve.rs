//! A small file server for the built page: one folder, GET and HEAD, the loopback interface only.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::path::{Component, Path, PathBuf};
use std::thread;
use std::time::Duration;

use anyhow::{Context, Result, bail};

const DEFAULT_PORT: u16 = 8080;

/// A request's head may not be longer than this, bytes.
const HEAD_LIMIT: u64 = 16 * 1024;

/// Opens the port that the arguments of `serve` ask for.
pub fn listen(arguments: &[String]) -> Result<TcpListener> {
    let port = match arguments {
        [] => DEFAULT_PORT,
        [port] => {
            port.parse().with_context(|| format!("`{port}` is no port; try {DEFAULT_PORT}"))?
        }
        _ => bail!("`serve` takes at most one argument, the port"),
    };
    TcpListener::bind((Ipv4Addr::LOCALHOST, port)).with_context(|| {
        format!("port {port} cannot be opened; name another: `cargo xtask serve 8081`")
    })
}

/// Serves a folder until the program is ended.
pub fn serve(folder: &Path, listener: &TcpListener) -> Result<()> {
    let folder = folder.canonicalize().context("the page is not built")?;
    let port = listener.local_addr()?.port();
    println!("http://localhost:{port} serves {}; Ctrl-C ends it", folder.display());
    println!("{}", on_a_phone(port));
    for stream in listener.incoming().flatten() {
        let folder = folder.clone();
        // A browser that goes away in the middle is no reason to stop.
        thread::spawn(move || answer(stream, &folder).ok());
    }
    Ok(())
}

/// How a phone reaches the page: browsers give a camera to secure addresses only, and `localhost` is
/// one.
fn on_a_phone(port: u16) -> String {
    format!(
        "On an Android phone by USB: `adb reverse tcp:{port} tcp:{port}`, then http://localhost:{port} \
         there.\nOn any other phone: put the folder, as it is, on any https host; it needs no server \
         of its own."
    )
}

fn answer(stream: TcpStream, folder: &Path) -> Result<()> {
    stream.set_read_timeout(Some(Duration::from_secs(10)))?;
    let mut lines = BufReader::new(stream.try_clone()?.take(HEAD_LIMIT)).lines();
    let request = lines.next().context("empty request")??;
    for line in lines {
        if line?.is_empty() {
            break;
        }
    }
    respond(stream, folder, &request)
}

/// Answers a request line, such as `GET /index.html HTTP/1.1`.
fn respond(mut to: impl Write, folder: &Path, request: &str) -> Result<()> {
    let mut words = request.split(' ');
    let (method, target) = (words.next().unwrap_or_default(), words.next().unwrap_or_default());
    let (status, kind, body) = if !matches!(method, "GET" | "HEAD") {
        ("405 Method Not Allowed", "text/plain", b"only GET and HEAD\n".to_vec())
    } else if let Some(path) = file(folder, target) {
        ("200 OK", mime(&path), fs::read(&path)?)
    } else {
        ("404 Not Found", "text/plain", b"no such file\n".to_vec())
    };
    write!(
        to,
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {}\r\n\
         Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\nConnection: close\r\n\r\n",
        body.len()
    )?;
    if method != "HEAD" {
        to.write_all(&body)?;
    }
    Ok(())
}

/// The file that a request names; `None` where there is none or it lies outside the folder.
fn file(folder: &Path, target: &str) -> Option<PathBuf> {
    let path = target.split(['?', '#']).next()?.strip_prefix('/')?;
    let relative = Path::new(if path.is_empty() { "index.html" } else { path });
    let is_plain = relative.components().all(|part| matches!(part, Component::Normal(_)));
    // Canonical, so that a link cannot lead out of the folder either.
    let found = folder.join(relative).canonicalize().ok()?;
    (is_plain && found.starts_with(folder) && found.is_file()).then_some(found)
}

/// The media type by the file's extension; `.wasm` must be right for streaming compilation.
fn mime(path: &Path) -> &'static str {
    match path.extension().and_then(|extension| extension.to_str()) {
        Some("html") => "text/html; charset=utf-8",
        Some("js" | "mjs") => "text/javascript; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("json" | "map") => "application/json",
        Some("webmanifest") => "application/manifest+json",
        Some("wasm") => "application/wasm",
        Some("svg") => "image/svg+xml",
        Some("png") => "image/png",
        Some("jpg" | "jpeg") => "image/jpeg",
        Some("ico") => "image/x-icon",
        Some("txt") => "text/plain; charset=utf-8",
        _ => "application/octet-stream",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn get(request: &str) -> String {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).canonicalize().unwrap();
        let mut bytes = Vec::new();
        respond(&mut bytes, &folder, request).unwrap();
        String::from_utf8(bytes).unwrap()
    }

    #[test]
    fn files_of_the_folder_are_served() {
        let answer = get("GET /Cargo.toml?x=1 HTTP/1.1");
        assert!(answer.starts_with("HTTP/1.1 200 OK\r\n"));
        assert!(answer.ends_with(include_str!("../Cargo.toml")));
        assert!(!get("HEAD /Cargo.toml HTTP/1.1").contains("[package]"));
    }

    #[test]
    fn nothing_outside_the_folder_is_served() {
        for target in ["/../Cargo.toml", "//etc/passwd", "/src/../../Cargo.toml", "/", "/src", ""] {
            assert!(get(&format!("GET {target} HTTP/1.1")).starts_with("HTTP/1.1 404"), "{target}");
        }
    }

    #[test]
    fn other_methods_are_refused() {
        assert!(get("POST /Cargo.toml HTTP/1.1").starts_with("HTTP/1.1 405"));
    }

    #[test]
    fn a_port_that_is_taken_or_none_is_refused() {
        let taken = listen(&["0".into()]).unwrap();
        let port = taken.local_addr().unwrap().port().to_string();
        for words in [vec![port], vec!["65536".into()], vec!["x".into()], vec!["1".into(); 2]] {
            assert!(listen(&words).is_err(), "{words:?}");
        }
    }

    #[test]
    fn modules_and_webassembly_have_their_types() {
        assert_eq!(mime(Path::new("a.wasm")), "application/wasm");
        assert_eq!(mime(Path::new("a.js")), "text/javascript; charset=utf-8");
    }
}
