//! Every command line of this program that a document or a help text shows is one that the program understands.

use super::{Program, command as program};
use crate::registry;
use clap::{Command, FromArgMatches};
use std::fs;
use std::path::{Path, PathBuf};

/// A command line of a document, from the verb on.
struct Shown {
    words: Vec<String>,
    /// It stands in a block, to be copied; within a sentence it may leave arguments out.
    whole: bool,
}

/// The Markdown files of a folder and of those below it.
fn documents(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    let below = paths.iter().filter(|path| path.is_dir()).flat_map(|path| documents(path));
    below.chain(paths.iter().filter(|path| path.extension().is_some_and(|e| e == "md")).cloned()).collect()
}

/// The command lines in a text in Markdown.
fn shown(text: &str) -> Vec<Shown> {
    let (mut fenced, mut block, mut prose, mut found) = (false, String::new(), String::new(), Vec::new());
    for line in text.lines() {
        if line.starts_with("```") {
            fenced = !fenced;
        } else if fenced || line.starts_with("    ") {
            block.push_str(line.trim());
            if block.ends_with('\\') {
                block.pop();
                continue;
            }
            found.extend(called(&block, true));
            block.clear();
        } else {
            prose.push_str(line);
            prose.push(' ');
        }
    }
    found.extend(prose.split('`').skip(1).step_by(2).filter_map(|code| called(code, false)));
    found
}

/// What `line` gives this program, if it calls it: up to a comment, a pipe or a redirection.
fn called(line: &str, whole: bool) -> Option<Shown> {
    let rest = line.strip_prefix("skipgrid ").or_else(|| line.strip_prefix("cargo run --release -- "))?;
    // A text that goes over several lines, or a dependency in TOML.
    let words = shlex::split(rest).filter(|words| words.first().is_some_and(|word| word != "="))?;
    let end = words.iter().position(|word| ["|", ">", "||", "&&"].contains(&word.as_str()));
    Some(Shown { words: words[..end.unwrap_or(words.len())].to_vec(), whole })
}

/// What is wrong with a command line.
fn fault(shown: &Shown) -> Option<String> {
    let program = program();
    let verb = shown.words.first()?;
    if verb == "help" {
        return None;
    }
    let Some(verb) = program.find_subcommand(verb) else { return Some(format!("there is no verb `{verb}`")) };
    let own = shown.words.split(|word| word == "--").next().unwrap_or_default();
    for option in own.iter().filter_map(|word| word.strip_prefix("--")) {
        let parts = [&program, verb].into_iter().chain(verb.get_subcommands());
        if !parts.flat_map(|part| part.get_arguments()).any(|known| known.get_long() == Some(option)) {
            return Some(format!("`{}` has no option --{option}", verb.get_name()));
        }
    }
    for pair in own.windows(2).filter(|pair| pair[0] == "--accel") {
        // One capital letter stands for any name, a pattern for several; voxels cannot be built over triangles, peers perhaps not on
        // this machine.
        let name = pair[1].split(':').next().unwrap_or_default();
        let known = registry::ENTRIES.iter().find(|entry| entry.name == name);
        let tried = known.is_none_or(|entry| entry.exact && entry.needs != registry::Needs::SolidVoxels);
        let many = name == "A" || name == "all" || name.contains('*');
        if !many
            && tried
            && let Err(error) = registry::build(&pair[1], Vec::<[glam::Vec3; 3]>::new())
        {
            return Some(error.to_string());
        }
    }
    if shown.whole {
        use clap::error::ErrorKind::{DisplayHelp, DisplayVersion};
        let line = std::iter::once("skipgrid").chain(shown.words.iter().map(String::as_str));
        let parsed = program.try_get_matches_from(line).and_then(|matches| Program::from_arg_matches(&matches));
        return parsed.err().filter(|e| !matches!(e.kind(), DisplayHelp | DisplayVersion)).map(|e| e.to_string());
    }
    None
}

#[test]
fn faults_are_found() {
    let text = "`skipgrid rendr`, `skipgrid render`, `skipgrid bench --ray 3`\n```sh\nskipgrid render room.glb --spp  # so\n\
                skipgrid compare a.glb \\\n  --accel gird > b\n```\n";
    let faults: Vec<bool> = shown(text).iter().map(|shown| fault(shown).is_some()).collect();
    assert_eq!(faults, [true, true, true, false, true]);
}

#[test]
fn commands_in_documents_are_understood() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut paths = vec![root.join("README.md"), root.join("ARCHITECTURE.md")];
    paths.extend(["docs", "adapters", "reference"].iter().flat_map(|folder| documents(&root.join(folder))));
    let (mut seen, mut faults) = (0, Vec::new());
    for path in paths {
        for shown in shown(&fs::read_to_string(&path).expect("a document")) {
            seen += 1;
            faults.extend(
                fault(&shown).map(|why| format!("{}: skipgrid {}: {why}", path.display(), shown.words.join(" "))),
            );
        }
    }
    assert!(seen > 100, "the search finds next to nothing: {seen}");
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// The examples at the end of a help text; three spaces set off what is said about one.
fn examples(help: &str) -> Vec<Shown> {
    let (_, examples) = help.split_once("Examples").unwrap_or_default();
    let lines = examples.lines().map(|line| line.trim_start().split("   ").next().unwrap_or_default());
    lines.filter_map(|line| called(line, true)).collect()
}

#[test]
fn every_verb_has_two_examples_that_are_understood() {
    fn walk(verb: &Command, path: &[&str]) {
        let help = verb.get_after_help().map(ToString::to_string).unwrap_or_default();
        let examples = examples(&help);
        assert!(examples.len() >= 2, "{path:?} has {} examples", examples.len());
        assert!(examples.iter().any(|shown| shown.words.iter().zip(path).all(|(a, b)| a == b)), "{path:?}");
        for shown in &examples {
            assert_eq!(fault(shown), None, "{path:?}: {:?}", shown.words);
        }
        for below in verb.get_subcommands().filter(|below| below.get_name() != "help") {
            walk(below, &[path, &[below.get_name()]].concat());
        }
    }
    walk(&program(), &[]);
}
