//! The command line is a safe function of the library too: a program that calls it has threads,
//! an environment and a log of its own.

use std::process::ExitCode;

/// Called twice, beside a log that was set up before: neither panics, neither ends the process,
/// and the environment, which other threads may read at any time, is left alone.
#[test]
fn it_may_be_called_beside_other_threads_and_again() {
    struct Silent;
    impl log::Log for Silent {
        fn enabled(&self, _: &log::Metadata<'_>) -> bool {
            false
        }
        fn log(&self, _: &log::Record<'_>) {}
        fn flush(&self) {}
    }
    log::set_logger(&Silent).expect("no log was set before");

    let before: Vec<_> = std::env::vars_os().collect();
    for _ in 0..2 {
        let code = spherule::cli::run(["spherule", "devices", "--json"]);
        assert_eq!(code, ExitCode::SUCCESS);
        let code = spherule::cli::run(["spherule", "--version"]);
        assert_eq!(code, ExitCode::SUCCESS);
        let code = spherule::cli::run(["spherule", "paint"]);
        assert_eq!(code, ExitCode::from(2));
    }
    let after: Vec<_> = std::env::vars_os().collect();
    assert_eq!(before, after, "the environment is the caller's");
}
