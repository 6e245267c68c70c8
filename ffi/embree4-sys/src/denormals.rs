//! The floating-point mode of worker threads.

use crate::bindings;

/// Makes the calling thread read and write denormal numbers as zero.
///
/// Embree's traversal is faster so, and gives the same answers on every thread only if all threads
/// agree: call it at the start of each worker. Does nothing on processors other than `x86_64` and
/// `aarch64`.
pub fn flush_denormals() {
    // SAFETY: sets two bits of this thread's floating-point control register, nothing else. Rust
    // code that runs afterwards sees zero instead of a denormal result, never an invalid value.
    unsafe { bindings::shim_flush_denormals() }
}

#[cfg(test)]
mod tests {
    use std::hint::black_box;

    #[test]
    fn a_denormal_product_becomes_zero_on_the_calling_thread_only() {
        let product = || black_box(black_box(f32::MIN_POSITIVE) * black_box(0.5));
        assert!(product() > 0.0);
        let flushed = std::thread::spawn(move || {
            super::flush_denormals();
            product()
        });
        assert_eq!(
            flushed.join().expect("the thread does not panic").to_bits(),
            0
        );
        assert!(product() > 0.0);
    }
}
