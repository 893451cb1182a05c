//! How the library is linked; the Python package, which depends on it, is linked in the same way.

use std::env;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let is = |name: &str, value: &str| env::var(name).is_ok_and(|v| v == value);
    if is("CARGO_CFG_TARGET_OS", "linux") {
        // an FMU travels: names of functions that nobody calls from outside are a fifth of it
        println!("cargo::rustc-cdylib-link-arg=-Wl,--strip-all");
        if is("CARGO_CFG_TARGET_ARCH", "x86_64") && is("CARGO_CFG_TARGET_ENV", "gnu") {
            println!("cargo::rustc-cdylib-link-arg=-Wl,--wrap=hypot");
        }
    }
}
