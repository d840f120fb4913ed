//! The hard cases on every rung, on the CPU and on every adapter: no promise may be broken, and
//! `certified` promises all of them.

mod common;

use common::{all_adapters, device, skips};
use spherule::Device;
use spherule::accuracy::cases::{Verdict, catalogue};
use spherule::accuracy::scene_cases::SCENE_CASES;
use spherule::kernel::Rung;

fn check(device: &Device) {
    let mut broken = Vec::new();
    let mut judge = |number: u8, name: &str, rung: Rung, verdict: spherule::Result<Verdict>| {
        let verdict = verdict.expect("the device runs");
        if verdict.is_broken() || rung == Rung::Certified && verdict != Verdict::Holds {
            broken.push(format!("{number} {name} on {}: {verdict:?}", rung.name()));
        }
    };
    for rung in Rung::ALL {
        for case in catalogue() {
            judge(case.number, case.name, rung, case.judge(device, rung));
        }
        for case in SCENE_CASES {
            judge(case.number, case.name, rung, case.judge(device, rung));
        }
    }
    assert!(
        broken.is_empty(),
        "{}:\n{}",
        device.name(),
        broken.join("\n")
    );
}

#[test]
fn no_promise_is_broken_on_the_cpu() {
    check(&Device::Cpu);
}

#[test]
fn no_promise_is_broken_on_gpus() {
    if skips("no_promise_is_broken_on_gpus") {
        return;
    }
    for adapter in all_adapters() {
        check(&device(adapter));
    }
}

#[test]
fn the_catalogue_is_complete() {
    let mut numbers: Vec<u8> = catalogue().iter().map(|case| case.number).collect();
    numbers.extend(SCENE_CASES.iter().map(|case| case.number));
    numbers.sort_unstable();
    assert_eq!(numbers, (1..=47).collect::<Vec<u8>>());
}

/// The cases can fail: the textbook formula fails on those that it is known to fail on.
#[test]
fn the_textbook_formula_fails_where_it_is_known_to() {
    for case in catalogue() {
        if [1, 2, 3, 4, 8, 26].contains(&case.number) {
            let verdict = case
                .judge(&Device::Cpu, Rung::Textbook)
                .expect("the CPU runs");
            assert!(
                matches!(verdict, Verdict::FailsUnpromised(_)),
                "{} {}: {verdict:?}",
                case.number,
                case.name
            );
        }
    }
}
