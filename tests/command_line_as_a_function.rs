//! The command line as a library function: the program that calls it has its own threads,
//! environment and logger.

use std::process::ExitCode;

/// It may be called several times, with a logger already set. It does not panic, does not end the
/// process, and does not change the environment, which other threads may read at any time.
#[test]
fn it_may_be_called_again_and_beside_other_threads() {
    struct Silent;
    impl log::Log for Silent {
        fn enabled(&self, _: &log::Metadata<'_>) -> bool {
            false
        }
        fn log(&self, _: &log::Record<'_>) {}
        fn flush(&self) {}
    }
    log::set_logger(&Silent).expect("no logger was set before");

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
    assert_eq!(before, after, "the environment must not change");
}
