//! Whether two names are the same file: by another spelling, a symlink or a hard link.

use std::path::{Path, PathBuf};

use super::identity::Identity;
use super::output::Output;
use crate::error::{Error, Result};
use crate::shown::shown_path;

/// Fails if two outputs are the same file, or both standard output.
///
/// # Errors
///
/// [`Error::OutputRefused`], which names both.
pub fn refuse_clashes(outputs: &[&Output]) -> Result<()> {
    for (index, one) in outputs.iter().enumerate() {
        for other in &outputs[..index] {
            if one.is_stdout() && other.is_stdout() {
                return Err(refused(
                    one,
                    "two outputs cannot both go to standard output".into(),
                    "give one of them a file",
                ));
            }
            let identity = one.identity();
            if identity.is_some() && identity == other.identity() {
                return Err(refused(
                    one,
                    format!("is the same file as the output {}", name(other)),
                    "give each output a file of its own",
                ));
            }
        }
    }
    Ok(())
}

/// Fails if an output would replace an input, or be appended to it.
///
/// # Errors
///
/// [`Error::OutputRefused`], which names both.
pub fn refuse_inputs(outputs: &[&Output], inputs: &[PathBuf]) -> Result<()> {
    for output in outputs {
        let identity = output.identity();
        for input in inputs {
            if identity.is_some() && identity == Identity::of(input) {
                return Err(refused(
                    output,
                    format!("is the same file as the input {}", shown_path(input)),
                    "give the output a file of its own",
                ));
            }
        }
    }
    Ok(())
}

/// An output's name for messages.
fn name(output: &Output) -> String {
    if output.path() == Path::new("-") {
        "on standard output".into()
    } else {
        shown_path(output.path())
    }
}

fn refused(output: &Output, reason: String, help: &str) -> Error {
    let path = if output.path() == Path::new("-") {
        "standard output".into()
    } else {
        output.path().into()
    };
    Error::OutputRefused {
        path,
        reason,
        help: help.into(),
    }
}
