//! What the sources of `core` may not name: `std`, `alloc`, and `unsafe` outside `kernels/`.
//!
//! The builds for bare metal prove that `std` is absent there; this check also sees code that a
//! `cfg` hides from those builds, and says the line. Comments, texts and whatever stands under
//! `#[cfg(test)]` are exempt.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};

use crate::workspace::Workspace;

/// Checks every source file of `core`.
pub fn check(workspace: &Workspace) -> Result<()> {
    let root = workspace.path("core/src");
    let mut files = Vec::new();
    list(&root, &mut files)?;
    files.sort();
    ensure!(!files.is_empty(), "core/src has no sources");
    let mut offences = Vec::new();
    for path in &files {
        let text = fs::read_to_string(path)?;
        let name = path.strip_prefix(&workspace.root).unwrap_or(path).display();
        let in_kernels = path.starts_with(root.join("kernels"));
        for offence in offences_in(&text, in_kernels) {
            offences.push(format!("\n  {name}:{}: `{}`", offence.line, offence.word));
        }
    }
    if !offences.is_empty() {
        bail!(
            "core must not name std or alloc, nor unsafe outside core/src/kernels:{}",
            offences.concat()
        );
    }
    println!("{} files keep the rules", files.len());
    Ok(())
}

/// Rust files below a folder, except those named `tests.rs`, which belong under `#[cfg(test)]`.
fn list(folder: &Path, files: &mut Vec<PathBuf>) -> Result<()> {
    let entries =
        fs::read_dir(folder).with_context(|| format!("no folder {}", folder.display()))?;
    for entry in entries {
        let path = entry?.path();
        if path.is_dir() {
            list(&path, files)?;
        } else if path.extension().is_some_and(|extension| extension == "rs")
            && path.file_name().is_some_and(|name| name != "tests.rs")
        {
            files.push(path);
        }
    }
    Ok(())
}

#[derive(Debug, PartialEq)]
struct Token {
    word: String, // an identifier or a single sign
    line: usize,  // from 1
}

/// The forbidden names in a source text.
fn offences_in(text: &str, in_kernels: bool) -> Vec<Token> {
    let tokens = without_tests(tokens(text));
    let mut offences = Vec::new();
    for (index, token) in tokens.iter().enumerate() {
        let at = |offset: usize| tokens.get(index + offset).map(|token| token.word.as_str());
        let before = index.checked_sub(1).and_then(|i| tokens.get(i)).map(|t| t.word.as_str());
        let is_path = at(1) == Some(":") && at(2) == Some(":");
        let forbidden = match token.word.as_str() {
            "std" | "alloc" => before == Some("crate") || is_path,
            "unsafe" => !in_kernels,
            _ => false,
        };
        if forbidden {
            offences.push(Token { word: token.word.clone(), line: token.line });
        }
    }
    offences
}

/// Identifiers and signs, without comments, texts, characters and lifetimes.
fn tokens(text: &str) -> Vec<Token> {
    let chars: Vec<char> = text.chars().collect();
    let at = |index: usize| chars.get(index).copied().unwrap_or('\0');
    let (mut tokens, mut index, mut line) = (Vec::new(), 0, 1);
    while index < chars.len() {
        let begin = index;
        let c = at(index);
        if c == '/' && at(index + 1) == '/' {
            while index < chars.len() && at(index) != '\n' {
                index += 1;
            }
        } else if c == '/' && at(index + 1) == '*' {
            index = end_of_block_comment(&chars, index);
        } else if c == '"' {
            index = end_of_text(&chars, index);
        } else if c == '\'' {
            // A character closes after one sign or an escape; otherwise this is a lifetime.
            if at(index + 1) == '\\' {
                index += 3;
                while index < chars.len() && at(index) != '\'' {
                    index += 1;
                }
                index += 1;
            } else {
                index += if at(index + 2) == '\'' { 3 } else { 1 };
            }
        } else if c.is_alphanumeric() || c == '_' {
            while at(index).is_alphanumeric() || at(index) == '_' {
                index += 1;
            }
            let word: String = chars[begin..index].iter().collect();
            let hashes = (index..).take_while(|i| at(*i) == '#').count();
            if matches!(word.as_str(), "r" | "br" | "cr") && at(index + hashes) == '"' {
                index = end_of_raw_text(&chars, index, hashes);
            } else {
                tokens.push(Token { word, line });
            }
        } else {
            index += 1;
            if !c.is_whitespace() {
                tokens.push(Token { word: c.to_string(), line });
            }
        }
        index = index.min(chars.len());
        line += chars[begin..index].iter().filter(|c| **c == '\n').count();
    }
    tokens
}

fn end_of_block_comment(chars: &[char], begin: usize) -> usize {
    let (mut depth, mut index) = (1, begin + 2);
    while depth > 0 && index < chars.len() {
        let step = match chars.get(index..index + 2) {
            Some(['/', '*']) => {
                depth += 1;
                2
            }
            Some(['*', '/']) => {
                depth -= 1;
                2
            }
            _ => 1,
        };
        index += step;
    }
    index
}

fn end_of_text(chars: &[char], begin: usize) -> usize {
    let mut index = begin + 1;
    while index < chars.len() && chars[index] != '"' {
        index += if chars[index] == '\\' { 2 } else { 1 };
    }
    index + 1
}

fn end_of_raw_text(chars: &[char], begin: usize, hashes: usize) -> usize {
    let mut index = begin + hashes + 1;
    while index < chars.len() {
        let closes = chars[index] == '"'
            && chars
                .get(index + 1..index + 1 + hashes)
                .is_some_and(|h| h.iter().all(|c| *c == '#'));
        index += 1;
        if closes {
            return index + hashes;
        }
    }
    index
}

/// Drops each `#[cfg(test)]` attribute and the item behind it, up to its `;` or closing brace.
fn without_tests(tokens: Vec<Token>) -> Vec<Token> {
    let mut kept = Vec::new();
    let mut rest = tokens.into_iter().peekable();
    while let Some(token) = rest.next() {
        if token.word != "#" || rest.peek().is_none_or(|next| next.word != "[") {
            kept.push(token);
            continue;
        }
        let mut attribute = vec![token];
        let mut depth = 0;
        for token in rest.by_ref() {
            depth += i32::from(token.word == "[") - i32::from(token.word == "]");
            attribute.push(token);
            if depth == 0 {
                break;
            }
        }
        let has = |word: &str| attribute.iter().any(|token| token.word == word);
        let is_test_only = has("cfg") && has("test") && !has("not") && !has("any");
        if !is_test_only {
            kept.append(&mut attribute);
            continue;
        }
        let mut depth = 0;
        for token in rest.by_ref() {
            depth += match token.word.as_str() {
                "{" | "(" | "[" => 1,
                "}" | ")" | "]" => -1,
                _ => 0,
            };
            if depth == 0 && matches!(token.word.as_str(), ";" | "}") {
                break;
            }
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str, in_kernels: bool) -> Vec<(String, usize)> {
        offences_in(text, in_kernels).into_iter().map(|token| (token.word, token.line)).collect()
    }

    #[test]
    fn forbidden_names_are_found_with_their_lines() {
        assert_eq!(words("use core::fmt;\nuse std::vec::Vec;", false), [("std".into(), 2)]);
        assert_eq!(words("extern crate alloc;", false), [("alloc".into(), 1)]);
        assert_eq!(words("fn f() {\n\n unsafe { g() } }", false), [("unsafe".into(), 3)]);
        assert_eq!(words("#[cfg(feature = \"std\")]\nextern crate std;", false).len(), 1);
        assert_eq!(words("#[cfg(not(test))]\nextern crate std;", false).len(), 1);
        assert_eq!(words("#[cfg(any(test, unix))]\nextern crate std;", false).len(), 1);
    }

    #[test]
    fn kernels_may_be_unsafe_but_not_std() {
        assert_eq!(words("unsafe { std::hint::black_box(0) }", true), [("std".into(), 1)]);
    }

    #[test]
    fn comments_texts_and_other_names_are_exempt() {
        let text = "// std::vec\n/* unsafe /* std::a */ */ \"std::x \\\" unsafe\" r#\"unsafe \"\"# \
                    'u' '\\'' fn f<'unsafe_>() {} let std = unsafe_code; my_std::x;";
        assert_eq!(words(text, false), []);
    }

    #[test]
    fn tests_are_exempt_and_what_follows_them_is_not() {
        let text =
            "#[cfg(test)]\nextern crate std;\n#[cfg(test)]\nmod tests { fn a() { std::b() } }";
        assert_eq!(words(text, false), []);
        assert_eq!(words(&format!("{text}\nfn c() {{ std::d() }}"), false), [("std".into(), 5)]);
    }
}
