//! The buffers and accessors of a glTF file (glTF 2.0 specification, section 3.6).

use crate::input::InputError;
use crate::input::check::{Checker, MAX_MAGNITUDE};
use crate::input::files::{InputFiles, relative_to};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use glam::DVec4;
use gltf::accessor::{DataType, Dimensions};
use gltf::buffer::Source;
use std::collections::BTreeMap;
use std::path::Path;

/// The buffers of a glTF file, read on demand.
pub(super) struct GltfBuffers<'a> {
    check: Checker<'a>,
    /// The binary chunk of a `.glb` file.
    blob: Option<Vec<u8>>,
    /// The buffers read so far, by index.
    read: BTreeMap<usize, Vec<u8>>,
}

impl<'a> GltfBuffers<'a> {
    pub(super) fn new(file: &'a Path, blob: Option<Vec<u8>>) -> GltfBuffers<'a> {
        GltfBuffers {
            check: Checker { file },
            blob,
            read: BTreeMap::new(),
        }
    }

    pub(super) fn refuse<T>(&self, key: &str, message: impl Into<String>) -> Result<T, InputError> {
        self.check.refuse(key, message)
    }

    /// The elements of an accessor, at least one, of 1 to 4 `components`. `name` is its key in messages.
    pub(super) fn numbers(
        &mut self,
        accessor: &gltf::Accessor,
        components: usize,
        name: &str,
    ) -> Result<Vec<DVec4>, InputError> {
        let dimensions = match accessor.dimensions() {
            Dimensions::Scalar => 1,
            Dimensions::Vec2 => 2,
            Dimensions::Vec3 => 3,
            Dimensions::Vec4 => 4,
            _ => 0,
        };
        if dimensions != components {
            let message = format!("elements do not have {components} components");
            return self.refuse(name, message);
        }
        let (Some(view), None) = (accessor.view(), accessor.sparse()) else {
            return self.refuse(name, "sparse accessors are not read; export it without");
        };
        let number: fn(&[u8]) -> f64 = match (accessor.data_type(), accessor.normalized()) {
            (DataType::F32, _) => |b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]).into(),
            (DataType::I8, true) => |b| (f64::from(b[0] as i8) / 127.0).max(-1.0),
            (DataType::U8, true) => |b| f64::from(b[0]) / 255.0,
            (DataType::I16, true) => {
                |b| (f64::from(i16::from_le_bytes([b[0], b[1]])) / 32767.0).max(-1.0)
            }
            (DataType::U16, true) => |b| f64::from(u16::from_le_bytes([b[0], b[1]])) / 65535.0,
            _ => {
                return self.refuse(
                    name,
                    "components are neither floats nor normalized integers",
                );
            }
        };
        let size = accessor.data_type().size();
        let stride = view.stride().unwrap_or(size * components);
        let offset = view.offset().saturating_add(accessor.offset());
        let count = accessor.count();
        let bytes = self.buffer(&view.buffer())?;
        let bytes_of = |i: usize| {
            let start = i.checked_mul(stride)?.checked_add(offset)?;
            bytes.get(start..start.checked_add(size * components)?)
        };
        // Before allocation: the count may be wrong.
        if count == 0 || bytes_of(count - 1).is_none() {
            return self.refuse(name, "is empty or goes beyond its buffer");
        }
        let element = |i: usize| -> Option<DVec4> {
            let mut element = DVec4::ZERO;
            for (i, bytes) in bytes_of(i)?.chunks_exact(size).enumerate() {
                element[i] = number(bytes);
            }
            Some(element).filter(|element| element.abs().max_element() <= MAX_MAGNITUDE)
        };
        match (0..count).map(element).collect() {
            Some(elements) => Ok(elements),
            None => self.refuse(name, "contains a number that is not finite or too large"),
        }
    }

    fn buffer(&mut self, buffer: &gltf::Buffer) -> Result<&[u8], InputError> {
        let index = buffer.index();
        if !self.read.contains_key(&index) {
            let bytes = self.load(buffer)?;
            self.read.insert(index, bytes);
        }
        Ok(&self.read[&index])
    }

    fn load(&self, buffer: &gltf::Buffer) -> Result<Vec<u8>, InputError> {
        let name = format!("buffers[{}].uri", buffer.index());
        let uri = match (buffer.source(), &self.blob) {
            (Source::Uri(uri), _) => uri,
            (Source::Bin, Some(blob)) if buffer.index() == 0 => return Ok(blob.clone()),
            (Source::Bin, _) => return self.refuse(&name, "is missing"),
        };
        if let Some(data) = uri.strip_prefix("data:") {
            let data = data.split_once(";base64,").map(|(_, data)| data);
            return match data.map(|data| BASE64_STANDARD.decode(data)) {
                Some(Ok(bytes)) => Ok(bytes),
                _ => self.refuse(&name, "is not data in base64"),
            };
        }
        let Ok(decoded) = urlencoding::decode(uri) else {
            return self.refuse(&name, "is not UTF-8");
        };
        let file = relative_to(self.check.file, &decoded);
        InputFiles::default().read_reference(&file, self.check.file, &name)
    }
}
