//! `skipgrid run-under`: a program that nobody changed, with our accelerators in the place of Embree.

#[cfg(target_os = "linux")]
mod elf;
#[cfg(target_os = "linux")]
mod library;
#[cfg(target_os = "linux")]
mod links;
#[cfg(target_os = "linux")]
mod program;
#[cfg(target_os = "linux")]
mod report;
#[cfg(target_os = "linux")]
mod start;

use super::Outcome;
use super::console::Console;
use crate::error::{Error, Result};
use crate::registry::{self, ENTRIES, Needs};
use std::ffi::OsString;
use std::path::PathBuf;

const DETAILS: &str = "\
Linux's dynamic loader is told to take our library, which speaks Embree's interface, instead of Embree: by LD_LIBRARY_PATH, or \
by LD_PRELOAD where the program's files insist on a folder. Nothing is installed or changed, and other programs see nothing of it. \
The program must link Embree 3 or 4 as a shared library: Debian's Blender, Open3D and embree-tools do, and the Python packages \
mitsuba and embreex (trimesh); programs with Embree built in, such as the packages open3d and pyluxcore, are refused.

For Python, and scripts of Python, the files that link Embree are looked for among the installed packages. For scripts in other \
languages name such a file with --linked-by.

The program's exit code is passed on (128 and the number of the signal if one ended it), and its input and output are its own. At \
the end standard error says what was traced. Exit code 2: it does not link Embree, or the accelerator is not understood.

Examples:
  skipgrid run-under -- blender -b scene.blend -E CYCLES -o //frame -f 1
  skipgrid run-under --accel grid:density=4 -- python3 render_with_mitsuba.py
  skipgrid run-under --linked-by /usr/bin/blender -- ./blender-in-a-shell-script.sh";

/// Run another program with an accelerator of ours in the place of Embree
#[derive(Debug, clap::Args)]
#[command(after_help = DETAILS)]
pub struct Args {
    /// Accelerator, with options; see `skipgrid list`
    #[arg(long, value_name = "A", default_value = "nested", env = "SKIPGRID_ACCEL")]
    accel: String,

    /// The library that takes Embree's place, or the folder of libskipgrid_embree3.so and libskipgrid_embree4.so; default: beside
    /// this program, then ../lib/skipgrid from it
    #[arg(long, value_name = "FILE|FOLDER", env = "SKIPGRID_EMBREE_LIBRARY")]
    library: Option<PathBuf>,

    /// The program or library that links Embree, where it cannot be found from PROGRAM
    #[arg(long, value_name = "FILE")]
    linked_by: Option<PathBuf>,

    /// Where a line of JSON goes for each process that used Embree; lines are added
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,

    /// The program and its arguments
    #[arg(value_name = "PROGRAM", required = true, trailing_var_arg = true, allow_hyphen_values = true)]
    command: Vec<OsString>,
}

/// Runs the program.
pub fn run(args: &Args, console: &Console) -> Result<Outcome> {
    check_accel(&args.accel)?;
    run_here(args, console)
}

/// Builds over one triangle, so that a specification with a fault is refused before the program starts.
fn check_accel(spec: &str) -> Result<()> {
    let name = spec.split(':').next().unwrap_or(spec);
    if let Some(entry) = ENTRIES.iter().find(|entry| entry.name == name && entry.needs != Needs::Any) {
        let cause = "takes one kind of primitives alone, and a program's scenes may have any";
        return Err(Error::Spec { spec: spec.to_string(), cause: format!("{} {cause}", entry.name) });
    }
    registry::build(spec, vec![[glam::Vec3::ZERO, glam::Vec3::X, glam::Vec3::Y]]).map(|_| ())
}

#[cfg(not(target_os = "linux"))]
fn run_here(_: &Args, _: &Console) -> Result<Outcome> {
    Err(Error::invalid("run-under speaks to the dynamic loader of Linux, and this is another system"))
}

#[cfg(target_os = "linux")]
fn run_here(args: &Args, console: &Console) -> Result<Outcome> {
    use crate::cli::input::check_file;
    use std::os::unix::process::ExitStatusExt;

    let [name, rest @ ..] = args.command.as_slice() else { unreachable!("the command line requires a program") };
    if let Some(file) = &args.report {
        check_file(file)?;
    }
    let program = program::find(name)?;
    let links = find_links(args, &program)?;
    let (swaps, left) = library::choose(links, args.library.as_deref())?;
    swaps.iter().for_each(|swap| console.note(swap));
    left.iter().for_each(|left| console.warn(format!("left as it is: {left}")));

    let (status, text) = start::run(program.path.as_os_str(), rest, &args.accel, &swaps)?;
    if let Some(file) = &args.report {
        append(file, &report::lines(&text))?;
    }
    let report = report::Report::parse(&text);
    if report.unread > 0 {
        console.warn(format!("{} lines of the library's report are not understood", report.unread));
    }
    match (report.processes, status.signal()) {
        (0, Some(signal)) => {
            console.warn(format!("signal {signal} ended the program before it could report what was traced"))
        }
        (0, None) => {
            console.warn("the program ended without making an Embree device: nothing went through our library")
        }
        _ => console.note(report.text()),
    }
    if let Some(errors) = report.errors() {
        console.warn(errors);
    }
    // A program's exit code has eight bits; without one a signal ended it.
    let signalled = |signal: i32| 128 + (signal & 0x7f) as u8;
    Ok(Outcome::OfProgram(
        status.code().map_or_else(|| signalled(status.signal().unwrap_or(0)), |code| (code & 0xff) as u8),
    ))
}

/// The files that link Embree among those that the program loads.
#[cfg(target_os = "linux")]
fn find_links(args: &Args, program: &program::Program) -> Result<Vec<links::Link>> {
    let mut loader = links::Loader::new();
    let root = match &args.linked_by {
        Some(file) => file.canonicalize().map_err(|error| Error::io(file, error))?,
        None => program.binary.clone(),
    };
    let binary = elf::read(&root)?;
    let mut found = loader.links(&root, &[]);
    let python = program.python.as_ref().filter(|_| args.linked_by.is_none());
    if let Some(python) = python {
        let above = if binary.runpath.is_none() { binary.rpath } else { Vec::new() };
        for library in python.libraries() {
            found.extend(loader.links(&library, &above));
        }
    }
    if !found.is_empty() {
        return Ok(found);
    }
    let inside = loader.followed().find(|path| elf::contains_embree(path));
    let packages = if python.is_some() { ", nor does any library of the packages on its path" } else { "" };
    let cause = match inside {
        Some(file) => format!("Embree is built into {}, where nothing can take its place", file.display()),
        None if program.path.canonicalize().is_ok_and(|path| path != root) && python.is_none() => {
            format!(
                "neither {} nor what it loads links Embree as a shared library; if {} starts something that does, name its \
                     file with --linked-by",
                root.display(),
                program.path.display()
            )
        }
        None => format!("neither it nor what it loads links Embree as a shared library{packages}"),
    };
    Err(Error::malformed(if args.linked_by.is_some() { &root } else { &program.path }, cause))
}

/// Adds `text` to the end of `file`.
#[cfg(target_os = "linux")]
fn append(file: &std::path::Path, text: &str) -> Result<()> {
    use std::io::Write;
    let open = std::fs::OpenOptions::new().create(true).append(true).open(file);
    open.and_then(|mut file| file.write_all(text.as_bytes())).map_err(|error| Error::io(file, error))
}
