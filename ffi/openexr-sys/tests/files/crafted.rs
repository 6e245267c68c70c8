//! EXR files put together byte by byte, for what the writer does not make.

/// Sample of a channel at a pixel; exact in every sample type.
pub(crate) fn value(x: u32, y: u32, channel: u32) -> u32 {
    1 + x + 10 * y + 100 * channel
}

/// An uncompressed file with the pixel types of the format: 0 uint, 1 half, 2 float.
pub(crate) struct Crafted<'a> {
    channels: &'a [(&'a str, u32)],
    size: (u32, u32),
    tile: Option<(u32, u32)>,
    /// Value of the attribute; the samples stay as they are.
    pub(crate) compression: u8,
    /// Sampling of every channel in both directions; the samples stay as they are.
    pub(crate) sampling: u32,
    /// Calls the part deep.
    pub(crate) is_deep: bool,
}

impl<'a> Crafted<'a> {
    /// Rows from the top down. Files beyond a million pixels have a header only.
    pub(crate) fn scanlines(channels: &'a [(&'a str, u32)], width: u32, height: u32) -> Self {
        let size = (width, height);
        Self {
            channels,
            size,
            tile: None,
            compression: 0,
            sampling: 1,
            is_deep: false,
        }
    }

    /// Tiles of one level. `channels` sorted by name.
    pub(crate) fn tiles(
        channels: &'a [(&'a str, u32)],
        width: u32,
        height: u32,
        tile: (u32, u32),
    ) -> Self {
        Self {
            tile: Some(tile),
            ..Self::scanlines(channels, width, height)
        }
    }

    pub(crate) fn bytes(&self) -> Vec<u8> {
        let mut file = self.header();
        if self.size.0 * self.size.1 > 1_000_000 {
            return file;
        }
        let chunks = self.chunks();
        let mut offset = file.len() + 8 * chunks.len();
        for chunk in &chunks {
            file.extend((offset as u64).to_le_bytes());
            offset += chunk.len();
        }
        file.extend(chunks.concat());
        file
    }

    fn header(&self) -> Vec<u8> {
        let flags = (u32::from(self.is_deep) << 11)
            | (u32::from(self.tile.is_some() && !self.is_deep) << 9);
        let mut file = vec![0x76, 0x2f, 0x31, 0x01];
        file.extend((2 | flags).to_le_bytes());
        let mut attribute = |name: &str, kind: &str, value: &[u8]| {
            file.extend([name.as_bytes(), b"\0", kind.as_bytes(), b"\0"].concat());
            file.extend((value.len() as u32).to_le_bytes());
            file.extend(value);
        };
        let mut list = Vec::new();
        for (name, kind) in self.channels {
            list.extend([name.as_bytes(), b"\0"].concat());
            list.extend(
                [*kind, 0, self.sampling, self.sampling]
                    .map(u32::to_le_bytes)
                    .concat(),
            );
        }
        list.push(0);
        attribute("channels", "chlist", &list);
        attribute("compression", "compression", &[self.compression]);
        let window = [0, 0, self.size.0 - 1, self.size.1 - 1]
            .map(u32::to_le_bytes)
            .concat();
        attribute("dataWindow", "box2i", &window);
        attribute("displayWindow", "box2i", &window);
        attribute("lineOrder", "lineOrder", &[0]);
        attribute("pixelAspectRatio", "float", &1.0_f32.to_le_bytes());
        attribute("screenWindowCenter", "v2f", &[0; 8]);
        attribute("screenWindowWidth", "float", &1.0_f32.to_le_bytes());
        if let Some((width, height)) = self.tile {
            let tiles = [&width.to_le_bytes()[..], &height.to_le_bytes(), &[0]].concat();
            attribute("tiles", "tiledesc", &tiles);
        }
        if self.is_deep {
            attribute("type", "string", b"deepscanline");
            attribute("name", "string", b"deep");
            attribute("version", "int", &1_u32.to_le_bytes());
            attribute("chunkCount", "int", &self.size.1.to_le_bytes());
            attribute("maxSamplesPerPixel", "int", &1_u32.to_le_bytes());
        }
        file.push(0);
        file
    }

    fn chunks(&self) -> Vec<Vec<u8>> {
        let (width, height) = self.size;
        let (tile_width, tile_height) = self.tile.unwrap_or((width, 1));
        let mut chunks = Vec::new();
        for top in (0..height).step_by(tile_height as usize) {
            for left in (0..width).step_by(tile_width as usize) {
                let place = match self.tile {
                    Some(_) => vec![left / tile_width, top / tile_height, 0, 0],
                    None => vec![top],
                };
                let columns = left..(left + tile_width).min(width);
                let rows = top..(top + tile_height).min(height);
                let samples: Vec<u8> = rows.flat_map(|y| self.row(y, columns.clone())).collect();
                let mut chunk: Vec<u8> = place.into_iter().flat_map(u32::to_le_bytes).collect();
                chunk.extend((samples.len() as u32).to_le_bytes());
                chunk.extend(samples);
                chunks.push(chunk);
            }
        }
        chunks
    }

    fn row(&self, y: u32, columns: std::ops::Range<u32>) -> Vec<u8> {
        let mut bytes = Vec::new();
        for (channel, (_, kind)) in self.channels.iter().enumerate() {
            for x in columns.clone() {
                let value = value(x, y, channel as u32);
                match kind {
                    0 => bytes.extend(value.to_le_bytes()),
                    1 => bytes.extend(half::f16::from_f32(value as f32).to_le_bytes()),
                    _ => bytes.extend((value as f32).to_le_bytes()),
                }
            }
        }
        bytes
    }
}
