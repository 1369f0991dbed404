//! Output files of commands. An output never replaces an input, and is either complete or not written at all.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use crate::error::CliError;
use crate::files::model::STANDARD;
use crate::messages::progress;
use crate::output;

/// A file to be written at the end of a command and checked at its beginning.
///
/// Nothing is written before [`OutputFile::write`]. A regular file is written under a temporary name in its directory and then
/// renamed, so a command that fails leaves the earlier file as it was. Symbolic links are followed. Devices and pipes are written
/// in place. `-` is stdout; reports then go to stderr.
#[derive(Debug)]
pub(crate) struct OutputFile {
    /// As the user named it, for messages.
    path: PathBuf,
    destination: Destination,
}

#[derive(Debug)]
enum Destination {
    /// The path after following all symbolic links.
    Rename(PathBuf),
    InPlace(File),
    Stdout,
}

impl OutputFile {
    /// Checks that `path`, given by the option `flag`, can be written and is not one of `inputs`.
    ///
    /// Two paths to the same file are recognised through symbolic and hard links.
    ///
    /// # Errors
    /// The file is an input, is a directory or read-only, or its directory cannot be written.
    pub(crate) fn create<P: AsRef<Path>>(
        flag: &'static str,
        path: &Path,
        inputs: impl IntoIterator<Item = P>,
    ) -> Result<Self, CliError> {
        refuse_inputs(flag, path, inputs)?;
        let destination = Destination::find(path).map_err(|reason| CliError::Write {
            file: path.into(),
            reason,
        })?;
        Ok(Self {
            path: path.into(),
            destination,
        })
    }

    /// Whether both would replace the same file, whatever their names.
    pub(crate) fn replaces_the_same_as(&self, other: &Self) -> bool {
        match (&self.destination, &other.destination) {
            (Destination::Rename(one), Destination::Rename(another)) => one == another,
            (Destination::Stdout, Destination::Stdout) => true,
            _ => false,
        }
    }

    /// Writes the output of `content`.
    ///
    /// # Errors
    /// `content` fails, or the file cannot be written. An earlier file is then left as it was.
    pub(crate) fn write(self, content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), CliError> {
        progress::clear();
        let written = match self.destination {
            Destination::Rename(target) => replace(&target, content),
            Destination::InPlace(file) => buffered(file, content),
            Destination::Stdout => return buffered(io::stdout().lock(), content).map_err(CliError::Stdout),
        };
        written.map_err(|reason| CliError::Write {
            file: self.path,
            reason,
        })
    }
}

impl Destination {
    fn find(path: &Path) -> io::Result<Self> {
        if path == Path::new(STANDARD) {
            output::leave_stdout_to_a_file();
            return Ok(Self::Stdout);
        }
        if let Some(stream) = standard_stream(path)? {
            return Ok(Self::InPlace(stream));
        }
        let target = match fs::metadata(path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => behind_links(path)?,
            Err(error) => return Err(error),
            Ok(found) if found.is_dir() => return Err(io::ErrorKind::IsADirectory.into()),
            Ok(found) if !found.is_file() => return Ok(Self::InPlace(OpenOptions::new().write(true).open(path)?)),
            // What looks like a file there is a name for something that is already open.
            Ok(_) if path.starts_with("/dev") || path.starts_with("/proc") => {
                return Ok(Self::InPlace(OpenOptions::new().append(true).open(path)?));
            }
            // Renaming would replace a read-only file without asking.
            Ok(found) if found.permissions().readonly() => return Err(io::ErrorKind::PermissionDenied.into()),
            Ok(_) => fs::canonicalize(path)?,
        };
        // Tried now, so that a path that cannot be written fails before any work is done.
        temporary_beside(&target)?.close()?;
        Ok(Self::Rename(target))
    }
}

/// This process's stdout or stderr, if `path` names one of them. It is appended to.
#[cfg(unix)]
fn standard_stream(path: &Path) -> io::Result<Option<File>> {
    use std::os::fd::AsFd;
    let stream = match path.to_str() {
        Some("/dev/stdout" | "/dev/fd/1" | "/proc/self/fd/1") => io::stdout().as_fd().try_clone_to_owned()?,
        Some("/dev/stderr" | "/dev/fd/2" | "/proc/self/fd/2") => io::stderr().as_fd().try_clone_to_owned()?,
        _ => return Ok(None),
    };
    Ok(Some(File::from(stream)))
}

#[cfg(not(unix))]
fn standard_stream(_: &Path) -> io::Result<Option<File>> {
    Ok(None)
}

/// The real path of a file that does not exist yet, following symbolic links whose target is missing.
fn behind_links(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_owned();
    // Linux follows as many.
    for _ in 0..40 {
        let directory = match path.parent() {
            Some(parent) if parent != Path::new("") => parent.canonicalize()?,
            _ => Path::new(".").canonicalize()?,
        };
        match fs::read_link(&path) {
            Ok(link) => path = directory.join(link),
            Err(_) => return Ok(directory.join(path.file_name().ok_or(io::ErrorKind::InvalidInput)?)),
        }
    }
    Err(io::Error::other("too many symbolic links"))
}

fn refuse_inputs<P: AsRef<Path>>(
    flag: &'static str,
    path: &Path,
    inputs: impl IntoIterator<Item = P>,
) -> Result<(), CliError> {
    // Opening a pipe would wait for its other end, and no pipe is overwritten.
    if !path.is_file() {
        return Ok(());
    }
    for input in inputs {
        let input = input.as_ref();
        if input.is_file() && same_file::is_same_file(path, input).unwrap_or(false) {
            let reason = format!(
                "{} is the same file as the input {}; choose another name",
                path.display(),
                input.display()
            );
            return Err(CliError::Flag { flag, reason });
        }
    }
    Ok(())
}

fn temporary_beside(target: &Path) -> io::Result<NamedTempFile> {
    let directory = match target.parent() {
        Some(parent) if parent != Path::new("") => parent,
        _ => Path::new("."),
    };
    let mut builder = tempfile::Builder::new();
    builder.prefix(".morph-collide-");
    // The permissions of any new file; the user's umask applies.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(directory)
}

fn replace(target: &Path, content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let temporary = temporary_beside(target)?;
    if let Ok(earlier) = fs::metadata(target) {
        temporary.as_file().set_permissions(earlier.permissions())?;
    }
    buffered(temporary.as_file(), content)?;
    temporary.persist(target).map_err(|error| error.error)?;
    Ok(())
}

fn buffered(file: impl Write, content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut file = BufWriter::new(file);
    content(&mut file)?;
    file.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    type TestResult = Result<(), Box<dyn std::error::Error>>;

    fn output(path: &Path, inputs: &[&Path]) -> Result<OutputFile, CliError> {
        OutputFile::create("--pairs", path, inputs)
    }

    fn names(directory: &Path) -> io::Result<Vec<std::ffi::OsString>> {
        fs::read_dir(directory)?.map(|entry| Ok(entry?.file_name())).collect()
    }

    #[test]
    fn a_failed_write_leaves_the_earlier_file_and_nothing_else() -> TestResult {
        let directory = tempfile::tempdir()?;
        let path = directory.path().join("pairs.csv");
        fs::write(&path, "earlier")?;
        let failed = output(&path, &[])?.write(|out| {
            out.write_all(&[b'x'; 100_000])?;
            Err(io::Error::other("half way"))
        });
        assert!(failed.is_err_and(|error| error.to_string().contains("half way")));
        assert_eq!(fs::read_to_string(&path)?, "earlier");
        assert_eq!(names(directory.path())?, ["pairs.csv"]);
        // An output that is dropped before it is written leaves nothing behind either.
        drop(output(&directory.path().join("other.csv"), &[])?);
        assert_eq!(names(directory.path())?, ["pairs.csv"]);
        Ok(())
    }

    #[test]
    fn a_new_file_and_an_earlier_one_get_the_content() -> TestResult {
        let directory = tempfile::tempdir()?;
        let path = directory.path().join("pairs.csv");
        for content in ["first, and longer", "second"] {
            output(&path, &[])?.write(|out| out.write_all(content.as_bytes()))?;
            assert_eq!(fs::read_to_string(&path)?, content);
        }
        Ok(())
    }

    #[test]
    fn an_input_is_refused_under_all_its_names() -> TestResult {
        let directory = tempfile::tempdir()?;
        let at = |name: &str| directory.path().join(name);
        let (input, other) = (at("scene.json"), at("other.json"));
        fs::write(&input, "{}")?;
        fs::write(&other, "{}")?;
        fs::hard_link(&input, at("hard.csv"))?;
        fs::create_dir(at("folder"))?;
        let mut aliases = vec![input.clone(), at("hard.csv"), at("folder/../scene.json")];
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(&input, at("soft.csv"))?;
            aliases.push(at("soft.csv"));
        }
        for alias in aliases {
            let error = output(&alias, &[&other, &input]).err().map(|error| error.to_string());
            let named = |error: &String| error.contains("--pairs") && error.contains("scene.json");
            assert!(error.as_ref().is_some_and(named), "{}: {error:?}", alias.display());
        }
        assert_eq!(fs::read_to_string(&input)?, "{}");
        output(&other, &[&input])?;
        Ok(())
    }

    #[test]
    fn directories_and_read_only_files_are_refused() -> TestResult {
        let directory = tempfile::tempdir()?;
        assert!(output(directory.path(), &[]).is_err());
        assert!(output(&directory.path().join("absent/pairs.csv"), &[]).is_err());
        let path = directory.path().join("pairs.csv");
        fs::write(&path, "earlier")?;
        let mut permissions = fs::metadata(&path)?.permissions();
        permissions.set_readonly(true);
        fs::set_permissions(&path, permissions)?;
        assert!(output(&path, &[]).is_err());
        Ok(())
    }

    #[cfg(unix)]
    #[test]
    fn a_link_stays_a_link_and_permissions_stay() -> TestResult {
        use std::os::unix::fs::PermissionsExt;
        let directory = tempfile::tempdir()?;
        let (path, link) = (directory.path().join("pairs.csv"), directory.path().join("link"));
        fs::write(&path, "earlier")?;
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640))?;
        std::os::unix::fs::symlink(&path, &link)?;
        output(&link, &[])?.write(|out| out.write_all(b"new"))?;
        assert!(fs::symlink_metadata(&link)?.is_symlink());
        assert_eq!(fs::read_to_string(&path)?, "new");
        assert_eq!(fs::metadata(&path)?.permissions().mode() & 0o777, 0o640);
        Ok(())
    }

    #[cfg(unix)]
    #[test]
    fn a_link_to_nothing_is_followed() -> TestResult {
        let directory = tempfile::tempdir()?;
        let at = |name: &str| directory.path().join(name);
        std::os::unix::fs::symlink("middle", at("link"))?;
        std::os::unix::fs::symlink(at("pairs.csv"), at("middle"))?;
        let (link, plain) = (output(&at("link"), &[])?, output(&at("./pairs.csv"), &[])?);
        assert!(link.replaces_the_same_as(&plain));
        link.write(|out| out.write_all(b"new"))?;
        assert!(fs::symlink_metadata(at("link"))?.is_symlink());
        assert_eq!(fs::read_to_string(at("pairs.csv"))?, "new");
        std::os::unix::fs::symlink("round", at("round"))?;
        assert!(output(&at("round"), &[]).is_err());
        Ok(())
    }

    #[cfg(unix)]
    #[test]
    fn a_device_is_written_in_place() -> TestResult {
        output(Path::new("/dev/null"), &[])?.write(|out| out.write_all(b"gone"))?;
        assert!(!fs::metadata("/dev/null")?.is_file());
        Ok(())
    }
}
