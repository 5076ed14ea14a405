//! Balls: the sphereflake, mirrors in SPD, on a wide floor.

use super::super::flakes;
use super::setting::{Setting, surface};
use super::{Body, Entry, Options, Stage};
use crate::error::Result;

pub(in super::super) const ENTRY: Entry = Entry {
    name: "spd-balls",
    summary: "SPD balls: 7381 spheres, nine smaller ones around each, and a floor; z up",
    options: "n: size factor, levels below the first sphere (4)",
    slots: "level l of the recursion has slot l",
    source: "Haines 1987, SPD 3.14 balls",
    keys: &["n"],
    body,
    stage,
};

fn body(options: &Options) -> Result<Body> {
    let n = options.n(4, 1..=18)?;
    options.limit_size((9_u64.pow(n + 1) - 1) / 8)?;
    Ok(Body { spheres: flakes::spheres(n), ..Body::default() })
}

fn stage(_: &Options) -> Stage {
    let setting = Setting {
        from: [2.1, 1.3, 1.7],
        lights: &[[4.0, 3.0, 2.0], [1.0, -4.0, 4.0], [-3.0, 1.0, 5.0]],
        ..Setting::USUAL
    };
    let floor = (flakes::floor(), surface("floor", [1.0, 0.75, 0.33], 0.8, 0.0));
    setting.stage(vec![surface("ball", [1.0, 0.9, 0.7], 0.5, 0.5)], vec![floor])
}
