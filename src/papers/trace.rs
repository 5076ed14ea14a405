//! The rays of one picture: recorded while it is rendered, then traced again through every accelerator.

use crate::accel::{Accel, Counts, Hit, Memory};
use crate::error::Result;
use crate::measure::rounds::{Pace, in_turns, same};
use crate::ray::{Aabb, Ray};
use crate::render::{Integrator, Sampler, Settings, render};
use crate::scene::Scene;
use std::hint::black_box;
use std::sync::{Mutex, PoisonError};

/// Longest path of the recorded pictures, edges: five reflections and a connection to a light, as Haines' SPD has it.
pub const MAX_DEPTH: u32 = 6;

/// Where a ray of a picture comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// The eye.
    Primary,
    /// A surface, towards a light; asked for any hit.
    Shadow,
    /// A mirror or glass.
    Secondary,
}

/// What the plain grid answered.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Answer {
    Closest(Option<Hit>),
    Any(bool),
}

/// One question of the renderer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Asked {
    /// The ray.
    pub ray: Ray,
    /// Where it comes from.
    pub origin: Origin,
    answer: Answer,
}

/// What a list of rays costs one accelerator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// Seconds for the whole list on one thread: from the median of the rounds. NaN for an empty list.
    pub seconds: f64,
    /// Half the distance between the fastest and the slowest round, as a share of the median.
    pub spread: f64,
    /// Work; independent of the machine.
    pub counts: Counts,
    /// Rays whose answer, counted or not, differs from the recorded one in any bit.
    pub wrong: u64,
}

impl Cost {
    /// Nanoseconds a ray; NaN for an empty list.
    pub fn nanoseconds(&self) -> f64 {
        1e9 * self.seconds / self.counts.rays as f64
    }

    /// A ray's share of `work`, one of the counts; NaN for an empty list.
    pub fn per_ray(&self, work: u64) -> f64 {
        work as f64 / self.counts.rays as f64
    }
}

/// All rays of a `size` x `size` picture of `scene` by Whitted's method, one sample a pixel, in the order in which one
/// thread asks for them. `plain` gives the answers that other accelerators must repeat.
///
/// # Errors
/// As [`render`].
pub fn record(scene: &Scene, plain: &dyn Accel, size: u32) -> Result<Vec<Asked>> {
    let eye = scene.camera.origin.as_vec3();
    let recorder = Recorder { plain, eye: eye.to_array(), asked: Mutex::new(Vec::new()) };
    render(scene, &recorder, &settings(size), &|_, _| {})?;
    Ok(recorder.asked.into_inner().unwrap_or_else(PoisonError::into_inner))
}

/// `rays` as questions for the closest hit, with the answers of `plain`.
pub fn ask(rays: &[Ray], plain: &dyn Accel) -> Vec<Asked> {
    let asked =
        |ray: &Ray| Asked { ray: *ray, origin: Origin::Primary, answer: Answer::Closest(plain.closest_hit(ray)) };
    rays.iter().map(asked).collect()
}

/// How the pictures are rendered: on one thread.
pub fn settings(size: u32) -> Settings {
    Settings {
        integrator: Integrator::Whitted,
        width: size,
        height: size,
        sampler: Sampler::Regular(1),
        max_depth: MAX_DEPTH,
        threads: Some(1),
        shadow_voxels: Some(false),
        ..Settings::default()
    }
}

/// Traces `asked` through each of `accels`: twice to compare the answers, with and without counting, then in interleaved
/// rounds for time. `rounds` is at least 1.
pub fn costs(asked: &[Asked], accels: &[&dyn Accel], rounds: u32) -> Vec<Cost> {
    let paces = if asked.is_empty() {
        vec![Pace { per_second: f64::NAN, spread: f64::NAN }; accels.len()]
    } else {
        in_turns(accels.len(), rounds, |i| pass(asked, accels[i]))
    };
    let cost = |(accel, pace): (&&dyn Accel, Pace)| {
        let (counts, wrong) = check(asked, *accel);
        Cost { seconds: 1.0 / pace.per_second, spread: pace.spread, counts, wrong }
    };
    accels.iter().zip(paces).map(cost).collect()
}

/// The work for the list, and the number of rays whose answer, counted or not, differs from the recorded one.
pub fn check(asked: &[Asked], accel: &dyn Accel) -> (Counts, u64) {
    let mut counts = Counts::default();
    let mut wrong = 0;
    for Asked { ray, answer, .. } in asked {
        let right = match *answer {
            Answer::Closest(hit) => {
                same(hit, accel.closest_hit(ray)) & same(hit, accel.closest_hit_counted(ray, &mut counts))
            }
            Answer::Any(any) => (any == accel.any_hit(ray)) & (any == accel.any_hit_counted(ray, &mut counts)),
        };
        wrong += u64::from(!right);
    }
    (counts, wrong)
}

/// At most about `most` rays of the list in stretches of neighbours, evenly spread.
pub fn thinned(asked: &[Asked], most: usize) -> Vec<Asked> {
    const STRETCH: usize = 64;
    let every = asked.len().div_ceil(most.max(1)).max(1);
    asked.chunks(STRETCH).step_by(every).flatten().copied().collect()
}

/// Traces the list once.
pub fn pass(asked: &[Asked], accel: &dyn Accel) {
    let answer = |asked: &Asked| match asked.answer {
        Answer::Closest(_) => accel.closest_hit(&asked.ray).map_or(0, |hit| hit.prim),
        Answer::Any(_) => u32::from(accel.any_hit(&asked.ray)),
    };
    black_box(asked.iter().map(answer).fold(0, |sum: u32, x| sum ^ x));
}

/// Answers as the plain accelerator, and keeps what it was asked.
struct Recorder<'a> {
    plain: &'a dyn Accel,
    /// Coordinates of the eye: a ray from there is a primary one.
    eye: [f32; 3],
    asked: Mutex<Vec<Asked>>,
}

impl Recorder<'_> {
    fn keep(&self, ray: &Ray, origin: Origin, answer: Answer) {
        let mut asked = self.asked.lock().unwrap_or_else(PoisonError::into_inner);
        asked.push(Asked { ray: *ray, origin, answer });
    }
}

impl Accel for Recorder<'_> {
    fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        let hit = self.plain.closest_hit(ray);
        let from_eye = ray.origin.to_array() == self.eye;
        self.keep(ray, if from_eye { Origin::Primary } else { Origin::Secondary }, Answer::Closest(hit));
        hit
    }

    fn any_hit(&self, ray: &Ray) -> bool {
        let any = self.plain.any_hit(ray);
        self.keep(ray, Origin::Shadow, Answer::Any(any));
        any
    }

    fn closest_hit_counted(&self, ray: &Ray, _: &mut Counts) -> Option<Hit> {
        self.closest_hit(ray)
    }

    fn any_hit_counted(&self, ray: &Ray, _: &mut Counts) -> bool {
        self.any_hit(ray)
    }

    fn bounds(&self) -> Aabb {
        self.plain.bounds()
    }

    fn memory(&self) -> Memory {
        self.plain.memory()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Sphere;
    use crate::scene::{Light, SceneParts};
    use glam::{DVec3, Vec3};

    /// A matt ball before a light behind the eye's right shoulder, seen from +z.
    fn ball() -> Scene {
        let spheres = vec![(Sphere { centre: Vec3::ZERO, radius: 1.0 }, 0)];
        let light = Light::Directional { direction: DVec3::NEG_Z, irradiance: Vec3::ONE };
        Scene::new(SceneParts { spheres, lights: vec![light], ..SceneParts::default() }).expect("a valid scene")
    }

    #[test]
    fn every_ray_of_the_picture_is_recorded_once() {
        let scene = ball();
        let plain = scene.accel("brute").expect("always there");
        let asked = record(&scene, &plain, 16).expect("a picture");
        let film = render(&scene, &*plain, &settings(16), &|_, _| {}).expect("a picture");
        let count = |origin| asked.iter().filter(|a| a.origin == origin).count() as u64;
        assert_eq!(count(Origin::Primary), 256);
        assert_eq!(count(Origin::Shadow), film.stats.shadow);
        assert!(film.stats.shadow > 0, "the ball is lit");
        assert_eq!(count(Origin::Secondary), film.stats.bounce);
    }

    #[test]
    fn a_wrong_accelerator_is_found_out() {
        let scene = ball();
        let plain = scene.accel("brute").expect("always there");
        let asked = record(&scene, &plain, 8).expect("a picture");
        let cost = &costs(&asked, &[&*plain], 1)[0];
        assert_eq!((cost.wrong, cost.counts.rays, cost.counts.tests), (0, asked.len() as u64, asked.len() as u64));
        let nothing = Scene::new(SceneParts::default()).expect("an empty scene");
        let blind = nothing.accel("brute").expect("always there");
        let hits = asked.iter().filter(|a| plain.any_hit(&a.ray)).count() as u64;
        assert!(hits > 0);
        assert_eq!(check(&asked, &*blind).1, hits);
    }

    #[test]
    fn thinning_keeps_stretches_of_the_list() {
        let scene = ball();
        let plain = scene.accel("brute").expect("always there");
        let asked = record(&scene, &plain, 32).expect("a picture");
        let some = thinned(&asked, asked.len() / 4);
        assert!(some.len() <= asked.len() / 4 + 64, "{} of {}", some.len(), asked.len());
        assert_eq!(some[..64], asked[..64]);
        assert_eq!(thinned(&asked, usize::MAX), asked);
    }
}
