//! The command `spherule`.

fn main() -> std::process::ExitCode {
    spherule::cli::main()
}
