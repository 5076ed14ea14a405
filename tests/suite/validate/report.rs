//! The page and the numbers beside it, in a browser where one is installed.

use super::{folder, own_reference};
use skipgrid::picture::io::{self, Attributes};
use skipgrid::validate::{self, Environment, Options, Report};
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// What the program says and does.
fn program(folder: &Path, args: &[&str]) -> (Option<i32>, String) {
    let (code, _, stderr) = crate::ended(crate::program(folder).arg("validate").args(args));
    (code, stderr)
}

fn environment() -> Environment {
    Environment {
        program: "skipgrid <1>".into(),
        machine: "a machine".into(),
        command: "skipgrid validate 'a & b'".into(),
        threads: Some(3),
        replicates: 8,
        spp: 32,
    }
}

/// The part of the page with this heading's anchor.
fn part<'a>(page: &'a str, id: &str) -> &'a str {
    let start = page.find(&format!(" id=\"{id}\">")).unwrap_or_else(|| panic!("no part {id}"));
    page[start..].split("</section>").next().expect("at least one piece")
}

fn run(test: &str) -> (std::path::PathBuf, Report) {
    let manifest = own_reference(test);
    let options = Options { keep_pictures: true, count_steps: true, reseeds: 3, ..Options::default() };
    let report = validate::run(&manifest, &[], &["brute".to_string(), "grid".to_string()], &options).expect("it runs");
    (manifest, report)
}

#[test]
fn the_page_shows_all_that_was_found() {
    let (_, report) = run("page");
    let page = report.html(&environment());
    assert!(!page.contains("http"), "the page needs the network");
    // The two scales; ours, theirs, difference and map of both comparisons; the tests of both accelerators and the steps of the one
    // that has any. Equal pictures of the second accelerator are not repeated.
    assert_eq!(page.matches("data:image/png;base64,").count(), 2 + 8 + 3);
    assert_eq!(part(&page, "verdicts").matches("<tr><td>").count(), 4);
    assert_eq!(part(&page, "metrics").matches("brute, grid").count(), 2, "equal pictures share a row");
    assert_eq!(part(&page, "power").matches("<tr><td>").count(), 3);
    let speed = part(&page, "speed");
    assert_eq!(speed.matches("<td class=\"number\">1.00</td>").count() / 2, 1, "the first over itself, twice: {speed}");
    assert_eq!(speed.matches("<td class=\"number\">24 x 16</td>").count(), 4);
    for tier in report.entries.iter().flat_map(|e| &e.verdict.tiers) {
        let camera = 24 * 16 * tier.samples;
        assert!(tier.rays > camera && tier.rays < 20 * camera, "{} rays", tier.rays);
    }
    // Brute force steps nowhere and tests everything: two triangles and a sphere.
    let scene = part(&page, "scene-small");
    for entry in &report.entries {
        let steps = entry.steps.as_ref().expect("counted");
        let shown = if entry.accel == "brute" { "-".into() } else { format!("{:.2}", steps.steps) };
        let row = format!("<tr><td>{}</td><td class=\"number\">{shown}</td>", entry.accel);
        assert!(scene.contains(&row), "{row}");
        assert!(steps.steps <= f64::from(steps.most_steps) && steps.picture.pixels.len() == 24 * 16);
    }
    let [brute, grid] = [0, 1].map(|i| report.entries[i].steps.as_ref().expect("counted"));
    assert_eq!((brute.steps, brute.tests, brute.leaps), (0.0, 3.0, 0.0));
    assert_eq!(scene.matches("not counted or none: brute</p>").count(), 1);
    assert!(grid.steps > 0.0 && grid.tests > 0.0, "{} steps, {} tests", grid.steps, grid.tests);
    let about = part(&page, "environment");
    for words in ["skipgrid &lt;1&gt;", "a machine", "'a &amp; b'", "<dd>3</dd>", "8 renders of 32 samples"] {
        assert!(about.contains(words), "{words}");
    }
    assert!(page.contains("none &lt;&amp;&gt;"), "the command of the reference");
}

#[test]
fn a_failure_is_shown_with_its_reason() {
    let (manifest, _) = run("page_failed");
    let image = manifest.with_file_name("pov.exr");
    let mut tampered = io::read(&image).expect("read");
    tampered.pixels[40][1] += 1e-6;
    io::write(&image, &tampered, &Attributes::default()).expect("written");
    let options = Options { keep_pictures: true, count_steps: true, ..Options::default() };
    let report = validate::run(&manifest, &[], &["brute".to_string()], &options).expect("it runs");
    let page = report.html(&environment());
    assert!(page.contains("<h1>Validation <span class=\"fail\">FAILED</span></h1>"));
    assert!(page.contains("</a> <b class=\"fail\">FAILED</b></li>"), "the contents say so too");
    let scene = part(&page, "scene-small");
    assert!(scene.contains("the stored pixels were changed"), "{scene}");
    // The other comparison of the scene still has its pictures, and the rays of the one that failed are not made up.
    assert_eq!(scene.matches("class=\"pane compare\"").count(), 1);
    assert!(part(&page, "speed").contains("<td class=\"number\">0 x 0</td>"));
}

#[test]
fn the_program_writes_the_page_and_its_numbers() {
    let folder = folder("report_program-pages");
    let manifest = own_reference("report_program");
    let accels = ["--accel", "brute", "--accel", "grid", "--spp", "4", "--replicates", "4"];
    let reference = ["--reference", manifest.parent().expect("a folder").to_str().expect("text")];
    let (code, stderr) = program(&folder, &[&reference[..], &accels, &["--report", "a page.html"]].concat());
    assert!(code == Some(0) && stderr.contains("a page.json"), "{code:?} {stderr}");
    let page = fs::read_to_string(folder.join("a page.html")).expect("a page");
    assert!(part(&page, "environment").contains("--report 'a page.html'"));
    let data = fs::read(folder.join("a page.json")).expect("numbers");
    let value: serde_json::Value = serde_json::from_slice(&data).expect("JSON");
    assert_eq!((&value["passed"], &value["environment"]["spp"]), (&true.into(), &4.into()));
    assert!(value["summary"][0].as_str().expect("text").starts_with("4 of 4 comparisons passed"));
    let entry = &value["report"]["entries"][1];
    assert_eq!(entry["accel"], "grid");
    assert!(entry["steps"]["steps"].as_f64().expect("a number") > 0.0 && entry["steps"]["picture"].is_null());
    let tier = &entry["verdict"]["tiers"][1];
    assert_eq!((&tier["samples"], &tier["pictures"]), (&16.into(), &serde_json::Value::Null));
    assert!(tier["rays"].as_u64().expect("a count") > 16 * 24 * 16);
    let (code, stderr) = program(&folder, &["--report", "page.json"]);
    assert!(code == Some(2) && stderr.contains("page.json") && stderr.contains("report.html"), "{code:?} {stderr}");
}

/// What the browser makes of the page at `address`, or `None` if there is no browser.
fn browse(folder: &Path, address: &str, window: &str) -> Option<Output> {
    let profile = folder.join("profile");
    let options =
        ["--headless", "--no-sandbox", "--disable-gpu", "--enable-logging=stderr", "--timeout=60000", "--dump-dom"];
    ["chromium", "chromium-browser", "google-chrome"].iter().find_map(|name| {
        Command::new(name)
            .args(options)
            .args([format!("--user-data-dir={}", profile.display()), format!("--window-size={window}"), address.into()])
            .output()
            .ok()
    })
}

#[test]
fn the_controls_do_what_they_say_in_a_browser() {
    let folder = folder("report_browser");
    let (_, report) = run("report_browser");
    let file = folder.join("report.html");
    fs::write(&file, report.html(&environment())).expect("written");
    let address = format!("file://{}#selftest", file.display()).replace(' ', "%20");
    for window in ["1280,900", "600,800"] {
        let Some(output) = browse(&folder, &address, window) else {
            eprintln!("skipped: no chromium is installed");
            return;
        };
        let [page, log] = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
        assert!(!log.contains("CONSOLE"), "the page complains: {log}");
        let findings = part(&page, "findings").split("</pre>").next().expect("at least one piece");
        assert!(!findings.contains("FAILED") && findings.contains(" checks, 0 failed"), "at {window}: {findings}");
        // Two comparisons with eleven checks each, and those of zoom, labels and links.
        assert!(findings.matches("ok: ").count() > 60, "at {window}: {findings}");
    }
}
