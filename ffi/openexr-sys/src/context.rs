//! The library's context, the stream below it and the messages that come out of it.

use std::cell::Cell;
use std::ffi::{CStr, c_char, c_void};
use std::fs::File;
use std::io;
use std::os::unix::fs::FileExt;

use crate::bindings as c;
use crate::error::Error;

/// What the callbacks see: the file, and a place for what went wrong.
struct Stream {
    file: File,
    io_error: Cell<Option<io::Error>>,
    message: Cell<Option<String>>,
}

impl Stream {
    /// Keeps the first error: later ones follow from it.
    fn record_io(&self, error: io::Error) {
        self.io_error.set(self.io_error.take().or(Some(error)));
    }

    fn record_message(&self, message: String) {
        self.message.set(self.message.take().or(Some(message)));
    }
}

/// An open context. It is closed when dropped.
pub(crate) struct Context {
    raw: c::exr_context_t,
    /// From `Box::into_raw`; a `Box` here would claim to be the only way to the stream.
    stream: *mut Stream,
}

impl Context {
    /// Opens `file` for reading and parses its header.
    pub(crate) fn read(file: File) -> Result<Self, Error> {
        Self::open(file, |raw, user_data| {
            // SAFETY: `user_data` is the stream, freed after the context is closed; the callbacks
            // have the signatures that the library asks for and do not unwind.
            unsafe {
                c::openexr_shim_start_read(
                    raw,
                    user_data,
                    Some(read_at),
                    Some(file_size),
                    Some(on_error),
                )
            }
        })
    }

    /// Prepares `file`, open for writing, to be filled from its first byte.
    pub(crate) fn write(file: File) -> Result<Self, Error> {
        Self::open(file, |raw, user_data| {
            // SAFETY: as in `read`.
            unsafe { c::openexr_shim_start_write(raw, user_data, Some(write_at), Some(on_error)) }
        })
    }

    fn open(
        file: File,
        start: impl FnOnce(*mut c::exr_context_t, *mut c_void) -> c::exr_result_t,
    ) -> Result<Self, Error> {
        let stream = Stream {
            file,
            io_error: Cell::new(None),
            message: Cell::new(None),
        };
        let mut context = Self {
            raw: std::ptr::null_mut(),
            stream: Box::into_raw(Box::new(stream)),
        };
        let code = start(&mut context.raw, context.stream.cast());
        context.check(code)?;
        Ok(context)
    }

    /// The library's handle; valid as long as `self`.
    pub(crate) fn raw(&self) -> c::exr_context_t {
        self.raw
    }

    /// Turns a result code into what happened, with the library's own words where it had any.
    pub(crate) fn check(&self, code: c::exr_result_t) -> Result<(), Error> {
        let stream = self.stream();
        if let Some(error) = stream.io_error.take() {
            return Err(Error::Io(error));
        }
        let message = stream.message.take();
        let is = |other: c::exr_error_code_t| code == other as c::exr_result_t;
        if is(c::EXR_ERR_SUCCESS) {
            return Ok(());
        }
        let message = message.unwrap_or_else(|| default_message(code));
        Err(if is(c::EXR_ERR_FEATURE_NOT_IMPLEMENTED) {
            Error::Unsupported(format!(
                "OpenEXR {} cannot do this: {message}",
                crate::version()
            ))
        } else {
            Error::Broken(message)
        })
    }

    /// Closes the context; for a written file this is when the table of chunks is written.
    pub(crate) fn finish(mut self) -> Result<(), Error> {
        let code = self.close();
        self.check(code)
    }

    fn close(&mut self) -> c::exr_result_t {
        if self.raw.is_null() {
            return c::EXR_ERR_SUCCESS as c::exr_result_t;
        }
        // SAFETY: `raw` is open; the library sets it to null, so it is closed once.
        unsafe { c::exr_finish(&mut self.raw) }
    }

    fn stream(&self) -> &Stream {
        // SAFETY: freed in `drop` only; every other access is shared, too.
        unsafe { &*self.stream }
    }
}

impl Drop for Context {
    fn drop(&mut self) {
        self.close();
        // SAFETY: from `Box::into_raw`, freed here only, after the context that used it.
        drop(unsafe { Box::from_raw(self.stream) });
    }
}

/// The library's general text for a code.
fn default_message(code: c::exr_result_t) -> String {
    // SAFETY: the function takes any code and returns a constant string.
    unsafe { text(c::exr_get_default_error_message(code)) }
}

/// Copies a C string; a null pointer gives an empty text.
///
/// # Safety
/// `text` is null or points to a string that ends with a zero byte.
pub(crate) unsafe fn text(text: *const c_char) -> String {
    if text.is_null() {
        return String::new();
    }
    // SAFETY: promised by the caller.
    unsafe { CStr::from_ptr(text) }
        .to_string_lossy()
        .into_owned()
}

/// Reads up to `size` bytes at `offset`; fewer only at the end of the file.
unsafe extern "C" fn read_at(
    _: c::exr_const_context_t,
    user_data: *mut c_void,
    buffer: *mut c_void,
    size: u64,
    offset: u64,
    _: c::exr_stream_error_func_ptr_t,
) -> i64 {
    let Ok(length) = usize::try_from(size) else {
        return -1;
    };
    if length == 0 {
        return 0;
    }
    // SAFETY: `user_data` is the stream that `Context::open` passed; it is alive and shared.
    let stream = unsafe { &*user_data.cast::<Stream>() };
    // SAFETY: the library's buffer has `size` bytes. They may be uninitialised for Rust: zeroed
    // first, since a slice must not show such bytes.
    let buffer = unsafe {
        buffer.cast::<u8>().write_bytes(0, length);
        std::slice::from_raw_parts_mut(buffer.cast::<u8>(), length)
    };
    let mut filled = 0;
    while filled < length {
        match stream
            .file
            .read_at(&mut buffer[filled..], offset + filled as u64)
        {
            Ok(0) => break,
            Ok(count) => filled += count,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => {
                stream.record_io(error);
                return -1;
            }
        }
    }
    filled as i64
}

/// Bytes in the file; the library checks its header against it.
unsafe extern "C" fn file_size(_: c::exr_const_context_t, user_data: *mut c_void) -> i64 {
    // SAFETY: as in `read_at`.
    let stream = unsafe { &*user_data.cast::<Stream>() };
    match stream.file.metadata() {
        Ok(metadata) => i64::try_from(metadata.len()).unwrap_or(i64::MAX),
        Err(error) => {
            stream.record_io(error);
            -1
        }
    }
}

/// Writes all of `size` bytes at `offset`.
unsafe extern "C" fn write_at(
    _: c::exr_const_context_t,
    user_data: *mut c_void,
    buffer: *const c_void,
    size: u64,
    offset: u64,
    _: c::exr_stream_error_func_ptr_t,
) -> i64 {
    let Ok(length) = usize::try_from(size) else {
        return -1;
    };
    if length == 0 {
        return 0;
    }
    // SAFETY: as in `read_at`.
    let stream = unsafe { &*user_data.cast::<Stream>() };
    // SAFETY: the library passes `size` bytes that it has filled.
    let bytes = unsafe { std::slice::from_raw_parts(buffer.cast::<u8>(), length) };
    match stream.file.write_all_at(bytes, offset) {
        Ok(()) => length as i64,
        Err(error) => {
            stream.record_io(error);
            -1
        }
    }
}

/// Keeps the library's message for `Context::check`.
unsafe extern "C" fn on_error(
    context: c::exr_const_context_t,
    _: c::exr_result_t,
    message: *const c_char,
) {
    let mut user_data = std::ptr::null_mut();
    // SAFETY: the library hands in its own context, or null, which the function refuses.
    let code = unsafe { c::exr_get_user_data(context, &mut user_data) };
    if code != c::EXR_ERR_SUCCESS as c::exr_result_t || user_data.is_null() {
        return;
    }
    // SAFETY: as in `read_at`; the message is a string of the library.
    unsafe { (*user_data.cast::<Stream>()).record_message(text(message)) };
}
