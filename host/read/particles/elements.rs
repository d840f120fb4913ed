//! The elements: their van der Waals radii, and their colours in molecular viewers.
//!
//! Radii in ångström from A. Bondi, J. Phys. Chem. 68 (1964) 441, completed for the main group by
//! M. Mantina et al., J. Phys. Chem. A 113 (2009) 5806, and for the other elements by S. Alvarez,
//! Dalton Trans. 42 (2013) 8617. Elements that none of them lists have 2.00. Colours are Jmol's, in
//! sRGB.

use Source::{Alvarez, Bondi, Mantina, Unknown};

/// The source of a radius.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// Bondi 1964.
    Bondi,
    /// Mantina et al. 2009.
    Mantina,
    /// Alvarez 2013.
    Alvarez,
    /// None; the radius is a placeholder.
    Unknown,
}

/// An element as a viewer shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Element {
    /// The symbol.
    pub symbol: &'static str,
    /// The van der Waals radius in ångström.
    pub radius: f32,
    /// The source of the radius.
    pub source: Source,
    /// The colour, `0xRRGGBB` in sRGB.
    pub color: u32,
}

/// Stands for an unknown element.
pub const UNKNOWN: Element = element("?", 2.0, Unknown, 0xFF1493);

/// The element with this symbol; case is ignored.
#[must_use]
pub fn by_symbol(symbol: &str) -> Option<&'static Element> {
    // Deuterium and tritium, as structures from neutron diffraction name them.
    let symbol = match symbol {
        "D" | "d" | "T" | "t" => "H",
        other => other,
    };
    ELEMENTS
        .iter()
        .find(|element| element.symbol.eq_ignore_ascii_case(symbol))
}

/// The element with this atomic number.
#[must_use]
pub fn by_number(number: usize) -> Option<&'static Element> {
    ELEMENTS.get(number.checked_sub(1)?)
}

const fn element(symbol: &'static str, radius: f32, source: Source, color: u32) -> Element {
    Element {
        symbol,
        radius,
        source,
        color,
    }
}

/// The elements in order of their atomic number.
#[rustfmt::skip]
static ELEMENTS: &[Element] = &[
    element("H", 1.10, Mantina, 0xFFFFFF),
    element("He", 1.40, Bondi, 0xD9FFFF),
    element("Li", 1.81, Mantina, 0xCC80FF),
    element("Be", 1.53, Mantina, 0xC2FF00),
    element("B", 1.92, Mantina, 0xFFB5B5),
    element("C", 1.70, Bondi, 0x909090),
    element("N", 1.55, Bondi, 0x3050F8),
    element("O", 1.52, Bondi, 0xFF0D0D),
    element("F", 1.47, Bondi, 0x90E050),
    element("Ne", 1.54, Bondi, 0xB3E3F5),
    element("Na", 2.27, Bondi, 0xAB5CF2),
    element("Mg", 1.73, Bondi, 0x8AFF00),
    element("Al", 1.84, Mantina, 0xBFA6A6),
    element("Si", 2.10, Bondi, 0xF0C8A0),
    element("P", 1.80, Bondi, 0xFF8000),
    element("S", 1.80, Bondi, 0xFFFF30),
    element("Cl", 1.75, Bondi, 0x1FF01F),
    element("Ar", 1.88, Bondi, 0x80D1E3),
    element("K", 2.75, Bondi, 0x8F40D4),
    element("Ca", 2.31, Mantina, 0x3DFF00),
    element("Sc", 2.58, Alvarez, 0xE6E6E6),
    element("Ti", 2.46, Alvarez, 0xBFC2C7),
    element("V", 2.42, Alvarez, 0xA6A6AB),
    element("Cr", 2.45, Alvarez, 0x8A99C7),
    element("Mn", 2.45, Alvarez, 0x9C7AC7),
    element("Fe", 2.44, Alvarez, 0xE06633),
    element("Co", 2.40, Alvarez, 0xF090A0),
    element("Ni", 2.40, Alvarez, 0x50D050),
    element("Cu", 2.38, Alvarez, 0xC88033),
    element("Zn", 2.39, Alvarez, 0x7D80B0),
    element("Ga", 1.87, Bondi, 0xC28F8F),
    element("Ge", 2.11, Mantina, 0x668F8F),
    element("As", 1.85, Bondi, 0xBD80E3),
    element("Se", 1.90, Bondi, 0xFFA100),
    element("Br", 1.83, Mantina, 0xA62929),
    element("Kr", 2.02, Bondi, 0x5CB8D1),
    element("Rb", 3.03, Mantina, 0x702EB0),
    element("Sr", 2.49, Mantina, 0x00FF00),
    element("Y", 2.75, Alvarez, 0x94FFFF),
    element("Zr", 2.52, Alvarez, 0x94E0E0),
    element("Nb", 2.56, Alvarez, 0x73C2C9),
    element("Mo", 2.45, Alvarez, 0x54B5B5),
    element("Tc", 2.44, Alvarez, 0x3B9E9E),
    element("Ru", 2.46, Alvarez, 0x248F8F),
    element("Rh", 2.44, Alvarez, 0x0A7D8C),
    element("Pd", 2.15, Alvarez, 0x006985),
    element("Ag", 2.53, Alvarez, 0xC0C0C0),
    element("Cd", 2.49, Alvarez, 0xFFD98F),
    element("In", 1.93, Bondi, 0xA67573),
    element("Sn", 2.17, Bondi, 0x668080),
    element("Sb", 2.06, Mantina, 0x9E63B5),
    element("Te", 2.06, Bondi, 0xD47A00),
    element("I", 1.98, Bondi, 0x940094),
    element("Xe", 2.16, Bondi, 0x429EB0),
    element("Cs", 3.43, Mantina, 0x57178F),
    element("Ba", 2.68, Mantina, 0x00C900),
    element("La", 2.98, Alvarez, 0x70D4FF),
    element("Ce", 2.88, Alvarez, 0xFFFFC7),
    element("Pr", 2.92, Alvarez, 0xD9FFC7),
    element("Nd", 2.95, Alvarez, 0xC7FFC7),
    element("Pm", 2.00, Unknown, 0xA3FFC7),
    element("Sm", 2.90, Alvarez, 0x8FFFC7),
    element("Eu", 2.87, Alvarez, 0x61FFC7),
    element("Gd", 2.83, Alvarez, 0x45FFC7),
    element("Tb", 2.79, Alvarez, 0x30FFC7),
    element("Dy", 2.87, Alvarez, 0x1FFFC7),
    element("Ho", 2.81, Alvarez, 0x00FF9C),
    element("Er", 2.83, Alvarez, 0x00E675),
    element("Tm", 2.79, Alvarez, 0x00D452),
    element("Yb", 2.80, Alvarez, 0x00BF38),
    element("Lu", 2.74, Alvarez, 0x00AB24),
    element("Hf", 2.63, Alvarez, 0x4DC2FF),
    element("Ta", 2.53, Alvarez, 0x4DA6FF),
    element("W", 2.57, Alvarez, 0x2194D6),
    element("Re", 2.49, Alvarez, 0x267DAB),
    element("Os", 2.48, Alvarez, 0x266696),
    element("Ir", 2.41, Alvarez, 0x175487),
    element("Pt", 2.29, Alvarez, 0xD0D0E0),
    element("Au", 2.32, Alvarez, 0xFFD123),
    element("Hg", 2.45, Alvarez, 0xB8B8D0),
    element("Tl", 1.96, Bondi, 0xA6544D),
    element("Pb", 2.02, Bondi, 0x575961),
    element("Bi", 2.07, Mantina, 0x9E4FB5),
    element("Po", 1.97, Mantina, 0xAB5C00),
    element("At", 2.02, Mantina, 0x754F45),
    element("Rn", 2.20, Mantina, 0x428296),
    element("Fr", 3.48, Mantina, 0x420066),
    element("Ra", 2.83, Mantina, 0x007D00),
    element("Ac", 2.80, Alvarez, 0x70ABFA),
    element("Th", 2.93, Alvarez, 0x00BAFF),
    element("Pa", 2.88, Alvarez, 0x00A1FF),
    element("U", 2.71, Alvarez, 0x008FFF),
    element("Np", 2.82, Alvarez, 0x0080FF),
    element("Pu", 2.81, Alvarez, 0x006BFF),
    element("Am", 2.83, Alvarez, 0x545CF2),
    element("Cm", 3.05, Alvarez, 0x785CE3),
    element("Bk", 3.40, Alvarez, 0x8A4FE3),
    element("Cf", 3.05, Alvarez, 0xA136D4),
    element("Es", 2.70, Alvarez, 0xB31FD4),
    element("Fm", 2.00, Unknown, 0xB31FBA),
    element("Md", 2.00, Unknown, 0xB30DA6),
    element("No", 2.00, Unknown, 0xBD0D87),
    element("Lr", 2.00, Unknown, 0xC70066),
    element("Rf", 2.00, Unknown, 0xCC0059),
    element("Db", 2.00, Unknown, 0xD1004F),
    element("Sg", 2.00, Unknown, 0xD90045),
    element("Bh", 2.00, Unknown, 0xE00038),
    element("Hs", 2.00, Unknown, 0xE6002E),
    element("Mt", 2.00, Unknown, 0xEB0026),
];
