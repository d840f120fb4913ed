//! Molecules: atoms become spheres with the van der Waals radius and the colour of their
//! element. One scene unit is one ångström.

pub mod elements;
pub mod pdb;
pub mod xyz;

use std::path::Path;

use glam::Vec3;
use rayon::prelude::*;
use spherule_kernel::{Material, Sphere};

use super::text::read_text;
use super::world::{GRAIN, World};
use crate::error::{Error, Place, Result, SceneError};
use crate::plural::count_of;
use crate::scene::limits::{MAX_LENGTH, MAX_SPHERES};
use elements::Element;

/// An atom of a molecule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Atom {
    /// Where it is, in ångström.
    pub position: Vec3,
    /// What it is.
    pub element: &'static Element,
}

/// Reads the molecule at `path` as a world of spheres.
///
/// # Errors
///
/// [`Error::Scene`] with the line that is wrong.
pub(super) fn load(
    path: &Path,
    parse: fn(&str) -> std::result::Result<Vec<Atom>, WrongLine>,
) -> Result<World> {
    let text = read_text(path)?;
    match parse(&text) {
        Ok(atoms) if atoms.len() > MAX_SPHERES => Err(Error::Scene(SceneError::without_place(
            path,
            format!(
                "the file has {}, more than {MAX_SPHERES}",
                count_of(atoms.len(), "atom")
            ),
            "render it in parts",
        ))),
        Ok(atoms) => Ok(world(&atoms)),
        Err(wrong) => Err(wrong.into_error(path, text)),
    }
}

/// Whether an atom may be so far from the origin, along an axis; its radius is less than what the
/// largest floats below the limit are apart.
fn is_coordinate(number: f32) -> bool {
    number.abs() < MAX_LENGTH
}

/// What is said of coordinates that are none.
const TOO_FAR: &str = "coordinates are in ångström, and below 1e18";

/// A world of these atoms, with one material for each element that occurs.
#[must_use]
pub fn world(atoms: &[Atom]) -> World {
    let mut world = World::default();
    let elements = elements_of(atoms);
    let is_unknown = |element: &Element| element.symbol == elements::UNKNOWN.symbol;
    if elements.iter().any(|element| is_unknown(element)) {
        let unknown = atoms
            .par_iter()
            .filter(|atom| is_unknown(atom.element))
            .count();
        tracing::warn!(
            "{} of an element that cannot be told: drawn pink, with a radius of {} Å",
            count_of(unknown, "atom"),
            elements::UNKNOWN.radius
        );
    }
    // Each element's material has its place among them.
    for element in &elements {
        world.add_material(Material::diffuse(linear(element.color)));
    }
    let id_of = |atom: &Atom| {
        let is_its = |element: &&Element| element.symbol == atom.element.symbol;
        elements.iter().position(is_its).map_or(0, |id| id as u32)
    };
    let atoms = || atoms.par_iter().with_min_len(GRAIN);
    world.spheres = atoms()
        .map(|atom| Sphere::new(atom.position, atom.element.radius))
        .collect();
    world.material_ids = atoms().map(id_of).collect();
    world
}

/// The elements that occur, in the order in which they do: few, so that looking through them is fastest.
fn elements_of(atoms: &[Atom]) -> Vec<&'static Element> {
    let add = |mut known: Vec<&'static Element>, element: &'static Element| {
        if !known.iter().any(|other| other.symbol == element.symbol) {
            known.push(element);
        }
        known
    };
    atoms
        .par_chunks(GRAIN)
        .map(|some| some.iter().map(|atom| atom.element).fold(Vec::new(), add))
        .reduce(Vec::new, |before, after| {
            after.into_iter().fold(before, add)
        })
}

/// What is wrong with a line of a molecule file.
#[derive(Debug)]
pub struct WrongLine {
    /// The line, counted from zero.
    line: usize,
    message: String,
    label: &'static str,
    help: &'static str,
}

impl WrongLine {
    fn new(
        line: usize,
        message: impl Into<String>,
        label: &'static str,
        help: &'static str,
    ) -> Self {
        Self {
            line,
            message: message.into(),
            label,
            help,
        }
    }

    fn into_error(self, path: &Path, text: String) -> Error {
        let start = text
            .split_inclusive('\n')
            .take(self.line)
            .map(str::len)
            .sum::<usize>()
            .min(text.len());
        let length = text[start..]
            .find(['\r', '\n'])
            .unwrap_or(text.len() - start);
        Error::Scene(Box::new(SceneError {
            path: path.into(),
            message: self.message,
            help: self.help.into(),
            place: Some(Place {
                span: start..start + length,
                text,
                label: self.label.into(),
            }),
        }))
    }
}

/// From `0xRRGGBB` in sRGB to linear Rec. 709 (IEC 61966-2-1).
fn linear(color: u32) -> Vec3 {
    let channel = |shift: u32| {
        let encoded = ((color >> shift) & 0xff) as f32 / 255.0;
        if encoded <= 0.040_45 {
            encoded / 12.92
        } else {
            ((encoded + 0.055) / 1.055).powf(2.4)
        }
    };
    Vec3::new(channel(16), channel(8), channel(0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::encode::srgb;

    #[test]
    fn colours_survive_the_round_trip() {
        for color in [0x00_00_00, 0xFF_FF_FF, 0x90_90_90, 0xFF_0D_0D, 0x01_02_0A] {
            let back = linear(color)
                .to_array()
                .map(|channel| (srgb(channel) * 255.0).round() as u32);
            assert_eq!(back, [color >> 16, (color >> 8) & 0xff, color & 0xff]);
        }
    }

    #[test]
    fn equal_elements_share_a_material() {
        let carbon = elements::by_symbol("c").expect("carbon");
        let atom = Atom {
            position: Vec3::ZERO,
            element: carbon,
        };
        let world = world(&[atom, atom]);
        assert_eq!(world.materials.len(), 1);
        assert_eq!(world.material_ids, [0, 0]);
        assert_eq!(world.spheres[0].radius(), 1.7);
    }

    #[test]
    fn materials_stand_in_the_order_of_their_first_atoms() {
        let symbols = ["o", "h", "c", "h"];
        let atoms: Vec<Atom> = symbols
            .iter()
            .flat_map(|symbol| {
                let element = elements::by_symbol(symbol).expect("an element");
                let position = Vec3::ZERO;
                std::iter::repeat_n(Atom { position, element }, GRAIN)
            })
            .collect();
        let ids = world(&atoms).material_ids;
        assert_eq!([0, 1, 2, 3].map(|run| ids[run * GRAIN]), [0, 1, 2, 1]);
    }
}
