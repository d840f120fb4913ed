//! [`Effects`]: which effects exist in a compiled pipeline. Runs on the GPU and on the CPU.
//!
//! The set is fixed before the kernel is compiled: on the GPU it is a specialisation constant, on
//! the CPU a constant that each loop is compiled for. Effects that are not in the set are not in
//! the machine code.

use bytemuck::{Pod, Zeroable};

/// A set of effects, one bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub struct Effects(u32);

macro_rules! effects {
    ($($(#[$doc:meta])* $constant:ident = $bit:literal, $name:literal;)*) => {
        impl Effects {
            $($(#[$doc])* pub const $constant: Self = Self(1 << $bit);)*

            /// Every effect.
            pub const ALL: Self = Self($((1 << $bit))|*);

            /// Each effect with its name.
            #[cfg(not(target_arch = "spirv"))]
            pub const NAMED: &[(Self, &'static str)] = &[$((Self::$constant, $name)),*];
        }
    };
}

effects! {
    /// More than one sample a pixel, each at its own place in the pixel.
    ANTIALIASING = 0, "antialiasing";
    /// A lamp at the eye, for scenes that have no light of their own.
    HEADLAMP = 1, "headlamp";
    /// Point lights and a sun without extent.
    HARD_SHADOWS = 2, "hard-shadows";
    /// Spherical lights and a sun with an extent, sampled by solid angle.
    SOFT_SHADOWS = 3, "soft-shadows";
    /// Ambient light that is darker where something is near.
    AMBIENT_OCCLUSION = 4, "ambient-occlusion";
    /// Metal as smooth as a mirror.
    MIRROR = 5, "mirror";
    /// Rough metal.
    ROUGH_METAL = 6, "rough-metal";
    /// Glass, solid or hollow.
    GLASS = 7, "glass";
    /// Spheres that emit light.
    EMISSION = 8, "emission";
    /// Light that diffuse surfaces reflect onto each other.
    INTERREFLECTION = 9, "interreflection";
    /// A lens with an extent: what is out of focus is blurred.
    DEFOCUS = 10, "defocus";
    /// Spheres that move while the shutter is open.
    MOTION_BLUR = 11, "motion-blur";
    /// A homogeneous medium.
    FOG = 12, "fog";
    /// A sky that changes from the horizon to the zenith.
    SKY_GRADIENT = 13, "sky-gradient";
    /// The disc of the sun.
    SUN = 14, "sun";
    /// An image of the surroundings as the sky.
    ENVIRONMENT = 15, "environment";
    /// A background that is transparent in the image.
    TRANSPARENT_BACKGROUND = 16, "transparent-background";
    /// A diffuse base under a clear coat.
    PLASTIC = 17, "plastic";
    /// Spheres so large, or so far from the origin, that where a ray meets them is computed in
    /// pairs of floats.
    LARGE_SPHERES = 18, "large-spheres";
    /// Glass in other glass, or that overlaps it, and cameras in glass.
    NESTED_GLASS = 19, "nested-glass";
    /// So many lights that they are chosen by what they may give to a place.
    MANY_LIGHTS = 20, "many-lights";
    /// Glass that lets the light of lights without extent through, unbent.
    CLEAR_SHADOWS = 21, "clear-shadows";
    /// A filter other than the pixel itself.
    FILTER = 22, "filter";
    /// A limit on the indirect light of each sample.
    CLAMP = 23, "clamp";
    /// Light that reaches a surface by one sphere, through glass or mirrored, found exactly.
    CAUSTICS = 24, "caustics";
}

impl Effects {
    /// The effects that this build of the kernel has. That is every effect, unless the environment
    /// variable `SPHERULE_EFFECTS` gave the bits of a set when it was compiled. Then the code of
    /// all other effects is left out from the first compilation on; specialised pipelines are
    /// measured against this.
    pub const BUILT: Self = match option_env!("SPHERULE_EFFECTS") {
        None => Self::ALL,
        Some(bits) => Self(Self::ALL.0 & parse(bits)),
    };

    /// The number of the specialisation constant that holds the set that the pipeline is compiled
    /// for.
    pub const SPEC_ID: u32 = 2;
    /// The number of the specialisation constant that is 1 if the pipeline is for scenes that call
    /// for exactly that set, and 0 if the launch says which of them the scene calls for.
    pub const IS_EXACT_SPEC_ID: u32 = 3;

    /// No effect.
    pub const NONE: Self = Self(0);

    /// Effects for which paths continue beyond their first vertex.
    pub const BOUNCING: Self = Self::MIRROR
        .and(Self::ROUGH_METAL)
        .and(Self::PLASTIC)
        .and(Self::GLASS)
        .and(Self::INTERREFLECTION)
        .and(Self::FOG);

    /// The set with these bits; bits that stand for no effect are dropped.
    #[inline]
    #[must_use]
    pub const fn from_bits(bits: u32) -> Self {
        Self(bits & Self::ALL.0)
    }

    /// The bits of the set, the value of the specialisation constant.
    #[inline]
    #[must_use]
    pub const fn to_bits(self) -> u32 {
        self.0
    }

    /// Whether the set holds any of `effects`.
    #[inline]
    #[must_use]
    pub const fn any(self, effects: Self) -> bool {
        self.0 & effects.0 != 0
    }

    /// The effects of both sets.
    #[inline]
    #[must_use]
    pub const fn and(self, effects: Self) -> Self {
        Self(self.0 | effects.0)
    }

    /// The effects that are in both sets.
    #[inline]
    #[must_use]
    pub const fn within(self, effects: Self) -> Self {
        Self(self.0 & effects.0)
    }

    /// The effects of this set that are not in `effects`.
    #[inline]
    #[must_use]
    pub const fn without(self, effects: Self) -> Self {
        Self(self.0 & !effects.0)
    }

    /// Whether the set is empty.
    #[inline]
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }
}

/// Reads a decimal number; characters that are not digits are skipped.
const fn parse(text: &str) -> u32 {
    let bytes = text.as_bytes();
    let mut number: u32 = 0;
    let mut index = 0;
    while index < bytes.len() {
        let digit = bytes[index].wrapping_sub(b'0');
        if digit < 10 {
            number = number.wrapping_mul(10).wrapping_add(digit as u32);
        }
        index += 1;
    }
    number
}
