//! Nodes and leaves of rays through complete trees, and how long the walks take.

use crate::bsp::{Form, Met, Regular};
use crate::measure::rounds::in_turns;
use crate::papers::report::{Cell, Table};
use crate::random::Random;
use crate::ray::Ray;
use glam::DVec3;
use std::hint::black_box;

/// One tree under all walks.
pub(super) struct Level {
    pub n: u32,
    /// In the order of [`Form::ALL`].
    walks: Vec<Walked>,
}

/// What the rays through a tree cost one walk.
#[derive(Clone, Copy)]
pub(super) struct Walked {
    /// Leaves a ray, mean and most.
    pub leaves: f64,
    pub most_leaves: u64,
    /// Nodes a ray.
    pub nodes: f64,
    /// Nodes over leaves, mean over the rays and most.
    pub nodes_per_leaf: f64,
    pub most: f64,
    pub nanoseconds: f64,
    /// Half the distance between the fastest and the slowest round, as a share of the median.
    spread: f64,
}

impl Level {
    pub fn of(&self, form: Form) -> &Walked {
        let at = Form::ALL.iter().position(|(_, f)| *f == form);
        &self.walks[at.unwrap_or_else(|| unreachable!("every form is among all"))]
    }
}

/// One ray under one walk.
pub(super) struct Case {
    pub best: bool,
    pub n: u32,
    pub form: Form,
    pub leaves: u64,
    pub nodes: u64,
}

/// Nodes and leaves of one ray; `all`: beyond its first leaf too.
fn count(tree: &Regular, ray: &Ray, form: Form, all: bool) -> (u64, u64) {
    let (mut nodes, mut leaves) = (0, 0);
    tree.walk(ray, form, &mut |met| {
        match met {
            Met::Node => nodes += 1,
            Met::Leaf(_) => leaves += 1,
        }
        all
    });
    (nodes, leaves)
}

/// From a uniform point of a random face of the unit cube to one of the opposite face, begun as far before it again.
fn through(random: &mut Random) -> Ray {
    let axis = random.below(3);
    let mut point = |side: f64| {
        let mut p = DVec3::new(random.unit(), random.unit(), random.unit());
        p[axis] = side;
        p
    };
    let (from, to) = (point(0.0), point(1.0));
    let (from, to) = if random.below(2) == 0 { (from, to) } else { (to, from) };
    Ray::new((from - (to - from)).as_vec3(), (to - from).as_vec3())
}

/// Nearly along a diagonal of the cube: through about three leaves for each on an axis.
fn corner_to_corner(random: &mut Random) -> Ray {
    let mut near = || 1e-3 * DVec3::new(random.unit(), random.unit(), random.unit());
    let (from, to) = (near(), DVec3::ONE - near());
    Ray::new((from - (to - from)).as_vec3(), (to - from).as_vec3())
}

/// Measures all walks on one tree.
pub(super) fn level(tree: &Regular, n: u32, rays: u32, rounds: u32) -> Level {
    let mut random = Random::new(u64::from(n));
    let rays: Vec<Ray> = (0..rays).map(|_| through(&mut random)).collect();
    let paces = in_turns(Form::ALL.len(), rounds, |i| {
        let sum = rays.iter().map(|ray| count(tree, ray, Form::ALL[i].1, true).0).sum::<u64>();
        black_box(sum);
    });
    let walks = Form::ALL.iter().zip(paces).map(|((_, form), pace)| {
        let counted: Vec<(u64, u64)> = rays.iter().map(|ray| count(tree, ray, *form, true)).collect();
        // A ray through the cube meets a leaf; rounding its corners to f32 may lead one past it.
        let counted: Vec<(u64, u64)> = counted.into_iter().filter(|(_, leaves)| *leaves > 0).collect();
        let mean = |of: &dyn Fn(&(u64, u64)) -> f64| counted.iter().map(of).sum::<f64>() / counted.len() as f64;
        let ratio = |&(nodes, leaves): &(u64, u64)| nodes as f64 / leaves as f64;
        Walked {
            leaves: mean(&|c| c.1 as f64),
            most_leaves: counted.iter().map(|c| c.1).max().unwrap_or(0),
            nodes: mean(&|c| c.0 as f64),
            nodes_per_leaf: mean(&ratio),
            most: counted.iter().map(ratio).fold(0.0, f64::max),
            nanoseconds: 1e9 / pace.per_second / rays.len() as f64,
            spread: pace.spread,
        }
    });
    Level { n, walks: walks.collect() }
}

/// Best and worst case of all walks on one tree.
pub(super) fn cases(tree: &Regular, n: u32, rays: u32) -> Vec<Case> {
    let mut random = Random::new(u64::from(n) + 1);
    let rays: Vec<Ray> = (0..rays).map(|_| corner_to_corner(&mut random)).collect();
    let leaves = |ray: &&Ray| count(tree, ray, Form::Interval, true).1;
    let Some(longest) = rays.iter().max_by_key(leaves) else { return Vec::new() };
    let case = |best: bool, form: Form| {
        let (nodes, leaves) = count(tree, longest, form, !best);
        Case { best, n, form, leaves, nodes }
    };
    [true, false].into_iter().flat_map(|best| Form::ALL.map(|(_, form)| case(best, form))).collect()
}

fn name(form: Form) -> &'static str {
    Form::ALL.iter().find(|(_, f)| *f == form).map_or("", |(name, _)| name)
}

pub(super) fn table(levels: &[Level]) -> Table {
    let mut table = Table::new(
        "regular",
        "Complete trees of N^3 leaves: nodes and leaves of random rays through opposite faces, and the time of the walks",
        &[
            "N",
            "<walk",
            "leaves/ray",
            "most leaves/N",
            "nodes/ray",
            "nodes/leaf",
            "nodes/leaf most",
            "nodes to interval",
            "ns/ray",
            "spread %",
            "ns to interval",
        ],
    );
    for level in levels {
        let base = level.of(Form::Interval);
        for (name, form) in Form::ALL {
            let w = level.of(form);
            let cells: [Cell; 11] = [
                level.n.into(),
                name.into(),
                w.leaves.into(),
                (w.most_leaves as f64 / f64::from(level.n)).into(),
                w.nodes.into(),
                w.nodes_per_leaf.into(),
                w.most.into(),
                (w.nodes / base.nodes).into(),
                w.nanoseconds.into(),
                (100.0 * w.spread).into(),
                (w.nanoseconds / base.nanoseconds).into(),
            ];
            table.row(cells);
        }
    }
    table
}

pub(super) fn case_table(cases: &[Case]) -> Table {
    let mut table = Table::new(
        "cases",
        "The note's table of cases: partitioning is O(log N) at best and O(N) at worst, re-traversal O(log N) and O(N log N)",
        &["<case", "N", "<walk", "leaves", "nodes", "nodes/log2 N", "nodes/N", "nodes/(N log2 N)"],
    );
    for best in [true, false] {
        for case in cases.iter().filter(|case| case.best == best) {
            let (n, nodes) = (f64::from(case.n), case.nodes as f64);
            let cells: [Cell; 8] = [
                if best { "best" } else { "worst" }.into(),
                case.n.into(),
                name(case.form).into(),
                case.leaves.into(),
                case.nodes.into(),
                (nodes / n.log2()).into(),
                (nodes / n).into(),
                (nodes / (n * n.log2())).into(),
            ];
            table.row(cells);
        }
    }
    table
}
