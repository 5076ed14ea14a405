//! Compares several accelerators on the same rays: are the answers equal, what do they cost?

use super::comparison::{Build, Comparison, Deviations, Difference, Kind, Rate, Row};
use super::machine::Machine;
use super::rays::{Query, RayKind, RayOptions, RaySet, ray_sets};
use super::rounds::{in_turns_alone, same, timed_build};
use crate::accel::{Accel, Counts, Hit};
use crate::error::{Error, Result};
use crate::ray::Ray;
use crate::registry::promises_exact;
use crate::scene::Scene;
use std::hint::black_box;

/// How to compare.
#[derive(Clone, Debug, PartialEq)]
pub struct Rounds {
    /// Timed rounds, at least 1. In each, every accelerator traces every set once, in turns.
    pub rounds: u32,
    /// Which rays, if [`Rounds::given`] has none.
    pub rays: RayOptions,
    /// These rays, asked for their closest hit, instead of camera, shadow and diffuse ones.
    pub given: Option<Vec<Ray>>,
}

impl Default for Rounds {
    fn default() -> Self {
        Self { rounds: 5, rays: RayOptions::default(), given: None }
    }
}

/// An accelerator that is ready to be compared.
pub struct Built {
    /// Specification, its name in reports.
    pub spec: String,
    /// Whether it promises exact answers; see [`promises_exact`].
    pub exact: bool,
    /// Cost of building.
    pub build: Build,
    /// The accelerator.
    pub accel: Box<dyn Accel>,
}

impl Built {
    /// Builds by `make` and takes the time: once, and twice more if that is quick.
    ///
    /// # Errors
    /// As `make`.
    pub fn new(spec: &str, exact: bool, make: impl Fn() -> Result<Box<dyn Accel>>) -> Result<Self> {
        let (accel, time) = timed_build(make)?;
        let build = Build { milliseconds: time.wall, cpu_milliseconds: time.cpu, memory: accel.memory() };
        Ok(Self { spec: spec.to_string(), exact, build, accel })
    }
}

/// Compares the accelerators that `specs` name on rays of `scene`; the first one that promises exact answers is the
/// measure of the others.
///
/// # Errors
/// No accelerator or no round is asked for; one cannot be built; the film has no pixels; the rays do not fit into memory.
///
/// ```
/// use skipgrid::measure::{RayOptions, Rounds, compare};
/// use skipgrid::scene::{LoadOptions, load};
///
/// let scene = load("random:n=200", &LoadOptions::default())?;
/// let rounds = Rounds { rounds: 1, rays: RayOptions { width: 16, height: 16, ..RayOptions::default() }, given: None };
/// let comparison = compare(&scene, &["brute", "grid"], &rounds)?;
/// assert!(comparison.identical());
/// // Camera rays come first: 256 rays, 200 tests each without a grid.
/// let tests = |row: usize| comparison.rows[row].rates[0].map(|rate| rate.counts.tests);
/// assert_eq!(tests(0), Some(256 * 200));
/// assert!(tests(1) < tests(0));
/// # Ok::<(), skipgrid::Error>(())
/// ```
pub fn compare<S: AsRef<str>>(scene: &Scene, specs: &[S], rounds: &Rounds) -> Result<Comparison> {
    compare_with(scene, specs, rounds, &|_| {})
}

/// As [`compare`]; calls `progress` with a few words before each stage.
///
/// # Errors
/// As [`compare`].
pub fn compare_with<S: AsRef<str>>(
    scene: &Scene,
    specs: &[S],
    rounds: &Rounds,
    progress: &dyn Fn(&str),
) -> Result<Comparison> {
    if specs.is_empty() || rounds.rounds == 0 {
        return Err(Error::invalid(format!(
            "nothing to compare: {} accelerators, {} rounds",
            specs.len(),
            rounds.rounds
        )));
    }
    let mut built = Vec::with_capacity(specs.len());
    for spec in specs {
        let spec = spec.as_ref();
        progress(&format!("building {spec}"));
        built.push(Built::new(spec, promises_exact(spec), || scene.accel(spec))?);
    }
    let sets = match &rounds.given {
        Some(rays) => vec![RaySet { kind: RayKind::Given, query: Query::Closest, rays: rays.clone() }],
        None => ray_sets(scene, &built[truth_of(&built)].accel, &rounds.rays)?,
    };
    contest(scene, &built, &sets, rounds.rounds, progress)
}

/// The accelerator whose answers the others are held against: the first that promises exact ones, else the first.
fn truth_of(built: &[Built]) -> usize {
    built.iter().position(|b| b.exact).unwrap_or(0)
}

/// Compares accelerators that are built over `scene` on `sets`; see [`compare_with`].
///
/// # Errors
/// There is no accelerator or no round.
pub fn contest(
    scene: &Scene,
    built: &[Built],
    sets: &[RaySet],
    rounds: u32,
    progress: &dyn Fn(&str),
) -> Result<Comparison> {
    if built.is_empty() || rounds == 0 {
        return Err(Error::invalid(format!("nothing to compare: {} accelerators, {rounds} rounds", built.len())));
    }
    let row = |b: &Built| Row {
        accel: b.spec.clone(),
        described: String::new(),
        build: b.build,
        rates: Vec::new(),
        exact: b.exact,
        deviations: Deviations::default(),
    };
    let mut rows: Vec<Row> = built.iter().map(row).collect();
    let accels: Vec<&dyn Accel> = built.iter().map(|b| &*b.accel).collect();
    let truth = truth_of(built);
    let mut check = Check::default();
    let mut kinds = Vec::with_capacity(sets.len());
    for set in sets {
        let name = set.kind.name();
        progress(&format!("checking {name} rays"));
        let hits: Vec<Option<Hit>> = set.rays.iter().map(|ray| accels[truth].closest_hit(ray)).collect();
        let first = &built[truth].spec;
        kinds.push(Kind {
            kind: set.kind,
            query: set.query,
            rays: set.rays.len() as u64,
            hits: hits.iter().flatten().count() as u64,
        });
        let checked = |(accel, row): (&&dyn Accel, &mut Row)| {
            let before = row.deviations.total();
            let counts = check.answers(set, &hits, first, *accel, row);
            (counts, row.deviations.total() - before)
        };
        let work: Vec<(Counts, u64)> = accels.iter().zip(&mut rows).map(checked).collect();
        progress(&format!("timing {name} rays"));
        let rates = time(set, &accels, rounds);
        for ((row, rate), (counts, differing)) in rows.iter_mut().zip(rates).zip(work) {
            row.rates.push(rate.map(|(rays_per_second, spread)| Rate { rays_per_second, spread, counts, differing }));
        }
    }
    rows.iter_mut().zip(&accels).for_each(|(row, accel)| row.described = accel.describe());
    Ok(Comparison {
        scene: scene.name.clone(),
        primitives: scene.primitive_count(),
        rounds,
        machine: Machine::this(),
        kinds,
        rows,
        differing: check.differing,
        difference: check.first,
        truth,
    })
}

/// Answers that differ though they promise to be exact.
#[derive(Default)]
struct Check {
    differing: u64,
    first: Option<Difference>,
}

impl Check {
    /// Asks every question about every ray of `set`, whose answers by `first` are `truth`, and counts deviations in `row`;
    /// returns the work of the set's own question.
    fn answers(
        &mut self,
        set: &RaySet,
        truth: &[Option<Hit>],
        first: &str,
        accel: &dyn Accel,
        row: &mut Row,
    ) -> Counts {
        let mut counts = Counts::default();
        for (index, (ray, &truth)) in set.rays.iter().zip(truth).enumerate() {
            let mut wrong = None;
            let hit = accel.closest_hit(ray);
            if !same(truth, hit) {
                wrong = Some(("closest hit", Ok(hit)));
            }
            let any = accel.any_hit(ray);
            if any != truth.is_some() {
                wrong = wrong.or(Some(("any hit", Err(any))));
            }
            match set.query {
                Query::Closest => {
                    let hit = accel.closest_hit_counted(ray, &mut counts);
                    if !same(truth, hit) {
                        wrong = wrong.or(Some(("counted closest hit", Ok(hit))));
                    }
                }
                Query::Any => {
                    let any = accel.any_hit_counted(ray, &mut counts);
                    if any != truth.is_some() {
                        wrong = wrong.or(Some(("counted any hit", Err(any))));
                    }
                }
            }
            let Some((query, answer)) = wrong else { continue };
            row.deviations.count(truth, hit);
            if !row.exact {
                continue;
            }
            self.differing += 1;
            self.first.get_or_insert_with(|| Difference {
                kind: set.kind,
                index,
                ray: *ray,
                query,
                first: (first.to_string(), truth),
                other: (row.accel.clone(), answer),
            });
        }
        counts
    }
}

/// Median rate and spread of each accelerator; `None` if there is no ray.
fn time(set: &RaySet, accels: &[&dyn Accel], rounds: u32) -> Vec<Option<(f64, f64)>> {
    if set.rays.is_empty() {
        return vec![None; accels.len()];
    }
    let rays = set.rays.len() as f64;
    let paces = in_turns_alone(accels.len(), rounds, |i| trace(set, accels[i]));
    paces.into_iter().map(|pace| Some((pace.per_second * rays, pace.spread))).collect()
}

/// Traces the set once.
fn trace(set: &RaySet, accel: &dyn Accel) {
    black_box(match set.query {
        Query::Closest => {
            set.rays.iter().filter_map(|ray| accel.closest_hit(ray)).fold(0u32, |sum, hit| sum ^ hit.prim)
        }
        Query::Any => set.rays.iter().fold(0, |sum, ray| sum + u32::from(accel.any_hit(ray))),
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::{BruteForce, Memory};
    use crate::geometry::Sphere;
    use crate::ray::Aabb;
    use glam::Vec3;

    /// Says that nothing is hit when only asked whether anything is.
    struct Blind<A>(A);

    impl<A: Accel> Accel for Blind<A> {
        fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
            self.0.closest_hit(ray)
        }
        fn any_hit(&self, _: &Ray) -> bool {
            false
        }
        fn closest_hit_counted(&self, ray: &Ray, counts: &mut Counts) -> Option<Hit> {
            self.0.closest_hit_counted(ray, counts)
        }
        fn any_hit_counted(&self, ray: &Ray, counts: &mut Counts) -> bool {
            self.0.any_hit_counted(ray, counts)
        }
        fn bounds(&self) -> Aabb {
            self.0.bounds()
        }
        fn memory(&self) -> Memory {
            self.0.memory()
        }
    }

    fn set() -> (Vec<Sphere>, RaySet) {
        let spheres = vec![Sphere { centre: Vec3::ZERO, radius: 1.0 }];
        let origins = [Vec3::new(-3.0, 0.0, 0.0), Vec3::new(-3.0, 2.0, 0.0)];
        let rays = origins.map(|o| Ray::new(o, Vec3::X)).to_vec();
        (spheres, RaySet { kind: RayKind::Given, query: Query::Closest, rays })
    }

    #[test]
    fn the_check_sees_a_wrong_flag_and_a_wrong_bit() {
        let (spheres, set) = set();
        let accel = BruteForce::new(&spheres);
        // The first ray meets the unit sphere at t = 2, the second passes it.
        let truth = [Some(Hit { t: 2.0, prim: 0 }), None];
        let mut check = Check::default();
        let mut right = row("b");
        let counts = check.answers(&set, &truth, "a", &accel, &mut right);
        assert_eq!((check.differing, counts.rays, counts.tests), (0, 2, 2));
        assert_eq!(right.deviations.total(), 0);

        let mut blind = row("blind");
        check.answers(&set, &truth, "a", &Blind(&accel), &mut blind);
        assert_eq!((check.differing, blind.deviations), (1, Deviations { other: 1, ..Deviations::default() }));
        let first = check.first.take().expect("a difference was counted");
        assert_eq!((first.index, first.query, first.other), (0, "any hit", ("blind".to_string(), Err(false))));

        let truth = [Some(Hit { t: 2.0f32.next_up(), prim: 0 }), None];
        check.answers(&set, &truth, "a", &accel, &mut right);
        assert_eq!(check.first.as_ref().map(|d| (d.index, d.query)), Some((0, "closest hit")));

        // One that promises nothing differs, but that is no failure.
        let mut peer = Row { exact: false, ..row("peer") };
        let truth = [None, Some(Hit { t: 2.0, prim: 0 })];
        check.answers(&set, &truth, "a", &accel, &mut peer);
        assert_eq!((check.differing, peer.deviations.missed, peer.deviations.extra), (2, 1, 1));
    }

    fn row(accel: &str) -> Row {
        let build = Build { milliseconds: 0.0, cpu_milliseconds: 0.0, memory: Memory::default() };
        let (described, deviations) = (String::new(), Deviations::default());
        Row { accel: accel.into(), described, build, rates: Vec::new(), exact: true, deviations }
    }

    #[test]
    fn every_accelerator_gets_a_rate_and_an_empty_set_none() {
        let (spheres, mut set) = set();
        let brute = BruteForce::new(spheres);
        let accels: Vec<&dyn Accel> = vec![&brute];
        assert!(time(&set, &accels, 2)[0].is_some_and(|(rate, spread)| rate > 0.0 && spread >= 0.0));
        set.rays.clear();
        assert_eq!(time(&set, &accels, 2), [None]);
    }
}
