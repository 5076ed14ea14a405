//! A sweep as text, CSV and JSON.

use crate::cli::document::measured;
use crate::cli::table::{Table, exact, short};
use crate::measure::{Axis, Rate, Setting, Sweep};
use serde_json::{Value, json};

/// Tables for people: every setting, then the best ones.
pub(super) fn text(sweep: &Sweep, scene: &str, rounds: u32) -> String {
    let mut out = format!(
        "skipgrid {}: sweep, {scene}, {} primitives\n{}; traced on one thread\n{rounds} rounds:",
        env!("CARGO_PKG_VERSION"),
        sweep.primitives,
        sweep.machine
    );
    let kinds: Vec<String> = sweep.kinds.iter().map(|k| format!(" {} {} rays", k.rays, k.kind.name())).collect();
    let names: Vec<&str> = sweep.kinds.iter().map(|k| k.kind.name()).collect();
    let names = names.join(" / ");
    out += &format!(
        "{}\n\nNanoseconds a ray, half the range of the rounds in %, steps and tests a ray, speed over the accelerator as it was asked\n\
         for: each as {names}\n\n",
        kinds.join(",")
    );
    let mut table =
        Table::new(&["<accelerator", "<option", "build ms", "bytes", "ns", "spread", "steps", "tests", "over default"]);
    for setting in &sweep.settings {
        let option = setting.axis.map_or("-".to_string(), |axis| format!("{}={}", axis.name(), setting.value));
        let each = |value: &dyn Fn(&Rate) -> f64| {
            let cells =
                setting.rates.iter().map(|rate| rate.as_ref().map_or("-".to_string(), |rate| short(value(rate))));
            cells.collect::<Vec<_>>().join("/")
        };
        table.row(vec![
            sweep.accels[setting.accel].clone(),
            option,
            short(setting.build.milliseconds),
            setting.build.memory.total().to_string(),
            each(&|rate| 1e9 / rate.rays_per_second),
            each(&|rate| 100.0 * rate.spread),
            each(&|rate| rate.counts.steps as f64 / rate.counts.rays as f64),
            each(&|rate| rate.counts.tests as f64 / rate.counts.rays as f64),
            setting.gains.iter().map(|g| short(*g)).collect::<Vec<_>>().join("/"),
        ]);
    }
    out += &table.text();
    out += &best(sweep);
    out += &if sweep.identical() {
        format!("\nidentical hits: all {} settings that promise exact answers agree to the bit\n", sweep.settings.len())
    } else {
        format!("\nDIFFERENT HITS: {} answers\n", sweep.differing)
    };
    if sweep.interrupted {
        out += "interrupted: settings are missing\n";
    }
    out
}

/// The best setting of each accelerator and of all, for each kind of rays.
fn best(sweep: &Sweep) -> String {
    let mut table = Table::new(&["<rays", "<accelerator", "<best setting", "over default", "spread %", "<"]);
    for (k, kind) in sweep.kinds.iter().enumerate() {
        for best in sweep.finals.iter().filter(|f| f.kind == k) {
            let words = if best.is_clear() { "" } else { "no more than the spread" };
            let mut cells = vec![kind.kind.name().to_string(), sweep.accels[best.setting.accel].clone()];
            cells.extend([name(&best.setting), short(best.gain()), format!("{:.1}", 100.0 * best.spread())]);
            cells.push(words.to_string());
            table.row(cells);
        }
    }
    let mut out = format!(
        "\nThe best settings, timed once more, as the greatest of many rates is flattered\n\n{}\n",
        table.text()
    );
    for (k, kind) in sweep.kinds.iter().enumerate() {
        let Some(fastest) = sweep.fastest(k) else { continue };
        let (first, ratio) = (&sweep.accels[0], short(fastest.setting.ratios[k]));
        out += &format!(
            "{} rays: fastest of all is `{}`, {ratio} times the speed of `{first}`\n",
            kind.kind.name(),
            fastest.setting.spec
        );
    }
    out
}

fn name(setting: &Setting) -> String {
    setting.axis.map_or("the default".to_string(), |axis| format!("{}={}", axis.name(), setting.value))
}

/// One line for each setting and kind of rays, all digits.
pub(super) fn csv(sweep: &Sweep, scene: &str) -> String {
    let mut table = Table::new(&[
        "<scene",
        "<accelerator",
        "<option",
        "<value",
        "<specification",
        "<rays",
        "build_ms",
        "build_cpu_ms",
        "bytes",
        "ns_per_ray",
        "spread",
        "steps_per_ray",
        "leaps_per_ray",
        "tests_per_ray",
        "over_default",
        "over_default_spread",
        "over_first",
    ]);
    for setting in &sweep.settings {
        for (k, kind) in sweep.kinds.iter().enumerate() {
            let build = &setting.build;
            let mut cells = vec![scene.to_string(), sweep.accels[setting.accel].clone()];
            cells.extend([
                setting.axis.map_or("", Axis::name).to_string(),
                setting.value.clone(),
                setting.spec.clone(),
            ]);
            cells.extend([kind.kind.name().to_string(), exact(build.milliseconds), exact(build.cpu_milliseconds)]);
            cells.push(build.memory.total().to_string());
            match setting.rates[k] {
                Some(rate) => {
                    let ray = |n: u64| exact(n as f64 / rate.counts.rays as f64);
                    cells.extend([exact(1e9 / rate.rays_per_second), exact(rate.spread)]);
                    cells.extend([ray(rate.counts.steps), ray(rate.counts.leaps), ray(rate.counts.tests)]);
                }
                None => cells.extend(std::iter::repeat_n(String::new(), 5)),
            }
            cells.extend([setting.gains[k], setting.spreads[k], setting.ratios[k]].map(exact));
            table.row(cells);
        }
    }
    table.csv()
}

/// Everything.
pub(super) fn json(sweep: &Sweep, scene: &str, rounds: u32) -> Value {
    let settings: Vec<Value> = sweep.settings.iter().map(|s| of_setting(sweep, s)).collect();
    let best: Vec<Value> = sweep
        .finals
        .iter()
        .map(|best| {
            json!({
                "rays": sweep.kinds[best.kind].kind.name(),
                "accelerator": sweep.accels[best.setting.accel],
                "specification": best.setting.spec,
                "over_default": best.gain(),
                "spread": best.spread(),
                "over_first": best.setting.ratios[best.kind],
                "clear": best.is_clear(),
            })
        })
        .collect();
    let kinds: Vec<Value> =
        sweep.kinds.iter().map(|k| json!({ "rays": k.kind.name(), "count": k.rays, "hits": k.hits })).collect();
    let body = json!({
        "scene": scene,
        "primitives": sweep.primitives,
        "machine": sweep.machine.to_string(),
        "rounds": rounds,
        "kinds": kinds,
        "accelerators": sweep.accels,
        "settings": settings,
        "best": best,
        "left_out": sweep.left_out,
        "identical": sweep.identical(),
        "differing": sweep.differing,
        "interrupted": sweep.interrupted,
    });
    measured("skipgrid.sweep/1", &sweep.machine, body)
}

fn of_setting(sweep: &Sweep, setting: &Setting) -> Value {
    let rates: Vec<Value> = sweep
        .kinds
        .iter()
        .enumerate()
        .filter_map(|(k, kind)| {
            let rate = setting.rates[k]?;
            Some(json!({
                "rays": kind.kind.name(),
                "ns_per_ray": 1e9 / rate.rays_per_second,
                "spread": rate.spread,
                "steps": rate.counts.steps,
                "leaps": rate.counts.leaps,
                "tests": rate.counts.tests,
                "over_default": setting.gains[k],
                "over_default_spread": setting.spreads[k],
                "over_first": setting.ratios[k],
            }))
        })
        .collect();
    json!({
        "accelerator": sweep.accels[setting.accel],
        "option": setting.axis.map(Axis::name),
        "value": setting.value,
        "specification": setting.spec,
        "build_ms": setting.build.milliseconds,
        "build_cpu_ms": setting.build.cpu_milliseconds,
        "bytes": setting.build.memory.total(),
        "rates": rates,
    })
}
