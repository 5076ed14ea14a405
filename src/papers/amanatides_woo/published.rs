//! The paper's own numbers.

/// A row of the paper's table. Time is for 512 x 512 pixels on a machine of 1987.
pub(super) struct Published {
    pub figure: u32,
    pub scene: &'static str,
    pub minutes: f64,
    pub subdivision: u32,
    pub objects: u64,
    pub objects_per_voxel: f64,
    pub tests: f64,
    pub tests_with_id: f64,
}

/// The paper's table as a later document repeats it; the paper itself was not at hand.
pub(super) const PUBLISHED: [Published; 4] = [
    Published {
        figure: 4,
        scene: "random:n=4",
        minutes: 49.5,
        subdivision: 20,
        objects: 4,
        objects_per_voxel: 0.3,
        tests: 4.6,
        tests_with_id: 1.7,
    },
    Published {
        figure: 5,
        scene: "random:n=31",
        minutes: 44.8,
        subdivision: 20,
        objects: 31,
        objects_per_voxel: 0.9,
        tests: 5.3,
        tests_with_id: 2.0,
    },
    Published {
        figure: 6,
        scene: "random:n=62",
        minutes: 21.7,
        subdivision: 30,
        objects: 62,
        objects_per_voxel: 0.2,
        tests: 1.9,
        tests_with_id: 1.4,
    },
    Published {
        figure: 7,
        scene: "random:n=3540",
        minutes: 32.6,
        subdivision: 40,
        objects: 3540,
        objects_per_voxel: 1.1,
        tests: 6.6,
        tests_with_id: 3.8,
    },
];
