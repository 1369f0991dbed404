//! Where numbers come from: the day, the commit and the machine.

use std::error::Error;
use std::path::Path;
use std::process::Command;

use morph_collision::Kernel;

use crate::machine::cpu;

/// Today, the commit of the code, and this machine with its vector instructions.
///
/// # Errors
/// Git or `date` cannot be run, or the folder is not in a repository.
pub fn origin(docs: &Path) -> Result<String, Box<dyn Error>> {
    let cores = std::thread::available_parallelism().map_or(0, usize::from);
    Ok(format!(
        "{} at commit {}, {}, {cores} cores, {}-{}, {}",
        output(Command::new("date").args(["-u", "+%F"]))?,
        commit(docs)?,
        cpu(),
        std::env::consts::OS,
        std::env::consts::ARCH,
        Kernel::default().name(),
    ))
}

/// The commit, marked if anything but documents has changed since.
fn commit(docs: &Path) -> Result<String, Box<dyn Error>> {
    let git = |args: &[&str]| output(Command::new("git").arg("-C").arg(docs).args(args));
    let head = git(&["rev-parse", "--short", "HEAD"])?;
    let changes = git(&[
        "status",
        "--porcelain",
        "--",
        ":/",
        ":(top,exclude)docs",
        ":(top,exclude)*.md",
    ])?;
    Ok(if changes.is_empty() {
        head
    } else {
        format!("{head} with changes")
    })
}

fn output(command: &mut Command) -> Result<String, Box<dyn Error>> {
    let output = command.output().map_err(|error| format!("{command:?}: {error}"))?;
    if !output.status.success() {
        let reason = String::from_utf8_lossy(&output.stderr);
        return Err(format!("{command:?}: {}", reason.trim()).into());
    }
    Ok(String::from_utf8(output.stdout)?.trim().to_owned())
}
