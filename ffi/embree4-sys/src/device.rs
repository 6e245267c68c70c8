//! The library's entry point: one device, shared by all scenes of a process.

use std::ffi::{CStr, CString, c_char, c_void};
use std::fmt;
use std::ptr;
use std::sync::atomic::{AtomicI64, Ordering::Relaxed};
use std::sync::{Arc, Mutex, PoisonError};

use crate::bindings;
use crate::error::Error;

/// A release of Embree.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Version {
    /// The number before the first dot.
    pub major: u32,
    /// The number between the dots.
    pub minor: u32,
    /// The number after the second dot.
    pub patch: u32,
}

impl fmt::Display for Version {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}.{}.{}", self.major, self.minor, self.patch)
    }
}

/// The two releases of Embree that meet in a process.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Versions {
    /// The release whose headers this crate was built with.
    pub header: Version,
    /// The release of the shared library that was loaded.
    pub library: Version,
}

impl Versions {
    /// Whether the library lays out rays and hits as the headers say.
    ///
    /// Embree keeps its layout within a major release, except that a hit grew at 4.3.
    fn share_layout(&self) -> bool {
        let with_instance_arrays = |version: Version| (version.major, version.minor) >= (4, 3);
        self.header.major == self.library.major
            && with_instance_arrays(self.header) == with_instance_arrays(self.library)
    }
}

/// Memory that Embree has taken for its scenes, in bytes; buffers that it shares with the caller are not
/// its own.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MemoryUse {
    /// What it holds now.
    pub held: u64,
    /// The most that it has held at once: building a tree takes more than the tree.
    pub peak: u64,
}

/// An Embree device. Clones are cheap and name the same device.
#[derive(Clone, Debug)]
pub struct Device {
    inner: Arc<DeviceInner>,
}

#[derive(Debug)]
struct DeviceInner {
    handle: bindings::RTCDevice,
    versions: Versions,
    /// What Embree last said about an error; `record_message` writes it.
    message: Mutex<String>,
    /// Bytes held, and the most so far; `count_memory` writes them.
    held: AtomicI64,
    peak: AtomicI64,
}

// SAFETY: Embree's device functions may be called from any thread; the message is behind a mutex, and
// the counts are atomic.
unsafe impl Send for DeviceInner {}
// SAFETY: as above.
unsafe impl Sync for DeviceInner {}

impl Drop for DeviceInner {
    fn drop(&mut self) {
        // SAFETY: the handle came from rtcNewDevice and is released once. Every scene holds an Arc
        // of this device, so none is left that could report an error to `message`.
        unsafe { bindings::rtcReleaseDevice(self.handle) }
    }
}

impl Device {
    /// Makes a device.
    ///
    /// - `config`: Embree's comma-separated options, such as `threads=2`; empty for its defaults.
    ///   Embree ignores an option that it does not know.
    ///
    /// # Errors
    /// [`Error::Device`] if Embree refuses the configuration or the processor, or if `config`
    /// contains a zero byte; [`Error::WrongLibrary`] if the library that was loaded does not match
    /// the headers of the build.
    pub fn new(config: &str) -> Result<Self, Error> {
        let refused = |message: String| Error::Device {
            config: config.to_owned(),
            message,
        };
        let c_config =
            CString::new(config).map_err(|_| refused("it contains a zero byte".to_owned()))?;
        // SAFETY: the string is NUL-terminated and outlives the call.
        let handle = unsafe { bindings::rtcNewDevice(c_config.as_ptr()) };
        if handle.is_null() {
            // SAFETY: a null device asks for the error of this thread's last rtcNewDevice.
            let code = unsafe { bindings::rtcGetDeviceError(ptr::null_mut()) };
            return Err(refused(creation_message(code)));
        }
        let versions = Versions {
            header: header_version(),
            library: library_version(handle),
        };
        let device = Self {
            inner: Arc::new(DeviceInner {
                handle,
                versions,
                message: Mutex::default(),
                held: AtomicI64::new(0),
                peak: AtomicI64::new(0),
            }),
        };
        if !versions.share_layout() {
            return Err(Error::WrongLibrary(versions));
        }
        let user = Arc::as_ptr(&device.inner).cast::<c_void>().cast_mut();
        // SAFETY: the device is live; both functions take the pointer for a DeviceInner, which stays
        // at its address until it has released the device.
        unsafe {
            bindings::rtcSetDeviceErrorFunction(handle, Some(record_message), user);
            bindings::rtcSetDeviceMemoryMonitorFunction(handle, Some(count_memory), user);
        }
        Ok(device)
    }

    /// The releases of the headers and of the library.
    pub fn version(&self) -> Versions {
        self.inner.versions
    }

    /// What the scenes of this device take.
    pub fn memory(&self) -> MemoryUse {
        let bytes = |count: &AtomicI64| u64::try_from(count.load(Relaxed)).unwrap_or(0);
        MemoryUse {
            held: bytes(&self.inner.held),
            peak: bytes(&self.inner.peak),
        }
    }

    pub(crate) fn handle(&self) -> bindings::RTCDevice {
        self.inner.handle
    }

    pub(crate) fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.inner, &other.inner)
    }

    /// Turns an error that Embree recorded on this thread since the last call into ours.
    pub(crate) fn check(&self, operation: &'static str) -> Result<(), Error> {
        // SAFETY: the device is live.
        let code = unsafe { bindings::rtcGetDeviceError(self.inner.handle) };
        if code == bindings::RTC_ERROR_NONE {
            return Ok(());
        }
        let words = self
            .inner
            .message
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone();
        let message = if words.is_empty() {
            code_meaning(code).to_owned()
        } else {
            words
        };
        Err(Error::Embree { operation, message })
    }
}

/// Embree's error callback: keeps the words for [`Device::check`].
///
/// # Safety
/// `user` must point to the live `DeviceInner` of the device, `text` to a C string or nothing.
unsafe extern "C" fn record_message(
    user: *mut c_void,
    _code: bindings::RTCError,
    text: *const c_char,
) {
    if user.is_null() || text.is_null() {
        return;
    }
    // SAFETY: see above; only shared references to a DeviceInner exist.
    let device = unsafe { &*user.cast_const().cast::<DeviceInner>() };
    // SAFETY: see above.
    let words = unsafe { CStr::from_ptr(text) }.to_string_lossy();
    let mut message = device
        .message
        .lock()
        .unwrap_or_else(PoisonError::into_inner);
    message.clear();
    message.push_str(&words);
}

/// Embree's memory callback: counts for [`Device::memory`], and lets everything pass.
///
/// # Safety
/// `user` must point to the live `DeviceInner` of the device.
unsafe extern "C" fn count_memory(user: *mut c_void, bytes: isize, _done: bool) -> bool {
    if !user.is_null() {
        // SAFETY: see above; only shared references to a DeviceInner exist.
        let device = unsafe { &*user.cast_const().cast::<DeviceInner>() };
        let bytes = bytes as i64;
        let held = device.held.fetch_add(bytes, Relaxed) + bytes;
        device.peak.fetch_max(held, Relaxed);
    }
    true
}

/// Why the last rtcNewDevice of this thread failed; there is no device yet to ask.
fn creation_message(code: bindings::RTCError) -> String {
    let meaning = match code {
        bindings::RTC_ERROR_UNKNOWN => "an option cannot be read, or the reason is unknown",
        other => code_meaning(other),
    };
    // SAFETY: a null device is allowed and asks for this thread's last failure.
    let text = unsafe { bindings::shim_error_message(ptr::null_mut()) };
    if text.is_null() {
        return meaning.to_owned();
    }
    // SAFETY: Embree returns a C string that stays valid until its next error on this thread.
    let words = unsafe { CStr::from_ptr(text) }.to_string_lossy();
    if words.is_empty() {
        code_meaning(code).to_owned()
    } else {
        words.into_owned()
    }
}

fn code_meaning(code: bindings::RTCError) -> &'static str {
    match code {
        bindings::RTC_ERROR_INVALID_ARGUMENT => "invalid argument",
        bindings::RTC_ERROR_INVALID_OPERATION => "invalid operation",
        bindings::RTC_ERROR_OUT_OF_MEMORY => "out of memory",
        bindings::RTC_ERROR_UNSUPPORTED_CPU => "this processor lacks the instructions it needs",
        bindings::RTC_ERROR_CANCELLED => "cancelled",
        _ => "unknown error",
    }
}

fn header_version() -> Version {
    Version {
        major: bindings::RTC_VERSION_MAJOR,
        minor: bindings::RTC_VERSION_MINOR,
        patch: bindings::RTC_VERSION_PATCH,
    }
}

fn library_version(handle: bindings::RTCDevice) -> Version {
    let property = |which| {
        // SAFETY: the device is live, and the version properties exist in every release.
        let value = unsafe { bindings::rtcGetDeviceProperty(handle, which) };
        u32::try_from(value).unwrap_or(0)
    };
    Version {
        major: property(bindings::RTC_DEVICE_PROPERTY_VERSION_MAJOR),
        minor: property(bindings::RTC_DEVICE_PROPERTY_VERSION_MINOR),
        patch: property(bindings::RTC_DEVICE_PROPERTY_VERSION_PATCH),
    }
}

#[cfg(test)]
mod tests {
    use super::{Version, Versions};

    fn version(major: u32, minor: u32) -> Version {
        Version {
            major,
            minor,
            patch: 1,
        }
    }

    #[test]
    fn only_a_library_with_the_layout_of_the_headers_is_taken() {
        let share = |header, library| Versions { header, library }.share_layout();
        assert!(share(version(3, 13), version(3, 12)));
        assert!(share(version(4, 3), version(4, 4)));
        assert!(share(version(4, 1), version(4, 2)));
        assert!(!share(version(3, 13), version(4, 4)));
        assert!(!share(version(4, 3), version(3, 13)));
        assert!(!share(version(4, 3), version(4, 2)));
        assert!(!share(version(4, 2), version(4, 3)));
    }
}
