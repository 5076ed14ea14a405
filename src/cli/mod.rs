//! The program: one file for each verb.
//!
//! Data go to standard output, everything else to standard error. Exit codes: 0 done and, if something was checked, in
//! order; 1 a check failed; 2 bad usage or bad input; 3 input or output failed; 130 interrupted.

mod bench;
mod compare;
mod completions;
mod console;
mod converge;
mod diff;
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

use clap::{Parser, Subcommand};
use console::Console;
use std::process::ExitCode;

const EXAMPLES: &str = "\
Examples:
  skipgrid render cornell -o cornell.png            a scene made by formula
  skipgrid render room.glb --accel obvhs-cwbvh -o room.exr
  skipgrid compare room.glb --accel grid --accel obvhs-cwbvh
  skipgrid validate --report report.html            against POV-Ray's and Mitsuba's pictures
  skipgrid trace mesh.obj --rays rays.npy --hits hits.npy
  skipgrid run-under -- blender -b scene.blend -f 1    Blender on our accelerators instead of Embree

Exit codes: 0 done and, if something was checked, in order; 1 a check failed; 2 bad usage or bad input; 3 input or \
output failed; 130 interrupted.
Data go to standard output, all else to standard error. NO_COLOR is respected.";

/// Grid ray-tracing accelerators next to BVHs in one path tracer, and a validator against POV-Ray and Mitsuba.
#[derive(Debug, Parser)]
#[command(name = "skipgrid", version, after_help = EXAMPLES, max_term_width = 110)]
struct Program {
    #[command(subcommand)]
    verb: Verb,

    /// Print errors only; data still go to standard output
    #[arg(long, short, global = true)]
    quiet: bool,
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

/// Runs the program on its command line and prints what goes wrong.
pub fn main() -> ExitCode {
    let program = match Program::try_parse() {
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
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Program::command().debug_assert();
    }
}
