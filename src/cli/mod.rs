//! The program: one file for each verb.
//!
//! Data go to standard output, everything else to standard error. Exit codes: 0 done and, if something was checked, in
//! order; 1 a check failed; 2 bad usage or bad input; 3 input or output failed; 130 interrupted, by SIGINT or SIGTERM.

mod bench;
mod compare;
mod completions;
mod console;
mod converge;
mod diff;
mod document;
#[cfg(test)]
mod documented;
mod export;
mod info;
mod input;
mod interrupt;
mod list;
mod man;
mod merge;
mod outputs;
mod papers;
mod picture;
mod plan;
mod render;
mod run_under;
mod shard;
mod stress;
mod sweep;
mod table;
mod trace;
mod validate;

use clap::{ColorChoice, Command, CommandFactory, FromArgMatches, Parser, Subcommand};
use console::Console;
use std::process::ExitCode;

/// What the verbs are for, in the order in which a newcomer may want them.
const GROUPS: &[(&str, &[&str])] = &[
    ("Pictures", &["render", "diff", "export"]),
    ("Pictures in parts, on many machines", &["plan", "shard", "merge"]),
    ("What there is", &["list", "info"]),
    ("Accelerators in your program", &["trace", "run-under"]),
    ("Accelerators measured", &["compare", "bench", "sweep", "converge", "papers"]),
    ("Answers and pictures checked", &["validate", "stress"]),
    ("Shell and manual", &["completions", "man", "help"]),
];

const DETAILS: &str = "\
Examples:
  skipgrid render cornell -o cornell.png            to begin with: a scene made by formula, no file is needed
  skipgrid list                                     accelerators, scenes, features
  skipgrid render room.glb -o room.exr              a scene of yours
  skipgrid compare room.glb --accel grid --accel obvhs-cwbvh
  skipgrid validate --report report.html            against POV-Ray's and Mitsuba's pictures
  skipgrid run-under -- blender -b scene.blend -f 1    Blender on our accelerators instead of Embree
`skipgrid VERB --help` says more of each verb, with examples.

Exit codes:
  0    done and, if something was checked, in order
  1    a check failed: hits or pictures differ, a bound is exceeded, shards are missing
  2    bad usage or bad input
  3    input or output failed
  130  interrupted (SIGINT or SIGTERM): files are whole, not there, or have `.partial` in their names
`run-under` ends with the exit code of its program.

Data go to standard output, all else to standard error. Progress and colour are for terminals alone; NO_COLOR and TERM=dumb \
are respected. The JSON of every verb is described in docs/json.md.";

/// Grid ray-tracing accelerators next to BVHs in one path tracer, and a validator against POV-Ray and Mitsuba.
#[derive(Debug, Parser)]
#[command(name = "skipgrid", version, after_help = DETAILS, max_term_width = 110)]
struct Program {
    #[command(subcommand)]
    verb: Verb,

    /// Print errors only; data still go to standard output
    #[arg(long, short, global = true)]
    quiet: bool,
}

/// The command line as it is parsed and described.
fn command() -> Command {
    let command = with_negative_numbers(Program::command());
    let template =
        format!("{{about-with-newline}}\n{{usage-heading}} {{usage}}\n\n{}{{options}}{{after-help}}", groups(&command));
    // Whatever else the environment says, such as CI=true, which counts for more elsewhere.
    let dumb = std::env::var_os("TERM").is_some_and(|terminal| terminal == "dumb");
    command.help_template(template).color(if dumb { ColorChoice::Never } else { ColorChoice::Auto })
}

/// `--rays -5` is a number that is refused with its reason, not an option that nobody knows.
fn with_negative_numbers(command: Command) -> Command {
    let values = |arg: clap::Arg| if arg.get_action().takes_values() { arg.allow_negative_numbers(true) } else { arg };
    command.mut_args(values).mut_subcommands(with_negative_numbers)
}

/// The verbs under the headings of [`GROUPS`], and the heading of the options.
fn groups(command: &Command) -> String {
    let style = command.get_styles();
    let (header, literal) = (style.get_header(), style.get_literal());
    let mut text = String::new();
    for (heading, names) in GROUPS {
        text += &format!("{header}{heading}:{header:#}\n");
        for name in *names {
            let verb = command.find_subcommand(name);
            let about =
                verb.and_then(Command::get_about).map_or("Print this or a verb's help".into(), ToString::to_string);
            text += &format!("  {literal}{name:<11}{literal:#}  {about}\n");
        }
        text += "\n";
    }
    text + &format!("{header}Options:{header:#}\n")
}

#[derive(Debug, Subcommand)]
enum Verb {
    List(list::Args),
    Info(info::Args),
    Render(render::Args),
    Plan(plan::Args),
    Shard(shard::Args),
    Merge(merge::Args),
    Compare(compare::Args),
    Converge(converge::Args),
    Sweep(sweep::Args),
    Bench(bench::Args),
    Trace(trace::Args),
    RunUnder(run_under::Args),
    Validate(validate::Args),
    Stress(stress::Args),
    Export(export::Args),
    Diff(diff::Args),
    Papers(papers::Args),
    Completions(completions::Args),
    Man(man::Args),
}

/// How a verb ended that met no error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Outcome {
    /// All done, nothing wrong.
    Done,
    /// A check said no.
    CheckFailed,
    /// The user wanted no more; what was finished is kept.
    Interrupted,
    /// Another program ran, and this is its exit code.
    #[cfg_attr(not(target_os = "linux"), expect(dead_code, reason = "programs are run on Linux only"))]
    OfProgram(u8),
}

impl Outcome {
    /// Of a measurement whose answers or pictures must be `identical`.
    fn of(identical: bool, interrupted: bool) -> Self {
        match (identical, interrupted) {
            (false, _) => Self::CheckFailed,
            (true, true) => Self::Interrupted,
            (true, false) => Self::Done,
        }
    }
}

/// Runs the program on its command line and prints what goes wrong.
pub fn main() -> ExitCode {
    let parsed = command().try_get_matches().and_then(|matches| Program::from_arg_matches(&matches));
    let program = match parsed {
        Ok(program) => program,
        Err(message) => {
            // Help and usage go where clap sends them; a closed pipe is no reason to fail.
            let _ = message.print();
            return ExitCode::from(if message.use_stderr() { 2 } else { 0 });
        }
    };
    interrupt::listen();
    let console = Console::new(program.quiet);
    let outcome = match program.verb {
        Verb::List(args) => list::run(&args, &console),
        Verb::Info(args) => info::run(&args, &console),
        Verb::Render(args) => render::run(&args, &console),
        Verb::Plan(args) => plan::run(&args, &console),
        Verb::Shard(args) => shard::run(&args, &console),
        Verb::Merge(args) => merge::run(&args, &console),
        Verb::Compare(args) => compare::run(&args, &console),
        Verb::Converge(args) => converge::run(&args, &console),
        Verb::Sweep(args) => sweep::run(&args, &console),
        Verb::Bench(args) => bench::run(&args, &console),
        Verb::Trace(args) => trace::run(&args, &console),
        Verb::RunUnder(args) => run_under::run(&args, &console),
        Verb::Validate(args) => validate::run(&args, &console),
        Verb::Stress(args) => stress::run(&args, &console),
        Verb::Export(args) => export::run(&args, &console),
        Verb::Diff(args) => diff::run(&args, &console),
        Verb::Papers(args) => papers::run(&args, &console),
        Verb::Completions(args) => completions::run(&args, &console),
        Verb::Man(args) => man::run(&args, &console),
    };
    match outcome {
        Ok(Outcome::Done) => ExitCode::SUCCESS,
        Ok(Outcome::CheckFailed) => ExitCode::from(1),
        Ok(Outcome::Interrupted) => ExitCode::from(interrupt::EXIT_CODE),
        Ok(Outcome::OfProgram(code)) => ExitCode::from(code),
        Err(error) => {
            console.error(&error);
            ExitCode::from(error.exit_code())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        command().debug_assert();
    }

    #[test]
    fn every_verb_is_in_one_group() {
        let (program, mut grouped) = (command(), Vec::<&str>::new());
        GROUPS.iter().for_each(|(_, names)| grouped.extend(*names));
        let mut verbs: Vec<&str> = program.get_subcommands().map(Command::get_name).chain(["help"]).collect();
        verbs.sort();
        grouped.sort();
        assert_eq!(grouped, verbs);
    }
}
