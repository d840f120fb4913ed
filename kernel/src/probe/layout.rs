//! The memory layout of every type that crosses between host and device, as numbers. Runs on
//! the GPU and on the CPU, so that the two can be compared.

use crate::accel::node::Node;
use crate::filter::Filter;
use crate::fog::Fog;
use crate::light::sky::Sky;
use crate::material::optics::{Fresnel, Incidence};
use crate::probe::canary::{Operands, Outcome, WideOutcome};
use crate::probe::glass_walk::Walk;
use crate::shape::Shape;
use crate::{Accumulator, Camera, Hit, Launch, Light, Material, PathLaunch, Pixel, Ray, Sphere};
use core::mem::offset_of;

macro_rules! layouts {
    ($($name:literal = $value:expr;)*) => {
        /// What each entry of the table is, in order: a type's size, or a field's offset.
        #[cfg(not(target_arch = "spirv"))]
        pub const NAMES: &[&str] = &[$($name),*];

        /// The number of entries.
        pub const COUNT: usize = [$($value),*].len();

        /// Writes the table of sizes and offsets, which are in bytes, as the compiler of this code
        /// sees it. A slice that is too short is filled as far as it goes.
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
    "size of Shape" = size_of::<Shape>();
    "Shape.second" = offset_of!(Shape, second);
    "Shape.third" = offset_of!(Shape, third);
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
    "Material.kind" = offset_of!(Material, kind);
    "Material.volume" = offset_of!(Material, volume);
    "Material.parameter" = offset_of!(Material, parameter);
    "size of Light" = size_of::<Light>();
    "Light.position" = offset_of!(Light, position);
    "Light.kind" = offset_of!(Light, kind);
    "Light.color" = offset_of!(Light, color);
    "Light.cumulative" = offset_of!(Light, cumulative);
    "Light.probability" = offset_of!(Light, probability);
    "Light.sphere" = offset_of!(Light, sphere);
    "Light.height" = offset_of!(Light, height);
    "size of Sky" = size_of::<Sky>();
    "Sky.horizon" = offset_of!(Sky, horizon);
    "Sky.environment_probability" = offset_of!(Sky, environment_probability);
    "Sky.zenith" = offset_of!(Sky, zenith);
    "Sky.sun_probability" = offset_of!(Sky, sun_probability);
    "Sky.sun_direction" = offset_of!(Sky, sun_direction);
    "Sky.sun_height" = offset_of!(Sky, sun_height);
    "Sky.sun_radiance" = offset_of!(Sky, sun_radiance);
    "Sky.environment_turn" = offset_of!(Sky, environment_turn);
    "Sky.environment_size" = offset_of!(Sky, environment_size);
    "size of Fog" = size_of::<Fog>();
    "Fog.center" = offset_of!(Fog, center);
    "Fog.radius" = offset_of!(Fog, radius);
    "Fog.albedo" = offset_of!(Fog, albedo);
    "Fog.extinction" = offset_of!(Fog, extinction);
    "Fog.anisotropy" = offset_of!(Fog, anisotropy);
    "size of Filter" = size_of::<Filter>();
    "Filter.kind" = offset_of!(Filter, kind);
    "Filter.width" = offset_of!(Filter, width);
    "size of PathLaunch" = size_of::<PathLaunch>();
    "PathLaunch.camera" = offset_of!(PathLaunch, camera);
    "PathLaunch.image_size" = offset_of!(PathLaunch, image_size);
    "PathLaunch.tile_origin" = offset_of!(PathLaunch, tile_origin);
    "PathLaunch.tile_size" = offset_of!(PathLaunch, tile_size);
    "PathLaunch.first_sample" = offset_of!(PathLaunch, first_sample);
    "PathLaunch.sample_count" = offset_of!(PathLaunch, sample_count);
    "PathLaunch.seed" = offset_of!(PathLaunch, seed);
    "PathLaunch.max_bounces" = offset_of!(PathLaunch, max_bounces);
    "PathLaunch.lens_radius" = offset_of!(PathLaunch, lens_radius);
    "PathLaunch.focus_distance" = offset_of!(PathLaunch, focus_distance);
    "PathLaunch.shutter_open" = offset_of!(PathLaunch, shutter_open);
    "PathLaunch.shutter_close" = offset_of!(PathLaunch, shutter_close);
    "PathLaunch.ambient_distance" = offset_of!(PathLaunch, ambient_distance);
    "PathLaunch.sphere_light_probability" = offset_of!(PathLaunch, sphere_light_probability);
    "PathLaunch.called_effects" = offset_of!(PathLaunch, called_effects);
    "PathLaunch.has_ambient_sky" = offset_of!(PathLaunch, has_ambient_sky);
    "PathLaunch.has_plain_sky" = offset_of!(PathLaunch, has_plain_sky);
    "PathLaunch.is_adaptive" = offset_of!(PathLaunch, is_adaptive);
    "PathLaunch.indirect_limit" = offset_of!(PathLaunch, indirect_limit);
    "PathLaunch.first_caster" = offset_of!(PathLaunch, first_caster);
    "PathLaunch.first_shape" = offset_of!(PathLaunch, first_shape);
    "PathLaunch.glass_at_eye" = offset_of!(PathLaunch, glass_at_eye);
    "PathLaunch.sky" = offset_of!(PathLaunch, sky);
    "PathLaunch.fog" = offset_of!(PathLaunch, fog);
    "PathLaunch.filter" = offset_of!(PathLaunch, filter);
    "size of Accumulator" = size_of::<Accumulator>();
    "Accumulator.color_alpha" = offset_of!(Accumulator, color_alpha);
    "Accumulator.statistics" = offset_of!(Accumulator, statistics);
    "size of Node" = size_of::<Node>();
    "Node.sides" = offset_of!(Node, sides);
    "Node.corner" = offset_of!(Node, corner);
    "Node.links" = offset_of!(Node, links);
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
    "WideOutcome.large_sum" = offset_of!(WideOutcome, large_sum);
    "WideOutcome.large_square" = offset_of!(WideOutcome, large_square);
    "WideOutcome.product" = offset_of!(WideOutcome, product);
    "WideOutcome.quotient" = offset_of!(WideOutcome, quotient);
    "WideOutcome.root" = offset_of!(WideOutcome, root);
}
