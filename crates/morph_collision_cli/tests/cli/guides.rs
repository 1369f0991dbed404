//! Completions, manual pages and help.

use crate::support::{TestResult, error_of, run_program, stdout_of};

const COMMANDS: [&str; 11] = [
    "inspect",
    "query",
    "sweep",
    "lint",
    "export",
    "bake",
    "scene",
    "run",
    "motion",
    "completions",
    "man",
];

#[test]
fn shells_learn_every_command() -> TestResult {
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = stdout_of(&run_program(["completions", shell])?);
        for command in COMMANDS {
            assert!(script.contains(command), "no {command} for {shell}");
        }
        assert!(script.contains("fail-on-touch"), "{shell}");
    }
    Ok(())
}

#[test]
fn there_is_a_manual_page_for_the_program_and_for_each_command() -> TestResult {
    let page = stdout_of(&run_program(["man"])?);
    assert!(
        page.contains(".TH morph\\-collide") || page.contains(".TH morph-collide"),
        "{page}"
    );
    for command in COMMANDS {
        let page = stdout_of(&run_program(["man", command])?);
        assert!(
            page.contains(".SH SYNOPSIS") && page.contains(command),
            "{command}: {page}"
        );
    }
    let message = error_of(&run_program(["man", "sweap"])?);
    assert!(message.contains("did you mean \"sweep\"?"), "{message}");
    Ok(())
}

#[test]
fn help_shows_defaults_in_lines_that_are_not_too_long() -> TestResult {
    let help = stdout_of(&run_program(["scene", "--help"])?);
    assert!(help.contains("[default: 30]"), "{help}");
    for command in COMMANDS {
        let help = stdout_of(&run_program([command, "--help"])?);
        let widest = help.lines().map(|line| line.chars().count()).max();
        assert!(widest <= Some(120), "{command}: {widest:?}");
    }
    Ok(())
}
