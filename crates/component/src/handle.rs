//! An instance behind the interfaces of the draft: lists as arrays, and answers as results.

use crate::interfaces::fmi::fmi3::types::Status;
use crate::interfaces::fmi::fmi3::{callbacks, resource_dir_callbacks};
use aerodeck_core::error::Error;
use aerodeck_unit::fmi2::types::fmi2Status;
use aerodeck_unit::fmi3::*;
use std::ffi::{CStr, CString, c_char, c_void};
use std::path::Path;

/// An instance of FMI 3.0, and what it is called in the log. The name lies apart, for the logger points to it.
pub(crate) struct Handle {
    pub(crate) instance: *mut c_void,
    pub(crate) _name: Box<CString>,
}

impl Drop for Handle {
    fn drop(&mut self) {
        // SAFETY: made by `instantiate_from_files`, and freed here alone
        unsafe { fmi3FreeInstance(self.instance) };
    }
}

pub(crate) fn status(of: fmi2Status) -> Status {
    match of {
        fmi2Status::fmi2OK | fmi2Status::fmi2Pending => Status::Ok,
        fmi2Status::fmi2Warning => Status::Warning,
        fmi2Status::fmi2Discard => Status::Discard,
        fmi2Status::fmi2Error => Status::Error,
        fmi2Status::fmi2Fatal => Status::Fatal,
    }
}

/// What has been written to a place, unless the call was refused.
pub(crate) fn answer<T>(of: fmi2Status, value: T) -> Result<T, Status> {
    match status(of) {
        Status::Ok | Status::Warning => Ok(value),
        refused => Err(refused),
    }
}

pub(crate) unsafe extern "C" fn log(
    name: *mut c_void,
    of: fmi2Status,
    category: *const c_char,
    message: *const c_char,
) {
    // SAFETY: the environment is the instance's name, and texts of the log end with a zero byte
    let [name, category, message] =
        unsafe { [name.cast_const().cast(), category, message].map(|text| CStr::from_ptr(text)) }
            .map(CStr::to_string_lossy);
    callbacks::log_message(&name, status(of), &category, &message);
}

/// A file of `resources/` by the host, which says in words why it has none.
pub(crate) fn read(file: &Path) -> Result<Option<Vec<u8>>, Error> {
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    let read = resource_dir_callbacks::read_file(&name);
    match read {
        Err(why) if name == aerodeck_unit::location::MODEL_FILE => {
            Err(Error::input("resources", "a file", why).in_file(file))
        }
        read => Ok(read.ok()),
    }
}

type Get<T> = unsafe extern "C" fn(*mut c_void, *const u32, usize, *mut T, usize) -> fmi2Status;
type Set<T> = unsafe extern "C" fn(*mut c_void, *const u32, usize, *const T, usize) -> fmi2Status;

impl Handle {
    /// Values of some variables; as many as there are elements of arrays.
    pub(crate) fn get<T: Clone + Default>(
        &self,
        function: Get<T>,
        of: &[u32],
    ) -> Result<Vec<T>, Status> {
        // SAFETY: an instance, and lists of the lengths that stand beside them
        unsafe {
            let count = count_of_values(self.instance, of);
            let mut values = vec![T::default(); count];
            let done = function(
                self.instance,
                of.as_ptr(),
                of.len(),
                values.as_mut_ptr(),
                count,
            );
            answer(done, values)
        }
    }

    pub(crate) fn set<T>(&self, function: Set<T>, of: &[u32], values: &[T]) -> Status {
        // SAFETY: as in `get`
        status(unsafe {
            function(
                self.instance,
                of.as_ptr(),
                of.len(),
                values.as_ptr(),
                values.len(),
            )
        })
    }

    pub(crate) fn call(&self, function: unsafe extern "C" fn(*mut c_void) -> fmi2Status) -> Status {
        // SAFETY: an instance
        status(unsafe { function(self.instance) })
    }

    /// Says that there are no clocks.
    pub(crate) fn refuse_clocks(&self, function: &str) -> Status {
        // SAFETY: an instance
        status(unsafe { no_clocks(self.instance, function) })
    }

    pub(crate) fn no_clocks<T>(&self, function: &str) -> Result<Vec<T>, Status> {
        Err(self.refuse_clocks(function))
    }

    pub(crate) fn derivative(
        &self,
        function: unsafe extern "C" fn(
            *mut c_void,
            *const u32,
            usize,
            *const u32,
            usize,
            *const f64,
            usize,
            *mut f64,
            usize,
        ) -> fmi2Status,
        [unknowns, knowns, sized_by]: [&[u32]; 3],
        seed: &[f64],
    ) -> Result<Vec<f64>, Status> {
        // SAFETY: as in `get`
        unsafe {
            let mut found = vec![0.0; count_of_values(self.instance, sized_by)];
            let done = function(
                self.instance,
                unknowns.as_ptr(),
                unknowns.len(),
                knowns.as_ptr(),
                knowns.len(),
                seed.as_ptr(),
                seed.len(),
                found.as_mut_ptr(),
                found.len(),
            );
            answer(done, found)
        }
    }
}

/// References and orders of rates; an order that C cannot name is one that is not offered either.
pub(crate) fn split(requests: Vec<(u32, u32)>) -> (Vec<u32>, Vec<i32>) {
    let order = |order| i32::try_from(order).unwrap_or(i32::MAX);
    let requests = requests.into_iter();
    requests.map(|(of, n)| (of, order(n))).unzip()
}
