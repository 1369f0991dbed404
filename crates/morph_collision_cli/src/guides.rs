//! `morph-collide completions` and `morph-collide man`: help for shells and for `man`.

use clap::{Args, CommandFactory};
use clap_complete::Shell;

use crate::Cli;
use crate::error::CliError;
use crate::output;

const COMPLETIONS_EXAMPLE: &str = "Example:
  morph-collide completions bash > ~/.local/share/bash-completion/completions/morph-collide";

const MAN_EXAMPLE: &str = "Example:
  morph-collide man run | man -l -";

/// Print a script that completes commands and options in a shell.
#[derive(Debug, Args)]
#[command(after_help = COMPLETIONS_EXAMPLE)]
pub(crate) struct CompletionsArgs {
    /// The shell.
    shell: Shell,
}

/// Print the manual page of the program, or of one of its commands, in roff.
#[derive(Debug, Args)]
#[command(after_help = MAN_EXAMPLE)]
pub(crate) struct ManArgs {
    /// The command; without it, the page of the program.
    command: Option<String>,
}

pub(crate) fn completions(args: &CompletionsArgs) -> Result<(), CliError> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "morph-collide", &mut script);
    output::write(&String::from_utf8_lossy(&script))
}

pub(crate) fn man(args: &ManArgs) -> Result<(), CliError> {
    let mut program = Cli::command();
    program.build();
    let command = match &args.command {
        None => &program,
        Some(name) => {
            let names: Vec<&str> = program.get_subcommands().map(clap::Command::get_name).collect();
            let hint = morph_collision_models::text::suggestion(name, names.iter().copied());
            let found = program.find_subcommand(name);
            found.ok_or_else(|| CliError::Flag {
                flag: "COMMAND",
                reason: format!("there is no command {name}{hint}"),
            })?
        }
    };
    let mut page = Vec::new();
    let rendered = clap_mangen::Man::new(command.clone()).render(&mut page);
    rendered.map_err(CliError::Stdout)?;
    output::write(&String::from_utf8_lossy(&page))
}
