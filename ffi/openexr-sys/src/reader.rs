//! Reading the first part of a file.

use std::ffi::CString;
use std::fs::File;
use std::io;
use std::os::unix::fs::FileExt;

use half::f16;

use crate::bindings as c;
use crate::context::Context;
use crate::error::Error;
use crate::header::{Header, SampleType, parse};

/// The first four bytes of every EXR file.
const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

/// An open file whose header has been read and checked.
pub struct Reader {
    context: Context,
    header: Header,
    names: Vec<CString>,
}

/// Samples of one channel of one chunk, in the file's own type.
enum Scratch {
    Uint(Vec<u32>),
    Half(Vec<u16>),
    Float(Vec<f32>),
}

/// Where a chunk lies in the data window and how far it may reach.
struct ChunkBounds {
    left: usize,
    top: usize,
    max_width: usize,
    max_height: usize,
}

impl Reader {
    /// Reads the header of an EXR file.
    ///
    /// # Errors
    /// [`Error::NotExr`], [`Error::Broken`] and [`Error::Oversized`] for files that are none or are
    /// damaged, [`Error::Unsupported`] for deep data, [`Error::Io`] when reading fails.
    pub fn new(file: File) -> Result<Self, Error> {
        let mut magic = [0; 4];
        match file.read_exact_at(&mut magic, 0) {
            Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => {
                return Err(Error::NotExr);
            }
            result => result?,
        }
        if magic != MAGIC {
            return Err(Error::NotExr);
        }
        let file_bytes = file.metadata()?.len();
        let context = Context::read(file)?;
        let parsed = parse(&context)?;
        check_claims(&parsed.header, parsed.compression_code, file_bytes)?;
        Ok(Self {
            context,
            header: parsed.header,
            names: parsed.names,
        })
    }

    /// The header of the first part.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// Reads channels of the first part, at full resolution, as f32.
    ///
    /// - `names`: channels as the header names them, in any order.
    ///
    /// Returns for each name the rows of the data window from the top down. Halves are converted
    /// exactly, unsigned integers are rounded to the nearest f32.
    ///
    /// # Errors
    /// [`Error::Invalid`] for an unknown name, [`Error::Unsupported`] for a subsampled channel or a
    /// compression that this version of the library lacks, [`Error::Broken`] for damaged samples.
    pub fn read_channels(&self, names: &[&str]) -> Result<Vec<Vec<f32>>, Error> {
        let indices = names
            .iter()
            .map(|name| self.channel_index(name))
            .collect::<Result<Vec<_>, _>>()?;
        let mut images = names
            .iter()
            .map(|_| self.allocate_image())
            .collect::<Result<Vec<_>, _>>()?;
        if self.header.is_tiled {
            self.read_tiles(&indices, &mut images)?;
        } else {
            self.read_rows(&indices, &mut images)?;
        }
        Ok(images)
    }

    fn channel_index(&self, name: &str) -> Result<usize, Error> {
        let channels = &self.header.channels;
        let Some(index) = channels.iter().position(|channel| channel.name == name) else {
            return Err(Error::Invalid(format!("there is no channel {name}")));
        };
        if channels[index].sampling != (1, 1) {
            let (x, y) = channels[index].sampling;
            return Err(Error::Unsupported(format!(
                "channel {name} is subsampled ({x}×{y}), which is not read"
            )));
        }
        Ok(index)
    }

    fn allocate_image(&self) -> Result<Vec<f32>, Error> {
        let window = self.header.data_window;
        let count = u64::from(window.width()) * u64::from(window.height());
        let mut image = Vec::new();
        let length = usize::try_from(count).map_err(|_| Error::OutOfMemory(count))?;
        image
            .try_reserve_exact(length)
            .map_err(|_| Error::OutOfMemory(count.saturating_mul(4)))?;
        image.resize(length, 0.0);
        Ok(image)
    }

    fn read_rows(&self, indices: &[usize], images: &mut [Vec<f32>]) -> Result<(), Error> {
        let window = self.header.data_window;
        let mut chunk_rows = 0;
        // SAFETY: an open context and a valid place to write to.
        let code =
            unsafe { c::exr_get_scanlines_per_chunk(self.context.raw(), 0, &mut chunk_rows) };
        self.context.check(code)?;
        let rows = usize::try_from(chunk_rows).unwrap_or(0).max(1);
        for top in (0..window.height() as usize).step_by(rows) {
            let y = (i64::from(window.min[1]) + top as i64) as i32;
            let mut chunk = empty_chunk();
            // SAFETY: as above.
            self.context.check(unsafe {
                c::exr_read_scanline_chunk_info(self.context.raw(), 0, y, &mut chunk)
            })?;
            let max_width = window.width() as usize;
            let bounds = ChunkBounds {
                left: 0,
                top,
                max_width,
                max_height: rows,
            };
            self.read_chunk(&chunk, &bounds, indices, images)?;
        }
        Ok(())
    }

    fn read_tiles(&self, indices: &[usize], images: &mut [Vec<f32>]) -> Result<(), Error> {
        let window = self.header.data_window;
        let (mut tile_width, mut tile_height) = (0, 0);
        // SAFETY: an open context and valid places to write to.
        self.context.check(unsafe {
            c::exr_get_tile_sizes(
                self.context.raw(),
                0,
                0,
                0,
                &mut tile_width,
                &mut tile_height,
            )
        })?;
        let max_width = usize::try_from(tile_width).unwrap_or(0).max(1);
        let max_height = usize::try_from(tile_height).unwrap_or(0).max(1);
        for (row, top) in (0..window.height() as usize)
            .step_by(max_height)
            .enumerate()
        {
            for (column, left) in (0..window.width() as usize).step_by(max_width).enumerate() {
                let mut chunk = empty_chunk();
                let (x, y) = (column as i32, row as i32);
                // SAFETY: as above.
                self.context.check(unsafe {
                    c::exr_read_tile_chunk_info(self.context.raw(), 0, x, y, 0, 0, &mut chunk)
                })?;
                let bounds = ChunkBounds {
                    left,
                    top,
                    max_width,
                    max_height,
                };
                self.read_chunk(&chunk, &bounds, indices, images)?;
            }
        }
        Ok(())
    }

    /// Decodes one chunk into scratch memory of exactly its size and copies it into the images.
    fn read_chunk(
        &self,
        chunk: &c::exr_chunk_info_t,
        bounds: &ChunkBounds,
        indices: &[usize],
        images: &mut [Vec<f32>],
    ) -> Result<(), Error> {
        let image_width = self.header.data_window.width() as usize;
        let image_height = self.header.data_window.height() as usize;
        let width = usize::try_from(chunk.width).unwrap_or(0);
        let height = usize::try_from(chunk.height).unwrap_or(0);
        if width > bounds.max_width.min(image_width - bounds.left)
            || height > bounds.max_height.min(image_height - bounds.top)
        {
            return Err(Error::Broken(
                "a chunk is larger than its place in the image".to_owned(),
            ));
        }
        let mut scratches: Vec<Scratch> = indices
            .iter()
            .map(|&index| Scratch::new(self.header.channels[index].sample_type, width * height))
            .collect();
        let planes: Vec<c::openexr_shim_plane> = indices
            .iter()
            .zip(&mut scratches)
            .map(|(&index, scratch)| c::openexr_shim_plane {
                name: self.names[index].as_ptr(),
                samples: scratch.as_mut_ptr(),
                width: chunk.width,
                height: chunk.height,
                type_: self.header.channels[index].sample_type.to_code(),
            })
            .collect();
        // SAFETY: an open context and a chunk that it described; each plane has `width` × `height`
        // samples of its type, and the shim refuses a chunk that would not fit.
        self.context.check(unsafe {
            c::openexr_shim_decode(
                self.context.raw(),
                chunk,
                planes.as_ptr(),
                planes.len() as i32,
            )
        })?;
        for (scratch, image) in scratches.iter().zip(images) {
            for row in 0..height {
                let start = (bounds.top + row) * image_width + bounds.left;
                scratch.copy_row(row * width, &mut image[start..start + width]);
            }
        }
        Ok(())
    }
}

impl Scratch {
    fn new(sample_type: SampleType, length: usize) -> Self {
        match sample_type {
            SampleType::Uint => Self::Uint(vec![0; length]),
            SampleType::Half => Self::Half(vec![0; length]),
            SampleType::Float => Self::Float(vec![0.0; length]),
        }
    }

    fn as_mut_ptr(&mut self) -> *mut std::ffi::c_void {
        match self {
            Self::Uint(samples) => samples.as_mut_ptr().cast(),
            Self::Half(samples) => samples.as_mut_ptr().cast(),
            Self::Float(samples) => samples.as_mut_ptr().cast(),
        }
    }

    /// Converts as many samples as `row` has, beginning at `start`.
    fn copy_row(&self, start: usize, row: &mut [f32]) {
        let end = start + row.len();
        match self {
            Self::Uint(samples) => {
                for (value, &sample) in row.iter_mut().zip(&samples[start..end]) {
                    *value = sample as f32;
                }
            }
            Self::Half(samples) => {
                for (value, &sample) in row.iter_mut().zip(&samples[start..end]) {
                    *value = f16::from_bits(sample).to_f32();
                }
            }
            Self::Float(samples) => row.copy_from_slice(&samples[start..end]),
        }
    }
}

/// A place for the library to describe a chunk in.
fn empty_chunk() -> c::exr_chunk_info_t {
    c::exr_chunk_info_t {
        idx: 0,
        start_x: 0,
        start_y: 0,
        height: 0,
        width: 0,
        level_x: 0,
        level_y: 0,
        type_: 0,
        compression: 0,
        data_offset: 0,
        packed_size: 0,
        unpacked_size: 0,
        sample_count_data_offset: 0,
        sample_count_table_size: 0,
    }
}

/// Refuses an empty image and one that cannot come from a file of this size.
fn check_claims(
    header: &Header,
    compression: c::exr_compression_t,
    file_bytes: u64,
) -> Result<(), Error> {
    let (width, height) = (header.data_window.width(), header.data_window.height());
    if width == 0 || height == 0 || width > i32::MAX as u32 / 4 {
        let message = format!("the data window cannot have {width}×{height} pixels");
        return Err(Error::Broken(message));
    }
    // A subsampled channel has fewer samples, but such files are not read anyway.
    let pixel_bytes: u64 = header
        .channels
        .iter()
        .filter(|channel| channel.sampling == (1, 1))
        .map(|channel| channel.sample_type.bytes())
        .sum();
    let claimed = u64::from(width)
        .saturating_mul(u64::from(height))
        .saturating_mul(pixel_bytes);
    if claimed / max_expansion(compression) > file_bytes {
        return Err(Error::Oversized {
            claimed,
            file: file_bytes,
        });
    }
    Ok(())
}

/// How many times larger than its packed form a chunk can be, at most and with room to spare.
fn max_expansion(compression: c::exr_compression_t) -> u64 {
    match compression {
        c::EXR_COMPRESSION_NONE => 1,
        // Two bytes stand for a run of at most 128.
        c::EXR_COMPRESSION_RLE => 64,
        // Deflate reaches 1032; a Huffman run about 500.
        c::EXR_COMPRESSION_ZIPS | c::EXR_COMPRESSION_ZIP | c::EXR_COMPRESSION_PIZ => 1100,
        // Deflate of three bytes in place of four.
        c::EXR_COMPRESSION_PXR24 => 1500,
        // Three bytes stand for 16 halves; float channels are not packed.
        c::EXR_COMPRESSION_B44 | c::EXR_COMPRESSION_B44A => 11,
        // Blocks of 64 samples that are all one value, then deflate.
        _ => 1 << 17,
    }
}
