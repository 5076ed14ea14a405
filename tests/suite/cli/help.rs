//! Help, completions and manual pages.

use super::*;

#[test]
fn help_has_examples_for_every_verb() {
    let folder = folder("help");
    let top = skipgrid(&folder, &["--help"]);
    assert_eq!(top.code, Some(0));
    for part in
        ["Exit codes", "to begin with: ", "Pictures:\n  render ", "Accelerators measured:\n  compare ", "-q, --quiet"]
    {
        assert!(top.stdout.contains(part), "{part}: {}", top.stdout);
    }
    for verb in verbs(&top.stdout) {
        let help = skipgrid(&folder, &[verb, "--help"]);
        assert_eq!(help.code, Some(0), "{verb}");
        assert!(help.stdout.contains(&format!("skipgrid {verb}")), "{verb}: {}", help.stdout);
        assert!(help.stdout.contains("Example"), "{verb}: {}", help.stdout);
        assert!(help.stderr.is_empty(), "{verb}: {}", help.stderr);
    }
    let version = skipgrid(&folder, &["--version"]);
    assert_eq!((version.code, version.stdout.trim()), (Some(0), concat!("skipgrid ", env!("CARGO_PKG_VERSION"))));
}

#[test]
fn shells_and_man_get_every_verb() {
    let folder = folder("man");
    let help = skipgrid(&folder, &["--help"]).stdout;
    let verbs = verbs(&help);
    assert!(verbs.contains(&"render") && verbs.contains(&"man"), "{help}");
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = skipgrid(&folder, &["completions", shell]);
        assert_eq!(script.code, Some(0), "{shell}: {}", script.stderr);
        for word in verbs.iter().chain(&["memory-budget"]) {
            assert!(script.stdout.contains(word), "{shell} lacks {word}");
        }
    }
    assert_eq!(skipgrid(&folder, &["man", "--to", "."]).code, Some(0));
    let mut expected: Vec<String> = verbs.iter().map(|verb| format!("skipgrid-{verb}.1")).collect();
    expected.push("skipgrid.1".into());
    expected.sort();
    assert_eq!(files(&folder), expected);
    for (args, page) in [(&["man"][..], "skipgrid.1"), (&["man", "render"], "skipgrid-render.1")] {
        let text = skipgrid(&folder, args).stdout;
        assert!(text.contains(".TH skipgrid") && text.contains("Examples:"), "{text}");
        assert_eq!(fs::read_to_string(folder.join(page)).expect("the page is there"), text, "{page}");
    }
}

/// The verbs that the help of the program names, but for `help`.
fn verbs(help: &str) -> Vec<&str> {
    let groups = help.split("\nOptions:").next().unwrap_or_default();
    let verbs: Vec<&str> = groups.lines().filter_map(first_word).filter(|verb| *verb != "help").collect();
    assert!(verbs.len() > 15, "{help}");
    verbs
}

/// The first word of a line of help that starts with two spaces; `None` for those that carry on with what is above.
fn first_word(line: &str) -> Option<&str> {
    line.strip_prefix("  ").filter(|rest| !rest.starts_with(' '))?.split_whitespace().next()
}
