//! Reads Wavefront OBJ with MTL: polygons, texture coordinates, normals, vertex colours, `Kd` and
//! `map_Kd`.
//!
//! A reader of our own, because the crates that read OBJ panic on short or huge numbers. `Kd` and
//! vertex colours are taken as sRGB, as viewers do; the format does not say. Left out: curves,
//! lines, transparency, scale and offset of textures.

use std::collections::HashMap;

use glam::DVec3;
use vantage_core::{Vec2, Vec3};

use super::colour::{in_unit, linear_from_srgb};
use super::source::{Files, MAX_ELEMENTS, Problem, Warnings, decode_image};
use super::{Material, Mesh, Texture, Wrap};

/// One corner of a polygon: indices of its position, texture coordinate and normal.
#[derive(Clone, Copy)]
struct Corner {
    position: usize,
    uv: Option<usize>,
    normal: Option<usize>,
}

#[derive(Default)]
struct Reader {
    positions: Vec<Vec3>,
    colours: Vec<[f32; 3]>, // as long as positions, or shorter: white from there on
    uvs: Vec<Vec2>,
    normals: Vec<Vec3>,
    triangles: Vec<([Corner; 3], u16)>,
    materials: Vec<Material>,
    material_of_name: HashMap<String, u16>,
    material: u16,
}

pub(super) fn read(
    bytes: &[u8],
    files: Files<'_>,
    warnings: &mut Warnings,
) -> Result<Mesh, Problem> {
    if bytes.contains(&0) {
        return Err(Problem::UnknownFormat); // binary, whatever its name says
    }
    // A back slash at the end continues the line.
    let text = String::from_utf8_lossy(bytes).replace("\\\r\n", " ").replace("\\\n", " ");
    let mut reader =
        Reader { materials: vec![Material::plain("default", [0.6; 3])], ..Reader::default() };
    for (number, line) in text.lines().enumerate() {
        reader.line(line, files, warnings).map_err(|problem| match problem {
            Problem::Corrupt(how) => Problem::Corrupt(format!("line {}: {how}", number + 1)),
            other => other,
        })?;
    }
    Ok(reader.into_mesh())
}

impl Reader {
    fn line(
        &mut self,
        line: &str,
        files: Files<'_>,
        warnings: &mut Warnings,
    ) -> Result<(), Problem> {
        let line = line.trim();
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let rest = rest.trim();
        match keyword {
            "v" => {
                let numbers = numbers(rest, 3)?;
                self.positions.push(Vec3::new(numbers[0], numbers[1], numbers[2]));
                if let &[_, _, _, r, g, b, ..] = numbers.as_slice() {
                    self.colours.resize(self.positions.len() - 1, [1.0; 3]);
                    self.colours.push([r, g, b].map(|c| linear_from_srgb(in_unit(c))));
                }
            }
            "vt" => {
                let numbers = numbers(rest, 1)?;
                let v = numbers.get(1).copied().unwrap_or(0.0);
                self.uvs.push(Vec2::new(numbers[0], 1.0 - v)); // v points upwards in OBJ
            }
            "vn" => {
                let numbers = numbers(rest, 3)?;
                self.normals.push(Vec3::new(numbers[0], numbers[1], numbers[2]));
            }
            "f" | "fo" => self.polygon(rest)?,
            "usemtl" => match self.material_of_name.get(rest) {
                Some(&index) => self.material = index,
                None => {
                    warnings.add(format!("material {rest} is not defined; grey is used"));
                    self.material = 0;
                }
            },
            "mtllib" => match files.read(rest) {
                Ok(bytes) => self.library(&String::from_utf8_lossy(&bytes), files, warnings)?,
                Err(why) => warnings
                    .add(format!("the material library {rest} is left out ({why}); grey is used")),
            },
            _ => {}
        }
        if self.positions.len().max(self.triangles.len()) > MAX_ELEMENTS {
            return Err(Problem::TooLarge(MAX_ELEMENTS));
        }
        Ok(())
    }

    fn polygon(&mut self, text: &str) -> Result<(), Problem> {
        let corners: Vec<Corner> =
            text.split_whitespace().map(|word| self.corner(word)).collect::<Result<_, _>>()?;
        let points: Vec<DVec3> =
            corners.iter().map(|c| self.positions[c.position].as_dvec3()).collect();
        for triangle in triangulated(&points) {
            self.triangles.push((triangle.map(|i| corners[i]), self.material));
        }
        Ok(())
    }

    /// `position`, `position/uv`, `position//normal` or `position/uv/normal`, counted from 1, or
    /// from the last one backwards.
    fn corner(&self, word: &str) -> Result<Corner, Problem> {
        let bad = || Problem::Corrupt(format!("{word:.40} is not a corner of a face"));
        let mut parts = word.split('/');
        let mut index = |length: usize| -> Result<Option<usize>, Problem> {
            let Some(part) = parts.next().filter(|part| !part.is_empty()) else { return Ok(None) };
            let number: i64 = part.parse().map_err(|_| bad())?;
            let from_start = if number < 0 { number + length as i64 } else { number - 1 };
            match usize::try_from(from_start) {
                Ok(index) if index < length => Ok(Some(index)),
                _ => Err(Problem::Corrupt(format!("a face names {number} of {length}"))),
            }
        };
        let position = index(self.positions.len())?.ok_or_else(bad)?;
        let uv = index(self.uvs.len())?;
        let normal = index(self.normals.len())?;
        Ok(Corner { position, uv, normal })
    }

    fn library(
        &mut self,
        text: &str,
        files: Files<'_>,
        warnings: &mut Warnings,
    ) -> Result<(), Problem> {
        let mut current: Option<Material> = None;
        for line in text.lines() {
            let line = line.trim();
            let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
            let rest = rest.trim();
            if keyword == "newmtl" {
                self.finish_material(current.replace(Material::plain(rest, [0.6; 3])))?;
            }
            let Some(material) = &mut current else { continue };
            match keyword {
                "Kd" => match numbers(rest, 3) {
                    Ok(kd) => {
                        for (to, from) in material.base_colour.iter_mut().zip(&kd[..3]) {
                            *to = linear_from_srgb(in_unit(*from));
                        }
                    }
                    Err(_) => {
                        warnings.add(format!("the colour of {} is unreadable", material.name))
                    }
                },
                "map_Kd" => match texture(rest, files) {
                    Ok(texture) => material.texture = Some(texture),
                    Err(why) => warnings.add(format!(
                        "the texture of {} is left out ({why}); its base colour is used",
                        material.name
                    )),
                },
                _ => {}
            }
        }
        self.finish_material(current)
    }

    fn finish_material(&mut self, material: Option<Material>) -> Result<(), Problem> {
        let Some(mut material) = material else { return Ok(()) };
        // Some exporters write a black colour beside a picture and mean the picture alone.
        if material.texture.is_some() && material.base_colour[..3] == [0.0; 3] {
            material.base_colour = [1.0; 4];
        }
        let index = u16::try_from(self.materials.len())
            .map_err(|_| Problem::Corrupt("more than 65,535 materials".to_owned()))?;
        self.material_of_name.insert(material.name.clone(), index);
        self.materials.push(material);
        Ok(())
    }

    fn into_mesh(self) -> Mesh {
        let mut mesh = Mesh { positions: self.positions, ..Mesh::default() };
        let has_uvs = !self.uvs.is_empty();
        let has_normals = !self.normals.is_empty();
        let has_colours = !self.colours.is_empty();
        for (corners, material) in &self.triangles {
            mesh.faces.push(corners.map(|c| c.position as u32));
            mesh.face_material.push(*material);
            if has_uvs {
                mesh.uvs.push(corners.map(|c| c.uv.map_or(Vec2::ZERO, |i| self.uvs[i])));
            }
            if has_normals {
                mesh.normals
                    .push(corners.map(|c| c.normal.map_or(Vec3::ZERO, |i| self.normals[i])));
            }
            if has_colours {
                let white = [1.0; 3];
                mesh.colours.push(corners.map(|c| *self.colours.get(c.position).unwrap_or(&white)));
            }
        }
        mesh.materials = self.materials;
        mesh
    }
}

/// At least `least` numbers separated by blanks.
fn numbers(text: &str, least: usize) -> Result<Vec<f32>, Problem> {
    let values: Vec<f32> = text
        .split_whitespace()
        .map(|word| word.parse().map_err(|_| format!("{word:.40} is not a number")))
        .collect::<Result<_, String>>()
        .map_err(Problem::Corrupt)?;
    if values.len() < least {
        return Err(Problem::Corrupt(format!("{} of {least} numbers", values.len())));
    }
    Ok(values)
}

/// The picture that a `map_Kd` names, after its options.
fn texture(text: &str, files: Files<'_>) -> Result<Texture, String> {
    let (mut rest, mut wrap) = (text, Wrap::Repeat);
    while rest.starts_with('-') {
        let (option, tail) = rest.split_once(char::is_whitespace).ok_or("it names no file")?;
        rest = tail.trim_start();
        while let Some((word, tail)) = rest.split_once(char::is_whitespace)
            && (word.parse::<f32>().is_ok() || matches!(word, "on" | "off"))
        {
            if option == "-clamp" && word == "on" {
                wrap = Wrap::Clamp;
            }
            rest = tail.trim_start();
        }
    }
    let bytes = files.read(rest).map_err(|why| format!("{rest}: {why}"))?;
    Ok(Texture { image: decode_image(&bytes)?, wrap: [wrap; 2] })
}

/// Cuts a polygon, maybe concave, into triangles of indices by clipping ears.
///
/// Where no ear is found (a polygon that crosses itself), and for more than 1,000 corners, what is
/// left becomes a fan.
fn triangulated(points: &[DVec3]) -> Vec<[usize; 3]> {
    let n = points.len();
    let mut triangles = Vec::with_capacity(n.saturating_sub(2));
    let mut ring: Vec<usize> = (0..n).collect();
    // Twice the vector area (Newell): the normal even of a concave polygon.
    let normal: DVec3 = (0..n).map(|i| points[i].cross(points[(i + 1) % n])).sum();
    let turn = |a: usize, b: usize, c: usize| {
        (points[b] - points[a]).cross(points[c] - points[a]).dot(normal)
    };
    while ring.len() > 3 && n <= 1000 {
        let m = ring.len();
        let ear = (0..m).find(|&i| {
            let (a, b, c) = (ring[(i + m - 1) % m], ring[i], ring[(i + 1) % m]);
            let is_inside =
                |&p: &usize| turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
            turn(a, b, c) > 0.0
                && !ring.iter().filter(|&&p| p != a && p != b && p != c).any(is_inside)
        });
        let Some(i) = ear else { break };
        triangles.push([ring[(i + m - 1) % m], ring[i], ring[(i + 1) % m]]);
        ring.remove(i);
    }
    for pair in ring.get(1..).unwrap_or_default().windows(2) {
        triangles.push([ring[0], pair[0], pair[1]]);
    }
    triangles
}
