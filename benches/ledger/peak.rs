//! Peak memory, by the operating system's own maximum.

use crate::entry::BenchEntry;
use std::process::Stdio;

/// Largest resident memory of a process that does the job once, MiB; `None` where the system does not say.
pub(crate) fn measured(entry: &BenchEntry) -> Result<Option<f64>, String> {
    let output = entry
        .process("--peak")?
        // the same on every machine, and every time: what the allocator keeps of freed blocks for a thread is chance
        .env("RAYON_NUM_THREADS", "1")
        .env("GLIBC_TUNABLES", "glibc.malloc.tcache_count=0")
        .stderr(Stdio::inherit())
        .output()
        .map_err(|e| e.to_string())?;
    if !output.status.success() {
        return Err(format!("{}: {}", entry.name, output.status));
    }
    Ok(String::from_utf8_lossy(&output.stdout).trim().parse().ok())
}

/// Does the job once and prints the maximum of this process and of those that it started, for [`measured`].
pub(crate) fn print(entry: &BenchEntry) -> Result<(), String> {
    (entry.job)().run(1);
    if let Some(mib) = peak_mib() {
        println!("{mib:.1}");
    }
    Ok(())
}

/// Largest resident memory of this process or of one that it started, MiB.
#[cfg(all(unix, target_pointer_width = "64"))]
pub(crate) fn peak_mib() -> Option<f64> {
    use std::ffi::{c_int, c_long};
    /// `struct rusage`: two times, then the maximum and thirteen counters.
    #[repr(C)]
    struct Usage {
        times: [c_long; 4],
        largest_resident: c_long,
        others: [c_long; 13],
    }
    unsafe extern "C" {
        fn getrusage(who: c_int, usage: *mut Usage) -> c_int;
    }
    // KiB, but bytes on macOS
    let mib = if cfg!(target_os = "macos") {
        1048576.0
    } else {
        1024.0
    };
    const SELF: c_int = 0;
    const CHILDREN: c_int = -1;
    let most = [SELF, CHILDREN].map(|who| {
        let mut usage = Usage {
            times: [0; 4],
            largest_resident: 0,
            others: [0; 13],
        };
        // SAFETY: a structure of this size and layout on 64-bit Unix
        let answer = unsafe { getrusage(who, &raw mut usage) };
        (answer == 0).then_some(usage.largest_resident as f64 / mib)
    });
    most.into_iter().flatten().reduce(f64::max)
}

#[cfg(not(all(unix, target_pointer_width = "64")))]
pub(crate) fn peak_mib() -> Option<f64> {
    None
}
