//! What exact answers cost: the tables of `skipgrid papers exactness`, as lines of tab-separated columns.
//!
//! `cargo bench --bench exactness [-- SCENE..]`: scenes of triangles, files or made by formula.

mod arguments;

use arguments::arguments;
use skipgrid::papers::exactness::{Options, SCENES, run};
use std::process::ExitCode;

fn main() -> ExitCode {
    let (bench, mut scenes) = arguments();
    if scenes.is_empty() {
        scenes = if bench { SCENES.map(String::from).to_vec() } else { vec!["bumpy:n=8".into()] };
    }
    let (size, rounds, rays) = if bench { (192, 11, 10_000) } else { (8, 1, 20) };
    let report = match run(&Options { size, rounds, scenes, rays, peers: true }, &|_, _, _| {}) {
        Ok(report) => report,
        Err(error) => {
            eprintln!("{error}");
            return ExitCode::FAILURE;
        }
    };
    println!("{}; {}", report.title, report.machine);
    for table in &report.tables {
        println!("\n{}", table.title);
        println!("{}", table.columns.iter().map(|c| c.trim_start_matches('<')).collect::<Vec<_>>().join("\t"));
        for row in &table.rows {
            println!("{}", row.iter().map(|cell| cell.short()).collect::<Vec<_>>().join("\t"));
        }
    }
    for claim in &report.claims {
        println!("\n{}: {} ({})", claim.claim, claim.verdict.words(), claim.numbers);
    }
    if report.wrong == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
