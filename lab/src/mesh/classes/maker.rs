//! What every class is made with: chance, colours, the object in the making, and a fineness.

use vantage_core::Vec3;

use super::paint::{Palette, Pattern, Rgb, plain};
use crate::mesh::kit::Chance;
use crate::mesh::shapes::Object;
use crate::mesh::{Material, Mesh};

/// The side of the pictures, in pixels.
const PICTURE: u32 = 96;

pub(super) struct Maker {
    pub chance: Chance,
    pub palette: Palette,
    object: Object,
    fineness: f32,
    coarse: f32,
}

impl Maker {
    /// `coarse` in (0, 1] makes the same object with fewer triangles.
    pub fn new(mut chance: Chance, coarse: f32) -> Self {
        let palette = Palette::new(&mut chance);
        let fineness = chance.between(0.75, 1.2) * coarse;
        Self { chance, palette, object: Object::default(), fineness, coarse }
    }

    /// A number of cells, more or fewer by how fine the object is; at least 3.
    pub fn cells(&self, usual: u32) -> u32 {
        ((usual as f32 * self.fineness + 0.5) as u32).max(3)
    }

    /// A number of cells that is fewer only where the object is made coarser; at least 3.
    pub fn few_cells(&self, usual: u32) -> u32 {
        ((usual as f32 * self.coarse + 0.5) as u32).max(3)
    }

    /// The side of a cell of flat parts, longer where the object is made coarser.
    pub fn cell(&self, usual: f32) -> f32 {
        usual / self.coarse
    }

    pub fn between(&mut self, low: f32, high: f32) -> f32 {
        self.chance.between(low, high)
    }

    /// Whether something happens that does so `share` of the time.
    pub fn maybe(&mut self, share: f32) -> bool {
        self.chance.unit() < share
    }

    /// One of several.
    pub fn pick<T: Copy>(&mut self, choice: &[T]) -> T {
        choice[self.chance.below(choice.len() as u32) as usize]
    }

    /// A colour of the object's palette.
    pub fn colour(&mut self) -> Rgb {
        self.palette.colour(&mut self.chance)
    }

    pub fn material(&mut self, material: Material) -> u16 {
        self.object.material(material)
    }

    /// A plain material of a colour.
    pub fn plain(&mut self, colour: Rgb) -> u16 {
        self.material(plain(colour))
    }

    /// A plain material of the palette.
    pub fn any_plain(&mut self) -> u16 {
        let colour = self.colour();
        self.plain(colour)
    }

    /// A material of one of these patterns in the palette's colours.
    pub fn patterned(&mut self, choice: &[Pattern]) -> u16 {
        let colours = [self.colour(), self.colour(), self.colour()];
        self.printed(choice, colours)
    }

    /// A material of one of these patterns in these colours.
    pub fn printed(&mut self, choice: &[Pattern], colours: [Rgb; 3]) -> u16 {
        let pattern = Pattern::one_of(&mut self.chance, choice);
        let material = pattern.material(colours, PICTURE, &mut self.chance);
        self.material(material)
    }

    /// A material of any pattern.
    pub fn covered(&mut self) -> u16 {
        self.patterned(&Pattern::ALL)
    }

    pub fn add(&mut self, material: u16, part: Mesh) {
        self.object.add(material, part);
    }

    /// A part and its mirror image beyond the plane x = 0.
    pub fn add_pair(&mut self, material: u16, part: Mesh) {
        self.add(material, part.clone());
        self.add(material, part.mirrored());
    }

    pub fn finished(self) -> Mesh {
        self.object.finished()
    }
}

impl Mesh {
    /// Mirrored in the plane x = 0.
    pub(super) fn mirrored(self) -> Self {
        let flip = Vec3::new(-1.0, 1.0, 1.0);
        let mut mesh = self;
        for position in &mut mesh.positions {
            *position *= flip;
        }
        for normal in mesh.normals.iter_mut().flatten() {
            // `inside_out` turns it around once more.
            *normal *= -flip;
        }
        mesh.inside_out()
    }
}
