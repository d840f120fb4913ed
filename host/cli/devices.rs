//! `spherule devices`: lists the devices that can render.

use std::fmt::Write;
use std::process::ExitCode;

use serde_json::json;

use super::args::DevicesArguments;
use super::print;
use crate::device::{AdapterReport, list_adapters};
use crate::error::Result;
use crate::plural::count_of;

pub(super) fn run(arguments: &DevicesArguments) -> Result<ExitCode> {
    let adapters = list_adapters();
    let threads = rayon::current_num_threads();
    if arguments.json {
        let value = json!({ "cpu": { "threads": threads }, "adapters": adapters });
        print(&format!("{value:#}\n"))?;
    } else {
        print(&table(&adapters, threads))?;
    }
    Ok(ExitCode::SUCCESS)
}

fn table(adapters: &[AdapterReport], threads: usize) -> String {
    let chosen = adapters.iter().position(|adapter| adapter.real_gpu);
    let mark = |is_chosen: bool| if is_chosen { "*" } else { " " };
    let mut text = String::new();
    // Writing to a String cannot fail.
    let _ = writeln!(
        text,
        "{} CPU, {}",
        mark(chosen.is_none()),
        count_of(threads, "thread")
    );
    for (index, adapter) in adapters.iter().enumerate() {
        let yes_no = |yes: bool| if yes { "yes" } else { "no" };
        let _ = writeln!(
            text,
            "{} {}\n    {} {}, driver {}\n    SPIR-V directly to the driver {}, 64-bit floats {}, timestamps {}\n    \
             buffers to {} MiB, {} MiB a binding, {} threads a workgroup",
            mark(chosen == Some(index)),
            adapter.name,
            adapter.kind,
            adapter.api,
            adapter.driver,
            yes_no(adapter.passthrough),
            yes_no(adapter.f64),
            yes_no(adapter.timestamps),
            adapter.max_buffer >> 20,
            adapter.max_binding >> 20,
            adapter.max_workgroup,
        );
    }
    if adapters.is_empty() {
        text.push_str("  no GPU adapter: this system has no graphics driver that wgpu can use\n");
    }
    text.push_str("* --device auto takes this one\n");
    text
}
