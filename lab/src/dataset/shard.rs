//! One object as bytes: see `FORMAT.md` in this folder.

use crc::{CRC_32_ISO_HDLC, Crc};
use miniz_oxide::deflate::compress_to_vec;
use miniz_oxide::inflate::decompress_to_vec_with_limit;
use vantage_core::objectives::{Face, FaceSet, Objective, Surface};
use vantage_core::{Pose, Quat, Scores, Vec3};

use super::data::{ObjectData, State, TestViews, Trajectory, Views};
use super::error::ShardError;
use crate::label::Label;

/// The version of the format.
pub(super) const VERSION: u32 = 1;
/// The length of the header in bytes.
pub(super) const HEADER: usize = 32;

const MAGIC: [u8; 8] = *b"VTGSHARD";
const CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);
/// 6 of 10: on 24 objects, 9 saves 1 % of the bytes and takes six times as long.
const COMPRESSION: u8 = 6;
/// No body is larger; a header that claims more is damaged.
const MOST_BYTES: usize = 1 << 30;

/// The checksum used throughout: CRC-32 (ISO-HDLC), as in PNG and zip.
pub(super) fn checksum(bytes: &[u8]) -> u32 {
    CRC.checksum(bytes)
}

/// Which object of which data set a shard belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Tag {
    /// Of the data set's parameters.
    pub fingerprint: u32,
    /// Of the object, from 0.
    pub number: u32,
}

/// A whole shard.
pub(super) fn encode(data: &ObjectData, image_size: u32, tag: Tag) -> Vec<u8> {
    let body = encode_body(data, image_size);
    let packed = compress_to_vec(&body, COMPRESSION);
    let mut bytes = Vec::with_capacity(HEADER + packed.len());
    bytes.extend(MAGIC);
    let lengths = [body.len() as u32, packed.len() as u32];
    for number in [VERSION, tag.fingerprint, tag.number, lengths[0], lengths[1]] {
        bytes.extend(number.to_le_bytes());
    }
    let mut digest = CRC.digest();
    digest.update(&bytes);
    digest.update(&packed);
    bytes.extend(digest.finalize().to_le_bytes());
    bytes.extend(packed);
    bytes
}

/// Whether the bytes are a whole, undamaged shard of this object; its compressed body.
pub(super) fn check(bytes: &[u8], tag: Tag) -> Result<(usize, &[u8]), ShardError> {
    let mut source = Source(bytes);
    if source.bytes(8, "header").map_err(|_| ShardError::Foreign)? != MAGIC {
        return Err(ShardError::Foreign);
    }
    let mut number = || source.u32("header");
    let version = number()?;
    if version != VERSION {
        return Err(ShardError::Version { expected: VERSION, got: version });
    }
    let found = Tag { fingerprint: number()?, number: number()? };
    let (length, packed_length, crc) = (number()? as usize, number()? as u64, number()?);
    let packed = source.0;
    if packed.len() as u64 != packed_length {
        let (expected, got) = (HEADER as u64 + packed_length, bytes.len() as u64);
        return Err(ShardError::Length { expected, got });
    }
    let mut digest = CRC.digest();
    digest.update(&bytes[..HEADER - 4]);
    digest.update(packed);
    if digest.finalize() != crc {
        return Err(ShardError::Checksum);
    }
    if found != tag {
        return Err(ShardError::Mismatch);
    }
    if length > MOST_BYTES {
        return Err(ShardError::Compression);
    }
    Ok((length, packed))
}

/// The object of a shard.
pub(super) fn decode(bytes: &[u8], image_size: u32, tag: Tag) -> Result<ObjectData, ShardError> {
    let (length, packed) = check(bytes, tag)?;
    let body = decompress_to_vec_with_limit(packed, length).map_err(|_| ShardError::Compression)?;
    if body.len() != length {
        return Err(ShardError::Compression);
    }
    decode_body(&body, image_size)
}

/// A body before it is compressed.
pub(super) fn encode_body(data: &ObjectData, image_size: u32) -> Vec<u8> {
    let mut sink = Sink(Vec::new());
    for text in [&data.name, &data.class] {
        sink.u32(text.len() as u32);
        sink.0.extend(text.as_bytes());
    }
    sink.u32(image_size);
    sink.u32(data.faces.len() as u32);
    sink.u32(data.train.poses.len() as u32);
    sink.u32(data.validation.poses.len() as u32);
    sink.u32(data.test.poses.len() as u32);
    sink.u32(data.trajectories.len() as u32);
    sink.u32(data.trajectories.first().map_or(0, |walk| walk.views.len()) as u32);
    sink.f32(data.texture_limit);
    for face in &data.faces {
        sink.vec3(face.centroid);
        sink.vec3(face.normal);
        sink.f32(face.area_share);
        sink.f32(face.complexity);
    }
    for views in [&data.train, &data.validation] {
        sink.poses(&views.poses);
        for label in &views.labels {
            sink.label(label);
        }
        sink.photos(&views.photos, image_size as usize);
    }
    sink.poses(&data.test.poses);
    for pixels in data.test.masks.chunks(8) {
        let bits = pixels.iter().enumerate().map(|(bit, &pixel)| (pixel & 1) << bit);
        sink.0.push(bits.fold(0, |byte, bit| byte | bit));
    }
    for walk in &data.trajectories {
        for view in &walk.views {
            sink.0.extend(view.to_le_bytes());
        }
        for state in &walk.states {
            for objective in Objective::ALL {
                sink.f32(state.scores.get(objective));
            }
            for gain in state.gains.iter().flatten() {
                sink.f32(*gain);
            }
        }
    }
    sink.0
}

/// The object of a body.
pub(super) fn decode_body(body: &[u8], image_size: u32) -> Result<ObjectData, ShardError> {
    let mut source = Source(body);
    let name = source.text("name")?;
    let class = source.text("class")?;
    if source.u32("image size")? != image_size {
        return Err(ShardError::Field("image size"));
    }
    let faces = source.count("number of faces", 32)?;
    let mut views = || source.count("number of views", 28);
    let (train, validation, test) = (views()?, views()?, views()?);
    let walks = source.u32("trajectories")? as usize;
    let steps = source.count("trajectories", 2)?;
    if walks > 0 && steps == 0 {
        return Err(ShardError::Field("trajectories"));
    }
    let texture_limit = source.f32("texture limit")?;
    if !texture_limit.is_finite() {
        return Err(ShardError::Field("texture limit"));
    }
    let faces = source.items(faces, |source| {
        Ok(Face {
            centroid: source.vec3("faces")?,
            normal: source.vec3("faces")?,
            area_share: source.f32("faces")?,
            complexity: source.f32("faces")?,
        })
    })?;
    if Surface::try_new(&faces, texture_limit).is_err() {
        return Err(ShardError::Field("faces"));
    }
    let mut views = |count: usize| -> Result<Views, ShardError> {
        let poses = source.poses(count)?;
        let labels = source.items(count, |source| source.label(faces.len()))?;
        let photos = source.photos(count, image_size as usize)?;
        Ok(Views { poses, labels, photos })
    };
    let (train, validation) = (views(train)?, views(validation)?);
    let poses = source.poses(test)?;
    let pixels = (image_size as usize).pow(2).checked_mul(test);
    let pixels = pixels.ok_or(ShardError::Field("masks"))?;
    let bits = source.bytes(pixels.div_ceil(8), "masks")?;
    let masks = (0..pixels).map(|pixel| bits[pixel / 8] >> (pixel % 8) & 1).collect();
    let test = TestViews { poses, masks };

    let candidates = train.poses.len();
    let trajectories = source.items(walks, |source| source.trajectory(steps, candidates))?;
    if !source.0.is_empty() {
        return Err(ShardError::Field("end"));
    }
    Ok(ObjectData { name, class, faces, texture_limit, train, validation, test, trajectories })
}

struct Sink(Vec<u8>);

impl Sink {
    fn u32(&mut self, number: u32) {
        self.0.extend(number.to_le_bytes());
    }

    fn f32(&mut self, number: f32) {
        self.0.extend(number.to_le_bytes());
    }

    fn vec3(&mut self, v: Vec3) {
        v.to_array().into_iter().for_each(|number| self.f32(number));
    }

    /// Seven bits a byte, the lowest first; the top bit says that more follow.
    fn varint(&mut self, mut number: u32) {
        while number >= 128 {
            self.0.push(number as u8 | 128);
            number >>= 7;
        }
        self.0.push(number as u8);
    }

    fn poses(&mut self, poses: &[Pose]) {
        for pose in poses {
            self.vec3(pose.position());
            pose.rotation().to_array().into_iter().for_each(|number| self.f32(number));
        }
    }

    fn label(&mut self, label: &Label) {
        let sighting = label.sighting();
        self.u32(sighting.pixels);
        self.u32(sighting.textured_background);
        for word in label.words() {
            self.u32(*word);
        }
        for &textured in sighting.textured {
            self.varint(textured);
        }
    }

    /// Channel by channel and row by row, each byte less its left neighbour.
    fn photos(&mut self, photos: &[u8], side: usize) {
        for photo in photos.chunks_exact(side * side * 4) {
            for channel in 0..4 {
                for row in photo.chunks_exact(side * 4) {
                    let mut left = 0u8;
                    for pixel in row.chunks_exact(4) {
                        self.0.push(pixel[channel].wrapping_sub(left));
                        left = pixel[channel];
                    }
                }
            }
        }
    }
}

/// What is left to read. Every length is checked before it is used.
struct Source<'a>(&'a [u8]);

impl<'a> Source<'a> {
    fn bytes(&mut self, count: usize, field: &'static str) -> Result<&'a [u8], ShardError> {
        let (bytes, rest) = self.0.split_at_checked(count).ok_or(ShardError::Field(field))?;
        self.0 = rest;
        Ok(bytes)
    }

    fn array<const N: usize>(&mut self, field: &'static str) -> Result<[u8; N], ShardError> {
        let (bytes, rest) = self.0.split_first_chunk().ok_or(ShardError::Field(field))?;
        self.0 = rest;
        Ok(*bytes)
    }

    fn u32(&mut self, field: &'static str) -> Result<u32, ShardError> {
        Ok(u32::from_le_bytes(self.array(field)?))
    }

    fn f32(&mut self, field: &'static str) -> Result<f32, ShardError> {
        Ok(f32::from_le_bytes(self.array(field)?))
    }

    fn vec3(&mut self, field: &'static str) -> Result<Vec3, ShardError> {
        Ok(Vec3::new(self.f32(field)?, self.f32(field)?, self.f32(field)?))
    }

    /// A number of things of at least `size` bytes each, no more than can follow.
    fn count(&mut self, field: &'static str, size: usize) -> Result<usize, ShardError> {
        let count = self.u32(field)? as usize;
        if count > self.0.len() / size { Err(ShardError::Field(field)) } else { Ok(count) }
    }

    fn items<T>(
        &mut self,
        count: usize,
        mut item: impl FnMut(&mut Self) -> Result<T, ShardError>,
    ) -> Result<Vec<T>, ShardError> {
        (0..count).map(|_| item(self)).collect()
    }

    fn text(&mut self, field: &'static str) -> Result<String, ShardError> {
        let length = self.count(field, 1)?;
        let text = std::str::from_utf8(self.bytes(length, field)?);
        text.map(str::to_owned).map_err(|_| ShardError::Field(field))
    }

    fn varint(&mut self, field: &'static str) -> Result<u32, ShardError> {
        let mut number = 0u64;
        for shift in (0..35).step_by(7) {
            let [byte] = self.array(field)?;
            number |= u64::from(byte & 127) << shift;
            if byte < 128 {
                return u32::try_from(number).map_err(|_| ShardError::Field(field));
            }
        }
        Err(ShardError::Field(field))
    }

    fn poses(&mut self, count: usize) -> Result<Vec<Pose>, ShardError> {
        self.items(count, |source| {
            let position = source.vec3("poses")?;
            let mut number = || source.f32("poses");
            let rotation = Quat::from_xyzw(number()?, number()?, number()?, number()?);
            Pose::try_new(position, rotation).map_err(|_| ShardError::Field("poses"))
        })
    }

    fn label(&mut self, faces: usize) -> Result<Label, ShardError> {
        const FIELD: &str = "labels";
        let (pixels, textured_background) = (self.u32(FIELD)?, self.u32(FIELD)?);
        let words = self.items(FaceSet::words_for(faces), |source| source.u32(FIELD))?;
        let seen = FaceSet::new(&words);
        if seen.iter().any(|face| face >= faces) {
            return Err(ShardError::Field(FIELD));
        }
        let textured = self.items(seen.len(), |source| source.varint(FIELD))?;
        Ok(Label::from_parts(words, textured, textured_background, pixels))
    }

    fn photos(&mut self, count: usize, side: usize) -> Result<Vec<u8>, ShardError> {
        let size = (side * side * 4).checked_mul(count).ok_or(ShardError::Field("photos"))?;
        let planes = self.bytes(size, "photos")?;
        let mut photos = vec![0; size];
        let area = side * side;
        for (photo, planes) in photos.chunks_exact_mut(area * 4).zip(planes.chunks_exact(area * 4))
        {
            for (channel, plane) in planes.chunks_exact(area).enumerate() {
                for (place, row) in plane.chunks_exact(side).enumerate() {
                    let mut value = 0u8;
                    for (x, &difference) in row.iter().enumerate() {
                        value = value.wrapping_add(difference);
                        photo[(place * side + x) * 4 + channel] = value;
                    }
                }
            }
        }
        Ok(photos)
    }

    fn trajectory(&mut self, steps: usize, candidates: usize) -> Result<Trajectory, ShardError> {
        const FIELD: &str = "trajectories";
        let views = self.items(steps, |source| {
            let view = u16::from_le_bytes(source.array(FIELD)?);
            if usize::from(view) < candidates { Ok(view) } else { Err(ShardError::Field(FIELD)) }
        })?;
        let states = self.items(steps, |source| {
            let mut four = || -> Result<[f32; 4], ShardError> {
                let mut number = || source.f32(FIELD);
                Ok([number()?, number()?, number()?, number()?])
            };
            let [coverage, geometry, diversity, texture] = four()?;
            let scores = Scores { coverage, geometry, diversity, texture };
            let gains = (0..candidates).map(|_| four()).collect::<Result<Vec<_>, _>>()?;
            Ok(State { scores, gains })
        })?;
        Ok(Trajectory { views, states })
    }
}
