//! The memory layout of every type that crosses between host and device, as numbers. Runs on
//! the GPU and on the CPU, so that the two can be compared.

use crate::canary::{Operands, Outcome, WideOutcome};
use crate::optics::{Fresnel, Incidence};
use crate::walk::Walk;
use crate::{Camera, Hit, Launch, Material, Pixel, Ray, Sphere};
use core::mem::offset_of;

macro_rules! layouts {
    ($($name:literal = $value:expr;)*) => {
        /// What each entry of the table measures, in order: a type's size, or a field's offset.
        #[cfg(not(target_arch = "spirv"))]
        pub const NAMES: &[&str] = &[$($name),*];

        /// How many entries there are.
        pub const COUNT: usize = [$($value),*].len();

        /// Writes the table, in bytes, as the compiler of this very code sees it. A slice that
        /// is too short is filled as far as it goes.
        #[inline]
        pub fn write(table: &mut [u32]) {
            let mut index = 0;
            $(
                if index < table.len() {
                    table[index] = $value as u32;
                }
                index += 1;
            )*
            let _ = index;
        }
    };
}

layouts! {
    "size of Sphere" = size_of::<Sphere>();
    "size of Ray" = size_of::<Ray>();
    "Ray.origin" = offset_of!(Ray, origin);
    "Ray.t_min" = offset_of!(Ray, t_min);
    "Ray.direction" = offset_of!(Ray, direction);
    "Ray.t_max" = offset_of!(Ray, t_max);
    "size of Hit" = size_of::<Hit>();
    "Hit.t" = offset_of!(Hit, t);
    "Hit.sphere" = offset_of!(Hit, sphere);
    "size of Camera" = size_of::<Camera>();
    "Camera.eye" = offset_of!(Camera, eye);
    "Camera.forward" = offset_of!(Camera, forward);
    "Camera.right" = offset_of!(Camera, right);
    "Camera.up" = offset_of!(Camera, up);
    "size of Material" = size_of::<Material>();
    "Material.color" = offset_of!(Material, color);
    "size of Pixel" = size_of::<Pixel>();
    "size of Launch" = size_of::<Launch>();
    "Launch.camera" = offset_of!(Launch, camera);
    "Launch.background" = offset_of!(Launch, background);
    "Launch.first_of_tile" = offset_of!(Launch, first_of_tile);
    "Launch.image_size" = offset_of!(Launch, image_size);
    "Launch.tile_origin" = offset_of!(Launch, tile_origin);
    "Launch.tile_size" = offset_of!(Launch, tile_size);
    "Launch.first_sphere" = offset_of!(Launch, first_sphere);
    "Launch.sphere_count" = offset_of!(Launch, sphere_count);
    "size of Operands" = size_of::<Operands>();
    "Operands.a" = offset_of!(Operands, a);
    "Operands.b" = offset_of!(Operands, b);
    "size of Outcome" = size_of::<Outcome>();
    "Outcome.sum" = offset_of!(Outcome, sum);
    "Outcome.difference" = offset_of!(Outcome, difference);
    "Outcome.product" = offset_of!(Outcome, product);
    "Outcome.halves" = offset_of!(Outcome, halves);
    "Outcome.quotient" = offset_of!(Outcome, quotient);
    "Outcome.root" = offset_of!(Outcome, root);
    "Outcome.equals_itself" = offset_of!(Outcome, equals_itself);
    "Outcome.small_product" = offset_of!(Outcome, small_product);
    "size of Incidence" = size_of::<Incidence>();
    "Incidence.cosine" = offset_of!(Incidence, cosine);
    "Incidence.eta" = offset_of!(Incidence, eta);
    "size of Fresnel" = size_of::<Fresnel>();
    "Fresnel.reflectance" = offset_of!(Fresnel, reflectance);
    "Fresnel.cosine_transmitted" = offset_of!(Fresnel, cosine_transmitted);
    "size of Walk" = size_of::<Walk>();
    "Walk.bounces" = offset_of!(Walk, bounces);
    "Walk.astray" = offset_of!(Walk, astray);
    "Walk.is_out" = offset_of!(Walk, is_out);
    "Walk.cosine" = offset_of!(Walk, cosine);
    "size of WideOutcome" = size_of::<WideOutcome>();
    "WideOutcome.sum" = offset_of!(WideOutcome, sum);
    "WideOutcome.product" = offset_of!(WideOutcome, product);
    "WideOutcome.quotient" = offset_of!(WideOutcome, quotient);
    "WideOutcome.root" = offset_of!(WideOutcome, root);
}
