//! The look of particles: atoms become spheres with the van der Waals radius and the colour of
//! their element. One scene unit is one ångström.

use glam::{DVec3, Vec3};
use rayon::prelude::*;
use spherule_kernel::{Material, Sphere};

use crate::film::encode::from_srgb;
use crate::plural::count_of;
use crate::read::particles::Atom;
use crate::read::particles::elements::{self, Element};
use crate::scene::world::GRAIN;
use crate::scene::{World, origin};

/// A world of these atoms, with one material for each element that occurs. Its origin is at this
/// point of the atoms' coordinates.
#[must_use]
pub fn world(atoms: &[Atom], origin: DVec3) -> World {
    let mut world = World::default();
    let elements = elements_of(atoms);
    let is_unknown = |element: &Element| element.symbol == elements::UNKNOWN.symbol;
    if elements.iter().any(|element| is_unknown(element)) {
        let unknown = atoms
            .par_iter()
            .filter(|atom| is_unknown(atom.element))
            .count();
        tracing::warn!(
            "{} of unknown element: drawn pink, with a radius of {} Å",
            count_of(unknown, "atom"),
            elements::UNKNOWN.radius
        );
    }
    // A material's id is the position of its element in the list.
    for element in &elements {
        world.add_material(Material::diffuse(linear(element.color)));
    }
    let id_of = |atom: &Atom| {
        let is_its = |element: &&Element| element.symbol == atom.element.symbol;
        elements.iter().position(is_its).map_or(0, |id| id as u32)
    };
    let atoms = || atoms.par_iter().with_min_len(GRAIN);
    world.spheres = atoms()
        .map(|atom| Sphere::new((atom.position - origin).as_vec3(), atom.element.radius))
        .collect();
    world.material_ids = atoms().map(id_of).collect();
    world
}

/// The point that becomes the origin of a scene of these atoms; `None` if they are near their own.
#[must_use]
pub fn origin(atoms: &[Atom]) -> Option<DVec3> {
    let nothing = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (low, high) = atoms
        .par_iter()
        .with_min_len(GRAIN)
        .map(|atom| {
            let radius = f64::from(atom.element.radius);
            (atom.position - radius, atom.position + radius)
        })
        .reduce(|| nothing, |a, b| (a.0.min(b.0), a.1.max(b.1)));
    origin::near((low + high) * 0.5, low.distance(high))
}

/// The elements that occur, in the order of their first atoms. They are few, so a linear search is
/// fastest.
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

/// Converts `0xRRGGBB` in sRGB to linear Rec. 709.
fn linear(color: u32) -> Vec3 {
    let channel = |shift: u32| from_srgb(((color >> shift) & 0xff) as f32 / 255.0);
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
            position: DVec3::ZERO,
            element: carbon,
        };
        let world = world(&[atom, atom], DVec3::ZERO);
        assert_eq!(world.materials.len(), 1);
        assert_eq!(world.material_ids, [0, 0]);
        assert_eq!(world.spheres[0].radius(), 1.7);
    }

    #[test]
    fn far_atoms_keep_their_places() {
        let element = elements::by_symbol("c").expect("carbon");
        let at = |by: f64| {
            [0.123, 1.5, -2.456].map(|x| Atom {
                position: DVec3::new(x, 2.0 * x, -x) + by,
                element,
            })
        };
        assert_eq!(origin(&at(0.0)), None);
        assert_eq!(origin(&[]), None);
        let far = at(-3e6);
        let origin = origin(&far).expect("an origin");
        assert_eq!(origin, DVec3::splat(-3e6));
        for (far, near) in world(&far, origin).spheres.iter().zip(at(0.0)) {
            let off = far.center() - near.position.as_vec3();
            assert!(off.abs().max_element() < 1e-6, "{off}");
        }
    }

    #[test]
    fn materials_stand_in_the_order_of_their_first_atoms() {
        let symbols = ["o", "h", "c", "h"];
        let atoms: Vec<Atom> = symbols
            .iter()
            .flat_map(|symbol| {
                let element = elements::by_symbol(symbol).expect("an element");
                let position = DVec3::ZERO;
                std::iter::repeat_n(Atom { position, element }, GRAIN)
            })
            .collect();
        let ids = world(&atoms, DVec3::ZERO).material_ids;
        assert_eq!([0, 1, 2, 3].map(|run| ids[run * GRAIN]), [0, 1, 2, 1]);
    }
}
