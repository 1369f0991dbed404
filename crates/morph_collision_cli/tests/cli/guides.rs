//! Completions, manual pages and help.

use crate::support::{TestResult, error_of, morph_collide, stdout_of};

const COMMANDS: [&str; 12] = [
    "inspect",
    "query",
    "sweep",
    "export",
    "scene",
    "run",
    "motion",
    "verify",
    "stress",
    "bench",
    "completions",
    "man",
];

#[test]
fn shells_learn_every_command() -> TestResult {
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = stdout_of(&morph_collide(["completions", shell])?);
        for command in COMMANDS {
            assert!(script.contains(command), "no {command} for {shell}");
        }
        assert!(script.contains("fail-on-touch"), "{shell}");
    }
    Ok(())
}

#[test]
fn there_is_a_manual_page_for_the_program_and_for_each_command() -> TestResult {
    let page = stdout_of(&morph_collide(["man"])?);
    assert!(
        page.contains(".TH morph\\-collide") || page.contains(".TH morph-collide"),
        "{page}"
    );
    for command in COMMANDS {
        let page = stdout_of(&morph_collide(["man", command])?);
        assert!(
            page.contains(".SH SYNOPSIS") && page.contains(command),
            "{command}: {page}"
        );
    }
    let message = error_of(&morph_collide(["man", "sweap"])?);
    assert!(message.contains("did you mean \"sweep\"?"), "{message}");
    Ok(())
}

#[test]
fn help_shows_defaults_and_the_same_methods_for_run_and_bench() -> TestResult {
    let methods = |command: &str| -> Result<Vec<String>, Box<dyn std::error::Error>> {
        let help = stdout_of(&morph_collide([command, "--help"])?);
        let from = help.find("Methods:").ok_or("no methods")?;
        let listed = help[from..]
            .lines()
            .filter_map(|line| line.trim().strip_prefix("- ")?.split_once(':'));
        Ok(listed.map(|(name, _)| name.to_owned()).collect())
    };
    let of_run = methods("run")?;
    assert!(
        of_run.len() == 10 && of_run.contains(&"hybrid".to_owned()),
        "{of_run:?}"
    );
    assert_eq!(methods("bench")?, of_run);
    let help = stdout_of(&morph_collide(["scene", "--help"])?);
    assert!(help.contains("[default: 30]"), "{help}");
    for command in COMMANDS {
        let help = stdout_of(&morph_collide([command, "--help"])?);
        let widest = help.lines().map(|line| line.chars().count()).max();
        assert!(widest <= Some(120), "{command}: {widest:?}");
    }
    Ok(())
}
