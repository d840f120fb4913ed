//! Made by `generate` out of rustdoc's JSON: tests/every-function/run --generate.

#![expect(
    clippy::semicolon_if_nothing_returned,
    clippy::unit_arg,
    reason = "a call is one expression"
)]
#![expect(
    clippy::too_many_lines,
    reason = "an enum has as many variants as it has"
)]

use crate::odd::{self, Odd, Source};
use crate::{Call, seen};

/// A call of each public function.
pub const CALLS: &[Call] = &[
    Call::new(
        "[spherule_kernel::sphere::Sphere] as spherule_kernel::accel::brute::Spheres::count",
        |s| {
            seen(<[spherule_kernel::sphere::Sphere] as spherule_kernel::accel::brute::Spheres>::count(&s.many()[..]))
        },
    ),
    Call::new("f32 as spherule_kernel::lane::Lane::abs", |s| {
        seen(<f32 as spherule_kernel::lane::Lane>::abs(s.draw()))
    }),
    Call::new("f32 as spherule_kernel::lane::Lane::add_strict", |s| {
        seen(<f32 as spherule_kernel::lane::Lane>::add_strict(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("f32 as spherule_kernel::lane::Lane::are_all", |s| {
        seen(<f32 as spherule_kernel::lane::Lane>::are_all(s.draw()))
    }),
    Call::new("f32 as spherule_kernel::lane::Lane::mul_strict", |s| {
        seen(<f32 as spherule_kernel::lane::Lane>::mul_strict(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("f32 as spherule_kernel::lane::Lane::simd_ge", |s| {
        seen(<f32 as spherule_kernel::lane::Lane>::simd_ge(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("f32 as spherule_kernel::lane::Lane::simd_gt", |s| {
        seen(<f32 as spherule_kernel::lane::Lane>::simd_gt(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("f32 as spherule_kernel::lane::Lane::simd_le", |s| {
        seen(<f32 as spherule_kernel::lane::Lane>::simd_le(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("f32 as spherule_kernel::lane::Lane::simd_lt", |s| {
        seen(<f32 as spherule_kernel::lane::Lane>::simd_lt(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("f32 as spherule_kernel::lane::Lane::splat", |s| {
        seen(<f32 as spherule_kernel::lane::Lane>::splat(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("f32 as spherule_kernel::lane::Lane::sqrt", |s| {
        seen(<f32 as spherule_kernel::lane::Lane>::sqrt(s.draw()))
    }),
    Call::new("f32 as spherule_kernel::lane::Lane::sub_strict", |s| {
        seen(<f32 as spherule_kernel::lane::Lane>::sub_strict(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("f32 as spherule_kernel::lane::Lane::to_single", |s| {
        seen(<f32 as spherule_kernel::lane::Lane>::to_single(s.draw()))
    }),
    Call::new("f64 as spherule_kernel::lane::Lane::abs", |s| {
        seen(<f64 as spherule_kernel::lane::Lane>::abs(s.draw()))
    }),
    Call::new("f64 as spherule_kernel::lane::Lane::add_strict", |s| {
        seen(<f64 as spherule_kernel::lane::Lane>::add_strict(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("f64 as spherule_kernel::lane::Lane::are_all", |s| {
        seen(<f64 as spherule_kernel::lane::Lane>::are_all(s.draw()))
    }),
    Call::new("f64 as spherule_kernel::lane::Lane::mul_strict", |s| {
        seen(<f64 as spherule_kernel::lane::Lane>::mul_strict(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("f64 as spherule_kernel::lane::Lane::simd_ge", |s| {
        seen(<f64 as spherule_kernel::lane::Lane>::simd_ge(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("f64 as spherule_kernel::lane::Lane::simd_gt", |s| {
        seen(<f64 as spherule_kernel::lane::Lane>::simd_gt(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("f64 as spherule_kernel::lane::Lane::simd_le", |s| {
        seen(<f64 as spherule_kernel::lane::Lane>::simd_le(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("f64 as spherule_kernel::lane::Lane::simd_lt", |s| {
        seen(<f64 as spherule_kernel::lane::Lane>::simd_lt(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("f64 as spherule_kernel::lane::Lane::splat", |s| {
        seen(<f64 as spherule_kernel::lane::Lane>::splat(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("f64 as spherule_kernel::lane::Lane::sqrt", |s| {
        seen(<f64 as spherule_kernel::lane::Lane>::sqrt(s.draw()))
    }),
    Call::new("f64 as spherule_kernel::lane::Lane::sub_strict", |s| {
        seen(<f64 as spherule_kernel::lane::Lane>::sub_strict(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("f64 as spherule_kernel::lane::Lane::to_single", |s| {
        seen(<f64 as spherule_kernel::lane::Lane>::to_single(s.draw()))
    }),
    Call::new("spherule::accel::build::build", |s| {
        seen(spherule::accel::build::build(
            &s.many()[..],
            &s.many()[..],
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule::accel::build::build_shapes", |s| {
        seen(spherule::accel::build::build_shapes(
            &s.many()[..],
            &s.many()[..],
            s.draw(),
        ))
    }),
    Call::new("spherule::accel::build::build_still", |s| {
        seen(spherule::accel::build::build_still(&s.many()[..], s.draw()))
    }),
    Call::new("spherule::accel::shapes::ShapeTree::of", |s| {
        seen(spherule::accel::shapes::ShapeTree::of(&s.draw(), s.draw()))
    }),
    Call::new("spherule::accel::shapes::ShapeTree::shapes", |s| {
        seen(spherule::accel::shapes::ShapeTree::shapes(
            &s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule::accel::tree::Acceleration::min_spheres", |s| {
        seen(spherule::accel::tree::Acceleration::min_spheres(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule::accel::tree::BuiltTree::sort", |s| {
        seen(spherule::accel::tree::BuiltTree::sort(
            &s.draw(),
            &s.many::<u32>()[..],
        ))
    }),
    Call::new("spherule::accel::tree::BuiltTree::sort_world", |s| {
        seen(spherule::accel::tree::BuiltTree::sort_world(
            &s.draw(),
            &s.draw(),
        ))
    }),
    Call::new("spherule::accel::tree::Nodes as Deref", |s| {
        seen(std::ops::Deref::deref(
            &s.draw::<spherule::accel::tree::Nodes>(),
        ))
    }),
    Call::new("spherule::accel::tree::Nodes::tree", |s| {
        seen(spherule::accel::tree::Nodes::tree(&s.draw()))
    }),
    Call::new("spherule::accuracy::ask::fresnel", |s| {
        seen(spherule::accuracy::ask::fresnel(
            &spherule::Device::Cpu,
            &s.many()[..],
        ))
    }),
    Call::new("spherule::accuracy::ask::nearest", |s| {
        seen(spherule::accuracy::ask::nearest(
            &spherule::Device::Cpu,
            s.draw(),
            &s.many()[..],
            &s.many()[..],
        ))
    }),
    Call::new("spherule::accuracy::ask::occluded", |s| {
        seen(spherule::accuracy::ask::occluded(
            &spherule::Device::Cpu,
            s.draw(),
            &s.many()[..],
            &s.many()[..],
        ))
    }),
    Call::new("spherule::accuracy::ask::surfaces", |s| {
        seen(spherule::accuracy::ask::surfaces(
            &spherule::Device::Cpu,
            &s.many()[..],
            &s.many()[..],
        ))
    }),
    Call::new("spherule::accuracy::ask::walks", |s| {
        seen(spherule::accuracy::ask::walks(
            &spherule::Device::Cpu,
            s.draw(),
            &s.many()[..],
            &s.many()[..],
        ))
    }),
    Call::new("spherule::accuracy::cases::Case::decided", |s| {
        seen(spherule::accuracy::cases::Case::decided(&s.draw()))
    }),
    Call::new("spherule::accuracy::cases::Case::judge", |s| {
        seen(spherule::accuracy::cases::Case::judge(
            &s.draw(),
            &spherule::Device::Cpu,
            s.draw(),
        ))
    }),
    Call::new("spherule::accuracy::cases::Case::samples", |s| {
        seen(spherule::accuracy::cases::Case::samples(&s.draw()).count())
    }),
    Call::new("spherule::accuracy::cases::Verdict::is_broken", |s| {
        seen(spherule::accuracy::cases::Verdict::is_broken(&s.draw()))
    }),
    Call::new("spherule::accuracy::cases::Verdict::of", |s| {
        seen(spherule::accuracy::cases::Verdict::of(s.draw(), s.draw()))
    }),
    Call::new("spherule::accuracy::cases::catalogue", |_| {
        seen(spherule::accuracy::cases::catalogue())
    }),
    Call::new("spherule::accuracy::cases::turned_axes", |s| {
        seen(spherule::accuracy::cases::turned_axes(s.draw()))
    }),
    Call::new("spherule::accuracy::families::Family::name", |s| {
        seen(spherule::accuracy::families::Family::name(s.draw()))
    }),
    Call::new("spherule::accuracy::families::Family::sample", |s| {
        seen(spherule::accuracy::families::Family::sample(
            s.draw(),
            s.draw(),
            s.few(),
        ))
    }),
    Call::new("spherule::accuracy::frames::measure", |s| {
        seen(spherule::accuracy::frames::measure(
            &spherule::Device::Cpu,
            &s.many()[..],
            &s.draw(),
            spherule::render::QUIET,
        ))
    }),
    Call::new("spherule::accuracy::hard_rays::export", |s| {
        seen(spherule::accuracy::hard_rays::export(
            &s.folder(),
            &spherule::Device::Cpu,
            usize::from(s.draw::<u8>()),
        ))
    }),
    Call::new("spherule::accuracy::measure::Escalation as Display", |s| {
        seen(
            s.draw::<spherule::accuracy::measure::Escalation>()
                .to_string(),
        )
    }),
    Call::new("spherule::accuracy::measure::Escalation::of", |s| {
        seen(spherule::accuracy::measure::Escalation::of(&s.many()[..]))
    }),
    Call::new("spherule::accuracy::measure::RungErrors::ulp_at", |s| {
        seen(spherule::accuracy::measure::RungErrors::ulp_at(
            &s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule::accuracy::measure::Steps as Display", |s| {
        seen(s.draw::<spherule::accuracy::measure::Steps>().to_string())
    }),
    Call::new("spherule::accuracy::measure::intersect_all", |s| {
        seen(spherule::accuracy::measure::intersect_all(
            &spherule::Device::Cpu,
            s.draw(),
            &s.many()[..],
        ))
    }),
    Call::new("spherule::accuracy::measure::intersect_on_gpu", |s| {
        seen(spherule::accuracy::measure::intersect_on_gpu(
            s.gpu(),
            s.draw(),
            &s.many()[..],
        ))
    })
    .on_gpu(),
    Call::new("spherule::accuracy::measure::judge", |s| {
        seen(spherule::accuracy::measure::judge(
            &s.many()[..],
            &s.many()[..],
        ))
    }),
    Call::new("spherule::accuracy::measure::self_hits", |s| {
        seen(spherule::accuracy::measure::self_hits(
            &spherule::Device::Cpu,
            s.draw(),
            &s.many()[..],
            &s.many()[..],
        ))
    }),
    Call::new("spherule::accuracy::oracle::Intersection::bracket", |s| {
        seen(spherule::accuracy::oracle::Intersection::bracket(
            &s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule::accuracy::oracle::Intersection::compare", |s| {
        seen(spherule::accuracy::oracle::Intersection::compare(
            &s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule::accuracy::oracle::Intersection::margin", |s| {
        seen(spherule::accuracy::oracle::Intersection::margin(&s.draw()))
    }),
    Call::new("spherule::accuracy::oracle::Intersection::meets", |s| {
        seen(spherule::accuracy::oracle::Intersection::meets(&s.draw()))
    }),
    Call::new("spherule::accuracy::oracle::Intersection::nearest", |s| {
        seen(spherule::accuracy::oracle::Intersection::nearest(
            &s.draw(),
            &s.draw(),
        ))
    }),
    Call::new(
        "spherule::accuracy::oracle::Intersection::nearest_root",
        |s| {
            seen(spherule::accuracy::oracle::Intersection::nearest_root(
                &s.draw(),
                &s.draw(),
            ))
        },
    ),
    Call::new("spherule::accuracy::oracle::Intersection::of", |s| {
        seen(spherule::accuracy::oracle::Intersection::of(
            &s.draw(),
            &s.draw(),
        ))
    }),
    Call::new("spherule::accuracy::oracle::Intersection::root", |s| {
        seen(spherule::accuracy::oracle::Intersection::root(
            &s.draw(),
            s.draw(),
        ))
    }),
    Call::new(
        "spherule::accuracy::oracle::Intersection::side_of_origin",
        |s| {
            seen(spherule::accuracy::oracle::Intersection::side_of_origin(
                &s.draw(),
            ))
        },
    ),
    Call::new("spherule::accuracy::oracle::is_transmitted", |s| {
        seen(spherule::accuracy::oracle::is_transmitted(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule::accuracy::price::measure", |s| {
        seen(spherule::accuracy::price::measure(
            &spherule::Device::Cpu,
            &s.many()[..],
            &s.many()[..],
        ))
    }),
    Call::new("spherule::accuracy::report::page", |s| {
        seen(spherule::accuracy::report::page(
            &s.text(),
            s.draw(),
            &s.draw::<odd::OddFamilies>().get(),
            Some((&s.text(), &s.many()[..])),
            &s.many()[..],
            &s.text(),
        ))
    }),
    Call::new("spherule::accuracy::samples::Step::series", |s| {
        seen(spherule::accuracy::samples::Step::series(&s.draw()))
    }),
    Call::new("spherule::accuracy::samples::in_all", |s| {
        seen(spherule::accuracy::samples::in_all(s.draw(), s.few()))
    }),
    Call::new("spherule::accuracy::samples::measure", |s| {
        seen(spherule::accuracy::samples::measure(
            &spherule::Device::Cpu,
            &s.many()[..],
            &s.draw(),
            s.draw(),
            spherule::render::QUIET,
        ))
    }),
    Call::new("spherule::accuracy::scene_cases::SceneCase::judge", |s| {
        seen(spherule::accuracy::scene_cases::SceneCase::judge(
            &s.draw(),
            &spherule::Device::Cpu,
            s.draw(),
        ))
    }),
    Call::new("spherule::accuracy::scene_rays::sample", |s| {
        seen(spherule::accuracy::scene_rays::sample(
            &s.draw(),
            s.draw(),
            s.few(),
        ))
    }),
    Call::new("spherule::accuracy::screen::nearest", |s| {
        seen(spherule::accuracy::screen::nearest(&s.draw(), &s.draw()))
    }),
    Call::new("spherule::accuracy::screen::screen", |s| {
        seen(spherule::accuracy::screen::screen(&s.draw(), &s.draw()))
    }),
    Call::new("spherule::accuracy::shape_families::Family::sample", |s| {
        seen(spherule::accuracy::shape_families::Family::sample(
            s.draw(),
            s.draw(),
            s.draw(),
            s.few(),
        ))
    }),
    Call::new("spherule::accuracy::shape_families::Known::exact", |s| {
        seen(spherule::accuracy::shape_families::Known::exact(&s.draw()))
    }),
    Call::new("spherule::accuracy::shape_families::Known::shape", |s| {
        seen(spherule::accuracy::shape_families::Known::shape(&s.draw()))
    }),
    Call::new(
        "spherule::accuracy::shape_families::intersect_shapes",
        |s| {
            seen(spherule::accuracy::shape_families::intersect_shapes(
                &spherule::Device::Cpu,
                s.draw(),
                &s.many()[..],
            ))
        },
    ),
    Call::new("spherule::accuracy::shape_families::measure", |s| {
        seen(spherule::accuracy::shape_families::measure(
            &spherule::Device::Cpu,
            s.draw(),
            &s.many()[..],
        ))
    }),
    Call::new("spherule::bench::export::export", |s| {
        seen(spherule::bench::export::export(
            &s.folder(),
            &s.text(),
            &s.draw(),
            &s.draw(),
            &s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule::bench::export::prepare", |s| {
        seen(spherule::bench::export::prepare(&s.path()))
    }),
    Call::new("spherule::bench::limit::Limit::of", |_| {
        seen(spherule::bench::limit::Limit::of(&spherule::Device::Cpu))
    })
    .at_most(2, 20),
    Call::new("spherule::bench::limit::Limit::rays_per_s", |s| {
        seen(spherule::bench::limit::Limit::rays_per_s(
            &s.draw(),
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule::bench::measure::measure", |s| {
        seen(spherule::bench::measure::measure(
            &spherule::Device::Cpu,
            &s.text(),
            &s.draw(),
            s.draw(),
            s.draw(),
            Some(&s.draw()),
        ))
    }),
    Call::new("spherule::bench::rays::Kind::is_any", |s| {
        seen(spherule::bench::rays::Kind::is_any(s.draw()))
    }),
    Call::new("spherule::bench::rays::Kind::name", |s| {
        seen(spherule::bench::rays::Kind::name(s.draw()))
    }),
    Call::new("spherule::bench::rays::RaySets::check_room", |s| {
        seen(spherule::bench::rays::RaySets::check_room(s.few(), s.few()))
    }),
    Call::new("spherule::bench::rays::RaySets::kind", |s| {
        seen(spherule::bench::rays::RaySets::kind(&s.draw(), s.draw()))
    }),
    Call::new("spherule::bench::rays::RaySets::of", |s| {
        seen(spherule::bench::rays::RaySets::of(
            &s.draw(),
            &s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule::bench::scenes::BenchScene::check_room", |s| {
        seen(spherule::bench::scenes::BenchScene::check_room(s.draw()))
    }),
    Call::new("spherule::bench::scenes::BenchScene::make", |s| {
        seen(spherule::bench::scenes::BenchScene::make(
            s.draw(),
            s.few(),
            s.few(),
        ))
    }),
    Call::new("spherule::bench::scenes::BenchScene::name", |s| {
        seen(spherule::bench::scenes::BenchScene::name(s.draw()))
    }),
    Call::new("spherule::bench::scenes::BenchScene::named", |s| {
        seen(spherule::bench::scenes::BenchScene::named(&s.text()))
    }),
    Call::new("spherule::bench::scenes::BenchScene::reach", |s| {
        seen(spherule::bench::scenes::BenchScene::reach(s.draw()))
    }),
    Call::new("spherule::bench::scenes::Source::load", |s| {
        seen(spherule::bench::scenes::Source::load(
            &s.draw(),
            s.few(),
            s.few(),
        ))
    }),
    Call::new("spherule::bench::scenes::Source::named", |s| {
        seen(spherule::bench::scenes::Source::named(&s.text()))
    }),
    Call::new("spherule::bench::scenes::load", |s| {
        seen(spherule::bench::scenes::load(&s.text(), s.few(), s.few()))
    }),
    Call::new("spherule::bench::verify::verify", |s| {
        seen(spherule::bench::verify::verify(
            &spherule::Device::Cpu,
            &s.draw(),
            &s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule::choose::bound", |s| {
        seen(spherule::choose::bound(&s.draw(), s.draw(), s.draw()))
    }),
    Call::new("spherule::choose::choose", |s| {
        seen(spherule::choose::choose(&s.draw(), s.draw(), s.draw()))
    }),
    Call::new("spherule::cpu::InstructionSet as Display", |s| {
        seen(s.draw::<spherule::cpu::InstructionSet>().to_string())
    }),
    Call::new("spherule::cpu::InstructionSet::chosen", |_| {
        seen(spherule::cpu::InstructionSet::chosen())
    }),
    Call::new("spherule::cpu::InstructionSet::is_there", |s| {
        seen(spherule::cpu::InstructionSet::is_there(s.draw()))
    }),
    Call::new("spherule::cpu::InstructionSet::name", |s| {
        seen(spherule::cpu::InstructionSet::name(s.draw()))
    }),
    Call::new("spherule::cpu::InstructionSet::wanted", |_| {
        seen(spherule::cpu::InstructionSet::wanted())
    }),
    Call::new("spherule::cpu::InstructionSet::widest", |_| {
        seen(spherule::cpu::InstructionSet::widest())
    }),
    Call::new("spherule::device::Device::backend", |_| {
        seen(spherule::device::Device::backend(&spherule::Device::Cpu))
    }),
    Call::new("spherule::device::Device::has_f64", |_| {
        seen(spherule::device::Device::has_f64(&spherule::Device::Cpu))
    }),
    Call::new("spherule::device::Device::name", |_| {
        seen(spherule::device::Device::name(&spherule::Device::Cpu))
    }),
    Call::new("spherule::device::Device::open", |s| {
        seen(spherule::device::Device::open(&s.draw()))
    }),
    Call::new("spherule::device::adapter::instance", |_| {
        seen(spherule::device::adapter::instance())
    }),
    Call::new("spherule::device::adapter::list_adapters", |_| {
        seen(spherule::device::adapter::list_adapters())
    }),
    Call::new("spherule::device::buffer::Buffer::binding", |s| {
        seen(spherule::device::buffer::Buffer::binding(&s.draw()))
    })
    .on_gpu(),
    Call::new("spherule::device::buffer::Buffer::is_empty", |s| {
        seen(spherule::device::buffer::Buffer::is_empty(&s.draw()))
    })
    .on_gpu(),
    Call::new("spherule::device::buffer::Buffer::len", |s| {
        seen(spherule::device::buffer::Buffer::len(&s.draw()))
    })
    .on_gpu(),
    Call::new("spherule::device::busy::keep_busy", |s| {
        seen(spherule::device::busy::keep_busy(s.gpu(), s.draw()))
    })
    .on_gpu(),
    Call::new("spherule::device::canary::Canary::objection", |s| {
        seen(spherule::device::canary::Canary::objection(
            &s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule::device::canary::Canary::on", |_| {
        seen(spherule::device::canary::Canary::on(&spherule::Device::Cpu))
    }),
    Call::new("spherule::device::canary::Canary::on_gpu", |s| {
        seen(spherule::device::canary::Canary::on_gpu(s.gpu()))
    })
    .on_gpu(),
    Call::new("spherule::device::canary::Canary::require", |s| {
        seen(spherule::device::canary::Canary::require(
            &s.draw(),
            s.draw(),
            &s.text(),
        ))
    }),
    Call::new("spherule::device::canary::Canary::require_on_gpu", |s| {
        seen(spherule::device::canary::Canary::require_on_gpu(
            s.gpu(),
            s.draw(),
        ))
    })
    .on_gpu(),
    Call::new("spherule::device::canary::Share::is_whole", |s| {
        seen(spherule::device::canary::Share::is_whole(s.draw()))
    }),
    Call::new("spherule::device::choice::DeviceChoice as Display", |s| {
        seen(s.draw::<spherule::device::DeviceChoice>().to_string())
    }),
    Call::new("spherule::device::choice::DeviceChoice as FromStr", |s| {
        seen(s.text().parse::<spherule::device::DeviceChoice>())
    }),
    Call::new("spherule::device::errors::is_catching", |_| {
        seen(spherule::device::is_catching())
    }),
    Call::new("spherule::device::gpu::Gpu::clear", |s| {
        seen(spherule::device::gpu::Gpu::clear::<u32>(s.gpu(), &s.draw()))
    })
    .on_gpu(),
    Call::new("spherule::device::gpu::Gpu::driver", |s| {
        seen(spherule::device::gpu::Gpu::driver(s.gpu()))
    })
    .on_gpu(),
    Call::new("spherule::device::gpu::Gpu::has_f64", |s| {
        seen(spherule::device::gpu::Gpu::has_f64(s.gpu()))
    })
    .on_gpu(),
    Call::new("spherule::device::gpu::Gpu::is_software", |s| {
        seen(spherule::device::gpu::Gpu::is_software(s.gpu()))
    })
    .on_gpu(),
    Call::new("spherule::device::gpu::Gpu::kernel", |s| {
        seen(spherule::device::gpu::Gpu::kernel(
            s.gpu(),
            &s.draw(),
            &s.text(),
            &s.many()[..],
        ))
    })
    .on_gpu(),
    Call::new("spherule::device::gpu::Gpu::limits", |s| {
        seen(spherule::device::gpu::Gpu::limits(s.gpu()))
    })
    .on_gpu(),
    Call::new("spherule::device::gpu::Gpu::name", |s| {
        seen(spherule::device::gpu::Gpu::name(s.gpu()))
    })
    .on_gpu(),
    Call::new("spherule::device::gpu::Gpu::open", |s| {
        seen(spherule::device::gpu::Gpu::open(&s.draw()))
    }),
    Call::new("spherule::device::gpu::Gpu::passes_spirv_through", |s| {
        seen(spherule::device::gpu::Gpu::passes_spirv_through(s.gpu()))
    })
    .on_gpu(),
    Call::new("spherule::device::gpu::Gpu::read", |s| {
        seen(spherule::device::gpu::Gpu::read::<u32>(s.gpu(), &s.draw()))
    })
    .on_gpu(),
    Call::new("spherule::device::gpu::Gpu::read_first", |s| {
        seen(spherule::device::gpu::Gpu::read_first::<u32>(
            s.gpu(),
            &s.draw(),
            s.draw(),
        ))
    })
    .on_gpu(),
    Call::new("spherule::device::gpu::Gpu::read_into", |s| {
        seen(spherule::device::gpu::Gpu::read_into::<u32>(
            s.gpu(),
            &s.draw(),
            &mut s.many()[..],
        ))
    })
    .on_gpu(),
    Call::new("spherule::device::gpu::Gpu::rows_of", |s| {
        seen(spherule::device::gpu::Gpu::rows_of(s.gpu(), s.draw()))
    })
    .on_gpu(),
    Call::new("spherule::device::gpu::Gpu::update", |s| {
        seen(spherule::device::gpu::Gpu::update::<u32>(
            s.gpu(),
            &s.draw(),
            &s.draw(),
        ))
    })
    .on_gpu(),
    Call::new("spherule::device::gpu::Gpu::upload", |s| {
        seen(spherule::device::gpu::Gpu::upload::<u32>(
            s.gpu(),
            &s.text(),
            &s.many()[..],
        ))
    })
    .on_gpu(),
    Call::new("spherule::device::gpu::Gpu::upload_uniform", |s| {
        seen(spherule::device::gpu::Gpu::upload_uniform::<u32>(
            s.gpu(),
            &s.text(),
            &s.draw(),
        ))
    })
    .on_gpu(),
    Call::new("spherule::device::gpu::Gpu::zeroed", |s| {
        seen(spherule::device::gpu::Gpu::zeroed::<u32>(
            s.gpu(),
            &s.text(),
            s.few(),
        ))
    })
    .on_gpu(),
    Call::new("spherule::device::gpu::GpuOptions as Default", |_| {
        seen(<spherule::device::gpu::GpuOptions as Default>::default())
    }),
    Call::new("spherule::device::gpu::GpuOptions::through_naga", |s| {
        seen(spherule::device::gpu::GpuOptions::through_naga(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule::device::gpu::GpuOptions::timeout", |s| {
        seen(spherule::device::gpu::GpuOptions::timeout(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule::device::gpu::GpuOptions::without_f64", |s| {
        seen(spherule::device::gpu::GpuOptions::without_f64(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule::device::kernel::Kernel::workgroup_size", |s| {
        seen(spherule::device::kernel::Kernel::workgroup_size(s.kernel()))
    })
    .on_gpu(),
    Call::new("spherule::device::kernel::Kernel::workgroups_for", |s| {
        seen(spherule::device::kernel::Kernel::workgroups_for(
            s.kernel(),
            s.draw(),
        ))
    })
    .on_gpu(),
    Call::new("spherule::device::kernel::LaunchTime::best", |s| {
        seen(spherule::device::kernel::LaunchTime::best(&s.draw()))
    }),
    Call::new("spherule::device::rung::f64_rate", |s| {
        seen(spherule::device::rung::f64_rate(s.gpu()))
    })
    .on_gpu(),
    Call::new("spherule::device::rung::module", |s| {
        seen(spherule::device::rung::module(s.gpu(), s.draw()))
    })
    .on_gpu(),
    Call::new("spherule::device::rung::modules", |s| {
        seen(spherule::device::rung::modules(s.gpu(), s.draw()))
    })
    .on_gpu(),
    Call::new("spherule::device::rung::uses_f64", |s| {
        seen(spherule::device::rung::uses_f64(s.gpu(), s.draw()))
    })
    .on_gpu(),
    Call::new("spherule::device::spirv::Module as Debug", |s| {
        seen(format!("{:?}", s.draw::<spherule::device::spirv::Module>()))
    }),
    Call::new("spherule::device::spirv::Module::entry_points", |s| {
        seen(spherule::device::spirv::Module::entry_points(&s.draw()))
    }),
    Call::new("spherule::device::spirv::Module::folded", |s| {
        seen(spherule::device::spirv::Module::folded(&s.draw()))
    }),
    Call::new("spherule::device::spirv::Module::from_bytes", |s| {
        seen(spherule::device::spirv::Module::from_bytes(
            &s.text(),
            &s.module()[..],
        ))
    }),
    Call::new("spherule::device::spirv::Module::is_trusted", |s| {
        seen(spherule::device::spirv::Module::is_trusted(&s.draw()))
    }),
    Call::new("spherule::device::spirv::Module::name", |s| {
        seen(spherule::device::spirv::Module::name(&s.draw()))
    }),
    Call::new("spherule::device::spirv::Module::needs_f64", |s| {
        seen(spherule::device::spirv::Module::needs_f64(&s.draw()))
    }),
    Call::new("spherule::device::spirv::Module::only", |s| {
        seen(spherule::device::spirv::Module::only(&s.draw(), &s.text()))
    }),
    Call::new("spherule::device::spirv::Module::specialise", |s| {
        seen(spherule::device::spirv::Module::specialise(
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule::device::spirv::Module::words", |s| {
        seen(spherule::device::spirv::Module::words(&s.draw()))
    }),
    Call::new("spherule::error::Error::help", |s| {
        seen(spherule::error::Error::help(&s.draw()))
    }),
    Call::new("spherule::error::Error::is_input", |s| {
        seen(spherule::error::Error::is_input(&s.draw()))
    }),
    Call::new("spherule::error::Place::line_column", |s| {
        seen(spherule::error::Place::line_column(&s.draw()))
    }),
    Call::new("spherule::film::Image::depth_range", |s| {
        seen(spherule::film::Image::depth_range(&s.draw()))
    }),
    Call::new("spherule::film::Image::has_alpha", |s| {
        seen(spherule::film::Image::has_alpha(&s.draw()))
    }),
    Call::new("spherule::film::Image::height", |s| {
        seen(spherule::film::Image::height(&s.draw()))
    }),
    Call::new("spherule::film::Image::new", |s| {
        seen(spherule::film::Image::new(
            s.few(),
            s.few(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule::film::Image::opacity", |s| {
        seen(spherule::film::Image::opacity(&s.draw(), s.draw()))
    }),
    Call::new("spherule::film::Image::pixel", |s| {
        seen(spherule::film::Image::pixel(&s.draw(), s.draw(), s.draw()))
    }),
    Call::new("spherule::film::Image::pixels", |s| {
        seen(spherule::film::Image::pixels(&s.draw()))
    }),
    Call::new("spherule::film::Image::save", |s| {
        seen(spherule::film::Image::save(&s.draw(), s.path()))
    }),
    Call::new("spherule::film::Image::set_alpha", |s| {
        seen(spherule::film::Image::set_alpha(&mut s.draw(), s.draw()))
    }),
    Call::new("spherule::film::Image::shading", |s| {
        seen(spherule::film::Image::shading(&s.draw()))
    }),
    Call::new("spherule::film::Image::to_rgb8", |s| {
        seen(spherule::film::Image::to_rgb8(&s.draw()))
    }),
    Call::new("spherule::film::Image::to_rgba8", |s| {
        seen(spherule::film::Image::to_rgba8(&s.draw()))
    }),
    Call::new("spherule::film::Image::width", |s| {
        seen(spherule::film::Image::width(&s.draw()))
    }),
    Call::new("spherule::film::agreement::Agreement::is_within", |s| {
        seen(spherule::film::agreement::Agreement::is_within(&s.draw()))
    }),
    Call::new("spherule::film::agreement::Agreement::of", |s| {
        seen(spherule::film::agreement::Agreement::of(
            &s.draw(),
            &s.draw(),
        ))
    }),
    Call::new("spherule::film::agreement::Channel::name", |s| {
        seen(spherule::film::agreement::Channel::name(s.draw()))
    }),
    Call::new("spherule::film::allocate", |s| {
        seen(spherule::film::allocate::<f32>(s.side(), s.side()))
    }),
    Call::new("spherule::film::compare::Comparison::is_within", |s| {
        seen(spherule::film::compare::Comparison::is_within(&s.draw()))
    }),
    Call::new("spherule::film::compare::Comparison::of", |s| {
        seen(spherule::film::compare::Comparison::of(
            &s.draw(),
            &s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule::film::compare::Tolerance as Default", |_| {
        seen(<spherule::film::compare::Tolerance as Default>::default())
    }),
    Call::new("spherule::film::compare::Tolerance::of_paths", |s| {
        seen(spherule::film::compare::Tolerance::of_paths(s.draw()))
    }),
    Call::new("spherule::film::encode::from_srgb", |s| {
        seen(spherule::film::encode::from_srgb(s.draw()))
    }),
    Call::new("spherule::film::encode::srgb", |s| {
        seen(spherule::film::encode::srgb(s.draw()))
    }),
    Call::new("spherule::film::flip::mean_flip", |s| {
        seen(spherule::film::flip::mean_flip(&s.draw(), &s.draw()))
    }),
    Call::new("spherule::kernel_module::f32", |_| {
        seen(spherule::kernel_module::f32())
    }),
    Call::new("spherule::kernel_module::f64", |_| {
        seen(spherule::kernel_module::f64())
    }),
    Call::new("spherule::look::origin", |s| {
        seen(spherule::look::origin(&s.many()[..]))
    }),
    Call::new("spherule::look::world", |s| {
        seen(spherule::look::world(&s.many()[..], s.draw()))
    }),
    Call::new("spherule::random::Random::log_within", |s| {
        seen(spherule::random::Random::log_within(
            &mut s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule::random::Random::new", |s| {
        seen(spherule::random::Random::new(s.draw()))
    }),
    Call::new("spherule::random::Random::next_u32", |s| {
        seen(spherule::random::Random::next_u32(&mut s.draw()))
    }),
    Call::new("spherule::random::Random::unit_vec3", |s| {
        seen(spherule::random::Random::unit_vec3(&mut s.draw()))
    }),
    Call::new("spherule::random::Random::vec3", |s| {
        seen(spherule::random::Random::vec3(
            &mut s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule::random::Random::within", |s| {
        seen(spherule::random::Random::within(
            &mut s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule::read::environment::is_decoding", |_| {
        seen(spherule::read::environment::is_decoding())
    }),
    Call::new("spherule::read::environment::load", |s| {
        seen(spherule::read::environment::load(&s.path(), s.draw()))
    }),
    Call::new("spherule::read::inputs", |_| seen(spherule::read::inputs())),
    Call::new("spherule::read::is_scene", |s| {
        seen(spherule::read::is_scene(&s.path()))
    }),
    Call::new("spherule::read::particles::ParticleFormat::load", |s| {
        seen(spherule::read::particles::ParticleFormat::load(
            &s.draw(),
            &s.path(),
        ))
    }),
    Call::new("spherule::read::particles::ParticleFormat::of", |s| {
        seen(spherule::read::particles::ParticleFormat::of(&s.path()))
    }),
    Call::new("spherule::read::particles::elements::by_number", |s| {
        seen(spherule::read::particles::elements::by_number(s.draw()))
    }),
    Call::new("spherule::read::particles::elements::by_symbol", |s| {
        seen(spherule::read::particles::elements::by_symbol(&s.text()))
    }),
    Call::new("spherule::read::particles::extensions", |_| {
        seen(spherule::read::particles::extensions())
    }),
    Call::new("spherule::read::particles::pdb::parse", |s| {
        seen(spherule::read::particles::pdb::parse(&s.file("pdb")))
    }),
    Call::new("spherule::read::particles::xyz::parse", |s| {
        seen(spherule::read::particles::xyz::parse(&s.file("xyz")))
    }),
    Call::new("spherule::read::toml::parse", |s| {
        seen(spherule::read::toml::parse(&s.path(), s.file("toml")))
    }),
    Call::new("spherule::render::cost::frames", |s| {
        seen(spherule::render::cost::frames(s.draw()))
    }),
    Call::new("spherule::render::cost::measure", |s| {
        seen(spherule::render::cost::measure(
            &s.draw(),
            s.draw(),
            &spherule::Device::Cpu,
            &s.many()[..],
            s.draw(),
            s.draw(),
            spherule::render::QUIET,
        ))
    }),
    Call::new("spherule::render::cpu::Prepared::new", |s| {
        seen(spherule::render::cpu::Prepared::new(&s.draw(), s.draw()))
    }),
    Call::new("spherule::render::cpu::render", |s| {
        seen(spherule::render::cpu::render(
            &s.launch(),
            &s.draw::<odd::OddPrepared>().get(),
            s.draw(),
            spherule::render::QUIET,
        ))
    }),
    Call::new("spherule::render::cpu::render_to", |s| {
        seen(spherule::render::cpu::render_to(
            &mut s.many()[..],
            &s.launch(),
            &s.draw::<odd::OddPrepared>().get(),
            s.draw(),
            spherule::render::QUIET,
        ))
    }),
    Call::new("spherule::render::estimate::is_brief", |s| {
        seen(spherule::render::estimate::is_brief(
            &s.draw(),
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule::render::estimate::on_cpu", |s| {
        seen(spherule::render::estimate::on_cpu(
            &s.draw(),
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule::render::fit::fit", |s| {
        seen(spherule::render::fit::fit(&mut s.draw(), s.draw(), |_| {
            Ok(s.draw())
        }))
    }),
    Call::new("spherule::render::gpu::Prepared::new", |s| {
        seen(spherule::render::gpu::Prepared::new(
            s.gpu(),
            &s.draw(),
            s.draw(),
        ))
    })
    .on_gpu(),
    Call::new("spherule::render::gpu::render", |s| {
        seen(spherule::render::gpu::render(
            s.gpu(),
            &s.launch(),
            &s.draw(),
            spherule::render::QUIET,
        ))
    })
    .on_gpu(),
    Call::new("spherule::render::gpu::render_paced", |s| {
        seen(spherule::render::gpu::render_paced(
            s.gpu(),
            &s.launch(),
            &s.draw(),
            spherule::render::QUIET,
            &mut s.draw(),
        ))
    })
    .on_gpu(),
    Call::new("spherule::render::gpu::time", |s| {
        seen(spherule::render::gpu::time(s.gpu(), &s.launch(), &s.draw()))
    })
    .on_gpu(),
    Call::new("spherule::render::launch::whole_image", |s| {
        seen(spherule::render::whole_image(&s.draw()))
    }),
    Call::new("spherule::render::pace::Pace::first_on", |s| {
        seen(spherule::render::pace::Pace::first_on(s.gpu()))
    })
    .on_gpu(),
    Call::new("spherule::render::pace::Pace::learn", |s| {
        seen(spherule::render::pace::Pace::learn(
            &mut s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule::render::pace::Pace::pixels", |s| {
        seen(spherule::render::pace::Pace::pixels(&s.draw(), s.draw()))
    }),
    Call::new("spherule::render::pace::Pace::spheres", |s| {
        seen(spherule::render::pace::Pace::spheres(&s.draw(), s.draw()))
    }),
    Call::new("spherule::render::pace::Pace::starting_at", |s| {
        seen(spherule::render::pace::Pace::starting_at(s.draw()))
    }),
    Call::new("spherule::render::pace::Pace::tile", |s| {
        seen(spherule::render::pace::Pace::tile(
            &s.draw(),
            s.few(),
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule::render::paths::cpu::render", |s| {
        seen(spherule::render::paths::cpu::render(
            &s.draw(),
            &s.draw(),
            spherule::render::QUIET,
        ))
    }),
    Call::new("spherule::render::paths::gpu::compile", |s| {
        seen(spherule::render::paths::gpu::compile(
            s.gpu(),
            &s.draw(),
            &s.draw(),
        ))
    })
    .on_gpu()
    .at_most(2, 240),
    Call::new("spherule::render::paths::gpu::render", |s| {
        seen(spherule::render::paths::gpu::render(
            s.gpu(),
            &s.draw(),
            &s.draw(),
            spherule::render::QUIET,
        ))
    })
    .on_gpu()
    .at_most(2, 240),
    Call::new("spherule::render::paths::prepare::Prepared::new", |s| {
        seen(spherule::render::paths::prepare::Prepared::new(
            &s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule::render::paths::render", |s| {
        seen(spherule::render::paths::render(
            &s.draw(),
            &s.draw(),
            &spherule::Device::Cpu,
            spherule::render::QUIET,
        ))
    }),
    Call::new("spherule::render::render", |s| {
        seen(spherule::render::render(
            &s.draw(),
            s.draw::<spherule::render::Settings>(),
            &spherule::Device::Cpu,
            spherule::render::QUIET,
        ))
    }),
    Call::new("spherule::render::rendered::Rendered::is_complete", |s| {
        seen(spherule::render::Rendered::is_complete(&s.draw()))
    }),
    Call::new("spherule::render::settings::EffectChoice::compiled", |s| {
        seen(spherule::render::EffectChoice::compiled(s.draw(), s.draw()))
    }),
    Call::new("spherule::render::settings::EffectChoice::shown", |s| {
        seen(spherule::render::EffectChoice::shown(s.draw(), s.draw()))
    }),
    Call::new("spherule::render::settings::Settings as From#0", |s| {
        seen(<spherule::render::Settings as From<
            spherule_kernel::shading::Shading,
        >>::from(s.draw()))
    }),
    Call::new("spherule::render::settings::Settings as From#1", |s| {
        seen(<spherule::render::Settings as From<(
            spherule_kernel::shading::Shading,
            spherule_kernel::precision::Rung,
        )>>::from(s.draw()))
    }),
    Call::new("spherule::render::settings::Settings::acceleration", |s| {
        seen(spherule::render::Settings::acceleration(s.draw(), s.draw()))
    }),
    Call::new("spherule::render::settings::Settings::effects", |s| {
        seen(spherule::render::Settings::effects(s.draw(), s.draw()))
    }),
    Call::new("spherule::render::settings::Settings::noise", |s| {
        seen(spherule::render::Settings::noise(s.draw(), s.draw()))
    }),
    Call::new("spherule::render::settings::Settings::rung", |s| {
        seen(spherule::render::Settings::rung(s.draw(), s.draw()))
    }),
    Call::new("spherule::render::settings::Settings::shading", |s| {
        seen(spherule::render::Settings::shading(s.draw(), s.draw()))
    }),
    Call::new("spherule::render::settings::Settings::time_limit", |s| {
        seen(spherule::render::Settings::time_limit(s.draw(), s.draw()))
    }),
    Call::new("spherule::scene::Scene::aspect", |s| {
        seen(spherule::scene::Scene::aspect(&s.draw()))
    }),
    Call::new("spherule::scene::Scene::called_effects", |s| {
        seen(spherule::scene::Scene::called_effects(&s.draw()))
    }),
    Call::new("spherule::scene::Scene::effects", |s| {
        seen(spherule::scene::Scene::effects(&s.draw()))
    }),
    Call::new("spherule::scene::Scene::load", |s| {
        seen(spherule::scene::Scene::load(s.path()))
    }),
    Call::new("spherule::scene::Scene::new", |s| {
        seen(spherule::scene::Scene::new(s.draw()))
    }),
    Call::new("spherule::scene::Scene::require_rung", |s| {
        seen(spherule::scene::Scene::require_rung(&s.draw(), s.draw()))
    }),
    Call::new("spherule::scene::Scene::samples", |s| {
        seen(spherule::scene::Scene::samples(&s.draw()))
    }),
    Call::new("spherule::scene::Scene::validate", |s| {
        seen(spherule::scene::Scene::validate(&s.draw()))
    }),
    Call::new("spherule::scene::Scene::view_or_framed", |s| {
        seen(spherule::scene::Scene::view_or_framed(&s.draw()))
    }),
    Call::new("spherule::scene::limits::Range as Display", |s| {
        seen(s.draw::<spherule::scene::limits::Range>().to_string())
    }),
    Call::new("spherule::scene::limits::Range::holds", |s| {
        seen(spherule::scene::limits::Range::holds(s.draw(), s.draw()))
    }),
    Call::new("spherule::scene::limits::Range::holds_all", |s| {
        seen(spherule::scene::limits::Range::holds_all(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule::scene::limits::hollow", |s| {
        seen(spherule::scene::limits::hollow(s.draw(), s.draw()))
    }),
    Call::new("spherule::scene::limits::is_vertical_fov", |s| {
        seen(spherule::scene::limits::is_vertical_fov(s.draw()))
    }),
    Call::new("spherule::scene::limits::is_within", |s| {
        seen(spherule::scene::limits::is_within(
            &s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule::scene::surroundings::Sampling as Default", |_| {
        seen(<spherule::scene::surroundings::Sampling as Default>::default())
    }),
    Call::new("spherule::scene::surroundings::Sun::height", |s| {
        seen(spherule::scene::surroundings::Sun::height(&s.draw()))
    }),
    Call::new("spherule::scene::surroundings::Sun::radiance", |s| {
        seen(spherule::scene::surroundings::Sun::radiance(&s.draw()))
    }),
    Call::new("spherule::scene::view::View::camera", |s| {
        seen(spherule::scene::view::View::camera(&s.draw(), s.draw()))
    }),
    Call::new("spherule::scene::view::View::framing", |s| {
        seen(spherule::scene::view::View::framing(
            &s.many()[..],
            s.draw(),
        ))
    }),
    Call::new("spherule::scene::world::World::add", |s| {
        seen(spherule::scene::world::World::add(
            &mut s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule::scene::world::World::add_material", |s| {
        seen(spherule::scene::world::World::add_material(
            &mut s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule::scene::world::World::add_moving", |s| {
        seen(spherule::scene::world::World::add_moving(
            &mut s.draw(),
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule::scene::world::World::add_moving_shape", |s| {
        seen(spherule::scene::world::World::add_moving_shape(
            &mut s.draw(),
            s.draw::<spherule_kernel::shape::Shape>(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule::scene::world::World::add_named_material", |s| {
        seen(spherule::scene::world::World::add_named_material(
            &mut s.draw(),
            &s.text(),
            s.draw(),
        ))
    }),
    Call::new("spherule::scene::world::World::add_shape", |s| {
        seen(spherule::scene::world::World::add_shape(
            &mut s.draw(),
            s.draw::<spherule_kernel::shape::Shape>(),
            s.draw(),
        ))
    }),
    Call::new("spherule::scene::world::World::append", |s| {
        seen(spherule::scene::world::World::append(
            &mut s.draw(),
            &s.draw(),
        ))
    }),
    Call::new("spherule::scene::world::World::glass_around", |s| {
        seen(spherule::scene::world::World::glass_around(
            &s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule::scene::world::World::kinds", |s| {
        seen(spherule::scene::world::World::kinds(&s.draw()))
    }),
    Call::new("spherule::scene::world::World::overlapping_glass", |s| {
        seen(spherule::scene::world::World::overlapping_glass(&s.draw()))
    }),
    Call::new("spherule::scene::world::World::without_copies", |s| {
        seen(spherule::scene::world::World::without_copies(&s.draw()))
    }),
    Call::new("spherule::threads::most", |_| {
        seen(spherule::threads::most())
    }),
    Call::new("spherule::trace::cpu::CpuTracer::bytes", |s| {
        seen(spherule::trace::cpu::CpuTracer::bytes(&s.draw()))
    }),
    Call::new("spherule::trace::cpu::CpuTracer::nearest", |s| {
        seen(spherule::trace::cpu::CpuTracer::nearest(
            &s.draw(),
            s.draw(),
            &s.many()[..],
            &mut s.draw(),
        ))
    }),
    Call::new("spherule::trace::cpu::CpuTracer::new", |s| {
        seen(spherule::trace::cpu::CpuTracer::new(
            &s.many()[..],
            s.draw(),
        ))
    }),
    Call::new("spherule::trace::cpu::CpuTracer::occluded", |s| {
        seen(spherule::trace::cpu::CpuTracer::occluded(
            &s.draw(),
            s.draw(),
            &s.many()[..],
            &mut s.draw(),
        ))
    }),
    Call::new("spherule::trace::cpu::CpuTracer::order", |s| {
        seen(spherule::trace::cpu::CpuTracer::order(&s.draw()))
    }),
    Call::new("spherule::trace::cpu::CpuTracer::tree", |s| {
        seen(spherule::trace::cpu::CpuTracer::tree(&s.draw()))
    }),
    Call::new("spherule::trace::cpu::CpuTracer::work", |s| {
        seen(spherule::trace::cpu::CpuTracer::work(
            &s.draw(),
            s.draw(),
            s.draw(),
            &s.many()[..],
        ))
    }),
    Call::new("spherule::trace::gpu::GpuTracer::bytes", |s| {
        seen(spherule::trace::gpu::GpuTracer::bytes(&s.draw()))
    })
    .on_gpu(),
    Call::new("spherule::trace::gpu::GpuTracer::hits", |s| {
        seen(spherule::trace::gpu::GpuTracer::hits(&s.draw(), &s.draw()))
    })
    .on_gpu(),
    Call::new("spherule::trace::gpu::GpuTracer::nearest", |s| {
        seen(spherule::trace::gpu::GpuTracer::nearest(
            &s.draw(),
            s.draw(),
            &s.draw(),
        ))
    })
    .on_gpu(),
    Call::new("spherule::trace::gpu::GpuTracer::new", |s| {
        seen(spherule::trace::gpu::GpuTracer::new(
            s.gpu(),
            &s.many()[..],
            s.draw(),
        ))
    })
    .on_gpu(),
    Call::new("spherule::trace::gpu::GpuTracer::occluded", |s| {
        seen(spherule::trace::gpu::GpuTracer::occluded(
            &s.draw(),
            s.draw(),
            &s.draw(),
        ))
    })
    .on_gpu(),
    Call::new("spherule::trace::gpu::GpuTracer::occlusions", |s| {
        seen(spherule::trace::gpu::GpuTracer::occlusions(
            &s.draw(),
            &s.draw(),
        ))
    })
    .on_gpu(),
    Call::new("spherule::trace::gpu::GpuTracer::upload", |s| {
        seen(spherule::trace::gpu::GpuTracer::upload(
            &s.draw(),
            &s.many()[..],
        ))
    })
    .on_gpu(),
    Call::new("spherule::ulp::distance", |s| {
        seen(spherule::ulp::distance(s.draw(), s.draw()))
    }),
    Call::new("spherule::ulp::shown", |s| {
        seen(spherule::ulp::shown(s.draw()))
    }),
    Call::new(
        "spherule_kernel::accel::brute::MovingSpheres as spherule_kernel::accel::brute::Spheres::count",
        |s| {
            seen(<spherule_kernel::accel::brute::MovingSpheres as spherule_kernel::accel::brute::Spheres>::count(&s.draw::<odd::OddMovingSpheres>().get()))
        },
    ),
    Call::new(
        "spherule_kernel::accel::brute::MovingSpheres as spherule_kernel::accel::brute::Spheres::is_left",
        |s| {
            seen(<spherule_kernel::accel::brute::MovingSpheres as spherule_kernel::accel::brute::Spheres>::is_left(&s.draw::<odd::OddMovingSpheres>().get(), s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::accel::brute::MovingSpheres as spherule_kernel::accel::brute::Spheres::is_passed",
        |s| {
            seen(<spherule_kernel::accel::brute::MovingSpheres as spherule_kernel::accel::brute::Spheres>::is_passed(&s.draw::<odd::OddMovingSpheres>().get(), s.draw()))
        },
    ),
    Call::new("spherule_kernel::accel::brute::MovingSpheres::read", |s| {
        seen(spherule_kernel::accel::brute::MovingSpheres::read(
            &s.draw::<odd::OddMovingSpheres>().get(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::accel::brute::is_occluded#0", |s| {
        seen(spherule_kernel::accel::brute::is_occluded(
            s.draw(),
            &s.draw(),
            &s.many::<spherule_kernel::Sphere>()[..],
        ))
    }),
    Call::new("spherule_kernel::accel::brute::is_occluded#1", |s| {
        seen(spherule_kernel::accel::brute::is_occluded(
            s.draw(),
            &s.draw(),
            &s.draw::<odd::OddMovingSpheres>().get(),
        ))
    }),
    Call::new("spherule_kernel::accel::brute::nearest_hit", |s| {
        seen(spherule_kernel::accel::brute::nearest_hit(
            &s.draw(),
            &s.many()[..],
        ))
    }),
    Call::new(
        "spherule_kernel::accel::brute::nearest_hit_by_bounds#0",
        |s| {
            seen(spherule_kernel::accel::brute::nearest_hit_by_bounds(
                s.draw(),
                &s.draw(),
                &s.many::<spherule_kernel::Sphere>()[..],
                s.draw(),
                s.few(),
            ))
        },
    ),
    Call::new(
        "spherule_kernel::accel::brute::nearest_hit_by_bounds#1",
        |s| {
            seen(spherule_kernel::accel::brute::nearest_hit_by_bounds(
                s.draw(),
                &s.draw(),
                &s.draw::<odd::OddMovingSpheres>().get(),
                s.draw(),
                s.few(),
            ))
        },
    ),
    Call::new("spherule_kernel::accel::brute::nearest_hit_in#0", |s| {
        seen(spherule_kernel::accel::brute::nearest_hit_in(
            s.draw(),
            &s.draw(),
            &s.many::<spherule_kernel::Sphere>()[..],
            s.draw(),
            s.few(),
        ))
    }),
    Call::new("spherule_kernel::accel::brute::nearest_hit_in#1", |s| {
        seen(spherule_kernel::accel::brute::nearest_hit_in(
            s.draw(),
            &s.draw(),
            &s.draw::<odd::OddMovingSpheres>().get(),
            s.draw(),
            s.few(),
        ))
    }),
    Call::new("spherule_kernel::accel::node::Extent::of_node", |s| {
        seen(spherule_kernel::accel::node::Extent::of_node(&s.draw()))
    }),
    Call::new("spherule_kernel::accel::node::Extent::to_node", |s| {
        seen(spherule_kernel::accel::node::Extent::to_node(s.draw()))
    }),
    Call::new("spherule_kernel::accel::node::Extent::widening", |s| {
        seen(spherule_kernel::accel::node::Extent::widening(
            &s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::accel::node::Node::all_spheres", |s| {
        seen(spherule_kernel::accel::node::Node::all_spheres(&s.draw()))
    }),
    Call::new("spherule_kernel::accel::node::Node::child", |s| {
        seen(spherule_kernel::accel::node::Node::child(
            &s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::accel::node::Node::has_nodes", |s| {
        seen(spherule_kernel::accel::node::Node::has_nodes(&s.draw()))
    }),
    Call::new("spherule_kernel::accel::node::Node::is_node", |s| {
        seen(spherule_kernel::accel::node::Node::is_node(
            &s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::accel::node::Node::leaf", |s| {
        seen(spherule_kernel::accel::node::Node::leaf(
            &s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::accel::node::Node::lower", |s| {
        seen(spherule_kernel::accel::node::Node::lower(s.draw()))
    }),
    Call::new("spherule_kernel::accel::node::Node::upper", |s| {
        seen(spherule_kernel::accel::node::Node::upper(s.draw()))
    }),
    Call::new("spherule_kernel::accel::node::Tree::is_none", |s| {
        seen(spherule_kernel::accel::node::Tree::is_none(
            s.draw::<odd::OddTree>().get(),
        ))
    }),
    Call::new("spherule_kernel::accel::node::Tree::nodes", |s| {
        seen(spherule_kernel::accel::node::Tree::nodes(
            s.draw::<odd::OddTree>().get(),
        ))
    }),
    Call::new("spherule_kernel::accel::node::Tree::of", |s| {
        seen(spherule_kernel::accel::node::Tree::of(&s.many()[..]))
    }),
    Call::new("spherule_kernel::accel::slabs::Slabs::of", |s| {
        seen(spherule_kernel::accel::slabs::Slabs::of(
            s.draw(),
            &s.draw(),
            &s.draw(),
        ))
    }),
    Call::new("spherule_kernel::accel::slabs::Slabs::widened", |s| {
        seen(spherule_kernel::accel::slabs::Slabs::widened(
            &s.draw(),
            &s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::accel::slabs::Slabs::widened_end", |s| {
        seen(spherule_kernel::accel::slabs::Slabs::widened_end(s.draw()))
    }),
    Call::new(
        "spherule_kernel::accel::traversal::OneByOne as spherule_kernel::accel::traversal::Traversal::is_occluded",
        |s| {
            seen(<spherule_kernel::accel::traversal::OneByOne as spherule_kernel::accel::traversal::Traversal>::is_occluded(&s.draw::<odd::OddOneByOne>().get(), &s.draw(), &s.draw::<odd::OddMovingSpheres>().get()))
        },
    ),
    Call::new(
        "spherule_kernel::accel::traversal::OneByOne as spherule_kernel::accel::traversal::Traversal::nearest_hit",
        |s| {
            seen(<spherule_kernel::accel::traversal::OneByOne as spherule_kernel::accel::traversal::Traversal>::nearest_hit(&s.draw::<odd::OddOneByOne>().get(), &s.draw(), &s.draw::<odd::OddMovingSpheres>().get()))
        },
    ),
    Call::new("spherule_kernel::accel::walk::any_hit_in_tree#0", |s| {
        seen(spherule_kernel::accel::walk::any_hit_in_tree(
            s.draw(),
            &s.draw(),
            s.draw::<odd::OddTree>().get(),
            &s.many::<spherule_kernel::Sphere>()[..],
        ))
    }),
    Call::new("spherule_kernel::accel::walk::any_hit_in_tree#1", |s| {
        seen(spherule_kernel::accel::walk::any_hit_in_tree(
            s.draw(),
            &s.draw(),
            s.draw::<odd::OddTree>().get(),
            &s.draw::<odd::OddMovingSpheres>().get(),
        ))
    }),
    Call::new("spherule_kernel::accel::walk::is_occluded_in_tree#0", |s| {
        seen(spherule_kernel::accel::walk::is_occluded_in_tree(
            s.draw(),
            &s.draw(),
            s.draw::<odd::OddTree>().get(),
            &s.many::<spherule_kernel::Sphere>()[..],
        ))
    }),
    Call::new("spherule_kernel::accel::walk::is_occluded_in_tree#1", |s| {
        seen(spherule_kernel::accel::walk::is_occluded_in_tree(
            s.draw(),
            &s.draw(),
            s.draw::<odd::OddTree>().get(),
            &s.draw::<odd::OddMovingSpheres>().get(),
        ))
    }),
    Call::new("spherule_kernel::accel::walk::nearest_hit_in_tree#0", |s| {
        seen(spherule_kernel::accel::walk::nearest_hit_in_tree(
            s.draw(),
            &s.draw(),
            s.draw::<odd::OddTree>().get(),
            &s.many::<spherule_kernel::Sphere>()[..],
        ))
    }),
    Call::new("spherule_kernel::accel::walk::nearest_hit_in_tree#1", |s| {
        seen(spherule_kernel::accel::walk::nearest_hit_in_tree(
            s.draw(),
            &s.draw(),
            s.draw::<odd::OddTree>().get(),
            &s.draw::<odd::OddMovingSpheres>().get(),
        ))
    }),
    Call::new("spherule_kernel::accel::walk::work_in_tree#0", |s| {
        seen(spherule_kernel::accel::walk::work_in_tree(
            s.draw(),
            s.draw(),
            &s.draw(),
            s.draw::<odd::OddTree>().get(),
            &s.many::<spherule_kernel::Sphere>()[..],
        ))
    }),
    Call::new("spherule_kernel::accel::walk::work_in_tree#1", |s| {
        seen(spherule_kernel::accel::walk::work_in_tree(
            s.draw(),
            s.draw(),
            &s.draw(),
            s.draw::<odd::OddTree>().get(),
            &s.draw::<odd::OddMovingSpheres>().get(),
        ))
    }),
    Call::new("spherule_kernel::arithmetic::arctangent::arctangent", |s| {
        seen(spherule_kernel::arithmetic::arctangent::arctangent(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::arithmetic::distill::distill#0", |s| {
        seen(spherule_kernel::arithmetic::distill::distill(
            &mut s.draw::<[f32; 1]>(),
        ))
    }),
    Call::new("spherule_kernel::arithmetic::distill::distill#1", |s| {
        seen(spherule_kernel::arithmetic::distill::distill(
            &mut s.draw::<[f32; 2]>(),
        ))
    }),
    Call::new("spherule_kernel::arithmetic::distill::distill#2", |s| {
        seen(spherule_kernel::arithmetic::distill::distill(
            &mut s.draw::<[f32; 9]>(),
        ))
    }),
    Call::new(
        "spherule_kernel::arithmetic::double_word::DoubleWord::difference",
        |s| {
            seen(
                spherule_kernel::arithmetic::double_word::DoubleWord::<f32>::difference(
                    s.draw(),
                    s.draw(),
                ),
            )
        },
    ),
    Call::new(
        "spherule_kernel::arithmetic::double_word::DoubleWord::divided_by",
        |s| {
            seen(
                spherule_kernel::arithmetic::double_word::DoubleWord::<f32>::divided_by(
                    s.draw(),
                    s.draw(),
                ),
            )
        },
    ),
    Call::new(
        "spherule_kernel::arithmetic::double_word::DoubleWord::from_float",
        |s| seen(spherule_kernel::arithmetic::double_word::DoubleWord::<f32>::from_float(s.draw())),
    ),
    Call::new(
        "spherule_kernel::arithmetic::double_word::DoubleWord::minus",
        |s| {
            seen(
                spherule_kernel::arithmetic::double_word::DoubleWord::<f32>::minus(
                    s.draw(),
                    s.draw(),
                ),
            )
        },
    ),
    Call::new(
        "spherule_kernel::arithmetic::double_word::DoubleWord::plus",
        |s| {
            seen(
                spherule_kernel::arithmetic::double_word::DoubleWord::<f32>::plus(
                    s.draw(),
                    s.draw(),
                ),
            )
        },
    ),
    Call::new(
        "spherule_kernel::arithmetic::double_word::DoubleWord::product",
        |s| {
            seen(
                spherule_kernel::arithmetic::double_word::DoubleWord::<f32>::product(
                    s.draw(),
                    s.draw(),
                ),
            )
        },
    ),
    Call::new(
        "spherule_kernel::arithmetic::double_word::DoubleWord::square_root",
        |s| {
            seen(spherule_kernel::arithmetic::double_word::DoubleWord::<f32>::square_root(s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::arithmetic::double_word::DoubleWord::times",
        |s| {
            seen(
                spherule_kernel::arithmetic::double_word::DoubleWord::<f32>::times(
                    s.draw(),
                    s.draw(),
                ),
            )
        },
    ),
    Call::new(
        "spherule_kernel::arithmetic::double_word::DoubleWord::times_float",
        |s| {
            seen(
                spherule_kernel::arithmetic::double_word::DoubleWord::<f32>::times_float(
                    s.draw(),
                    s.draw(),
                ),
            )
        },
    ),
    Call::new(
        "spherule_kernel::arithmetic::double_word::DoubleWord::total",
        |s| {
            seen(
                spherule_kernel::arithmetic::double_word::DoubleWord::<f32>::total(
                    s.draw(),
                    s.draw(),
                ),
            )
        },
    ),
    Call::new("spherule_kernel::arithmetic::elements::get", |s| {
        seen(spherule_kernel::arithmetic::elements::get(
            &s.draw::<[u32; 5]>(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::arithmetic::elements::read", |s| {
        seen(spherule_kernel::arithmetic::elements::read::<u32>(
            &s.many()[..],
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::arithmetic::elements::set", |s| {
        seen(spherule_kernel::arithmetic::elements::set(
            &mut s.draw::<[u32; 5]>(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new(
        "spherule_kernel::arithmetic::error_free::fast_two_sum",
        |s| seen(spherule_kernel::arithmetic::error_free::fast_two_sum::<f32>(s.draw(), s.draw())),
    ),
    Call::new("spherule_kernel::arithmetic::error_free::split", |s| {
        seen(spherule_kernel::arithmetic::error_free::split::<f32>(
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::arithmetic::error_free::two_diff", |s| {
        seen(spherule_kernel::arithmetic::error_free::two_diff::<f32>(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new(
        "spherule_kernel::arithmetic::error_free::two_product",
        |s| {
            seen(spherule_kernel::arithmetic::error_free::two_product::<f32>(
                s.draw(),
                s.draw(),
            ))
        },
    ),
    Call::new("spherule_kernel::arithmetic::error_free::two_sum", |s| {
        seen(spherule_kernel::arithmetic::error_free::two_sum::<f32>(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::arithmetic::strict::add", |s| {
        seen(spherule_kernel::arithmetic::strict::add(s.draw(), s.draw()))
    }),
    Call::new("spherule_kernel::arithmetic::strict::add_wide", |s| {
        seen(spherule_kernel::arithmetic::strict::add_wide(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::arithmetic::strict::mul", |s| {
        seen(spherule_kernel::arithmetic::strict::mul(s.draw(), s.draw()))
    }),
    Call::new("spherule_kernel::arithmetic::strict::mul_wide", |s| {
        seen(spherule_kernel::arithmetic::strict::mul_wide(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::arithmetic::strict::sub", |s| {
        seen(spherule_kernel::arithmetic::strict::sub(s.draw(), s.draw()))
    }),
    Call::new("spherule_kernel::arithmetic::strict::sub_wide", |s| {
        seen(spherule_kernel::arithmetic::strict::sub_wide(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::arithmetic::turn::turn", |s| {
        seen(spherule_kernel::arithmetic::turn::turn(s.draw()))
    }),
    Call::new("spherule_kernel::camera::Camera::film", |s| {
        seen(spherule_kernel::camera::Camera::film(s.draw(), s.draw()))
    }),
    Call::new("spherule_kernel::camera::Camera::from_basis", |s| {
        seen(spherule_kernel::camera::Camera::from_basis(
            s.draw(),
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::camera::Camera::look_at", |s| {
        seen(spherule_kernel::camera::Camera::look_at(
            s.draw(),
            s.draw(),
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::camera::Camera::pixel_ray", |s| {
        seen(spherule_kernel::camera::Camera::pixel_ray(
            &s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::camera::Camera::ray", |s| {
        seen(spherule_kernel::camera::Camera::ray(&s.draw(), s.draw()))
    }),
    Call::new("spherule_kernel::color::luminance", |s| {
        seen(spherule_kernel::color::luminance(s.draw()))
    }),
    Call::new("spherule_kernel::cull::bounds::Aim::bounds", |s| {
        seen(spherule_kernel::cull::bounds::Aim::<f32>::bounds(
            &s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::cull::bounds::Aim::is_out_of_reach", |s| {
        seen(spherule_kernel::cull::bounds::Aim::<f32>::is_out_of_reach(
            &s.draw(),
            &s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::cull::bounds::Bounds::is_open", |s| {
        seen(spherule_kernel::cull::bounds::Bounds::is_open(
            &s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::cull::bounds::Line::aim", |s| {
        seen(spherule_kernel::cull::bounds::Line::aim(&s.draw()))
    }),
    Call::new("spherule_kernel::cull::bounds::Line::bounds", |s| {
        seen(spherule_kernel::cull::bounds::Line::bounds(
            &s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::cull::bounds::Line::may_hit", |s| {
        seen(spherule_kernel::cull::bounds::Line::may_hit(
            &s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::cull::bounds::Line::of", |s| {
        seen(spherule_kernel::cull::bounds::Line::of(&s.draw()))
    }),
    Call::new("spherule_kernel::cull::cone::Cone::from_vec4", |s| {
        seen(spherule_kernel::cull::cone::Cone::from_vec4(s.draw()))
    }),
    Call::new("spherule_kernel::cull::cone::Cone::none", |_| {
        seen(spherule_kernel::cull::cone::Cone::none())
    }),
    Call::new("spherule_kernel::cull::cone::Cone::of", |s| {
        seen(spherule_kernel::cull::cone::Cone::of(s.draw(), s.draw()))
    }),
    Call::new("spherule_kernel::cull::cone::Cone::to_vec4", |s| {
        seen(spherule_kernel::cull::cone::Cone::to_vec4(s.draw()))
    }),
    Call::new("spherule_kernel::cull::cone::Sight::along", |s| {
        seen(spherule_kernel::cull::cone::Sight::along(s.draw()))
    }),
    Call::new("spherule_kernel::cull::cone::Sight::misses", |s| {
        seen(spherule_kernel::cull::cone::Sight::misses(
            &s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new(
        "spherule_kernel::cull::discriminant::Target::may_hit",
        |s| {
            seen(spherule_kernel::cull::discriminant::Target::<f32>::may_hit(
                &s.draw(),
                s.draw(),
                s.draw(),
            ))
        },
    ),
    Call::new("spherule_kernel::cull::discriminant::Target::of", |s| {
        seen(spherule_kernel::cull::discriminant::Target::<f32>::of(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new(
        "spherule_kernel::cull::discriminant::power_of_two_under",
        |s| {
            seen(spherule_kernel::cull::discriminant::power_of_two_under(
                s.draw(),
            ))
        },
    ),
    Call::new("spherule_kernel::cull::frustum::Frustum::around", |s| {
        seen(spherule_kernel::cull::frustum::Frustum::around(
            &s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::cull::frustum::Frustum::misses", |s| {
        seen(spherule_kernel::cull::frustum::Frustum::misses(
            &s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::cull::frustum::Frustum::within", |s| {
        seen(spherule_kernel::cull::frustum::Frustum::within(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::cull::frustum::Plane::around", |s| {
        seen(spherule_kernel::cull::frustum::Plane::around(
            &s.draw(),
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::cull::frustum::Plane::from_vec4", |s| {
        seen(spherule_kernel::cull::frustum::Plane::from_vec4(s.draw()))
    }),
    Call::new("spherule_kernel::cull::frustum::Plane::to_vec4", |s| {
        seen(spherule_kernel::cull::frustum::Plane::to_vec4(s.draw()))
    }),
    Call::new("spherule_kernel::cull::frustum::inward_normal", |s| {
        seen(spherule_kernel::cull::frustum::inward_normal::<f32>(
            s.draw(),
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::effects::Effects::and", |s| {
        seen(spherule_kernel::effects::Effects::and(s.draw(), s.draw()))
    }),
    Call::new("spherule_kernel::effects::Effects::any", |s| {
        seen(spherule_kernel::effects::Effects::any(s.draw(), s.draw()))
    }),
    Call::new("spherule_kernel::effects::Effects::from_bits", |s| {
        seen(spherule_kernel::effects::Effects::from_bits(s.draw()))
    }),
    Call::new("spherule_kernel::effects::Effects::is_empty", |s| {
        seen(spherule_kernel::effects::Effects::is_empty(s.draw()))
    }),
    Call::new("spherule_kernel::effects::Effects::to_bits", |s| {
        seen(spherule_kernel::effects::Effects::to_bits(s.draw()))
    }),
    Call::new("spherule_kernel::effects::Effects::within", |s| {
        seen(spherule_kernel::effects::Effects::within(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::effects::Effects::without", |s| {
        seen(spherule_kernel::effects::Effects::without(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::film::Accumulator::add", |s| {
        seen(spherule_kernel::film::Accumulator::add(
            &mut s.draw(),
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::film::Accumulator::add_to_group", |s| {
        seen(spherule_kernel::film::Accumulator::add_to_group(
            &mut s.draw(),
            s.draw(),
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::film::Accumulator::alpha", |s| {
        seen(spherule_kernel::film::Accumulator::alpha(&s.draw()))
    }),
    Call::new("spherule_kernel::film::Accumulator::color", |s| {
        seen(spherule_kernel::film::Accumulator::color(&s.draw()))
    }),
    Call::new("spherule_kernel::film::Accumulator::depth", |s| {
        seen(spherule_kernel::film::Accumulator::depth(&s.draw()))
    }),
    Call::new("spherule_kernel::film::Accumulator::of_tile", |s| {
        seen(spherule_kernel::film::Accumulator::of_tile(s.draw()))
    }),
    Call::new("spherule_kernel::film::Accumulator::pixel_at", |s| {
        seen(spherule_kernel::film::Accumulator::pixel_at(
            &s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::film::Accumulator::samples", |s| {
        seen(spherule_kernel::film::Accumulator::samples(&s.draw()))
    }),
    Call::new(
        "spherule_kernel::film::Accumulator::variance_by_groups",
        |s| {
            seen(spherule_kernel::film::Accumulator::variance_by_groups(
                &s.draw(),
            ))
        },
    ),
    Call::new(
        "spherule_kernel::film::Accumulator::variance_of_mean",
        |s| {
            seen(spherule_kernel::film::Accumulator::variance_of_mean(
                &s.draw(),
            ))
        },
    ),
    Call::new("spherule_kernel::film::Launch::blank", |s| {
        seen(spherule_kernel::film::Launch::blank(&s.draw()))
    }),
    Call::new("spherule_kernel::film::Launch::pixel", |s| {
        seen(spherule_kernel::film::Launch::pixel(
            &s.draw(),
            s.draw(),
            &s.draw(),
            s.draw(),
            &s.many()[..],
            &s.many()[..],
            &s.many()[..],
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::film::Launch::ray", |s| {
        seen(spherule_kernel::film::Launch::ray(
            &s.draw(),
            s.draw(),
            &s.draw(),
        ))
    }),
    Call::new("spherule_kernel::film::Launch::unless_hit", |s| {
        seen(spherule_kernel::film::Launch::unless_hit(
            &s.draw(),
            &s.draw(),
        ))
    }),
    Call::new("spherule_kernel::film::Pixel::color", |s| {
        seen(spherule_kernel::film::Pixel::color(&s.draw()))
    }),
    Call::new("spherule_kernel::film::Pixel::deferred", |s| {
        seen(spherule_kernel::film::Pixel::deferred(&s.draw()))
    }),
    Call::new("spherule_kernel::film::Pixel::depth", |s| {
        seen(spherule_kernel::film::Pixel::depth(&s.draw()))
    }),
    Call::new("spherule_kernel::film::Pixel::is_deferred", |s| {
        seen(spherule_kernel::film::Pixel::is_deferred(&s.draw()))
    }),
    Call::new("spherule_kernel::film::Pixel::is_hit", |s| {
        seen(spherule_kernel::film::Pixel::is_hit(&s.draw()))
    }),
    Call::new("spherule_kernel::film::Pixel::is_written", |s| {
        seen(spherule_kernel::film::Pixel::is_written(&s.draw()))
    }),
    Call::new("spherule_kernel::film::Pixel::new", |s| {
        seen(spherule_kernel::film::Pixel::new(s.draw(), s.draw()))
    }),
    Call::new("spherule_kernel::filter::Filter as Default", |_| {
        seen(<spherule_kernel::filter::Filter as Default>::default())
    }),
    Call::new("spherule_kernel::filter::Filter::new", |s| {
        seen(spherule_kernel::filter::Filter::new(s.draw(), s.draw()))
    }),
    Call::new("spherule_kernel::filter::Filter::place", |s| {
        seen(spherule_kernel::filter::Filter::place(&s.draw(), s.draw()))
    }),
    Call::new("spherule_kernel::fog::Fog::phase", |s| {
        seen(spherule_kernel::fog::Fog::phase(&s.draw(), s.draw()))
    }),
    Call::new("spherule_kernel::fog::Fog::sample", |s| {
        seen(spherule_kernel::fog::Fog::sample(
            &s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::fog::Fog::sample_distance", |s| {
        seen(spherule_kernel::fog::Fog::sample_distance(
            &s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::fog::Fog::span", |s| {
        seen(spherule_kernel::fog::Fog::span(
            &s.draw(),
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::fog::Fog::transmittance", |s| {
        seen(spherule_kernel::fog::Fog::transmittance(
            &s.draw(),
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::gpu::instructions::highest_bit", |s| {
        seen(spherule_kernel::gpu::instructions::highest_bit(s.draw()))
    }),
    Call::new("spherule_kernel::gpu::instructions::inverse_root", |s| {
        seen(spherule_kernel::gpu::instructions::inverse_root(s.draw()))
    }),
    Call::new("spherule_kernel::gpu::instructions::larger", |s| {
        seen(spherule_kernel::gpu::instructions::larger(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::gpu::instructions::lowest_bit", |s| {
        seen(spherule_kernel::gpu::instructions::lowest_bit(s.draw()))
    }),
    Call::new("spherule_kernel::gpu::instructions::smaller", |s| {
        seen(spherule_kernel::gpu::instructions::smaller(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::hit::Hit as Default", |_| {
        seen(<spherule_kernel::hit::Hit as Default>::default())
    }),
    Call::new("spherule_kernel::hit::Hit::is_deferred", |s| {
        seen(spherule_kernel::hit::Hit::is_deferred(&s.draw()))
    }),
    Call::new("spherule_kernel::hit::Hit::is_some", |s| {
        seen(spherule_kernel::hit::Hit::is_some(&s.draw()))
    }),
    Call::new("spherule_kernel::lane::Lane3::cross", |s| {
        seen(spherule_kernel::lane::Lane3::<f32>::cross(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::lane::Lane3::dot", |s| {
        seen(spherule_kernel::lane::Lane3::<f32>::dot(s.draw(), s.draw()))
    }),
    Call::new("spherule_kernel::lane::Lane3::dot_rough", |s| {
        seen(spherule_kernel::lane::Lane3::<f32>::dot_rough(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::lane::Lane3::minus", |s| {
        seen(spherule_kernel::lane::Lane3::<f32>::minus(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::lane::Lane3::minus_scaled", |s| {
        seen(spherule_kernel::lane::Lane3::<f32>::minus_scaled(
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::lane::Lane3::of", |s| {
        seen(spherule_kernel::lane::Lane3::<f32>::of(s.draw()))
    }),
    Call::new("spherule_kernel::lane::Lane3::plus", |s| {
        seen(spherule_kernel::lane::Lane3::<f32>::plus(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::lane::Lane3::scaled", |s| {
        seen(spherule_kernel::lane::Lane3::<f32>::scaled(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::lane::Lane3::to_vec3", |s| {
        seen(spherule_kernel::lane::Lane3::<f32>::to_vec3(s.draw()))
    }),
    Call::new("spherule_kernel::lane::Lane3::widened", |s| {
        seen(spherule_kernel::lane::Lane3::<f32>::widened(s.draw()))
    }),
    Call::new("spherule_kernel::light::Light::environment", |_| {
        seen(spherule_kernel::light::Light::environment())
    }),
    Call::new("spherule_kernel::light::Light::point", |s| {
        seen(spherule_kernel::light::Light::point(s.draw(), s.draw()))
    }),
    Call::new("spherule_kernel::light::Light::sphere", |s| {
        seen(spherule_kernel::light::Light::sphere(s.draw(), s.draw()))
    }),
    Call::new("spherule_kernel::light::Light::sun", |s| {
        seen(spherule_kernel::light::Light::sun(
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::light::cap_height", |s| {
        seen(spherule_kernel::light::cap_height(s.draw(), s.draw()))
    }),
    Call::new("spherule_kernel::light::sample_sphere", |s| {
        seen(spherule_kernel::light::sample_sphere(
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new(
        "spherule_kernel::light::sky::Sky::environment_density",
        |s| {
            seen(spherule_kernel::light::sky::Sky::environment_density(
                &s.draw(),
                s.draw(),
                &s.many()[..],
            ))
        },
    ),
    Call::new("spherule_kernel::light::sky::Sky::is_sun", |s| {
        seen(spherule_kernel::light::sky::Sky::is_sun(
            &s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::light::sky::Sky::radiance", |s| {
        seen(spherule_kernel::light::sky::Sky::radiance(
            &s.draw(),
            s.draw(),
            s.draw(),
            &s.many()[..],
        ))
    }),
    Call::new(
        "spherule_kernel::light::sky::Sky::sample_environment",
        |s| {
            seen(spherule_kernel::light::sky::Sky::sample_environment(
                &s.draw(),
                s.draw(),
                &s.many()[..],
                &s.many()[..],
            ))
        },
    ),
    Call::new("spherule_kernel::light::solid_angle", |s| {
        seen(spherule_kernel::light::solid_angle(s.draw()))
    }),
    Call::new("spherule_kernel::light::sphere_density", |s| {
        seen(spherule_kernel::light::sphere_density(s.draw(), s.draw()))
    }),
    Call::new("spherule_kernel::light::tree::choose", |s| {
        seen(spherule_kernel::light::tree::choose(
            &s.many()[..],
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::light::tree::probability_of", |s| {
        seen(spherule_kernel::light::tree::probability_of(
            &s.many()[..],
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::material::Material::bubble", |s| {
        seen(spherule_kernel::material::Material::bubble(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::material::Material::diffuse", |s| {
        seen(spherule_kernel::material::Material::diffuse(s.draw()))
    }),
    Call::new("spherule_kernel::material::Material::emissive", |s| {
        seen(spherule_kernel::material::Material::emissive(s.draw()))
    }),
    Call::new("spherule_kernel::material::Material::glass", |s| {
        seen(spherule_kernel::material::Material::glass(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::material::Material::is_glass", |s| {
        seen(spherule_kernel::material::Material::is_glass(&s.draw()))
    }),
    Call::new("spherule_kernel::material::Material::metal", |s| {
        seen(spherule_kernel::material::Material::metal(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::material::Material::plastic", |s| {
        seen(spherule_kernel::material::Material::plastic(
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::material::material_of", |s| {
        seen(spherule_kernel::material::material_of(
            s.draw(),
            &s.many()[..],
            &s.many()[..],
        ))
    }),
    Call::new(
        "spherule_kernel::material::microfacet::RoughMetal::evaluate",
        |s| {
            seen(spherule_kernel::material::microfacet::RoughMetal::evaluate(
                &s.draw(),
                s.draw(),
                &s.many()[..],
            ))
        },
    ),
    Call::new(
        "spherule_kernel::material::microfacet::RoughMetal::new",
        |s| {
            seen(spherule_kernel::material::microfacet::RoughMetal::new(
                s.draw(),
                s.draw(),
                s.draw(),
                &s.many()[..],
            ))
        },
    ),
    Call::new(
        "spherule_kernel::material::microfacet::RoughMetal::sample",
        |s| {
            seen(spherule_kernel::material::microfacet::RoughMetal::sample(
                &s.draw(),
                s.draw(),
                s.draw(),
            ))
        },
    ),
    Call::new("spherule_kernel::material::microfacet::Shares::mean", |s| {
        seen(spherule_kernel::material::microfacet::Shares::mean(
            &s.many()[..],
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::material::microfacet::Shares::of", |s| {
        seen(spherule_kernel::material::microfacet::Shares::of(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new(
        "spherule_kernel::material::microfacet::Shares::towards",
        |s| {
            seen(spherule_kernel::material::microfacet::Shares::towards(
                &s.many()[..],
                s.draw(),
                s.draw(),
            ))
        },
    ),
    Call::new(
        "spherule_kernel::material::microfacet::albedo::Albedo::of",
        |s| {
            seen(spherule_kernel::material::microfacet::Albedo::of(
                s.draw(),
                s.draw(),
            ))
        },
    ),
    Call::new(
        "spherule_kernel::material::microfacet::albedo::Albedo::table",
        |_| seen(spherule_kernel::material::microfacet::Albedo::table()),
    ),
    Call::new(
        "spherule_kernel::material::microfacet::sample_visible",
        |s| {
            seen(spherule_kernel::material::microfacet::sample_visible(
                s.draw(),
                s.draw(),
                s.draw(),
            ))
        },
    ),
    Call::new("spherule_kernel::material::microfacet::schlick", |s| {
        seen(spherule_kernel::material::microfacet::schlick(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::material::optics::Fresnel::refract", |s| {
        seen(spherule_kernel::material::optics::Fresnel::refract(
            s.draw(),
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new(
        "spherule_kernel::material::optics::Incidence::fresnel",
        |s| {
            seen(spherule_kernel::material::optics::Incidence::fresnel(
                s.draw(),
            ))
        },
    ),
    Call::new(
        "spherule_kernel::material::optics::Incidence::squared_cosine_transmitted",
        |s| {
            seen(spherule_kernel::material::optics::Incidence::squared_cosine_transmitted(s.draw()))
        },
    ),
    Call::new("spherule_kernel::material::optics::reflect", |s| {
        seen(spherule_kernel::material::optics::reflect(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new(
        "spherule_kernel::material::plastic::Plastic::evaluate",
        |s| {
            seen(spherule_kernel::material::plastic::Plastic::evaluate(
                &s.draw(),
                s.draw(),
                &s.many()[..],
            ))
        },
    ),
    Call::new("spherule_kernel::material::plastic::Plastic::new", |s| {
        seen(spherule_kernel::material::plastic::Plastic::new(
            s.draw(),
            s.draw(),
            s.draw(),
            s.draw(),
            &s.many()[..],
        ))
    }),
    Call::new("spherule_kernel::material::plastic::Plastic::sample", |s| {
        seen(spherule_kernel::material::plastic::Plastic::sample(
            &s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::path::caustic::ball::Ball::fold", |s| {
        seen(spherule_kernel::path::caustic::ball::Ball::fold(
            &s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::path::caustic::ball::Ball::new", |s| {
        seen(spherule_kernel::path::caustic::ball::Ball::new(
            s.draw(),
            s.draw(),
            s.draw(),
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::path::caustic::ball::Ball::root", |s| {
        seen(spherule_kernel::path::caustic::ball::Ball::root(
            &s.draw(),
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::path::caustic::ball::Ball::spread", |s| {
        seen(spherule_kernel::path::caustic::ball::Ball::spread(
            &s.draw(),
            s.draw(),
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::path::caustic::ball::Ball::turn", |s| {
        seen(spherule_kernel::path::caustic::ball::Ball::turn(
            &s.draw(),
            s.draw(),
        ))
    }),
    Call::new(
        "spherule_kernel::path::caustic::casters::Entry::choose",
        |s| {
            seen(spherule_kernel::path::caustic::casters::Entry::choose(
                &s.many()[..],
                s.draw(),
                s.draw(),
            ))
        },
    ),
    Call::new(
        "spherule_kernel::path::caustic::casters::Entry::find",
        |s| {
            seen(spherule_kernel::path::caustic::casters::Entry::find(
                &s.many()[..],
                s.draw(),
                s.draw(),
            ))
        },
    ),
    Call::new(
        "spherule_kernel::path::caustic::casters::Entry::is_hollow",
        |s| {
            seen(spherule_kernel::path::caustic::casters::Entry::is_hollow(
                s.draw(),
            ))
        },
    ),
    Call::new("spherule_kernel::path::caustic::casters::Entry::new", |s| {
        seen(spherule_kernel::path::caustic::casters::Entry::new(
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new(
        "spherule_kernel::path::caustic::casters::Entry::table",
        |s| {
            seen(spherule_kernel::path::caustic::casters::Entry::table(
                &s.many()[..],
            ))
        },
    ),
    Call::new("spherule_kernel::path::caustic::ways::Caster::ball", |s| {
        seen(spherule_kernel::path::caustic::ways::Caster::ball(
            &s.draw(),
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::path::caustic::ways::Ways::new", |s| {
        seen(spherule_kernel::path::caustic::ways::Ways::new(
            s.draw(),
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::path::caustic::ways::Ways::way", |s| {
        seen(spherule_kernel::path::caustic::ways::Ways::way(
            &mut s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::path::light_path::Path::bounces", |s| {
        seen(spherule_kernel::path::Path::bounces(&s.draw()))
    }),
    Call::new("spherule_kernel::path::light_path::Path::end", |s| {
        seen(spherule_kernel::path::Path::end(
            &s.draw(),
            &s.draw::<odd::OddScenery>().get(),
            s.draw(),
            &mut s.draw(),
        ))
    }),
    Call::new("spherule_kernel::path::light_path::Path::left", |s| {
        seen(spherule_kernel::path::Path::left(&s.draw()))
    }),
    Call::new("spherule_kernel::path::light_path::Path::or_exit", |s| {
        seen(spherule_kernel::path::Path::or_exit(&s.draw(), s.draw()))
    }),
    Call::new("spherule_kernel::path::light_path::Path::ray", |s| {
        seen(spherule_kernel::path::Path::ray(&s.draw()))
    }),
    Call::new("spherule_kernel::path::light_path::Path::receive", |s| {
        seen(spherule_kernel::path::Path::receive(
            &mut s.draw(),
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::path::light_path::Path::time", |s| {
        seen(spherule_kernel::path::Path::time(&s.draw()))
    }),
    Call::new("spherule_kernel::path::random::Sampler::at_vertex", |s| {
        seen(spherule_kernel::path::random::Sampler::at_vertex(
            &s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::path::random::Sampler::in_groups", |s| {
        seen(spherule_kernel::path::random::Sampler::in_groups(
            s.draw(),
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::path::random::Sampler::new", |s| {
        seen(spherule_kernel::path::random::Sampler::new(
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::path::random::Sampler::of", |s| {
        seen(spherule_kernel::path::random::Sampler::of(
            &s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::path::random::Sampler::pair", |s| {
        seen(spherule_kernel::path::random::Sampler::pair(
            &s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::path::random::Sampler::single", |s| {
        seen(spherule_kernel::path::random::Sampler::single(
            &s.draw(),
            s.draw(),
        ))
    }),
    Call::new(
        "spherule_kernel::path::random::VertexNumbers as spherule_kernel::path::random::Numbers::direction",
        |s| {
            seen(<spherule_kernel::path::random::VertexNumbers as spherule_kernel::path::random::Numbers>::direction(&s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::path::random::VertexNumbers as spherule_kernel::path::random::Numbers::others",
        |s| {
            seen(<spherule_kernel::path::random::VertexNumbers as spherule_kernel::path::random::Numbers>::others(&s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::path::random::VertexNumbers as spherule_kernel::path::random::Numbers::roulette",
        |s| {
            seen(<spherule_kernel::path::random::VertexNumbers as spherule_kernel::path::random::Numbers>::roulette(&s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::path::random::VertexNumbers as spherule_kernel::path::random::Numbers::towards_light",
        |s| {
            seen(<spherule_kernel::path::random::VertexNumbers as spherule_kernel::path::random::Numbers>::towards_light(&s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::path::random::VertexNumbers::choice",
        |s| {
            seen(spherule_kernel::path::random::VertexNumbers::choice(
                &s.draw(),
            ))
        },
    ),
    Call::new(
        "spherule_kernel::path::random::VertexNumbers::on_lamp",
        |s| {
            seen(spherule_kernel::path::random::VertexNumbers::on_lamp(
                &s.draw(),
            ))
        },
    ),
    Call::new("spherule_kernel::path::random::VertexNumbers::way", |s| {
        seen(spherule_kernel::path::random::VertexNumbers::way(&s.draw()))
    }),
    Call::new(
        "spherule_kernel::path::random::VertexNumbers::which_light",
        |s| {
            seen(spherule_kernel::path::random::VertexNumbers::which_light(
                &s.draw(),
            ))
        },
    ),
    Call::new(
        "spherule_kernel::path::random::VertexNumbers::which_sphere",
        |s| {
            seen(spherule_kernel::path::random::VertexNumbers::which_sphere(
                &s.draw(),
            ))
        },
    ),
    Call::new("spherule_kernel::path::sampling::Pair::of", |s| {
        seen(spherule_kernel::path::sampling::Pair::of(s.draw()))
    }),
    Call::new("spherule_kernel::path::sampling::cone", |s| {
        seen(spherule_kernel::path::sampling::cone(
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::path::sampling::cone_density", |s| {
        seen(spherule_kernel::path::sampling::cone_density(s.draw()))
    }),
    Call::new("spherule_kernel::path::sampling::cosine_density", |s| {
        seen(spherule_kernel::path::sampling::cosine_density(s.draw()))
    }),
    Call::new("spherule_kernel::path::sampling::cosine_hemisphere", |s| {
        seen(spherule_kernel::path::sampling::cosine_hemisphere(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::path::sampling::disc", |s| {
        seen(spherule_kernel::path::sampling::disc(s.draw()))
    }),
    Call::new("spherule_kernel::path::sampling::power_heuristic", |s| {
        seen(spherule_kernel::path::sampling::power_heuristic(
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::path::sampling::tangents", |s| {
        seen(spherule_kernel::path::sampling::tangents(s.draw()))
    }),
    Call::new("spherule_kernel::path::sampling::uniform_sphere", |s| {
        seen(spherule_kernel::path::sampling::uniform_sphere(s.draw()))
    }),
    Call::new(
        "spherule_kernel::path::scenery::Scenery::is_blocked_by_shape",
        |s| {
            seen(spherule_kernel::path::Scenery::is_blocked_by_shape(
                &s.draw::<odd::OddScenery>().get(),
                &s.draw(),
                s.draw(),
                s.draw(),
            ))
        },
    ),
    Call::new("spherule_kernel::path::scenery::Scenery::or_shape", |s| {
        seen(spherule_kernel::path::Scenery::or_shape(
            &s.draw::<odd::OddScenery>().get(),
            &s.draw(),
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::path::scenery::Scenery::sphere", |s| {
        seen(spherule_kernel::path::Scenery::sphere(
            &s.draw::<odd::OddScenery>().get(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::path::scenery::Scenery::spheres_at", |s| {
        seen(spherule_kernel::path::Scenery::spheres_at(
            &s.draw::<odd::OddScenery>().get(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::path::shadow::Shadow::distance", |s| {
        seen(spherule_kernel::path::Shadow::distance(
            &s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::path::shadow::Shadow::is_some", |s| {
        seen(spherule_kernel::path::Shadow::is_some(&s.draw()))
    }),
    Call::new("spherule_kernel::path::shadow::Shadow::up_to", |s| {
        seen(spherule_kernel::path::Shadow::up_to(s.draw(), s.draw()))
    }),
    Call::new("spherule_kernel::path::shadow::Shadow::whole_ray", |s| {
        seen(spherule_kernel::path::Shadow::whole_ray(&s.draw()))
    }),
    Call::new("spherule_kernel::path::step::Samples::of", |s| {
        seen(spherule_kernel::path::Samples::of(
            &s.draw(),
            s.draw(),
            &s.draw(),
        ))
    }),
    Call::new("spherule_kernel::path::step::start", |s| {
        seen(spherule_kernel::path::start(
            &s.draw::<odd::OddScenery>().get(),
            s.draw(),
            &s.draw(),
        ))
    }),
    Call::new("spherule_kernel::path::step::trace_pixel", |s| {
        seen(spherule_kernel::path::trace_pixel(
            &s.draw::<odd::OddScenery>().get(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::pixel::render_pixel", |s| {
        seen(spherule_kernel::pixel::render_pixel(
            s.draw(),
            s.draw(),
            s.draw(),
            &s.draw(),
            s.draw::<odd::OddTree>().get(),
            &s.many()[..],
            &s.many()[..],
            &s.many()[..],
            s.draw(),
            &s.draw(),
        ))
    }),
    Call::new("spherule_kernel::pixel::render_pixel_of_shapes", |s| {
        seen(spherule_kernel::pixel::render_pixel_of_shapes(
            s.draw(),
            s.draw(),
            &s.draw(),
            &s.draw::<odd::OddShapes>().get(),
            &s.many()[..],
            &s.many()[..],
            s.draw(),
            &s.draw(),
        ))
    }),
    Call::new("spherule_kernel::precision::Rung::is_bounded", |s| {
        seen(spherule_kernel::precision::Rung::is_bounded(s.draw()))
    }),
    Call::new("spherule_kernel::precision::Rung::name", |s| {
        seen(spherule_kernel::precision::Rung::name(s.draw()))
    }),
    Call::new("spherule_kernel::precision::Rung::needs", |s| {
        seen(spherule_kernel::precision::Rung::needs(s.draw()))
    }),
    Call::new("spherule_kernel::precision::Rung::summary", |s| {
        seen(spherule_kernel::precision::Rung::summary(s.draw()))
    }),
    Call::new("spherule_kernel::precision::Rung::to_u32", |s| {
        seen(spherule_kernel::precision::Rung::to_u32(s.draw()))
    }),
    Call::new(
        "spherule_kernel::precision::certified::Certified as spherule_kernel::precision::root::Precision::intersect",
        |s| {
            seen(<spherule_kernel::precision::certified::Certified as spherule_kernel::precision::root::Precision>::intersect(s.draw(), &s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::precision::certified::corrected::Residual::correct",
        |s| {
            seen(
                spherule_kernel::precision::certified::corrected::Residual::<f32>::correct(
                    s.draw(),
                    s.draw(),
                    s.draw(),
                    s.draw(),
                ),
            )
        },
    ),
    Call::new(
        "spherule_kernel::precision::certified::entry_or_defer",
        |s| {
            seen(spherule_kernel::precision::certified::entry_or_defer(
                s.draw(),
                &s.draw(),
                s.draw(),
            ))
        },
    ),
    Call::new(
        "spherule_kernel::precision::certified::intersect_in_single",
        |s| {
            seen(spherule_kernel::precision::certified::intersect_in_single(
                s.draw(),
                &s.draw(),
            ))
        },
    ),
    Call::new(
        "spherule_kernel::precision::certified::intersect_or_defer",
        |s| {
            seen(spherule_kernel::precision::certified::intersect_or_defer(
                s.draw(),
                &s.draw(),
            ))
        },
    ),
    Call::new(
        "spherule_kernel::precision::certified::intersect_with_stage",
        |s| {
            seen(spherule_kernel::precision::certified::intersect_with_stage(
                s.draw(),
                &s.draw(),
            ))
        },
    ),
    Call::new(
        "spherule_kernel::precision::certified::wide::WideRay::intersect",
        |s| {
            seen(
                spherule_kernel::precision::certified::wide::WideRay::<f32>::intersect(
                    &s.draw(),
                    s.draw(),
                    s.draw(),
                ),
            )
        },
    ),
    Call::new(
        "spherule_kernel::precision::certified::wide::WideRay::residual",
        |s| {
            seen(
                spherule_kernel::precision::certified::wide::WideRay::<f32>::residual(
                    &s.draw(),
                    s.draw(),
                    s.draw(),
                    s.draw(),
                ),
            )
        },
    ),
    Call::new(
        "spherule_kernel::precision::compensated::Compensated as spherule_kernel::precision::root::Precision::intersect",
        |s| {
            seen(<spherule_kernel::precision::compensated::Compensated as spherule_kernel::precision::root::Precision>::intersect(s.draw(), &s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::precision::compensated::Quadratic::c_error",
        |s| {
            seen(spherule_kernel::precision::compensated::Quadratic::c_error(
                &s.draw(),
            ))
        },
    ),
    Call::new(
        "spherule_kernel::precision::compensated::Quadratic::meets_for_certain",
        |s| seen(spherule_kernel::precision::compensated::Quadratic::meets_for_certain(&s.draw())),
    ),
    Call::new(
        "spherule_kernel::precision::compensated::Quadratic::misses_for_certain",
        |s| seen(spherule_kernel::precision::compensated::Quadratic::misses_for_certain(&s.draw())),
    ),
    Call::new(
        "spherule_kernel::precision::compensated::Quadratic::of",
        |s| {
            seen(spherule_kernel::precision::compensated::Quadratic::of(
                s.draw(),
                &s.draw(),
            ))
        },
    ),
    Call::new(
        "spherule_kernel::precision::compensated::Quadratic::roots",
        |s| {
            seen(spherule_kernel::precision::compensated::Quadratic::roots(
                &s.draw(),
            ))
        },
    ),
    Call::new(
        "spherule_kernel::precision::compensated::Quadratic::size_error",
        |s| seen(spherule_kernel::precision::compensated::Quadratic::size_error(&s.draw())),
    ),
    Call::new(
        "spherule_kernel::precision::double::Double as spherule_kernel::precision::root::Precision::intersect",
        |s| {
            seen(<spherule_kernel::precision::double::Double as spherule_kernel::precision::root::Precision>::intersect(s.draw(), &s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::precision::double::Quadratic::meets",
        |s| {
            seen(spherule_kernel::precision::double::Quadratic::<f32>::meets(
                &s.draw(),
            ))
        },
    ),
    Call::new("spherule_kernel::precision::double::Quadratic::of", |s| {
        seen(spherule_kernel::precision::double::Quadratic::<f32>::of(
            s.draw(),
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new(
        "spherule_kernel::precision::double::Quadratic::roots",
        |s| {
            seen(spherule_kernel::precision::double::Quadratic::<f32>::roots(
                &s.draw(),
            ))
        },
    ),
    Call::new("spherule_kernel::precision::double::quotient", |s| {
        seen(spherule_kernel::precision::double::quotient::<f32>(
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::precision::double::residual", |s| {
        seen(spherule_kernel::precision::double::residual::<f32>(
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::precision::double::square_root", |s| {
        seen(spherule_kernel::precision::double::square_root::<f32>(
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::precision::entry_or_defer", |s| {
        seen(spherule_kernel::precision::entry_or_defer(
            s.draw(),
            s.draw(),
            &s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::precision::intersect", |s| {
        seen(spherule_kernel::precision::intersect(
            s.draw(),
            s.draw(),
            &s.draw(),
        ))
    }),
    Call::new("spherule_kernel::precision::intersect_at_once", |s| {
        seen(spherule_kernel::precision::intersect_at_once(
            s.draw(),
            s.draw(),
            &s.draw(),
        ))
    }),
    Call::new("spherule_kernel::precision::intersect_or_defer", |s| {
        seen(spherule_kernel::precision::intersect_or_defer(
            s.draw(),
            s.draw(),
            &s.draw(),
        ))
    }),
    Call::new("spherule_kernel::precision::is_lazy", |s| {
        seen(spherule_kernel::precision::is_lazy(s.draw()))
    }),
    Call::new(
        "spherule_kernel::precision::robust::Quadratic::inner",
        |s| {
            seen(spherule_kernel::precision::robust::Quadratic::<f32>::inner(
                &s.draw(),
            ))
        },
    ),
    Call::new(
        "spherule_kernel::precision::robust::Quadratic::is_ahead",
        |s| seen(spherule_kernel::precision::robust::Quadratic::<f32>::is_ahead(&s.draw())),
    ),
    Call::new(
        "spherule_kernel::precision::robust::Quadratic::meets",
        |s| {
            seen(spherule_kernel::precision::robust::Quadratic::<f32>::meets(
                &s.draw(),
            ))
        },
    ),
    Call::new("spherule_kernel::precision::robust::Quadratic::of", |s| {
        seen(spherule_kernel::precision::robust::Quadratic::<f32>::of(
            s.draw(),
            s.draw(),
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new(
        "spherule_kernel::precision::robust::Quadratic::outer",
        |s| {
            seen(spherule_kernel::precision::robust::Quadratic::<f32>::outer(
                &s.draw(),
            ))
        },
    ),
    Call::new(
        "spherule_kernel::precision::robust::Quadratic::roots",
        |s| {
            seen(spherule_kernel::precision::robust::Quadratic::<f32>::roots(
                &s.draw(),
            ))
        },
    ),
    Call::new(
        "spherule_kernel::precision::robust::Robust as spherule_kernel::precision::root::Precision::intersect",
        |s| {
            seen(<spherule_kernel::precision::robust::Robust as spherule_kernel::precision::root::Precision>::intersect(s.draw(), &s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::precision::robust::Robust as spherule_kernel::precision::root::Precision::widening",
        |s| {
            seen(<spherule_kernel::precision::robust::Robust as spherule_kernel::precision::root::Precision>::widening(s.draw(), s.draw()))
        },
    ),
    Call::new("spherule_kernel::precision::root::choose_root", |s| {
        seen(spherule_kernel::precision::root::choose_root(
            s.draw(),
            s.draw(),
            &s.draw(),
        ))
    }),
    Call::new("spherule_kernel::precision::root::root_within", |s| {
        seen(spherule_kernel::precision::root::root_within::<f32>(
            s.draw(),
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new(
        "spherule_kernel::precision::textbook::Textbook as spherule_kernel::precision::root::Precision::intersect",
        |s| {
            seen(<spherule_kernel::precision::textbook::Textbook as spherule_kernel::precision::root::Precision>::intersect(s.draw(), &s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::precision::textbook::Textbook as spherule_kernel::precision::root::Precision::widening",
        |s| {
            seen(<spherule_kernel::precision::textbook::Textbook as spherule_kernel::precision::root::Precision>::widening(s.draw(), s.draw()))
        },
    ),
    Call::new("spherule_kernel::precision::widening", |s| {
        seen(spherule_kernel::precision::widening(
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::probe::canary::sing", |s| {
        seen(spherule_kernel::probe::canary::sing(s.draw()))
    }),
    Call::new("spherule_kernel::probe::canary::sing_wide", |s| {
        seen(spherule_kernel::probe::canary::sing_wide(s.draw()))
    }),
    Call::new("spherule_kernel::probe::glass_walk::walk_inside", |s| {
        seen(spherule_kernel::probe::glass_walk::walk_inside(
            s.draw(),
            &s.draw(),
            s.draw(),
            s.draw(),
            s.few(),
        ))
    }),
    Call::new("spherule_kernel::probe::layout::write", |s| {
        seen(spherule_kernel::probe::layout::write(&mut s.many()[..]))
    }),
    Call::new("spherule_kernel::probe::throughput::products", |s| {
        seen(spherule_kernel::probe::throughput::products(
            s.draw(),
            s.draw(),
            s.few(),
        ))
    }),
    Call::new("spherule_kernel::probe::throughput::wide_products", |s| {
        seen(spherule_kernel::probe::throughput::wide_products(
            s.draw(),
            s.draw(),
            s.few(),
        ))
    }),
    Call::new("spherule_kernel::ray::Ray::at", |s| {
        seen(spherule_kernel::ray::Ray::at(&s.draw(), s.draw()))
    }),
    Call::new("spherule_kernel::ray::Ray::end", |s| {
        seen(spherule_kernel::ray::Ray::end(&s.draw()))
    }),
    Call::new("spherule_kernel::ray::Ray::new", |s| {
        seen(spherule_kernel::ray::Ray::new(s.draw(), s.draw()))
    }),
    Call::new("spherule_kernel::ray::Ray::within", |s| {
        seen(spherule_kernel::ray::Ray::within(
            s.draw(),
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::shading::Quantity::has_background", |s| {
        seen(spherule_kernel::shading::Quantity::has_background(s.draw()))
    }),
    Call::new("spherule_kernel::shading::Shading::name", |s| {
        seen(spherule_kernel::shading::Shading::name(s.draw()))
    }),
    Call::new("spherule_kernel::shading::Shading::quantity", |s| {
        seen(spherule_kernel::shading::Shading::quantity(s.draw()))
    }),
    Call::new("spherule_kernel::shading::Shading::summary", |s| {
        seen(spherule_kernel::shading::Shading::summary(s.draw()))
    }),
    Call::new("spherule_kernel::shading::Shading::to_u32", |s| {
        seen(spherule_kernel::shading::Shading::to_u32(s.draw()))
    }),
    Call::new("spherule_kernel::shading::index_of", |s| {
        seen(spherule_kernel::shading::index_of(s.draw()))
    }),
    Call::new("spherule_kernel::shading::shade", |s| {
        seen(spherule_kernel::shading::shade(s.draw(), s.draw()))
    }),
    Call::new("spherule_kernel::shape::Kinds::and", |s| {
        seen(spherule_kernel::shape::Kinds::and(s.draw(), s.draw()))
    }),
    Call::new("spherule_kernel::shape::Kinds::from_bits", |s| {
        seen(spherule_kernel::shape::Kinds::from_bits(s.draw()))
    }),
    Call::new("spherule_kernel::shape::Kinds::is_empty", |s| {
        seen(spherule_kernel::shape::Kinds::is_empty(s.draw()))
    }),
    Call::new("spherule_kernel::shape::Kinds::to_bits", |s| {
        seen(spherule_kernel::shape::Kinds::to_bits(s.draw()))
    }),
    Call::new("spherule_kernel::shape::Shape as From#0", |s| {
        seen(<spherule_kernel::shape::Shape as From<
            spherule_kernel::shape::capsule::Capsule,
        >>::from(s.draw()))
    }),
    Call::new("spherule_kernel::shape::Shape as From#1", |s| {
        seen(<spherule_kernel::shape::Shape as From<
            spherule_kernel::shape::cylinder::Cylinder,
        >>::from(s.draw()))
    }),
    Call::new("spherule_kernel::shape::Shape as From#2", |s| {
        seen(<spherule_kernel::shape::Shape as From<
            spherule_kernel::shape::ellipsoid::Ellipsoid,
        >>::from(s.draw()))
    }),
    Call::new("spherule_kernel::shape::Shape as From#3", |s| {
        seen(<spherule_kernel::shape::Shape as From<
            spherule_kernel::shape::cuboid::Cuboid,
        >>::from(s.draw()))
    }),
    Call::new("spherule_kernel::shape::Shape as From#4", |s| {
        seen(<spherule_kernel::shape::Shape as From<
            spherule_kernel::shape::cone::Cone,
        >>::from(s.draw()))
    }),
    Call::new("spherule_kernel::shape::Shape as From#5", |s| {
        seen(<spherule_kernel::shape::Shape as From<
            spherule_kernel::shape::disc::Disc,
        >>::from(s.draw()))
    }),
    Call::new("spherule_kernel::shape::Shape::as_sphere", |s| {
        seen(spherule_kernel::shape::Shape::as_sphere(&s.draw()))
    }),
    Call::new("spherule_kernel::shape::Shape::bounds", |s| {
        seen(spherule_kernel::shape::Shape::bounds(&s.draw()))
    }),
    Call::new("spherule_kernel::shape::Shape::contains", |s| {
        seen(spherule_kernel::shape::Shape::contains(&s.draw(), s.draw()))
    }),
    Call::new("spherule_kernel::shape::Shape::hull", |s| {
        seen(spherule_kernel::shape::Shape::hull(&s.draw()))
    }),
    Call::new("spherule_kernel::shape::Shape::is_valid", |s| {
        seen(spherule_kernel::shape::Shape::is_valid(&s.draw()))
    }),
    Call::new("spherule_kernel::shape::Shape::kinds", |s| {
        seen(spherule_kernel::shape::Shape::kinds(&s.draw()))
    }),
    Call::new("spherule_kernel::shape::Shape::moved", |s| {
        seen(spherule_kernel::shape::Shape::moved(
            &s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::shape::Shape::name", |s| {
        seen(spherule_kernel::shape::Shape::name(&s.draw()))
    }),
    Call::new("spherule_kernel::shape::Shape::span", |s| {
        seen(spherule_kernel::shape::Shape::span(
            &s.draw(),
            s.draw(),
            s.draw(),
            &s.draw(),
        ))
    }),
    Call::new("spherule_kernel::shape::Shape::surface", |s| {
        seen(spherule_kernel::shape::Shape::surface(
            &s.draw(),
            s.draw(),
            &s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::shape::Shape::thickness", |s| {
        seen(spherule_kernel::shape::Shape::thickness(
            &s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::shape::among::Shapes::are_hit", |s| {
        seen(spherule_kernel::shape::among::Shapes::are_hit(
            &s.draw::<odd::OddShapes>().get(),
            s.draw(),
            &s.draw(),
            s.draw(),
            spherule_kernel::shape::among::Resting,
        ))
    }),
    Call::new("spherule_kernel::shape::among::Shapes::have", |s| {
        seen(spherule_kernel::shape::among::Shapes::have(
            &s.draw::<odd::OddShapes>().get(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::shape::among::Shapes::nearest_hit", |s| {
        seen(spherule_kernel::shape::among::Shapes::nearest_hit(
            &s.draw::<odd::OddShapes>().get(),
            s.draw(),
            &s.draw(),
            s.draw(),
            s.draw(),
            spherule_kernel::shape::among::Resting,
        ))
    }),
    Call::new("spherule_kernel::shape::among::Shapes::shape", |s| {
        seen(spherule_kernel::shape::among::Shapes::shape(
            &s.draw::<odd::OddShapes>().get(),
            s.draw(),
            spherule_kernel::shape::among::Resting,
        ))
    }),
    Call::new("spherule_kernel::shape::among::Shapes::size", |s| {
        seen(spherule_kernel::shape::among::Shapes::size(
            &s.draw::<odd::OddShapes>().get(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::shape::among::Shapes::surface", |s| {
        seen(spherule_kernel::shape::among::Shapes::surface(
            &s.draw::<odd::OddShapes>().get(),
            &s.draw(),
            s.draw(),
            s.draw(),
            spherule_kernel::shape::among::Resting,
        ))
    }),
    Call::new(
        "spherule_kernel::shape::capsule::Capsule as spherule::accuracy::shape_oracle::Exact::exact_span",
        |s| {
            seen(<spherule_kernel::shape::capsule::Capsule as spherule::accuracy::shape_oracle::Exact>::exact_span(&s.draw(), &s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::shape::capsule::Capsule as spherule_kernel::shape::Measures::as_sphere",
        |s| {
            seen(<spherule_kernel::shape::capsule::Capsule as spherule_kernel::shape::Measures>::as_sphere(&s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::shape::capsule::Capsule as spherule_kernel::shape::Measures::bounds",
        |s| {
            seen(<spherule_kernel::shape::capsule::Capsule as spherule_kernel::shape::Measures>::bounds(&s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::shape::capsule::Capsule as spherule_kernel::shape::Measures::hull",
        |s| {
            seen(<spherule_kernel::shape::capsule::Capsule as spherule_kernel::shape::Measures>::hull(&s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::shape::capsule::Capsule as spherule_kernel::shape::Measures::is_valid",
        |s| {
            seen(<spherule_kernel::shape::capsule::Capsule as spherule_kernel::shape::Measures>::is_valid(&s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::shape::capsule::Capsule as spherule_kernel::shape::Solid::contains",
        |s| {
            seen(<spherule_kernel::shape::capsule::Capsule as spherule_kernel::shape::Solid>::contains(&s.draw(), s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::shape::capsule::Capsule as spherule_kernel::shape::Solid::moved",
        |s| {
            seen(
                <spherule_kernel::shape::capsule::Capsule as spherule_kernel::shape::Solid>::moved(
                    &s.draw(),
                    s.draw(),
                ),
            )
        },
    ),
    Call::new(
        "spherule_kernel::shape::capsule::Capsule as spherule_kernel::shape::Solid::span",
        |s| {
            seen(
                <spherule_kernel::shape::capsule::Capsule as spherule_kernel::shape::Solid>::span(
                    &s.draw(),
                    s.draw(),
                    s.draw(),
                ),
            )
        },
    ),
    Call::new(
        "spherule_kernel::shape::capsule::Capsule as spherule_kernel::shape::Solid::surface",
        |s| {
            seen(<spherule_kernel::shape::capsule::Capsule as spherule_kernel::shape::Solid>::surface(&s.draw(), &s.draw(), s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::shape::capsule::Capsule as spherule_kernel::shape::Solid::textbook_span",
        |s| {
            seen(<spherule_kernel::shape::capsule::Capsule as spherule_kernel::shape::Solid>::textbook_span(&s.draw(), &s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::shape::capsule::Capsule as spherule_kernel::shape::Solid::thickness",
        |s| {
            seen(<spherule_kernel::shape::capsule::Capsule as spherule_kernel::shape::Solid>::thickness(&s.draw()))
        },
    ),
    Call::new("spherule_kernel::shape::capsule::Capsule::intersect", |s| {
        seen(spherule_kernel::shape::capsule::Capsule::intersect(
            &s.draw(),
            s.draw(),
            &s.draw(),
        ))
    }),
    Call::new("spherule_kernel::shape::capsule::Capsule::new", |s| {
        seen(spherule_kernel::shape::capsule::Capsule::new(
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new(
        "spherule_kernel::shape::cone::Cone as spherule::accuracy::shape_oracle::Exact::exact_span",
        |s| {
            seen(<spherule_kernel::shape::cone::Cone as spherule::accuracy::shape_oracle::Exact>::exact_span(&s.draw(), &s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::shape::cone::Cone as spherule_kernel::shape::Measures::bounds",
        |s| {
            seen(
                <spherule_kernel::shape::cone::Cone as spherule_kernel::shape::Measures>::bounds(
                    &s.draw(),
                ),
            )
        },
    ),
    Call::new(
        "spherule_kernel::shape::cone::Cone as spherule_kernel::shape::Measures::hull",
        |s| {
            seen(
                <spherule_kernel::shape::cone::Cone as spherule_kernel::shape::Measures>::hull(
                    &s.draw(),
                ),
            )
        },
    ),
    Call::new(
        "spherule_kernel::shape::cone::Cone as spherule_kernel::shape::Measures::is_valid",
        |s| {
            seen(
                <spherule_kernel::shape::cone::Cone as spherule_kernel::shape::Measures>::is_valid(
                    &s.draw(),
                ),
            )
        },
    ),
    Call::new(
        "spherule_kernel::shape::cone::Cone as spherule_kernel::shape::Solid::contains",
        |s| {
            seen(
                <spherule_kernel::shape::cone::Cone as spherule_kernel::shape::Solid>::contains(
                    &s.draw(),
                    s.draw(),
                ),
            )
        },
    ),
    Call::new(
        "spherule_kernel::shape::cone::Cone as spherule_kernel::shape::Solid::moved",
        |s| {
            seen(
                <spherule_kernel::shape::cone::Cone as spherule_kernel::shape::Solid>::moved(
                    &s.draw(),
                    s.draw(),
                ),
            )
        },
    ),
    Call::new(
        "spherule_kernel::shape::cone::Cone as spherule_kernel::shape::Solid::span",
        |s| {
            seen(
                <spherule_kernel::shape::cone::Cone as spherule_kernel::shape::Solid>::span(
                    &s.draw(),
                    s.draw(),
                    s.draw(),
                ),
            )
        },
    ),
    Call::new(
        "spherule_kernel::shape::cone::Cone as spherule_kernel::shape::Solid::surface",
        |s| {
            seen(
                <spherule_kernel::shape::cone::Cone as spherule_kernel::shape::Solid>::surface(
                    &s.draw(),
                    &s.draw(),
                    s.draw(),
                ),
            )
        },
    ),
    Call::new(
        "spherule_kernel::shape::cone::Cone as spherule_kernel::shape::Solid::textbook_span",
        |s| {
            seen(<spherule_kernel::shape::cone::Cone as spherule_kernel::shape::Solid>::textbook_span(&s.draw(), &s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::shape::cone::Cone as spherule_kernel::shape::Solid::thickness",
        |s| {
            seen(
                <spherule_kernel::shape::cone::Cone as spherule_kernel::shape::Solid>::thickness(
                    &s.draw(),
                ),
            )
        },
    ),
    Call::new("spherule_kernel::shape::cone::Cone::intersect", |s| {
        seen(spherule_kernel::shape::cone::Cone::intersect(
            &s.draw(),
            s.draw(),
            &s.draw(),
        ))
    }),
    Call::new("spherule_kernel::shape::cone::Cone::new", |s| {
        seen(spherule_kernel::shape::cone::Cone::new(
            s.draw(),
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new(
        "spherule_kernel::shape::cuboid::Cuboid as spherule::accuracy::shape_oracle::Exact::exact_span",
        |s| {
            seen(<spherule_kernel::shape::cuboid::Cuboid as spherule::accuracy::shape_oracle::Exact>::exact_span(&s.draw(), &s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::shape::cuboid::Cuboid as spherule_kernel::shape::Measures::bounds",
        |s| {
            seen(<spherule_kernel::shape::cuboid::Cuboid as spherule_kernel::shape::Measures>::bounds(&s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::shape::cuboid::Cuboid as spherule_kernel::shape::Measures::hull",
        |s| {
            seen(
                <spherule_kernel::shape::cuboid::Cuboid as spherule_kernel::shape::Measures>::hull(
                    &s.draw(),
                ),
            )
        },
    ),
    Call::new(
        "spherule_kernel::shape::cuboid::Cuboid as spherule_kernel::shape::Measures::is_valid",
        |s| {
            seen(<spherule_kernel::shape::cuboid::Cuboid as spherule_kernel::shape::Measures>::is_valid(&s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::shape::cuboid::Cuboid as spherule_kernel::shape::Solid::contains",
        |s| {
            seen(
                <spherule_kernel::shape::cuboid::Cuboid as spherule_kernel::shape::Solid>::contains(
                    &s.draw(),
                    s.draw(),
                ),
            )
        },
    ),
    Call::new(
        "spherule_kernel::shape::cuboid::Cuboid as spherule_kernel::shape::Solid::moved",
        |s| {
            seen(
                <spherule_kernel::shape::cuboid::Cuboid as spherule_kernel::shape::Solid>::moved(
                    &s.draw(),
                    s.draw(),
                ),
            )
        },
    ),
    Call::new(
        "spherule_kernel::shape::cuboid::Cuboid as spherule_kernel::shape::Solid::span",
        |s| {
            seen(
                <spherule_kernel::shape::cuboid::Cuboid as spherule_kernel::shape::Solid>::span(
                    &s.draw(),
                    s.draw(),
                    s.draw(),
                ),
            )
        },
    ),
    Call::new(
        "spherule_kernel::shape::cuboid::Cuboid as spherule_kernel::shape::Solid::surface",
        |s| {
            seen(
                <spherule_kernel::shape::cuboid::Cuboid as spherule_kernel::shape::Solid>::surface(
                    &s.draw(),
                    &s.draw(),
                    s.draw(),
                ),
            )
        },
    ),
    Call::new(
        "spherule_kernel::shape::cuboid::Cuboid as spherule_kernel::shape::Solid::textbook_span",
        |s| {
            seen(<spherule_kernel::shape::cuboid::Cuboid as spherule_kernel::shape::Solid>::textbook_span(&s.draw(), &s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::shape::cuboid::Cuboid as spherule_kernel::shape::Solid::thickness",
        |s| {
            seen(<spherule_kernel::shape::cuboid::Cuboid as spherule_kernel::shape::Solid>::thickness(&s.draw()))
        },
    ),
    Call::new("spherule_kernel::shape::cuboid::Cuboid::intersect", |s| {
        seen(spherule_kernel::shape::cuboid::Cuboid::intersect(
            &s.draw(),
            s.draw(),
            &s.draw(),
        ))
    }),
    Call::new("spherule_kernel::shape::cuboid::Cuboid::new", |s| {
        seen(spherule_kernel::shape::cuboid::Cuboid::new(
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new(
        "spherule_kernel::shape::cylinder::Cylinder as spherule::accuracy::shape_oracle::Exact::exact_span",
        |s| {
            seen(<spherule_kernel::shape::cylinder::Cylinder as spherule::accuracy::shape_oracle::Exact>::exact_span(&s.draw(), &s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::shape::cylinder::Cylinder as spherule_kernel::shape::Measures::bounds",
        |s| {
            seen(<spherule_kernel::shape::cylinder::Cylinder as spherule_kernel::shape::Measures>::bounds(&s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::shape::cylinder::Cylinder as spherule_kernel::shape::Measures::hull",
        |s| {
            seen(<spherule_kernel::shape::cylinder::Cylinder as spherule_kernel::shape::Measures>::hull(&s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::shape::cylinder::Cylinder as spherule_kernel::shape::Measures::is_valid",
        |s| {
            seen(<spherule_kernel::shape::cylinder::Cylinder as spherule_kernel::shape::Measures>::is_valid(&s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::shape::cylinder::Cylinder as spherule_kernel::shape::Solid::contains",
        |s| {
            seen(<spherule_kernel::shape::cylinder::Cylinder as spherule_kernel::shape::Solid>::contains(&s.draw(), s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::shape::cylinder::Cylinder as spherule_kernel::shape::Solid::moved",
        |s| {
            seen(<spherule_kernel::shape::cylinder::Cylinder as spherule_kernel::shape::Solid>::moved(&s.draw(), s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::shape::cylinder::Cylinder as spherule_kernel::shape::Solid::span",
        |s| {
            seen(
                <spherule_kernel::shape::cylinder::Cylinder as spherule_kernel::shape::Solid>::span(
                    &s.draw(),
                    s.draw(),
                    s.draw(),
                ),
            )
        },
    ),
    Call::new(
        "spherule_kernel::shape::cylinder::Cylinder as spherule_kernel::shape::Solid::surface",
        |s| {
            seen(<spherule_kernel::shape::cylinder::Cylinder as spherule_kernel::shape::Solid>::surface(&s.draw(), &s.draw(), s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::shape::cylinder::Cylinder as spherule_kernel::shape::Solid::textbook_span",
        |s| {
            seen(<spherule_kernel::shape::cylinder::Cylinder as spherule_kernel::shape::Solid>::textbook_span(&s.draw(), &s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::shape::cylinder::Cylinder as spherule_kernel::shape::Solid::thickness",
        |s| {
            seen(<spherule_kernel::shape::cylinder::Cylinder as spherule_kernel::shape::Solid>::thickness(&s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::shape::cylinder::Cylinder::intersect",
        |s| {
            seen(spherule_kernel::shape::cylinder::Cylinder::intersect(
                &s.draw(),
                s.draw(),
                &s.draw(),
            ))
        },
    ),
    Call::new("spherule_kernel::shape::cylinder::Cylinder::new", |s| {
        seen(spherule_kernel::shape::cylinder::Cylinder::new(
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new(
        "spherule_kernel::shape::disc::Disc as spherule::accuracy::shape_oracle::Exact::exact_span",
        |s| {
            seen(<spherule_kernel::shape::disc::Disc as spherule::accuracy::shape_oracle::Exact>::exact_span(&s.draw(), &s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::shape::disc::Disc as spherule_kernel::shape::Measures::bounds",
        |s| {
            seen(
                <spherule_kernel::shape::disc::Disc as spherule_kernel::shape::Measures>::bounds(
                    &s.draw(),
                ),
            )
        },
    ),
    Call::new(
        "spherule_kernel::shape::disc::Disc as spherule_kernel::shape::Measures::hull",
        |s| {
            seen(
                <spherule_kernel::shape::disc::Disc as spherule_kernel::shape::Measures>::hull(
                    &s.draw(),
                ),
            )
        },
    ),
    Call::new(
        "spherule_kernel::shape::disc::Disc as spherule_kernel::shape::Measures::is_valid",
        |s| {
            seen(
                <spherule_kernel::shape::disc::Disc as spherule_kernel::shape::Measures>::is_valid(
                    &s.draw(),
                ),
            )
        },
    ),
    Call::new(
        "spherule_kernel::shape::disc::Disc as spherule_kernel::shape::Solid::contains",
        |s| {
            seen(
                <spherule_kernel::shape::disc::Disc as spherule_kernel::shape::Solid>::contains(
                    &s.draw(),
                    s.draw(),
                ),
            )
        },
    ),
    Call::new(
        "spherule_kernel::shape::disc::Disc as spherule_kernel::shape::Solid::moved",
        |s| {
            seen(
                <spherule_kernel::shape::disc::Disc as spherule_kernel::shape::Solid>::moved(
                    &s.draw(),
                    s.draw(),
                ),
            )
        },
    ),
    Call::new(
        "spherule_kernel::shape::disc::Disc as spherule_kernel::shape::Solid::span",
        |s| {
            seen(
                <spherule_kernel::shape::disc::Disc as spherule_kernel::shape::Solid>::span(
                    &s.draw(),
                    s.draw(),
                    s.draw(),
                ),
            )
        },
    ),
    Call::new(
        "spherule_kernel::shape::disc::Disc as spherule_kernel::shape::Solid::surface",
        |s| {
            seen(
                <spherule_kernel::shape::disc::Disc as spherule_kernel::shape::Solid>::surface(
                    &s.draw(),
                    &s.draw(),
                    s.draw(),
                ),
            )
        },
    ),
    Call::new(
        "spherule_kernel::shape::disc::Disc as spherule_kernel::shape::Solid::textbook_span",
        |s| {
            seen(<spherule_kernel::shape::disc::Disc as spherule_kernel::shape::Solid>::textbook_span(&s.draw(), &s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::shape::disc::Disc as spherule_kernel::shape::Solid::thickness",
        |s| {
            seen(
                <spherule_kernel::shape::disc::Disc as spherule_kernel::shape::Solid>::thickness(
                    &s.draw(),
                ),
            )
        },
    ),
    Call::new("spherule_kernel::shape::disc::Disc::intersect", |s| {
        seen(spherule_kernel::shape::disc::Disc::intersect(
            &s.draw(),
            s.draw(),
            &s.draw(),
        ))
    }),
    Call::new("spherule_kernel::shape::disc::Disc::new", |s| {
        seen(spherule_kernel::shape::disc::Disc::new(
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new(
        "spherule_kernel::shape::ellipsoid::Ellipsoid as spherule::accuracy::shape_oracle::Exact::exact_span",
        |s| {
            seen(<spherule_kernel::shape::ellipsoid::Ellipsoid as spherule::accuracy::shape_oracle::Exact>::exact_span(&s.draw(), &s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::shape::ellipsoid::Ellipsoid as spherule_kernel::shape::Measures::as_sphere",
        |s| {
            seen(<spherule_kernel::shape::ellipsoid::Ellipsoid as spherule_kernel::shape::Measures>::as_sphere(&s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::shape::ellipsoid::Ellipsoid as spherule_kernel::shape::Measures::bounds",
        |s| {
            seen(<spherule_kernel::shape::ellipsoid::Ellipsoid as spherule_kernel::shape::Measures>::bounds(&s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::shape::ellipsoid::Ellipsoid as spherule_kernel::shape::Measures::hull",
        |s| {
            seen(<spherule_kernel::shape::ellipsoid::Ellipsoid as spherule_kernel::shape::Measures>::hull(&s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::shape::ellipsoid::Ellipsoid as spherule_kernel::shape::Measures::is_valid",
        |s| {
            seen(<spherule_kernel::shape::ellipsoid::Ellipsoid as spherule_kernel::shape::Measures>::is_valid(&s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::shape::ellipsoid::Ellipsoid as spherule_kernel::shape::Solid::contains",
        |s| {
            seen(<spherule_kernel::shape::ellipsoid::Ellipsoid as spherule_kernel::shape::Solid>::contains(&s.draw(), s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::shape::ellipsoid::Ellipsoid as spherule_kernel::shape::Solid::moved",
        |s| {
            seen(<spherule_kernel::shape::ellipsoid::Ellipsoid as spherule_kernel::shape::Solid>::moved(&s.draw(), s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::shape::ellipsoid::Ellipsoid as spherule_kernel::shape::Solid::span",
        |s| {
            seen(<spherule_kernel::shape::ellipsoid::Ellipsoid as spherule_kernel::shape::Solid>::span(&s.draw(), s.draw(), s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::shape::ellipsoid::Ellipsoid as spherule_kernel::shape::Solid::surface",
        |s| {
            seen(<spherule_kernel::shape::ellipsoid::Ellipsoid as spherule_kernel::shape::Solid>::surface(&s.draw(), &s.draw(), s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::shape::ellipsoid::Ellipsoid as spherule_kernel::shape::Solid::textbook_span",
        |s| {
            seen(<spherule_kernel::shape::ellipsoid::Ellipsoid as spherule_kernel::shape::Solid>::textbook_span(&s.draw(), &s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::shape::ellipsoid::Ellipsoid as spherule_kernel::shape::Solid::thickness",
        |s| {
            seen(<spherule_kernel::shape::ellipsoid::Ellipsoid as spherule_kernel::shape::Solid>::thickness(&s.draw()))
        },
    ),
    Call::new(
        "spherule_kernel::shape::ellipsoid::Ellipsoid::intersect",
        |s| {
            seen(spherule_kernel::shape::ellipsoid::Ellipsoid::intersect(
                &s.draw(),
                s.draw(),
                &s.draw(),
            ))
        },
    ),
    Call::new("spherule_kernel::shape::ellipsoid::Ellipsoid::new", |s| {
        seen(spherule_kernel::shape::ellipsoid::Ellipsoid::new(
            s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::shape::span::Span::exit", |s| {
        seen(spherule_kernel::shape::span::Span::<f32>::exit(
            &s.draw(),
            &s.draw(),
        ))
    }),
    Call::new("spherule_kernel::shape::span::Span::first", |s| {
        seen(spherule_kernel::shape::span::Span::<f32>::first(
            &s.draw(),
            &s.draw(),
        ))
    }),
    Call::new("spherule_kernel::shape::span::Span::none", |s| {
        seen(spherule_kernel::shape::span::Span::<f32>::none(s.draw()))
    }),
    Call::new("spherule_kernel::sphere::Sphere::center", |s| {
        seen(spherule_kernel::sphere::Sphere::center(&s.draw()))
    }),
    Call::new("spherule_kernel::sphere::Sphere::contains", |s| {
        seen(spherule_kernel::sphere::Sphere::contains(
            &s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::sphere::Sphere::intersect", |s| {
        seen(spherule_kernel::sphere::Sphere::intersect(
            &s.draw(),
            &s.draw(),
        ))
    }),
    Call::new("spherule_kernel::sphere::Sphere::is_valid", |s| {
        seen(spherule_kernel::sphere::Sphere::is_valid(&s.draw()))
    }),
    Call::new("spherule_kernel::sphere::Sphere::new", |s| {
        seen(spherule_kernel::sphere::Sphere::new(s.draw(), s.draw()))
    }),
    Call::new("spherule_kernel::sphere::Sphere::radius", |s| {
        seen(spherule_kernel::sphere::Sphere::radius(&s.draw()))
    }),
    Call::new("spherule_kernel::sphere::Sphere::to_vec4", |s| {
        seen(spherule_kernel::sphere::Sphere::to_vec4(s.draw()))
    }),
    Call::new("spherule_kernel::surface::Surface::at", |s| {
        seen(spherule_kernel::surface::Surface::at(
            &s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::surface::Surface::error", |s| {
        seen(spherule_kernel::surface::Surface::error(s.draw()))
    }),
    Call::new("spherule_kernel::surface::Surface::facing", |s| {
        seen(spherule_kernel::surface::Surface::facing(
            &s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::surface::Surface::leave", |s| {
        seen(spherule_kernel::surface::Surface::leave(
            &s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::surface::Surface::refined", |s| {
        seen(spherule_kernel::surface::Surface::refined(
            s.draw(),
            &s.draw(),
            s.draw(),
            s.draw(),
        ))
    }),
    Call::new("spherule_kernel::surface::unit", |s| {
        seen(spherule_kernel::surface::unit(s.draw()))
    }),
];

impl Odd for spherule::accel::shapes::ShapeTree {
    fn odd(s: &mut Source) -> Self {
        spherule::accel::shapes::ShapeTree {
            kinds: Odd::odd(s),
            shapes: Odd::odd(s),
            material_ids: Odd::odd(s),
            velocities: Odd::odd(s),
            nodes: Odd::odd(s),
        }
    }
}

impl Odd for spherule::accel::tree::Acceleration {
    fn odd(s: &mut Source) -> Self {
        match s.below(3) {
            0 => spherule::accel::tree::Acceleration::Auto,
            1 => spherule::accel::tree::Acceleration::Tree,
            _ => spherule::accel::tree::Acceleration::BruteForce,
        }
    }
}

impl Odd for spherule::accuracy::cases::Verdict {
    fn odd(s: &mut Source) -> Self {
        match s.below(3) {
            0 => spherule::accuracy::cases::Verdict::Holds,
            1 => spherule::accuracy::cases::Verdict::FailsUnpromised(Odd::odd(s)),
            _ => spherule::accuracy::cases::Verdict::Fails(Odd::odd(s)),
        }
    }
}

impl Odd for spherule::accuracy::families::Family {
    fn odd(s: &mut Source) -> Self {
        match s.below(6) {
            0 => spherule::accuracy::families::Family::Generic,
            1 => spherule::accuracy::families::Family::Far,
            2 => spherule::accuracy::families::Family::Ground,
            3 => spherule::accuracy::families::Family::Tangent,
            4 => spherule::accuracy::families::Family::Surface,
            _ => spherule::accuracy::families::Family::Inside,
        }
    }
}

impl Odd for spherule::accuracy::frames::Frame {
    fn odd(s: &mut Source) -> Self {
        spherule::accuracy::frames::Frame {
            rung: Odd::odd(s),
            milliseconds: Odd::odd(s),
            fastest: Odd::odd(s),
            slowest: Odd::odd(s),
            differing: Odd::odd(s),
            pixels: Odd::odd(s),
            flip: Odd::odd(s),
        }
    }
}

impl Odd for spherule::accuracy::measure::Escalation {
    fn odd(s: &mut Source) -> Self {
        spherule::accuracy::measure::Escalation {
            own: Odd::odd(s),
            own_in_single: Odd::odd(s),
            in_a_scene: Odd::odd(s),
            in_a_scene_in_single: Odd::odd(s),
        }
    }
}

impl Odd for spherule::accuracy::measure::RungErrors {
    fn odd(s: &mut Source) -> Self {
        spherule::accuracy::measure::RungErrors {
            rays: Odd::odd(s),
            hits: Odd::odd(s),
            false_hits: Odd::odd(s),
            false_misses: Odd::odd(s),
            margin: Odd::odd(s),
            max_ulp: Odd::odd(s),
            max_ulp_anywhere: Odd::odd(s),
            over_4_ulp: Odd::odd(s),
            normal_degrees: Odd::odd(s),
            histogram: Odd::odd(s),
            worst: Odd::odd(s),
        }
    }
}

impl Odd for spherule::accuracy::measure::Steps {
    fn odd(s: &mut Source) -> Self {
        spherule::accuracy::measure::Steps {
            wide: Odd::odd(s),
            midpoint: Odd::odd(s),
            filter: Odd::odd(s),
            pairs: Odd::odd(s),
            distilled_c: Odd::odd(s),
            distilled: Odd::odd(s),
        }
    }
}

impl Odd for spherule::accuracy::measure::Worst {
    fn odd(s: &mut Source) -> Self {
        spherule::accuracy::measure::Worst {
            ray: Odd::odd(s),
            sphere: Odd::odd(s),
            found: Odd::odd(s),
            truth: Odd::odd(s),
        }
    }
}

impl Odd for spherule::accuracy::oracle::Root {
    fn odd(s: &mut Source) -> Self {
        match s.below(2) {
            0 => spherule::accuracy::oracle::Root::Near,
            _ => spherule::accuracy::oracle::Root::Far,
        }
    }
}

impl Odd for spherule::accuracy::price::Price {
    fn odd(s: &mut Source) -> Self {
        spherule::accuracy::price::Price {
            nanoseconds: Odd::odd(s),
            fastest: Odd::odd(s),
            slowest: Odd::odd(s),
        }
    }
}

impl Odd for spherule::accuracy::samples::Step {
    fn odd(s: &mut Source) -> Self {
        spherule::accuracy::samples::Step {
            rung: Odd::odd(s),
            denoised: Odd::odd(s),
            samples: Odd::odd(s),
            milliseconds: Odd::odd(s),
            error: Odd::odd(s),
            estimate: Odd::odd(s),
            flip: Odd::odd(s),
        }
    }
}

impl Odd for spherule::accuracy::shape_families::Family {
    fn odd(s: &mut Source) -> Self {
        match s.below(6) {
            0 => spherule::accuracy::shape_families::Family::Generic,
            1 => spherule::accuracy::shape_families::Family::Far,
            2 => spherule::accuracy::shape_families::Family::Along,
            3 => spherule::accuracy::shape_families::Family::Thin,
            4 => spherule::accuracy::shape_families::Family::Grazing,
            _ => spherule::accuracy::shape_families::Family::Inside,
        }
    }
}

impl Odd for spherule::accuracy::shape_families::Known {
    fn odd(s: &mut Source) -> Self {
        match s.below(6) {
            0 => spherule::accuracy::shape_families::Known::Capsule(Odd::odd(s)),
            1 => spherule::accuracy::shape_families::Known::Cylinder(Odd::odd(s)),
            2 => spherule::accuracy::shape_families::Known::Ellipsoid(Odd::odd(s)),
            3 => spherule::accuracy::shape_families::Known::Box(Odd::odd(s)),
            4 => spherule::accuracy::shape_families::Known::Cone(Odd::odd(s)),
            _ => spherule::accuracy::shape_families::Known::Disc(Odd::odd(s)),
        }
    }
}

impl Odd for spherule::bench::limit::Limit {
    fn odd(s: &mut Source) -> Self {
        spherule::bench::limit::Limit {
            operations_per_s: Odd::odd(s),
            bytes_per_s: Odd::odd(s),
        }
    }
}

impl Odd for spherule::bench::rays::Kind {
    fn odd(s: &mut Source) -> Self {
        match s.below(4) {
            0 => spherule::bench::rays::Kind::Primary,
            1 => spherule::bench::rays::Kind::Shadow,
            2 => spherule::bench::rays::Kind::Ambient,
            _ => spherule::bench::rays::Kind::Incoherent,
        }
    }
}

impl Odd for spherule::bench::rays::RaySets {
    fn odd(s: &mut Source) -> Self {
        spherule::bench::rays::RaySets {
            primary: Odd::odd(s),
            shadow: Odd::odd(s),
            ambient: Odd::odd(s),
            incoherent: Odd::odd(s),
        }
    }
}

impl Odd for spherule::bench::scenes::Source {
    fn odd(s: &mut Source) -> Self {
        match s.below(2) {
            0 => spherule::bench::scenes::Source::Made(Odd::odd(s)),
            _ => spherule::bench::scenes::Source::File(Odd::odd(s)),
        }
    }
}

impl Odd for spherule::cpu::InstructionSet {
    fn odd(s: &mut Source) -> Self {
        match s.below(3) {
            0 => spherule::cpu::InstructionSet::Plain,
            1 => spherule::cpu::InstructionSet::Avx2,
            _ => spherule::cpu::InstructionSet::Avx512,
        }
    }
}

impl Odd for spherule::device::DeviceChoice {
    fn odd(s: &mut Source) -> Self {
        match s.below(4) {
            0 => spherule::device::DeviceChoice::Auto,
            1 => spherule::device::DeviceChoice::Gpu,
            2 => spherule::device::DeviceChoice::Cpu,
            _ => spherule::device::DeviceChoice::Named(Odd::odd(s)),
        }
    }
}

impl Odd for spherule::device::buffer::Access {
    fn odd(s: &mut Source) -> Self {
        match s.below(3) {
            0 => spherule::device::buffer::Access::Uniform,
            1 => spherule::device::buffer::Access::Read,
            _ => spherule::device::buffer::Access::ReadWrite,
        }
    }
}

impl Odd for spherule::device::canary::Canary {
    fn odd(s: &mut Source) -> Self {
        spherule::device::canary::Canary {
            sums: Odd::odd(s),
            products: Odd::odd(s),
            splits: Odd::odd(s),
            quotients: Odd::odd(s),
            quotient_ulps: Odd::odd(s),
            roots: Odd::odd(s),
            root_ulps: Odd::odd(s),
            finds_nan: Odd::odd(s),
            keeps_subnormals: Odd::odd(s),
            wide: Odd::odd(s),
            wide_sums: Odd::odd(s),
            wide_products: Odd::odd(s),
        }
    }
}

impl Odd for spherule::device::canary::Share {
    fn odd(s: &mut Source) -> Self {
        spherule::device::canary::Share {
            exact: Odd::odd(s),
            tried: Odd::odd(s),
        }
    }
}

impl Odd for spherule::device::kernel::LaunchTime {
    fn odd(s: &mut Source) -> Self {
        spherule::device::kernel::LaunchTime {
            device: Odd::odd(s),
            host: Odd::odd(s),
        }
    }
}

impl Odd for spherule::error::Error {
    fn odd(s: &mut Source) -> Self {
        match s.below(20) {
            0 => spherule::error::Error::NoAdapter {
                wanted: Odd::odd(s),
                found: Odd::odd(s),
            },
            1 => spherule::error::Error::NoSuchAdapter {
                name: Odd::odd(s),
                found: Odd::odd(s),
            },
            2 => spherule::error::Error::DeviceRefused {
                adapter: Odd::odd(s),
                reason: Odd::odd(s),
            },
            3 => spherule::error::Error::KernelInvalid {
                kernel: Odd::odd(s),
                reason: Odd::odd(s),
            },
            4 => spherule::error::Error::BufferTooLarge {
                label: Odd::odd(s),
                needed: Odd::odd(s),
                limit: Odd::odd(s),
                device: Odd::odd(s),
            },
            5 => spherule::error::Error::SkyTooLarge {
                width: Odd::odd(s),
                height: Odd::odd(s),
                needed: Odd::odd(s),
                limit: Odd::odd(s),
                device: Odd::odd(s),
                fits: Odd::odd(s),
            },
            6 => spherule::error::Error::OutOfMemory {
                device: Odd::odd(s),
                during: Odd::odd(s),
            },
            7 => spherule::error::Error::OutOfHostMemory {
                needed: Odd::odd(s),
                available: Odd::odd(s),
                purpose: Odd::odd(s),
            },
            8 => spherule::error::Error::Denoiser {
                reason: Odd::odd(s),
            },
            9 => spherule::error::Error::Threads {
                reason: Odd::odd(s),
            },
            10 => spherule::error::Error::LaunchLimits {
                kernel: Odd::odd(s),
                device: Odd::odd(s),
                what: Odd::odd(s),
                asked: Odd::odd(s),
                limit: Odd::odd(s),
            },
            11 => spherule::error::Error::Validation {
                during: Odd::odd(s),
                reason: Odd::odd(s),
            },
            12 => spherule::error::Error::DeviceLost {
                device: Odd::odd(s),
                during: Odd::odd(s),
                reason: Odd::odd(s),
            },
            13 => spherule::error::Error::Timeout {
                device: Odd::odd(s),
                during: Odd::odd(s),
                limit: Odd::odd(s),
            },
            14 => spherule::error::Error::RungRefused {
                rung: Odd::odd(s),
                device: Odd::odd(s),
                reason: Odd::odd(s),
            },
            15 => spherule::error::Error::Readback {
                what: Odd::odd(s),
                device: Odd::odd(s),
                reason: Odd::odd(s),
            },
            16 => spherule::error::Error::Scene(Odd::odd(s)),
            17 => spherule::error::Error::Image {
                path: Odd::odd(s),
                reason: Odd::odd(s),
                help: Odd::odd(s),
            },
            18 => spherule::error::Error::Output {
                path: Odd::odd(s),
                reason: Odd::odd(s),
                help: Odd::odd(s),
            },
            _ => spherule::error::Error::OutputRefused {
                path: Odd::odd(s),
                reason: Odd::odd(s),
                help: Odd::odd(s),
            },
        }
    }
}

impl Odd for spherule::error::Place {
    fn odd(s: &mut Source) -> Self {
        spherule::error::Place {
            text: Odd::odd(s),
            span: Odd::odd(s),
            label: Odd::odd(s),
        }
    }
}

impl Odd for spherule::error::SceneError {
    fn odd(s: &mut Source) -> Self {
        spherule::error::SceneError {
            path: Odd::odd(s),
            message: Odd::odd(s),
            help: Odd::odd(s),
            place: Odd::odd(s),
        }
    }
}

impl Odd for spherule::film::agreement::Agreement {
    fn odd(s: &mut Source) -> Self {
        spherule::film::agreement::Agreement {
            worst: Odd::odd(s),
            limit: Odd::odd(s),
            regions: Odd::odd(s),
        }
    }
}

impl Odd for spherule::film::agreement::Channel {
    fn odd(s: &mut Source) -> Self {
        match s.below(3) {
            0 => spherule::film::agreement::Channel::Red,
            1 => spherule::film::agreement::Channel::Green,
            _ => spherule::film::agreement::Channel::Blue,
        }
    }
}

impl Odd for spherule::film::agreement::Compared {
    fn odd(s: &mut Source) -> Self {
        match s.below(2) {
            0 => spherule::film::agreement::Compared::Mean,
            _ => spherule::film::agreement::Compared::Brighter,
        }
    }
}

impl Odd for spherule::film::agreement::Worst {
    fn odd(s: &mut Source) -> Self {
        spherule::film::agreement::Worst {
            x: Odd::odd(s),
            y: Odd::odd(s),
            width: Odd::odd(s),
            height: Odd::odd(s),
            channel: Odd::odd(s),
            compared: Odd::odd(s),
            errors: Odd::odd(s),
        }
    }
}

impl Odd for spherule::film::compare::Comparison {
    fn odd(s: &mut Source) -> Self {
        spherule::film::compare::Comparison {
            largest: Odd::odd(s),
            mean: Odd::odd(s),
            differing: Odd::odd(s),
            pixels: Odd::odd(s),
            tolerance: Odd::odd(s),
        }
    }
}

impl Odd for spherule::film::compare::Tolerance {
    fn odd(s: &mut Source) -> Self {
        spherule::film::compare::Tolerance {
            channel: Odd::odd(s),
            share: Odd::odd(s),
        }
    }
}

impl Odd for spherule::read::particles::Atom {
    fn odd(s: &mut Source) -> Self {
        spherule::read::particles::Atom {
            position: Odd::odd(s),
            element: Odd::odd(s),
        }
    }
}

impl Odd for spherule::render::EffectChoice {
    fn odd(s: &mut Source) -> Self {
        match s.below(3) {
            0 => spherule::render::EffectChoice::Auto,
            1 => spherule::render::EffectChoice::All,
            _ => spherule::render::EffectChoice::Only(Odd::odd(s)),
        }
    }
}

impl Odd for spherule::render::Rendered {
    fn odd(s: &mut Source) -> Self {
        spherule::render::Rendered {
            image: Odd::odd(s),
            traced: Odd::odd(s),
            rays: Odd::odd(s),
            timings: Odd::odd(s),
            reached: Odd::odd(s),
        }
    }
}

impl Odd for spherule::render::Timings {
    fn odd(s: &mut Source) -> Self {
        spherule::render::Timings {
            setup: Odd::odd(s),
            compile: Odd::odd(s),
            trace: Odd::odd(s),
            readback: Odd::odd(s),
        }
    }
}

impl Odd for spherule::render::paths::budget::Reached {
    fn odd(s: &mut Source) -> Self {
        spherule::render::paths::budget::Reached {
            samples: Odd::odd(s),
            most_samples: Odd::odd(s),
            mean_samples: Odd::odd(s),
            asked: Odd::odd(s),
            noise: Odd::odd(s),
            is_upper_estimate: Odd::odd(s),
            stopped_by: Odd::odd(s),
        }
    }
}

impl Odd for spherule::render::paths::budget::StoppedBy {
    fn odd(s: &mut Source) -> Self {
        match s.below(4) {
            0 => spherule::render::paths::budget::StoppedBy::Samples,
            1 => spherule::render::paths::budget::StoppedBy::TimeLimit,
            2 => spherule::render::paths::budget::StoppedBy::Noise,
            _ => spherule::render::paths::budget::StoppedBy::Interrupted,
        }
    }
}

impl Odd for spherule::scene::limits::Range {
    fn odd(s: &mut Source) -> Self {
        spherule::scene::limits::Range {
            low: Odd::odd(s),
            high: Odd::odd(s),
        }
    }
}

impl Odd for spherule::scene::surroundings::Sun {
    fn odd(s: &mut Source) -> Self {
        spherule::scene::surroundings::Sun {
            direction: Odd::odd(s),
            size: Odd::odd(s),
            irradiance: Odd::odd(s),
        }
    }
}

impl Odd for spherule::scene::view::View {
    fn odd(s: &mut Source) -> Self {
        spherule::scene::view::View {
            eye: Odd::odd(s),
            target: Odd::odd(s),
            up: Odd::odd(s),
            vertical_fov: Odd::odd(s),
        }
    }
}

impl Odd for spherule_kernel::accel::node::Extent {
    fn odd(s: &mut Source) -> Self {
        spherule_kernel::accel::node::Extent {
            low: Odd::odd(s),
            high: Odd::odd(s),
            smallest_radius: Odd::odd(s),
        }
    }
}

impl Odd for spherule_kernel::accel::node::Node {
    fn odd(s: &mut Source) -> Self {
        spherule_kernel::accel::node::Node {
            sides: Odd::odd(s),
            corner: Odd::odd(s),
            links: Odd::odd(s),
        }
    }
}

impl Odd for spherule_kernel::arithmetic::double_word::DoubleWord<f32> {
    fn odd(s: &mut Source) -> Self {
        spherule_kernel::arithmetic::double_word::DoubleWord::<f32> {
            high: Odd::odd(s),
            low: Odd::odd(s),
        }
    }
}

impl Odd for spherule_kernel::cull::bounds::Aim<f32> {
    fn odd(s: &mut Source) -> Self {
        spherule_kernel::cull::bounds::Aim::<f32> {
            direction: Odd::odd(s),
            inverse: Odd::odd(s),
            start: Odd::odd(s),
            behind: Odd::odd(s),
        }
    }
}

impl Odd for spherule_kernel::cull::bounds::Bounds {
    fn odd(s: &mut Source) -> Self {
        spherule_kernel::cull::bounds::Bounds {
            misses: Odd::odd(s),
            hits: Odd::odd(s),
            low: Odd::odd(s),
            high: Odd::odd(s),
        }
    }
}

impl Odd for spherule_kernel::cull::bounds::Line {
    fn odd(s: &mut Source) -> Self {
        spherule_kernel::cull::bounds::Line {
            origin: Odd::odd(s),
            direction: Odd::odd(s),
            a: Odd::odd(s),
            inverse: Odd::odd(s),
            unit: Odd::odd(s),
            start: Odd::odd(s),
            behind: Odd::odd(s),
        }
    }
}

impl Odd for spherule_kernel::cull::discriminant::Target<f32> {
    fn odd(s: &mut Source) -> Self {
        spherule_kernel::cull::discriminant::Target::<f32> {
            o: Odd::odd(s),
            c: Odd::odd(s),
            oo: Odd::odd(s),
            rr: Odd::odd(s),
        }
    }
}

impl Odd for spherule_kernel::film::Launch {
    fn odd(s: &mut Source) -> Self {
        spherule_kernel::film::Launch {
            camera: Odd::odd(s),
            background: Odd::odd(s),
            first_of_tile: Odd::odd(s),
            image_size: Odd::odd(s),
            tile_origin: Odd::odd(s),
            tile_size: Odd::odd(s),
            first_sphere: Odd::odd(s),
            sphere_count: Odd::odd(s),
        }
    }
}

impl Odd for spherule_kernel::film::PathLaunch {
    fn odd(s: &mut Source) -> Self {
        spherule_kernel::film::PathLaunch {
            camera: Odd::odd(s),
            image_size: Odd::odd(s),
            tile_origin: Odd::odd(s),
            tile_size: Odd::odd(s),
            first_sample: Odd::odd(s),
            sample_count: Odd::odd(s),
            seed: Odd::odd(s),
            max_bounces: Odd::odd(s),
            lens_radius: Odd::odd(s),
            focus_distance: Odd::odd(s),
            shutter_open: Odd::odd(s),
            shutter_close: Odd::odd(s),
            ambient_distance: Odd::odd(s),
            sphere_light_probability: Odd::odd(s),
            called_effects: Odd::odd(s),
            has_ambient_sky: Odd::odd(s),
            has_plain_sky: Odd::odd(s),
            is_adaptive: Odd::odd(s),
            glass_at_eye: Odd::odd(s),
            sky: Odd::odd(s),
            fog: Odd::odd(s),
            filter: Odd::odd(s),
            indirect_limit: Odd::odd(s),
            first_caster: Odd::odd(s),
            first_shape: Odd::odd(s),
            padding: Odd::odd(s),
        }
    }
}

impl Odd for spherule_kernel::filter::Filter {
    fn odd(s: &mut Source) -> Self {
        spherule_kernel::filter::Filter {
            kind: Odd::odd(s),
            width: Odd::odd(s),
            padding: Odd::odd(s),
        }
    }
}

impl Odd for spherule_kernel::fog::Fog {
    fn odd(s: &mut Source) -> Self {
        spherule_kernel::fog::Fog {
            center: Odd::odd(s),
            radius: Odd::odd(s),
            albedo: Odd::odd(s),
            extinction: Odd::odd(s),
            anisotropy: Odd::odd(s),
            padding: Odd::odd(s),
            padding_end: Odd::odd(s),
        }
    }
}

impl Odd for spherule_kernel::hit::Hit {
    fn odd(s: &mut Source) -> Self {
        spherule_kernel::hit::Hit {
            t: Odd::odd(s),
            sphere: Odd::odd(s),
        }
    }
}

impl Odd for spherule_kernel::lane::Lane3<f32> {
    fn odd(s: &mut Source) -> Self {
        spherule_kernel::lane::Lane3::<f32> {
            x: Odd::odd(s),
            y: Odd::odd(s),
            z: Odd::odd(s),
        }
    }
}

impl Odd for spherule_kernel::light::Light {
    fn odd(s: &mut Source) -> Self {
        spherule_kernel::light::Light {
            position: Odd::odd(s),
            kind: Odd::odd(s),
            color: Odd::odd(s),
            cumulative: Odd::odd(s),
            probability: Odd::odd(s),
            sphere: Odd::odd(s),
            height: Odd::odd(s),
            leaf: Odd::odd(s),
        }
    }
}

impl Odd for spherule_kernel::light::sky::Sky {
    fn odd(s: &mut Source) -> Self {
        spherule_kernel::light::sky::Sky {
            horizon: Odd::odd(s),
            environment_probability: Odd::odd(s),
            zenith: Odd::odd(s),
            sun_probability: Odd::odd(s),
            sun_direction: Odd::odd(s),
            sun_height: Odd::odd(s),
            sun_radiance: Odd::odd(s),
            environment_turn: Odd::odd(s),
            environment_size: Odd::odd(s),
            padding_end: Odd::odd(s),
        }
    }
}

impl Odd for spherule_kernel::material::microfacet::Shares {
    fn odd(s: &mut Source) -> Self {
        spherule_kernel::material::microfacet::Shares {
            all: Odd::odd(s),
            grazing: Odd::odd(s),
        }
    }
}

impl Odd for spherule_kernel::material::optics::Fresnel {
    fn odd(s: &mut Source) -> Self {
        spherule_kernel::material::optics::Fresnel {
            reflectance: Odd::odd(s),
            cosine_transmitted: Odd::odd(s),
        }
    }
}

impl Odd for spherule_kernel::material::optics::Incidence {
    fn odd(s: &mut Source) -> Self {
        spherule_kernel::material::optics::Incidence {
            cosine: Odd::odd(s),
            eta: Odd::odd(s),
        }
    }
}

impl Odd for spherule_kernel::path::Shadow {
    fn odd(s: &mut Source) -> Self {
        spherule_kernel::path::Shadow {
            ray: Odd::odd(s),
            left: Odd::odd(s),
            target: Odd::odd(s),
            lamp: Odd::odd(s),
            light: Odd::odd(s),
            scatterings: Odd::odd(s),
        }
    }
}

impl Odd for spherule_kernel::path::caustic::casters::Entry {
    fn odd(s: &mut Source) -> Self {
        spherule_kernel::path::caustic::casters::Entry {
            sphere: Odd::odd(s),
            hollow: Odd::odd(s),
            probability: Odd::odd(s),
        }
    }
}

impl Odd for spherule_kernel::path::caustic::ways::Caster {
    fn odd(s: &mut Source) -> Self {
        spherule_kernel::path::caustic::ways::Caster {
            kind: Odd::odd(s),
            radius: Odd::odd(s),
            hollow: Odd::odd(s),
            index: Odd::odd(s),
        }
    }
}

impl Odd for spherule_kernel::path::sampling::Pair {
    fn odd(s: &mut Source) -> Self {
        spherule_kernel::path::sampling::Pair {
            u: Odd::odd(s),
            turn: Odd::odd(s),
        }
    }
}

impl Odd for spherule_kernel::precision::Rung {
    fn odd(s: &mut Source) -> Self {
        match s.below(5) {
            0 => spherule_kernel::precision::Rung::Textbook,
            1 => spherule_kernel::precision::Rung::Robust,
            2 => spherule_kernel::precision::Rung::Compensated,
            3 => spherule_kernel::precision::Rung::Double,
            _ => spherule_kernel::precision::Rung::Certified,
        }
    }
}

impl Odd for spherule_kernel::precision::certified::corrected::Residual<f32> {
    fn odd(s: &mut Source) -> Self {
        spherule_kernel::precision::certified::corrected::Residual::<f32> {
            g: Odd::odd(s),
            h: Odd::odd(s),
        }
    }
}

impl Odd for spherule_kernel::precision::certified::wide::WideRay<f32> {
    fn odd(s: &mut Source) -> Self {
        spherule_kernel::precision::certified::wide::WideRay::<f32> {
            origin: Odd::odd(s),
            direction: Odd::odd(s),
            t_min: Odd::odd(s),
            t_max: Odd::odd(s),
        }
    }
}

impl Odd for spherule_kernel::precision::compensated::Quadratic {
    fn odd(s: &mut Source) -> Self {
        spherule_kernel::precision::compensated::Quadratic {
            o: Odd::odd(s),
            d: Odd::odd(s),
            r: Odd::odd(s),
            a: Odd::odd(s),
            b: Odd::odd(s),
            c: Odd::odd(s),
            discriminant: Odd::odd(s),
            k_squared: Odd::odd(s),
            length_scale: Odd::odd(s),
            direction_scale: Odd::odd(s),
        }
    }
}

impl Odd for spherule_kernel::precision::robust::Quadratic<f32> {
    fn odd(s: &mut Source) -> Self {
        spherule_kernel::precision::robust::Quadratic::<f32> {
            a: Odd::odd(s),
            b: Odd::odd(s),
            c: Odd::odd(s),
            discriminant: Odd::odd(s),
            size: Odd::odd(s),
        }
    }
}

impl Odd for spherule_kernel::probe::canary::Operands {
    fn odd(s: &mut Source) -> Self {
        spherule_kernel::probe::canary::Operands {
            a: Odd::odd(s),
            b: Odd::odd(s),
        }
    }
}

impl Odd for spherule_kernel::ray::Ray {
    fn odd(s: &mut Source) -> Self {
        spherule_kernel::ray::Ray {
            origin: Odd::odd(s),
            t_min: Odd::odd(s),
            direction: Odd::odd(s),
            t_max: Odd::odd(s),
        }
    }
}

impl Odd for spherule_kernel::shading::Quantity {
    fn odd(s: &mut Source) -> Self {
        match s.below(5) {
            0 => spherule_kernel::shading::Quantity::Light,
            1 => spherule_kernel::shading::Quantity::Color,
            2 => spherule_kernel::shading::Quantity::Vector,
            3 => spherule_kernel::shading::Quantity::Distance,
            _ => spherule_kernel::shading::Quantity::Index,
        }
    }
}

impl Odd for spherule_kernel::shading::Seen {
    fn odd(s: &mut Source) -> Self {
        spherule_kernel::shading::Seen {
            ray: Odd::odd(s),
            hit: Odd::odd(s),
            surface: Odd::odd(s),
            material: Odd::odd(s),
            tag: Odd::odd(s),
        }
    }
}

impl Odd for spherule_kernel::shading::Shading {
    fn odd(s: &mut Source) -> Self {
        match s.below(5) {
            0 => spherule_kernel::shading::Shading::Lit,
            1 => spherule_kernel::shading::Shading::Normals,
            2 => spherule_kernel::shading::Shading::Depth,
            3 => spherule_kernel::shading::Shading::Flat,
            _ => spherule_kernel::shading::Shading::Id,
        }
    }
}

impl Odd for spherule_kernel::shape::capsule::Capsule {
    fn odd(s: &mut Source) -> Self {
        spherule_kernel::shape::capsule::Capsule {
            start: Odd::odd(s),
            radius: Odd::odd(s),
            end: Odd::odd(s),
            unused: Odd::odd(s),
        }
    }
}

impl Odd for spherule_kernel::shape::cone::Cone {
    fn odd(s: &mut Source) -> Self {
        spherule_kernel::shape::cone::Cone {
            start: Odd::odd(s),
            start_radius: Odd::odd(s),
            end: Odd::odd(s),
            end_radius: Odd::odd(s),
        }
    }
}

impl Odd for spherule_kernel::shape::cuboid::Cuboid {
    fn odd(s: &mut Source) -> Self {
        spherule_kernel::shape::cuboid::Cuboid {
            center: Odd::odd(s),
            unused: Odd::odd(s),
            half_axes: Odd::odd(s),
            unused_too: Odd::odd(s),
            rotation: Odd::odd(s),
        }
    }
}

impl Odd for spherule_kernel::shape::cylinder::Cylinder {
    fn odd(s: &mut Source) -> Self {
        spherule_kernel::shape::cylinder::Cylinder {
            start: Odd::odd(s),
            radius: Odd::odd(s),
            end: Odd::odd(s),
            unused: Odd::odd(s),
        }
    }
}

impl Odd for spherule_kernel::shape::disc::Disc {
    fn odd(s: &mut Source) -> Self {
        spherule_kernel::shape::disc::Disc {
            center: Odd::odd(s),
            radius: Odd::odd(s),
            normal: Odd::odd(s),
            unused: Odd::odd(s),
        }
    }
}

impl Odd for spherule_kernel::shape::ellipsoid::Ellipsoid {
    fn odd(s: &mut Source) -> Self {
        spherule_kernel::shape::ellipsoid::Ellipsoid {
            center: Odd::odd(s),
            unused: Odd::odd(s),
            half_axes: Odd::odd(s),
            unused_too: Odd::odd(s),
            rotation: Odd::odd(s),
        }
    }
}

impl Odd for spherule_kernel::surface::Surface {
    fn odd(s: &mut Source) -> Self {
        spherule_kernel::surface::Surface {
            point: Odd::odd(s),
            normal: Odd::odd(s),
            error: Odd::odd(s),
        }
    }
}
