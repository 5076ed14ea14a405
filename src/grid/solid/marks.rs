//! Two bits a voxel: solid, at the surface.

/// The bits of all voxels of a frame, 32 voxels in a word.
#[derive(Clone, Debug)]
pub(super) struct Marks {
    words: Vec<u64>,
    len: usize,
}

const SOLID: u64 = 1;
const SURFACE: u64 = 2;

impl Marks {
    /// Bytes for so many voxels.
    pub fn bytes_for(voxels: u64) -> u64 {
        voxels.div_ceil(32) * 8
    }

    /// No voxel is anything; `None` if there is no memory.
    pub fn new(len: usize) -> Option<Self> {
        let mut words = Vec::new();
        words.try_reserve_exact(len.div_ceil(32)).ok()?;
        words.resize(len.div_ceil(32), 0);
        Some(Self { words, len })
    }

    pub fn set_solid(&mut self, voxel: usize) {
        self.words[voxel / 32] |= SOLID << (voxel % 32 * 2);
    }

    pub fn set_surface(&mut self, voxel: usize) {
        self.words[voxel / 32] |= SURFACE << (voxel % 32 * 2);
    }

    /// True if the voxel is solid.
    #[inline(always)]
    pub fn solid(&self, voxel: usize) -> bool {
        self.words[voxel / 32] >> (voxel % 32 * 2) & SOLID != 0
    }

    /// True if the closed voxel touches an exposed face.
    #[inline(always)]
    pub fn surface(&self, voxel: usize) -> bool {
        self.words[voxel / 32] >> (voxel % 32 * 2) & SURFACE != 0
    }

    /// Number of voxels.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Number of voxels at the surface.
    pub fn surfaces(&self) -> u64 {
        const ALL: u64 = 0xaaaa_aaaa_aaaa_aaaa;
        self.words.iter().map(|w| u64::from((w & ALL).count_ones())).sum()
    }

    /// Number of solid voxels that are not at the surface.
    pub fn inside(&self) -> u64 {
        const ALL: u64 = 0x5555_5555_5555_5555;
        self.words.iter().map(|w| u64::from((w & !(w >> 1) & ALL).count_ones())).sum()
    }

    /// Bytes held.
    pub fn bytes(&self) -> u64 {
        self.words.len() as u64 * 8
    }
}
