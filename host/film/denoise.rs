//! [`Denoiser`]: removes the noise of few samples by Intel's Open Image Denoise, if the machine has
//! its library.
//!
//! The library is looked for when a denoiser is opened; nothing of it is needed to build or to run
//! spherule. Version 2 is needed: the interface of version 1 has other names.
//!
//! A denoised image is biased: it shows what is likely, not what was computed. Files say so.

use std::ffi::{CStr, OsString, c_char, c_int, c_void};
use std::fmt;
use std::ptr;

use glam::Vec3;
use libloading::Library;
use spherule_kernel::Pixel;

use super::{Image, allocate};
use crate::error::{Error, Result};

/// What the environment variable names: the library's file, if it is not where the system looks.
pub const VARIABLE: &str = "SPHERULE_OIDN";

/// The library's names on this system, the first that is there counts.
const NAMES: &[&str] = if cfg!(windows) {
    &["OpenImageDenoise.dll"]
} else if cfg!(target_vendor = "apple") {
    &["libOpenImageDenoise.2.dylib", "libOpenImageDenoise.dylib"]
} else {
    &["libOpenImageDenoise.so.2", "libOpenImageDenoise.so"]
};

/// `OIDN_DEVICE_TYPE_CPU`: only its filters read the host's memory on every machine.
const ON_CPU: c_int = 1;
/// `OIDN_FORMAT_FLOAT3`.
const FLOAT3: c_int = 3;
/// The oldest version whose functions are called here.
const OLDEST: c_int = 20_000;

/// The library's own types.
type DeviceHandle = *mut c_void;
type FilterHandle = *mut c_void;

/// Generates a struct of the library's functions, and what finds them.
macro_rules! functions {
    ($($name:ident = $symbol:literal: fn($($argument:ty),*) $(-> $result:ty)?;)*) => {
        struct Functions {
            $($name: unsafe extern "C" fn($($argument),*) $(-> $result)?,)*
            // After the functions, which are of no use without it.
            _library: Library,
        }

        impl Functions {
            /// The functions of a library; the first that it lacks is the error.
            ///
            /// # Safety
            ///
            /// The functions with these names are those of `OpenImageDenoise/oidn.h`.
            unsafe fn of(library: Library) -> std::result::Result<Self, &'static str> {
                Ok(Self {
                    // SAFETY: the caller ensures that the function with this name has this type.
                    $($name: unsafe {
                        *library.get(concat!($symbol, "\0").as_bytes()).map_err(|_| $symbol)?
                    },)*
                    _library: library,
                })
            }
        }
    };
}

functions! {
    new_device = "oidnNewDevice": fn(c_int) -> DeviceHandle;
    release_device = "oidnReleaseDevice": fn(DeviceHandle);
    set_device_int = "oidnSetDeviceInt": fn(DeviceHandle, *const c_char, c_int);
    set_device_bool = "oidnSetDeviceBool": fn(DeviceHandle, *const c_char, bool);
    device_int = "oidnGetDeviceInt": fn(DeviceHandle, *const c_char) -> c_int;
    commit_device = "oidnCommitDevice": fn(DeviceHandle);
    device_error = "oidnGetDeviceError": fn(DeviceHandle, *mut *const c_char) -> c_int;
    new_filter = "oidnNewFilter": fn(DeviceHandle, *const c_char) -> FilterHandle;
    release_filter = "oidnReleaseFilter": fn(FilterHandle);
    set_image = "oidnSetSharedFilterImage": fn(
        FilterHandle, *const c_char, *mut c_void, c_int, usize, usize, usize, usize, usize
    );
    set_filter_bool = "oidnSetFilterBool": fn(FilterHandle, *const c_char, bool);
    commit_filter = "oidnCommitFilter": fn(FilterHandle);
    execute_filter = "oidnExecuteFilter": fn(FilterHandle);
}

/// Open Image Denoise, ready for images.
pub struct Denoiser {
    functions: Functions,
    device: DeviceHandle,
}

/// A filter of a denoiser; released when it is dropped.
struct Filter<'a>(&'a Functions, FilterHandle);

impl Drop for Filter<'_> {
    fn drop(&mut self) {
        // SAFETY: the filter was made by these functions and is released once.
        unsafe { (self.0.release_filter)(self.1) };
    }
}

impl Denoiser {
    /// Loads the library: the one that the environment variable [`VARIABLE`] names, or the one that
    /// the system finds by its usual name. Its code runs in this process from then on.
    ///
    /// # Errors
    ///
    /// [`Error::Denoiser`] if there is none, if it is older than version 2, or if it does not
    /// start.
    pub fn open() -> Result<Self> {
        let functions = load()?;
        // SAFETY: any number may be given; null is returned for one that stands for no device.
        let device = unsafe { (functions.new_device)(ON_CPU) };
        let denoiser = Self { functions, device };
        if device.is_null() {
            return Err(denoiser.failure());
        }
        let threads = c_int::try_from(rayon::current_num_threads()).unwrap_or(c_int::MAX);
        let functions = &denoiser.functions;
        // SAFETY: the device exists, and the names end with zeros.
        let version = unsafe {
            (functions.set_device_int)(device, c"numThreads".as_ptr(), threads);
            // Threads that are tied to processors would hold up the threads of the next render.
            (functions.set_device_bool)(device, c"setAffinity".as_ptr(), false);
            (functions.commit_device)(device);
            (functions.device_int)(device, c"version".as_ptr())
        };
        denoiser.check()?;
        if version < OLDEST {
            let text = format!("Open Image Denoise {} is too old", shown(version));
            return Err(Error::Denoiser { reason: text });
        }
        Ok(denoiser)
    }

    /// The library's name and version.
    #[must_use]
    pub fn name(&self) -> String {
        // SAFETY: the device exists, and the name ends with a zero.
        let version = unsafe { (self.functions.device_int)(self.device, c"version".as_ptr()) };
        format!("Open Image Denoise {}", shown(version))
    }

    /// Removes the noise of an image of light, and adds to its remarks that this was done. Depths
    /// and opacities stay as they are.
    ///
    /// # Errors
    ///
    /// [`Error::Denoiser`] with what the library says; the image is as before.
    pub fn denoise(&mut self, image: &mut Image) -> Result<()> {
        let (width, height) = (image.width as usize, image.height as usize);
        if image.pixels.is_empty() {
            return Ok(());
        }
        let mut noisy: Vec<[f32; 3]> = allocate(image.width, image.height)?;
        let mut clean: Vec<[f32; 3]> = allocate(image.width, image.height)?;
        for (color, pixel) in noisy.iter_mut().zip(&image.pixels) {
            *color = pixel.color().to_array();
        }
        let functions = &self.functions;
        // SAFETY: the device exists, and the name ends with a zero.
        let handle = unsafe { (functions.new_filter)(self.device, c"RT".as_ptr()) };
        if handle.is_null() {
            return Err(self.failure());
        }
        let filter = Filter(functions, handle);
        let (input, output) = (noisy.as_mut_ptr(), clean.as_mut_ptr());
        // SAFETY: both images have width × height pixels of three floats side by side, row by row,
        // which is what strides of zero mean, and outlive the filter's work. A device of the CPU
        // reads the host's memory.
        unsafe {
            for (name, pixels) in [(c"color", input), (c"output", output)] {
                let (name, pixels) = (name.as_ptr(), pixels.cast());
                (functions.set_image)(handle, name, pixels, FLOAT3, width, height, 0, 0, 0);
            }
            (functions.set_filter_bool)(handle, c"hdr".as_ptr(), true);
            (functions.commit_filter)(handle);
            (functions.execute_filter)(handle);
        }
        drop(filter);
        self.check()?;
        for (pixel, color) in image.pixels.iter_mut().zip(clean) {
            *pixel = Pixel::new(Vec3::from_array(color), pixel.depth());
        }
        if !image.remarks.is_empty() {
            image.remarks.push_str("; ");
        }
        image.remarks += &format!("denoised by {}, which is biased", self.name());
        Ok(())
    }

    /// The library's error, if there was one since the last call.
    fn check(&self) -> Result<()> {
        match self.said() {
            (0, _) => Ok(()),
            (_, reason) => Err(Error::Denoiser { reason }),
        }
    }

    /// The error for a call that returned nothing.
    fn failure(&self) -> Error {
        Error::Denoiser {
            reason: self.said().1,
        }
    }

    /// The code of the library's error, zero for none, and its message.
    fn said(&self) -> (c_int, String) {
        let mut message = ptr::null();
        // SAFETY: without a device the error of this thread is returned. The message stays until
        // the next call.
        unsafe {
            let code = (self.functions.device_error)(self.device, &raw mut message);
            let text = if message.is_null() {
                "it does not say why".into()
            } else {
                CStr::from_ptr(message).to_string_lossy().into_owned()
            };
            (code, text)
        }
    }
}

impl fmt::Debug for Denoiser {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Denoiser").field(&self.name()).finish()
    }
}

impl Drop for Denoiser {
    fn drop(&mut self) {
        if !self.device.is_null() {
            // SAFETY: the device is released once, after all of its filters.
            unsafe { (self.functions.release_device)(self.device) };
        }
    }
}

/// The library and its functions.
fn load() -> Result<Functions> {
    let named = std::env::var_os(VARIABLE);
    let names: Vec<OsString> = match &named {
        Some(name) => vec![name.clone()],
        None => NAMES.iter().map(OsString::from).collect(),
    };
    let mut reason = String::new();
    for name in &names {
        // SAFETY: what the library does when it is loaded is up to the system's owner, who put it
        // there, or to the user who named it.
        match unsafe { Library::new(name) } {
            // SAFETY: a library with this name has Intel's interface.
            Ok(library) => match unsafe { Functions::of(library) } {
                Ok(functions) => return Ok(functions),
                Err(symbol) => {
                    let name = name.to_string_lossy();
                    reason = format!("{name} has no function {symbol}: version 2 is needed");
                }
            },
            Err(error) if reason.is_empty() => reason = error.to_string(),
            Err(_) => {}
        }
    }
    Err(Error::Denoiser { reason })
}

/// A version as the library counts them: 20301 is 2.3.1.
fn shown(version: c_int) -> String {
    let (major, minor, patch) = (version / 10_000, version / 100 % 100, version % 100);
    format!("{major}.{minor}.{patch}")
}
