//! Breaks the lines of help texts. (clap can do it, but only with a crate that asks the terminal for its width.)

use clap::Command;
use clap::builder::StyledStr;

/// The width of help pages in characters.
const WIDTH: usize = 100;
/// clap indents descriptions by this much on long pages, and the list of commands by a little more.
const INDENT: usize = 14;
/// Descriptions stand beside their options on short pages.
const COLUMN: usize = 68;

/// A command whose texts are broken into lines, with all its subcommands.
pub(crate) fn wrapped(command: Command) -> Command {
    let about = command.get_about().map(|text| fill(text, WIDTH - INDENT));
    let long_about = command.get_long_about().map(|text| fill(text, WIDTH));
    let mut command = command.mut_args(|arg| {
        let help = arg.get_help().map(|text| fill(text, COLUMN));
        let long_help = arg.get_long_help().map(|text| fill(text, WIDTH - INDENT));
        let arg = help.into_iter().fold(arg, clap::Arg::help);
        long_help.into_iter().fold(arg, clap::Arg::long_help)
    });
    let after = command.get_after_help().map(|text| fill(text, WIDTH));
    let after_long = command.get_after_long_help().map(|text| fill(text, WIDTH));
    command = after.into_iter().fold(command, Command::after_help);
    command = after_long.into_iter().fold(command, Command::after_long_help);
    command = about.into_iter().fold(command, Command::about);
    command = long_about.into_iter().fold(command, Command::long_about);
    command.mut_subcommands(wrapped)
}

/// Breaks lines between words, so that they have at most `width` characters if the words allow. Indented lines stay as they are.
fn fill(text: &StyledStr, width: usize) -> String {
    let line = |line: &str| {
        if line.starts_with(' ') {
            return line.to_owned();
        }
        let mut filled = String::new();
        let mut length = 0;
        for word in line.split(' ') {
            let word_length = word.chars().count();
            if length > 0 && length + 1 + word_length > width {
                filled.push('\n');
                length = 0;
            } else if length > 0 {
                filled.push(' ');
                length += 1;
            }
            filled += word;
            length += word_length;
        }
        filled
    };
    let text = text.to_string();
    let lines: Vec<String> = text.lines().map(line).collect();
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_broken_between_words() {
        let text = StyledStr::from("one two three\n\nfour unbreakable five");
        assert_eq!(fill(&text, 7), "one two\nthree\n\nfour\nunbreakable\nfive");
        assert_eq!(fill(&StyledStr::from("  a b c d"), 3), "  a b c d");
    }
}
