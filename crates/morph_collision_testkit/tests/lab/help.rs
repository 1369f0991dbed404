//! Help.

use std::error::Error;

use crate::support::{TestResult, run_program, stdout_of};

#[test]
fn run_and_bench_have_the_same_methods() -> TestResult {
    let methods = |command: &str| -> Result<Vec<String>, Box<dyn Error>> {
        let help = stdout_of(&run_program([command, "--help"])?);
        let from = help.find("Methods:").ok_or("no methods")?;
        let listed = help[from..]
            .lines()
            .filter_map(|line| line.trim().strip_prefix("- ")?.split_once(':'));
        Ok(listed.map(|(name, _)| name.to_owned()).collect())
    };
    let of_run = methods("run")?;
    assert!(of_run.len() == 11 && of_run.contains(&"paper".to_owned()), "{of_run:?}");
    assert_eq!(methods("bench")?, of_run);
    Ok(())
}

#[test]
fn every_command_has_help_in_lines_that_are_not_too_long() -> TestResult {
    let help = stdout_of(&run_program(["--help"])?);
    let commands = help.lines().skip_while(|line| *line != "Commands:").skip(1);
    let commands = commands.take_while(|line| !line.is_empty());
    let commands: Vec<&str> = commands
        .filter_map(|line| line.strip_prefix("  ")?.split(' ').next())
        .collect();
    let commands: Vec<&str> = commands
        .into_iter()
        .filter(|command| !matches!(*command, "" | "help"))
        .collect();
    assert!(commands.len() > 10 && commands.contains(&"make-assets"), "{commands:?}");
    for command in commands {
        let help = stdout_of(&run_program([command, "--help"])?);
        // clap does not break lists of values.
        let lines = help.lines().filter(|line| !line.contains("possible values: "));
        let widest = lines.map(|line| line.chars().count()).max();
        assert!(widest <= Some(120), "{command}: {widest:?}");
    }
    Ok(())
}
