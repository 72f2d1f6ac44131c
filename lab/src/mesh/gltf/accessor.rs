//! Numbers out of glTF's accessors: strided, normalised, sparse, and checked against the buffers.
//!
//! The `gltf` crate's own reader trusts counts and offsets and panics where they lie; this one
//! gives an error. It reads every component as `f32` or as `u32`.

use gltf::json::Root;
use gltf::json::accessor::{Accessor, ComponentType, Type};
use gltf::json::validation::Checked;

use crate::mesh::source::{MAX_ELEMENTS, Problem};

/// The bytes of a file's buffers, in its order.
pub(super) type Buffers = [Vec<u8>];

pub(super) fn corrupt(what: &str) -> Problem {
    Problem::Corrupt(what.to_owned())
}

/// Reads accessor `index` as rows of `N` floats, shape (count, N).
///
/// Integers are divided by their largest value where the accessor says `normalized`. Where the
/// accessor has fewer than `N` components the rest is 1 (the alpha of an RGB colour); more are cut.
pub(super) fn floats<const N: usize>(
    root: &Root,
    buffers: &Buffers,
    index: usize,
) -> Result<Vec<[f32; N]>, Problem> {
    let accessor = root.accessors.get(index).ok_or_else(|| corrupt("an accessor is missing"))?;
    let layout = Layout::of(accessor)?;
    let mut rows = vec![[1.0; N]; layout.count];
    let read = |row: &mut [f32; N], bytes: &[u8]| {
        for (value, component) in row.iter_mut().zip(bytes.chunks_exact(layout.component_bytes())) {
            *value = float(component, layout.component, accessor.normalized);
        }
    };
    match accessor.buffer_view {
        Some(view) => {
            let source = Strided::of(root, buffers, view.value(), accessor_offset(accessor)?)?;
            source.check(layout.count, layout.row_bytes())?;
            for (row, i) in rows.iter_mut().zip(0..) {
                read(row, source.row(i, layout.row_bytes()));
            }
        }
        None if accessor.sparse.is_some() => rows.fill([0.0; N]),
        None => return Err(corrupt("an accessor has no data")),
    }
    if let Some(sparse) = &accessor.sparse {
        let count = usize_of(sparse.count.0)?;
        if count > layout.count {
            return Err(corrupt("a sparse accessor replaces more than it has"));
        }
        let Checked::Valid(index_type) = sparse.indices.component_type else {
            return Err(corrupt("a sparse accessor's index type is unknown"));
        };
        let index_bytes = bytes_of(index_type.0);
        let offset = usize_of(sparse.indices.byte_offset.0)?;
        let indices = Strided::of(root, buffers, sparse.indices.buffer_view.value(), offset)?;
        indices.check(count, index_bytes)?;
        let offset = usize_of(sparse.values.byte_offset.0)?;
        let values = Strided::of(root, buffers, sparse.values.buffer_view.value(), offset)?;
        values.check(count, layout.row_bytes())?;
        for i in 0..count {
            let target = integer(indices.row(i, index_bytes), index_type.0) as usize;
            let row = rows
                .get_mut(target)
                .ok_or_else(|| corrupt("a sparse accessor replaces what is not there"))?;
            read(row, values.row(i, layout.row_bytes()));
        }
    }
    Ok(rows)
}

/// Reads accessor `index` as rows of `N` unsigned integers, shape (count, N): indices and joints.
pub(super) fn integers<const N: usize>(
    root: &Root,
    buffers: &Buffers,
    index: usize,
) -> Result<Vec<[u32; N]>, Problem> {
    let accessor = root.accessors.get(index).ok_or_else(|| corrupt("an accessor is missing"))?;
    let layout = Layout::of(accessor)?;
    if !matches!(layout.component, ComponentType::U8 | ComponentType::U16 | ComponentType::U32) {
        return Err(corrupt("an accessor of indices does not hold unsigned integers"));
    }
    if accessor.sparse.is_some() {
        return Err(corrupt("an accessor of indices is sparse"));
    }
    let view = accessor.buffer_view.ok_or_else(|| corrupt("an accessor has no data"))?;
    let source = Strided::of(root, buffers, view.value(), accessor_offset(accessor)?)?;
    source.check(layout.count, layout.row_bytes())?;
    let rows = (0..layout.count).map(|i| {
        let mut row = [0; N];
        let bytes = source.row(i, layout.row_bytes()).chunks_exact(layout.component_bytes());
        for (value, component) in row.iter_mut().zip(bytes) {
            *value = integer(component, layout.component);
        }
        row
    });
    Ok(rows.collect())
}

/// How an accessor's elements lie in memory.
struct Layout {
    count: usize,
    component: ComponentType,
    components: usize,
}

impl Layout {
    fn of(accessor: &Accessor) -> Result<Self, Problem> {
        let Checked::Valid(component) = accessor.component_type else {
            return Err(corrupt("an accessor's component type is unknown"));
        };
        let components = match accessor.type_ {
            Checked::Valid(Type::Scalar) => 1,
            Checked::Valid(Type::Vec2) => 2,
            Checked::Valid(Type::Vec3) => 3,
            Checked::Valid(Type::Vec4) => 4,
            // Matrices of floats have no padding; others do not occur in what is read here.
            Checked::Valid(Type::Mat4) => 16,
            _ => return Err(corrupt("an accessor's type is not one that meshes have")),
        };
        let count = usize_of(accessor.count.0)?;
        if count > MAX_ELEMENTS {
            return Err(Problem::TooLarge(MAX_ELEMENTS));
        }
        Ok(Self { count, component: component.0, components })
    }

    fn component_bytes(&self) -> usize {
        bytes_of(self.component)
    }

    fn row_bytes(&self) -> usize {
        self.component_bytes() * self.components
    }
}

/// The bytes of a buffer view from an offset on, and the step from one element to the next.
struct Strided<'a> {
    bytes: &'a [u8],
    stride: Option<usize>,
}

impl<'a> Strided<'a> {
    fn of(root: &Root, buffers: &'a Buffers, view: usize, offset: usize) -> Result<Self, Problem> {
        // A stride of zero means elements without gaps, as no stride does.
        let stride = root.buffer_views.get(view).and_then(|v| v.byte_stride).map(|s| s.0);
        let stride = stride.filter(|stride| *stride > 0);
        let bytes = view_bytes(root, buffers, view)?
            .get(offset..)
            .ok_or_else(|| corrupt("an accessor starts beyond its buffer view"))?;
        Ok(Self { bytes, stride })
    }

    /// Proves that `count` elements of `size` bytes are there, so that `row` cannot fail.
    fn check(&self, count: usize, size: usize) -> Result<(), Problem> {
        let stride = self.stride.unwrap_or(size);
        let end = match count {
            0 => Some(0),
            _ => stride.checked_mul(count - 1).and_then(|start| start.checked_add(size)),
        };
        match end {
            Some(end) if end <= self.bytes.len() => Ok(()),
            _ => Err(corrupt("an accessor reaches beyond its buffer view")),
        }
    }

    fn row(&self, index: usize, size: usize) -> &'a [u8] {
        let start = index * self.stride.unwrap_or(size);
        &self.bytes[start..start + size]
    }
}

/// The bytes of a buffer view.
pub(super) fn view_bytes<'a>(
    root: &Root,
    buffers: &'a Buffers,
    view: usize,
) -> Result<&'a [u8], Problem> {
    let view = root.buffer_views.get(view).ok_or_else(|| corrupt("a buffer view is missing"))?;
    let buffer = buffers.get(view.buffer.value()).ok_or_else(|| corrupt("a buffer is missing"))?;
    let start = usize_of(view.byte_offset.map_or(0, |offset| offset.0))?;
    let end = start.checked_add(usize_of(view.byte_length.0)?);
    end.and_then(|end| buffer.get(start..end))
        .ok_or_else(|| corrupt("a buffer view reaches beyond its buffer"))
}

fn accessor_offset(accessor: &Accessor) -> Result<usize, Problem> {
    usize_of(accessor.byte_offset.map_or(0, |offset| offset.0))
}

fn usize_of(value: u64) -> Result<usize, Problem> {
    usize::try_from(value).map_err(|_| corrupt("a size is impossible"))
}

fn bytes_of(component: ComponentType) -> usize {
    match component {
        ComponentType::I8 | ComponentType::U8 => 1,
        ComponentType::I16 | ComponentType::U16 => 2,
        ComponentType::U32 | ComponentType::F32 => 4,
    }
}

/// One little-endian unsigned component of at most four bytes.
fn integer(bytes: &[u8], component: ComponentType) -> u32 {
    let mut word = [0; 4];
    for (to, from) in word.iter_mut().zip(bytes.iter().take(bytes_of(component))) {
        *to = *from;
    }
    u32::from_le_bytes(word)
}

/// One component as a float; see `floats` for `normalized`.
fn float(bytes: &[u8], component: ComponentType, normalized: bool) -> f32 {
    let word = integer(bytes, component);
    let (value, largest) = match component {
        ComponentType::F32 => return f32::from_bits(word),
        ComponentType::U8 => (word as f32, 255.0),
        ComponentType::U16 => (word as f32, 65_535.0),
        ComponentType::U32 => (word as f32, u32::MAX as f32),
        ComponentType::I8 => (f32::from(word as u8 as i8), 127.0),
        ComponentType::I16 => (f32::from(word as u16 as i16), 32_767.0),
    };
    if normalized { (value / largest).max(-1.0) } else { value }
}
