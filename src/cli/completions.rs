//! `skipgrid completions`: what a shell completes this program's command lines with.

use super::console::Console;
use super::{Outcome, command};
use crate::error::Result;
use clap_complete::{Shell, generate};

const DETAILS: &str = "\
Verbs, options, and values that are words are completed; accelerators and scenes are not, as they have options of their own.

Examples:
  skipgrid completions bash > ~/.local/share/bash-completion/completions/skipgrid
  skipgrid completions zsh > ~/.zfunc/_skipgrid          with ~/.zfunc in fpath
  skipgrid completions fish > ~/.config/fish/completions/skipgrid.fish";

/// Print what a shell completes command lines of skipgrid with
#[derive(Debug, clap::Args)]
#[command(after_help = DETAILS)]
pub struct Args {
    /// The shell
    shell: Shell,
}

/// Prints the script.
pub fn run(args: &Args, console: &Console) -> Result<Outcome> {
    let mut script = Vec::new();
    generate(args.shell, &mut command(), "skipgrid", &mut script);
    console.data(&String::from_utf8_lossy(&script))?;
    Ok(Outcome::Done)
}
