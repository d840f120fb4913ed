//! The command `spherule`.

use spherule::cli::{Allocator, spare_addresses};

#[global_allocator]
static ALLOCATOR: Allocator = Allocator;

fn main() -> std::process::ExitCode {
    quiet_mesa();
    // SAFETY: this is the start of the process, which has no other thread yet.
    unsafe { spare_addresses() };
    spherule::cli::main()
}

/// On a machine without a desktop session, Mesa's device-select layer complains on stderr that
/// it finds no Wayland socket. The layer only reorders adapters, which spherule does itself.
/// Vulkan's loader and its layers take such wishes from the environment alone.
fn quiet_mesa() {
    if std::env::var_os("XDG_RUNTIME_DIR").is_none() {
        // SAFETY: this is the start of the process, which has no other thread yet.
        unsafe { std::env::set_var("NODEVICE_SELECT", "1") };
    }
}
