//! A stand-in for Open Image Denoise's library, which the test compiles: it checks how it is
//! called, and halves every channel. `STAND_IN` in the environment makes it fail in one way.

use std::ffi::{CStr, c_char, c_int, c_void};
use std::ptr;
use std::sync::Mutex;

#[derive(Default)]
struct Image {
    pixels: usize,
    count: usize,
}

#[derive(Default)]
struct State {
    committed: bool,
    hdr: bool,
    color: Image,
    output: Image,
    error: Option<&'static CStr>,
    filters: i32,
}

static STATE: Mutex<Option<State>> = Mutex::new(None);
const DEVICE: *mut c_void = ptr::without_provenance_mut(16);
const FILTER: *mut c_void = ptr::without_provenance_mut(32);

fn with<T>(of: impl FnOnce(&mut State) -> T) -> T {
    of(STATE.lock().expect("the state").get_or_insert_default())
}

fn fails(how: &str) -> bool {
    std::env::var("STAND_IN").is_ok_and(|wanted| wanted == how)
}

/// Keeps the first mistake of a caller.
fn require(holds: bool, mistake: &'static CStr) {
    if !holds {
        with(|state| state.error = state.error.or(Some(mistake)));
    }
}

fn text<'a>(name: *const c_char) -> &'a str {
    // SAFETY: the caller gives a text that ends with a zero.
    unsafe { CStr::from_ptr(name) }.to_str().expect("ASCII")
}

#[unsafe(no_mangle)]
extern "C" fn oidnNewDevice(kind: c_int) -> *mut c_void {
    require(kind == 1, c"not a device of the CPU");
    if fails("device") {
        require(false, c"no device today");
        return ptr::null_mut();
    }
    DEVICE
}

#[unsafe(no_mangle)]
extern "C" fn oidnReleaseDevice(device: *mut c_void) {
    assert_eq!(device, DEVICE);
    with(|state| assert_eq!(state.filters, 0, "filters are released before their device"));
}

#[unsafe(no_mangle)]
extern "C" fn oidnSetDeviceInt(_: *mut c_void, name: *const c_char, value: c_int) {
    require(text(name) == "numThreads" && value > 0, c"threads");
}

#[unsafe(no_mangle)]
extern "C" fn oidnSetDeviceBool(_: *mut c_void, name: *const c_char, value: bool) {
    require(text(name) == "setAffinity" && !value, c"affinity");
}

#[unsafe(no_mangle)]
extern "C" fn oidnGetDeviceInt(_: *mut c_void, name: *const c_char) -> c_int {
    require(text(name) == "version", c"an unknown number");
    if fails("version") { 10_403 } else { 20_301 }
}

#[unsafe(no_mangle)]
extern "C" fn oidnCommitDevice(_: *mut c_void) {
    with(|state| state.committed = true);
}

#[unsafe(no_mangle)]
extern "C" fn oidnGetDeviceError(device: *mut c_void, message: *mut *const c_char) -> c_int {
    assert!(device.is_null() || device == DEVICE);
    with(|state| match state.error.take() {
        // SAFETY: the caller gives a place for the message.
        Some(error) => unsafe {
            *message = error.as_ptr();
            2
        },
        None => 0,
    })
}

#[unsafe(no_mangle)]
extern "C" fn oidnNewFilter(_: *mut c_void, kind: *const c_char) -> *mut c_void {
    require(text(kind) == "RT", c"an unknown filter");
    require(with(|state| state.committed), c"the device is not committed");
    if fails("filter") {
        require(false, c"no filter today");
        return ptr::null_mut();
    }
    with(|state| state.filters += 1);
    FILTER
}

#[unsafe(no_mangle)]
extern "C" fn oidnReleaseFilter(filter: *mut c_void) {
    assert_eq!(filter, FILTER);
    with(|state| state.filters -= 1);
}

#[unsafe(no_mangle)]
extern "C" fn oidnSetSharedFilterImage(
    _: *mut c_void,
    name: *const c_char,
    pixels: *mut c_void,
    format: c_int,
    width: usize,
    height: usize,
    offset: usize,
    pixel_stride: usize,
    row_stride: usize,
) {
    require(format == 3, c"not three floats");
    require(offset + pixel_stride + row_stride == 0, c"strides");
    let image = Image {
        pixels: pixels.addr(),
        count: width * height,
    };
    pixels.expose_provenance();
    with(|state| match text(name) {
        "color" => state.color = image,
        "output" => state.output = image,
        _ => state.error = Some(c"an unknown image"),
    });
}

#[unsafe(no_mangle)]
extern "C" fn oidnSetFilterBool(_: *mut c_void, name: *const c_char, value: bool) {
    with(|state| state.hdr = text(name) == "hdr" && value);
}

#[unsafe(no_mangle)]
extern "C" fn oidnCommitFilter(_: *mut c_void) {
    require(with(|state| state.hdr), c"light is not limited to one");
}

#[unsafe(no_mangle)]
extern "C" fn oidnExecuteFilter(_: *mut c_void) {
    if fails("execute") {
        require(false, c"no work today");
    }
    with(|state| {
        assert_eq!(state.color.count, state.output.count);
        let input: *const f32 = ptr::with_exposed_provenance(state.color.pixels);
        let output: *mut f32 = ptr::with_exposed_provenance_mut(state.output.pixels);
        for at in 0..3 * state.color.count {
            // SAFETY: both images have so many pixels of three floats.
            unsafe { output.add(at).write(0.5 * input.add(at).read()) };
        }
    });
}
