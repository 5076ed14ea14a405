//! Buffers of numbers, owned or shared with the caller, and the items that a geometry sees in them.

use crate::device::{Device, Fault};
use crate::types::{ErrorCode, format};
use std::ffi::c_void;
use std::ptr::NonNull;
use std::sync::Arc;

/// Bytes.
#[derive(Debug)]
pub struct Buffer {
    device: Arc<Device>,
    bytes: usize,
    data: NonNull<u8>,
    /// What `data` points into, unless the caller shares it.
    owned: Option<Box<[u128]>>,
}

// SAFETY: shared memory is read during commits and queries, when callers must leave it alone, as with Embree itself.
unsafe impl Send for Buffer {}
// SAFETY: as above.
unsafe impl Sync for Buffer {}

impl Buffer {
    /// A buffer of zeros, aligned to 16 bytes, with 16 more behind it: Embree's readers may read a whole vector.
    ///
    /// # Errors
    /// The memory monitor refuses, or there is no such memory.
    pub fn new(device: Arc<Device>, bytes: usize) -> Result<Self, Fault> {
        let none =
            |why: &str| Fault { code: ErrorCode::OutOfMemory, message: format!("a buffer of {bytes} bytes: {why}") };
        let units = bytes.div_ceil(16).checked_add(1).ok_or_else(|| none("too large"))?;
        let Ok(counted) = isize::try_from(bytes) else { return Err(none("too large")) };
        if !device.memory(counted) {
            return Err(none("the memory monitor refuses it"));
        }
        let mut owned = Vec::new();
        if owned.try_reserve_exact(units).is_err() {
            device.memory(-counted);
            return Err(none("out of memory"));
        }
        owned.resize(units, 0u128);
        let mut owned = owned.into_boxed_slice();
        let data = NonNull::from(&mut *owned).cast();
        Ok(Self { device, bytes, data, owned: Some(owned) })
    }

    /// Memory of the caller.
    ///
    /// # Errors
    /// `data` is null or not a multiple of 4.
    ///
    /// # Safety
    /// `bytes` at `data` can be read as long as the buffer is used.
    pub unsafe fn shared(device: Arc<Device>, data: *mut u8, bytes: usize) -> Result<Self, Fault> {
        let data = NonNull::new(data).ok_or_else(|| Fault::argument("a shared buffer at address 0"))?;
        if data.as_ptr().addr() % 4 != 0 {
            return Err(Fault::argument("a shared buffer whose address is no multiple of 4"));
        }
        Ok(Self { device, bytes, data, owned: None })
    }

    /// Where the bytes are.
    pub fn data(&self) -> *mut c_void {
        self.data.as_ptr().cast()
    }
}

impl Drop for Buffer {
    fn drop(&mut self) {
        if self.owned.is_some() {
            // It came as an `isize`.
            self.device.memory(-(self.bytes as isize));
        }
    }
}

/// Items of a buffer.
#[derive(Clone, Debug)]
pub struct View {
    buffer: Arc<Buffer>,
    offset: usize,
    stride: usize,
    count: usize,
    format: u32,
}

impl View {
    /// `count` items of `format`, the first at `offset`, each `stride` bytes after the one before.
    ///
    /// # Errors
    /// Embree's rules: offset and stride are multiples of 4, the format is one of its own, the items lie in the buffer.
    pub fn new(buffer: Arc<Buffer>, offset: usize, stride: usize, count: usize, format: u32) -> Result<Self, Fault> {
        if !offset.is_multiple_of(4) || !stride.is_multiple_of(4) {
            return Err(Fault::operation(format!(
                "offset {offset} and stride {stride} of a buffer must be multiples of 4"
            )));
        }
        if u32::try_from(count).is_err() {
            return Err(Fault::argument(format!("a buffer of {count} items, at most {} can be told apart", u32::MAX)));
        }
        if format::bytes(format).is_none() {
            return Err(Fault::unsupported(&format!("buffers of format {format:#x}")));
        }
        // Strides decide, as with Embree, which lets items be wider than their stride; what lies outside is not read.
        let needed = stride.checked_mul(count).and_then(|bytes| bytes.checked_add(offset));
        if needed.is_none_or(|needed| needed > buffer.bytes) {
            return Err(Fault::argument(format!(
                "{count} items every {stride} bytes from {offset} on do not lie in a buffer of {} bytes",
                buffer.bytes
            )));
        }
        Ok(Self { buffer, offset, stride, count, format })
    }

    /// Number of items.
    pub fn count(&self) -> usize {
        self.count
    }

    /// What the items are.
    pub fn format(&self) -> u32 {
        self.format
    }

    /// Where the first item is.
    pub fn data(&self) -> *mut c_void {
        // SAFETY: the offset lies in the buffer, or there is no item.
        unsafe { self.buffer.data().byte_add(self.offset) }
    }

    /// Where word `index` of an item is; `None` beyond the last item, the item itself and the buffer.
    fn word(&self, item: usize, index: usize) -> Option<*const u32> {
        // `new` saw that this does not overflow.
        let at = self.offset + item * self.stride + 4 * index;
        let inside = item < self.count
            && format::bytes(self.format).is_some_and(|bytes| 4 * index < bytes)
            && at + 4 <= self.buffer.bytes;
        // SAFETY: the place lies in the buffer.
        inside.then(|| unsafe { self.buffer.data().byte_add(at).cast_const().cast() })
    }

    /// Reads `N` words of 4 bytes at the start of an item; `None` beyond the last item.
    pub fn words<const N: usize>(&self, item: usize) -> Option<[u32; N]> {
        self.word(item, N - 1)?;
        let first = self.word(item, 0)?;
        // SAFETY: the first and the last word lie in the buffer.
        Some(unsafe { first.cast::<[u32; N]>().read_unaligned() })
    }

    /// Reads three f32; `None` beyond the last item.
    pub fn point(&self, item: usize) -> Option<[f32; 3]> {
        self.words(item).map(|words: [u32; 3]| words.map(f32::from_bits))
    }

    /// Reads one f32 of an item; `None` beyond the last one and beyond the item.
    pub fn number(&self, item: usize, index: usize) -> Option<f32> {
        // SAFETY: the word lies in the buffer.
        self.word(item, index).map(|word| unsafe { word.cast::<f32>().read_unaligned() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::types::Version;

    fn device() -> Arc<Device> {
        Arc::new(Device::new(Version::Three, "").unwrap())
    }

    #[test]
    fn items_must_lie_in_the_buffer() {
        let buffer = Arc::new(Buffer::new(device(), 36).unwrap());
        assert!(View::new(buffer.clone(), 0, 12, 3, format::FLOAT3).is_ok());
        assert!(View::new(buffer.clone(), 4, 12, 3, format::FLOAT3).is_err());
        assert!(View::new(buffer.clone(), 0, 16, 2, format::FLOAT3).is_ok());
        assert!(View::new(buffer.clone(), 0, 16, 3, format::FLOAT3).is_err());
        assert!(View::new(buffer.clone(), 0, 13, 1, format::FLOAT3).is_err());
        assert!(View::new(buffer.clone(), 0, usize::MAX - 3, 3, format::FLOAT3).is_err());
        assert!(View::new(buffer.clone(), 0, 12, 0, format::FLOAT3).is_ok());
        // Items wider than their stride: the last one ends outside.
        let wide = View::new(buffer, 0, 12, 3, format::FLOAT + 3).unwrap();
        assert_eq!((wide.number(1, 3), wide.number(2, 2), wide.number(2, 3)), (Some(0.0), Some(0.0), None));
    }

    #[test]
    fn items_are_read_by_their_stride() {
        let mut numbers = [0.0f32, 1.0, 2.0, 9.0, 3.0, 4.0, 5.0, 9.0];
        let bytes = size_of_val(&numbers);
        // SAFETY: the numbers outlive the buffer.
        let buffer = unsafe { Buffer::shared(device(), numbers.as_mut_ptr().cast(), bytes) }.unwrap();
        let view = View::new(Arc::new(buffer), 0, 16, 2, format::FLOAT3).unwrap();
        assert_eq!(view.point(1), Some([3.0, 4.0, 5.0]));
        assert_eq!((view.point(2), view.words::<4>(0), view.number(1, 2)), (None, None, Some(5.0)));
    }
}
