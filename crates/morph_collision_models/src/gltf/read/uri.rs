//! Resolves a buffer's URI and checks whether the file may refer to it.
//!
//! A file may come from anybody, so by default it may refer only to regular files in its own directory and below, by relative
//! paths that stay inside. Symbolic links must lead to a place inside. Everything else has to be allowed explicitly.

use std::borrow::Cow;
use std::path::{Component, Path, PathBuf};

use percent_encoding::percent_decode_str;

use super::document::abridged;
use super::error::BufferFault;

/// What a URI refers to.
#[derive(Debug, PartialEq)]
pub(super) enum Source<'a> {
    /// The bytes themselves, in base64.
    Base64(&'a str),
    /// A file, by its path as given.
    File(PathBuf),
}

/// Resolves a URI of a file in `directory`. Other files are allowed only if there is a directory.
pub(super) fn resolve<'a>(uri: &'a str, directory: Option<&Path>, any_path: bool) -> Result<Source<'a>, BufferFault> {
    let scheme = scheme(uri);
    if scheme.is_some_and(|scheme| scheme.eq_ignore_ascii_case("data")) {
        let encoded = uri.split_once(";base64,").ok_or(BufferFault::Encoding)?;
        return Ok(Source::Base64(encoded.1));
    }
    let directory = directory.ok_or(BufferFault::NoDirectory)?;
    let path = match scheme {
        None => decoded(uri)?,
        Some(scheme) if scheme.eq_ignore_ascii_case("file") => {
            allowed(any_path, "it is a file: URI")?;
            let path = &uri["file:".len()..];
            let path = path.strip_prefix("//").unwrap_or(path);
            decoded(path.strip_prefix("localhost").unwrap_or(path))?
        }
        Some(scheme) => return Err(BufferFault::Scheme(abridged(scheme))),
    };
    let path = Path::new(&*path);
    if path.as_os_str().is_empty() || path.as_os_str().as_encoded_bytes().contains(&0) {
        return Err(BufferFault::NoPath);
    }
    if !any_path {
        stays_inside(path)?;
    }
    Ok(Source::File(directory.join(path)))
}

/// Checks that a path is a regular file inside `directory` after following symbolic links.
pub(super) fn check_file(path: &Path, directory: &Path) -> Result<(), BufferFault> {
    let io = |error: std::io::Error| BufferFault::Io(error.to_string());
    let directory = if directory == Path::new("") {
        Path::new(".")
    } else {
        directory
    };
    let real = path.canonicalize().map_err(io)?;
    if !real.starts_with(directory.canonicalize().map_err(io)?) {
        return Err(BufferFault::Outside(
            "a symbolic link leads out of the model's directory",
        ));
    }
    // Checked before opening, because opening a pipe waits for its other end.
    if !real.metadata().map_err(io)?.is_file() {
        return Err(BufferFault::Outside("it is not a regular file"));
    }
    Ok(())
}

/// Letters, digits, `+`, `-` and `.` before a colon. A single letter is a drive.
fn scheme(uri: &str) -> Option<&str> {
    let (scheme, _) = uri.split_once(':')?;
    let mut letters = scheme.bytes();
    let first = letters.next().is_some_and(|byte| byte.is_ascii_alphabetic());
    let rest = letters.all(|byte| byte.is_ascii_alphanumeric() || matches!(byte, b'+' | b'-' | b'.'));
    (first && rest && scheme.len() > 1).then_some(scheme)
}

fn decoded(uri: &str) -> Result<Cow<'_, str>, BufferFault> {
    percent_decode_str(uri).decode_utf8().map_err(|_| BufferFault::NotUtf8)
}

fn allowed(any_path: bool, why: &'static str) -> Result<(), BufferFault> {
    if any_path {
        Ok(())
    } else {
        Err(BufferFault::Outside(why))
    }
}

/// Checks the path alone: it must be relative and never go above its start.
fn stays_inside(path: &Path) -> Result<(), BufferFault> {
    let mut depth = 0_usize;
    let drive = path.to_str().is_some_and(|path| path.as_bytes().get(1) == Some(&b':'));
    for component in path.components() {
        match component {
            Component::Prefix(_) | Component::RootDir => return Err(BufferFault::Outside("its path is absolute")),
            _ if drive => return Err(BufferFault::Outside("its path is absolute")),
            Component::ParentDir => {
                depth = depth
                    .checked_sub(1)
                    .ok_or(BufferFault::Outside("its path leads out of the model's directory"))?;
            }
            Component::Normal(_) => depth += 1,
            Component::CurDir => {}
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(uri: &str, any_path: bool) -> Result<Source<'_>, BufferFault> {
        resolve(uri, Some(Path::new("models")), any_path)
    }

    #[test]
    fn relative_paths_are_decoded_and_stay_inside() {
        for (uri, path) in [
            ("a.bin", "models/a.bin"),
            ("my%20body%2Ebin", "models/my body.bin"),
            ("./parts/../a.bin", "models/./parts/../a.bin"),
            ("50%.bin", "models/50%.bin"),
        ] {
            assert_eq!(file(uri, false), Ok(Source::File(path.into())), "{uri}");
        }
    }

    #[test]
    fn what_leads_out_is_refused_unless_it_is_allowed() {
        for (uri, allowed) in [
            ("/dev/zero", "/dev/zero"),
            ("%2Fdev%2Fzero", "/dev/zero"),
            ("../a.bin", "models/../a.bin"),
            ("%2e%2e/a.bin", "models/../a.bin"),
            ("parts/../../a.bin", "models/parts/../../a.bin"),
            ("file:///etc/passwd", "/etc/passwd"),
            ("FILE:/etc/passwd", "/etc/passwd"),
            ("file://localhost/etc/passwd", "/etc/passwd"),
            ("C:/a.bin", "models/C:/a.bin"),
        ] {
            assert!(matches!(file(uri, false), Err(BufferFault::Outside(_))), "{uri}");
            assert_eq!(file(uri, true), Ok(Source::File(allowed.into())), "{uri}");
        }
    }

    #[test]
    fn other_schemes_and_what_is_no_path_are_always_refused() {
        for any_path in [false, true] {
            let scheme = Err(BufferFault::Scheme("https".into()));
            assert_eq!(file("https://example.org/a.bin", any_path), scheme);
            assert_eq!(file("a%00b.bin", any_path), Err(BufferFault::NoPath));
            assert_eq!(file("", any_path), Err(BufferFault::NoPath));
            assert_eq!(file("%ff.bin", any_path), Err(BufferFault::NotUtf8));
            assert_eq!(file("data:text/plain,abc", any_path), Err(BufferFault::Encoding));
            assert_eq!(resolve("a.bin", None, any_path), Err(BufferFault::NoDirectory));
        }
        assert_eq!(file("data:;base64,AAAA", false), Ok(Source::Base64("AAAA")));
        let long = format!("{}:x", "a".repeat(1000));
        assert_eq!(
            file(&long, false),
            Err(BufferFault::Scheme(format!("{}...", "a".repeat(200))))
        );
    }
}
