//! What each rung promises, on every family of rays, on the CPU and on every adapter, judged by the
//! oracle. `SPHERULE_RAYS=N` sets the number of rays in a family; the slow suite uses ten million
//! in all.

mod common;

use common::{all_adapters, device, open_through_naga, open_without_f64, skips};
use spherule::Device;
use spherule::accuracy::families::Family;
use spherule::accuracy::measure::{RungErrors, intersect_all, intersect_on_gpu, judge};
use spherule::device::canary::Canary;
use spherule::kernel::Rung;
use spherule::ulp::shown;

fn rays() -> usize {
    std::env::var("SPHERULE_RAYS")
        .ok()
        .and_then(|text| text.parse().ok())
        .unwrap_or(100_000)
}

fn measure(device: &Device, rung: Rung, family: Family) -> RungErrors {
    let samples = family.sample(2026, rays());
    let answers = intersect_all(device, rung, &samples).expect("the rung runs here");
    let measured = judge(&samples, &answers);
    println!(
        "{:11} {:8} max {:>10} ulp ({} anywhere), {} over 4, {} false hits, {} false misses, margin {:.1e}",
        rung.name(),
        family.name(),
        shown(measured.max_ulp),
        shown(measured.max_ulp_anywhere),
        measured.over_4_ulp,
        measured.false_hits,
        measured.false_misses,
        measured.margin,
    );
    measured
}

/// `compensated` and `double`: at most 1 ulp wherever |c| ≥ 2⁻²⁰ |o|², and no line on the wrong
/// side of the silhouette outside of a margin on |Δ| / (a r²).
fn check_upper_rungs(device: &Device) {
    for family in Family::ALL {
        for (rung, margin) in [
            // 2⁻⁴² times |o|/r, which is at most 10⁵ in the family `far`.
            (Rung::Compensated, 1e5 * 2.0_f64.powi(-40)),
            (Rung::Double, 1e5 * 2.0_f64.powi(-48)),
        ] {
            let measured = measure(device, rung, family);
            assert!(
                measured.hits * 20 > measured.rays,
                "only {} hits",
                measured.hits
            );
            assert!(
                measured.max_ulp <= Some(1),
                "{} {}: {measured:?}",
                rung.name(),
                family.name()
            );
            assert!(
                measured.margin <= margin,
                "{} {}: {measured:?}",
                rung.name(),
                family.name()
            );
        }
    }
}

/// `certified`: every ray in its class, and t the nearest float.
fn check_certified(device: &Device) {
    for family in Family::ALL {
        let measured = measure(device, Rung::Certified, family);
        assert_eq!(
            (measured.false_hits, measured.false_misses),
            (0, 0),
            "{}: {measured:?}",
            family.name()
        );
        assert!(
            measured.max_ulp_anywhere <= Some(0),
            "{}: {measured:?}",
            family.name()
        );
    }
}

#[test]
fn certified_is_right_everywhere_on_the_cpu() {
    check_certified(&Device::Cpu);
}

#[test]
fn certified_is_right_everywhere_on_gpus() {
    if skips("certified_is_right_everywhere_on_gpus") {
        return;
    }
    for adapter in all_adapters() {
        check_certified(&device(adapter));
        check_certified(&Device::Gpu(Box::new(open_without_f64(adapter))));
    }
}

#[test]
fn upper_rungs_keep_their_bounds_on_the_cpu() {
    check_upper_rungs(&Device::Cpu);
}

#[test]
fn upper_rungs_keep_their_bounds_on_gpus() {
    if skips("upper_rungs_keep_their_bounds_on_gpus") {
        return;
    }
    for adapter in all_adapters() {
        check_upper_rungs(&device(adapter));
    }
}

/// What the lower rungs are for: `robust` is right on small spheres far away, where `textbook` is
/// not, and neither keeps digits on a huge ground.
#[test]
fn lower_rungs_fail_where_they_are_said_to() {
    let share_over_4 = |rung, family| {
        let measured = measure(&Device::Cpu, rung, family);
        (
            measured.over_4_ulp as f64 / measured.hits as f64,
            (measured.false_hits + measured.false_misses) as f64 / measured.rays as f64,
        )
    };
    let (textbook, textbook_wrong) = share_over_4(Rung::Textbook, Family::Far);
    let (robust, robust_wrong) = share_over_4(Rung::Robust, Family::Far);
    assert!(textbook > 0.5 && robust < 0.02, "{textbook} {robust}");
    assert!(
        robust_wrong < 0.1 * textbook_wrong,
        "{textbook_wrong} {robust_wrong}"
    );
    // Half of the generic rays aim at or near a silhouette.
    assert!(share_over_4(Rung::Robust, Family::Generic).0 < 0.05);
    assert!(share_over_4(Rung::Robust, Family::Ground).0 > 0.9);
}

/// naga drops `NoContraction`. If the driver then rearranges operations, the compensated rung is
/// wrong, and the canary must refuse it.
#[test]
fn without_no_contraction_the_canary_objects() {
    if skips("without_no_contraction_the_canary_objects") {
        return;
    }
    for adapter in all_adapters() {
        let gpu = open_through_naga(adapter);
        let samples = Family::Ground.sample(7, 10_000);
        let answers = intersect_on_gpu(&gpu, Rung::Compensated, &samples).expect("it runs");
        let measured = judge(&samples, &answers);
        let canary = Canary::on_gpu(&gpu).expect("the canary runs");
        println!("{}: {canary:?}\n{measured:?}", gpu.name());
        let objects = canary.objection(Rung::Compensated).is_some();
        assert_eq!(
            objects,
            measured.max_ulp > Some(1),
            "{canary:?} {measured:?}"
        );
        // Both drivers that were tried rearrange. A driver that does not may run the rung.
        assert!(objects, "{}", gpu.name());
    }
}

/// CPU and GPU agree bit for bit on the compensated rung, because its quotients and roots are
/// corrected and do not depend on the device's own.
#[test]
fn the_compensated_rung_gives_the_same_bits_everywhere() {
    if skips("the_compensated_rung_gives_the_same_bits_everywhere") {
        return;
    }
    for adapter in all_adapters() {
        let device = device(adapter);
        for family in [Family::Generic, Family::Far, Family::Inside] {
            let samples = family.sample(99, 20_000);
            let on_cpu = intersect_all(&Device::Cpu, Rung::Compensated, &samples).expect("CPU");
            let on_gpu = intersect_all(&device, Rung::Compensated, &samples).expect("GPU");
            let differing = on_cpu.iter().zip(&on_gpu).filter(|(a, b)| a != b).count();
            // A root within 2⁻⁴⁶ of half-way between two floats may be rounded either way.
            assert!(differing <= 2, "{}: {differing}", family.name());
        }
    }
}
