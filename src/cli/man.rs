//! `skipgrid man`: the manual pages, made of what `--help` says.

use super::console::Console;
use super::{Outcome, command};
use crate::error::{Error, Result};
use crate::picture::io::replace_file;
use crate::registry::did_you_mean;
use clap::Command;
use clap_mangen::Man;
use std::path::PathBuf;

const DETAILS: &str = "\
Examples:
  skipgrid man | man -l -
  skipgrid man render | man -l -
  skipgrid man --to ~/.local/share/man/man1          skipgrid.1, skipgrid-render.1 and so on";

/// Print the manual page of skipgrid or of one of its verbs
#[derive(Debug, clap::Args)]
#[command(after_help = DETAILS)]
pub struct Args {
    /// The verb; default: the page of the whole program
    verb: Option<String>,

    /// Write all pages into this folder, instead of printing one
    #[arg(long, value_name = "DIR", conflicts_with = "verb")]
    to: Option<PathBuf>,
}

/// Prints or writes pages.
pub fn run(args: &Args, console: &Console) -> Result<Outcome> {
    let mut program = command().disable_help_subcommand(true);
    // Gives the verbs their full names and the options of the whole program.
    program.build();
    let verbs: Vec<&Command> = program.get_subcommands().collect();
    if let Some(folder) = &args.to {
        for command in [&program].into_iter().chain(verbs) {
            let name = command.get_display_name().unwrap_or(command.get_name());
            replace_file(folder.join(format!("{name}.1")), &page(command)?)?;
        }
        return Ok(Outcome::Done);
    }
    let command = match &args.verb {
        None => &program,
        Some(verb) => verbs.iter().find(|command| command.get_name() == verb).ok_or_else(|| {
            let names: Vec<&str> = verbs.iter().map(|command| command.get_name()).collect();
            let hint = did_you_mean(&names, verb, 3);
            Error::invalid(format!("unknown verb `{verb}`{hint}; there are {}", names.join(", ")))
        })?,
    };
    console.data(&String::from_utf8_lossy(&page(command)?))?;
    Ok(Outcome::Done)
}

/// The page in roff.
fn page(command: &Command) -> Result<Vec<u8>> {
    let mut page = Vec::new();
    Man::new(command.clone())
        .source(concat!("skipgrid ", env!("CARGO_PKG_VERSION")))
        .render(&mut page)
        .map_err(|error| Error::io("the manual page", error))?;
    Ok(page)
}
