//! A benchmark as bars.

use super::catalogue::Class;
use super::study::{KINDS, Study};
use crate::papers::plot::{Bars, Group, Plot};

/// Rays a second of every accelerator: means of each class, then each scene; one column for each kind of rays.
pub fn bars(study: &Study) -> Plot {
    let kinds: Vec<usize> = (0..KINDS.len()).filter(|&k| study.options.kinds.contains(&KINDS[k])).collect();
    let accels = study.accels();
    let means = study.means();
    let mut groups = Vec::new();
    let classes = Class::ALL.into_iter().chain([Class::Other]);
    for class in classes.filter(|class| study.of_class(*class).count() > 1) {
        let rows = means.iter().filter(|mean| mean.class == class).map(|mean| {
            let speeds = kinds.iter().map(|&k| mean.speed[k] / 1e6).collect();
            (mean.accel.clone(), series(&accels, &mean.accel), speeds)
        });
        let title = format!("geometric mean of {} scenes: {}", study.of_class(class).count(), class.title());
        groups.push(Group { title, rows: rows.collect() });
    }
    for scene in &study.scenes {
        let rows = scene.comparison.rows.iter().enumerate().map(|(row, of)| {
            let speeds = kinds.iter().map(|&k| scene.speed(row, KINDS[k]) / 1e6).collect();
            (of.accel.clone(), series(&accels, &of.accel), speeds)
        });
        let title = format!("{}, {} primitives", scene.name, scene.comparison.primitives);
        groups.push(Group { title, rows: rows.collect() });
    }
    Plot::Bars(Bars {
        title: "Million rays a second of processor time, one thread".to_string(),
        subtitle: format!(
            "{}; medians of {} interleaved rounds; longer is faster",
            study.machine, study.options.rounds
        ),
        columns: kinds.iter().map(|&k| format!("{} rays", KINDS[k].name())).collect(),
        groups,
    })
}

/// Accelerators of one name, whatever their options, have one colour.
fn series(accels: &[String], accel: &str) -> usize {
    let mut names: Vec<&str> = Vec::new();
    for accel in accels {
        let name = accel.split(':').next().unwrap_or(accel);
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names.iter().position(|name| Some(*name) == accel.split(':').next()).unwrap_or(0)
}
