//! The C interface of the module for WebAssembly: one thread, texts as an address and a length.

/// Room for a text of `length` bytes, to be filled and handed to [`aerodeck_live`].
#[unsafe(no_mangle)]
extern "C" fn aerodeck_reserve(length: usize) -> *mut u8 {
    Box::into_raw(vec![0_u8; length].into_boxed_slice()).cast()
}

/// Takes a request back and answers it: address times 2³² plus length of a text that is to be given to
/// [`aerodeck_release`].
///
/// # Safety
/// `request` comes from [`aerodeck_reserve`] with the same length and is not used again.
#[unsafe(no_mangle)]
unsafe extern "C" fn aerodeck_live(request: *mut u8, length: usize) -> u64 {
    // SAFETY: as the caller promises
    let request = unsafe { text(request, length) };
    let answer = super::answer(&String::from_utf8_lossy(&request)).into_bytes();
    let length = answer.len() as u64;
    let address = Box::into_raw(answer.into_boxed_slice()).cast::<u8>() as u64;
    address << 32 | length
}

/// Frees an answer.
///
/// # Safety
/// Address and length are those of an answer that is not used again.
#[unsafe(no_mangle)]
unsafe extern "C" fn aerodeck_release(answer: *mut u8, length: usize) {
    // SAFETY: as the caller promises
    drop(unsafe { text(answer, length) });
}

/// # Safety
/// The bytes were leaked as a boxed slice of this length.
unsafe fn text(address: *mut u8, length: usize) -> Box<[u8]> {
    // SAFETY: as the caller promises
    unsafe { Box::from_raw(std::ptr::slice_from_raw_parts_mut(address, length)) }
}
