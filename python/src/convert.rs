//! Values of Python and of the library into each other.

use crate::error::{raised, wrong};
use aerodeck::section::Dof;
use numpy::{AllowTypeChange, PyArray2, PyArrayLike1, PyArrayLike2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyBytes, PyComplex, PyDict, PyList, PyString, PyTuple};
use serde::Serialize;
use serde::de::DeserializeOwned;

/// Anything the library can write as JSON.
pub fn json_text(value: &impl Serialize) -> PyResult<String> {
    serde_json::to_string(value).map_err(|e| raised(aerodeck::Error::Numerical(e.to_string())))
}

/// Anything the library can write as JSON, as dicts, lists and numbers.
pub fn to_python<'py>(py: Python<'py>, value: &impl Serialize) -> PyResult<Bound<'py, PyAny>> {
    py.import("json")?
        .call_method1("loads", (json_text(value)?,))
}

/// What `pickle` and `copy` make an object from again: `_from_state` of its class and its state as JSON.
pub type Reduced<'py> = (Bound<'py, PyAny>, (String,));

/// The state of an object for `__reduce__`.
pub fn reduced<'py, T: pyo3::PyClass>(
    slf: &Bound<'py, T>,
    state: &impl Serialize,
) -> PyResult<Reduced<'py>> {
    let from_state = slf.as_any().get_type().getattr("_from_state")?;
    Ok((from_state, (json_text(state)?,)))
}

/// The state that [`reduced`] wrote.
pub fn restored<T: DeserializeOwned>(state: &str) -> PyResult<T> {
    serde_json::from_str(state).map_err(|e| wrong("state", "one of this version", e.to_string()))
}

/// The same of an object of arrays: `_from_parts` of its class and the attributes, which are all of it.
pub type Parts<'py> = (Bound<'py, PyAny>, Bound<'py, PyTuple>);

/// The attributes of an object for `__reduce__`.
pub fn parts<'py, T: pyo3::PyClass>(slf: &Bound<'py, T>) -> PyResult<Parts<'py>> {
    let (py, slf) = (slf.py(), slf.as_any());
    let class = slf.get_type();
    let all = PyDict::new(py);
    for entry in class
        .getattr("__dict__")?
        .call_method0("items")?
        .try_iter()?
    {
        let (name, of): (String, Bound<'_, PyAny>) = entry?.extract()?;
        let kind = of.get_type().name()?;
        if ["getset_descriptor", "member_descriptor"].contains(&kind.to_str()?) {
            all.set_item(&name, slf.getattr(&name)?)?;
        }
    }
    let parts = py.import("types")?.getattr("SimpleNamespace")?;
    let parts = PyTuple::new(py, [parts.call((), Some(&all))?])?;
    Ok((class.getattr("_from_parts")?, parts))
}

/// Keys and values as a value of the library, with the words of a study file; `place` is named when they do not fit.
pub fn from_python<T: DeserializeOwned>(place: &str, value: &Bound<'_, PyAny>) -> PyResult<T> {
    refuse_not_finite(place, value)?;
    let (py, how) = (value.py(), PyDict::new(value.py()));
    // numbers and arrays of NumPy
    how.set_item(
        "default",
        py.eval(c"lambda of_numpy: of_numpy.tolist()", None, None)?,
    )?;
    let json = py.import("json")?;
    let text = json
        .call_method("dumps", (value,), Some(&how))
        .map_err(|e| {
            let expected = "numbers, texts, lists and dicts";
            wrong(place, expected, e.value(py).to_string())
        })?;
    let text: String = text.extract()?;
    serde_json::from_str(&text).map_err(|e| {
        let said = e.to_string();
        // the place is one in a text that the caller never saw
        let found = said.split(" at line ").next().unwrap_or_default();
        wrong(
            place,
            "the keys and values of a study file",
            found.to_owned(),
        )
    })
}

/// JSON has no NaN and no infinity; keys lead to the one that stands in `value`.
pub fn refuse_not_finite(place: &str, value: &Bound<'_, PyAny>) -> PyResult<()> {
    if let Ok(dict) = value.cast::<PyDict>() {
        let mut of_keys = dict.iter();
        return of_keys.try_for_each(|(key, of)| refuse_not_finite(&format!("{place}.{key}"), &of));
    }
    let value = &value.call_method0("tolist").unwrap_or(value.clone());
    if value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>() {
        return value
            .try_iter()?
            .try_for_each(|of| refuse_not_finite(place, &of?));
    }
    match value.extract::<f64>() {
        Ok(number) if !number.is_finite() => {
            Err(wrong(place, "a finite number", number.to_string()))
        }
        _ => Ok(()),
    }
}

/// Adds `key` unless the caller has stated it.
pub fn set_default(dict: &Bound<'_, PyDict>, key: &str, value: impl Serialize) -> PyResult<()> {
    if dict.contains(key)? {
        return Ok(());
    }
    dict.set_item(key, to_python(dict.py(), &value)?)
}

/// A word of the library's files: a notation, a motion, …
pub fn word<T: DeserializeOwned>(place: &str, expected: &str, text: &str) -> PyResult<T> {
    serde_json::from_value(text.into()).map_err(|_| wrong(place, expected, format!("`{text}`")))
}

/// Names of motions: `vertical`, `lateral`, `torsion`.
pub fn dof_names(dofs: &[Dof]) -> Vec<&'static str> {
    dofs.iter()
        .map(|d| match d {
            Dof::Vertical => "vertical",
            Dof::Lateral => "lateral",
            Dof::Torsion => "torsion",
        })
        .collect()
}

/// The motions of these names.
pub fn dofs(names: &[String]) -> PyResult<Vec<Dof>> {
    let one = |name: &String| word("dofs", "vertical, lateral or torsion", name);
    let twice = (0..names.len()).find(|&i| names[..i].contains(&names[i]));
    match twice {
        Some(i) => Err(wrong(
            "dofs",
            "every motion once",
            format!("`{}` twice", names[i]),
        )),
        None => names.iter().map(one).collect(),
    }
}

/// Numbers of an array or of any sequence; `place` is named where there are others.
pub fn list(place: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    let wrong = || {
        let found = value
            .repr()
            .map_or_else(|e| e.to_string(), |r| r.to_string());
        wrong(
            place,
            "numbers, in one dimension",
            found.chars().take(80).collect(),
        )
    };
    refuse_unreal(place, value)?;
    let array: PyArrayLike1<'_, f64, AllowTypeChange> = value.extract().map_err(|_| wrong())?;
    Ok(array.as_array().to_vec())
}

/// Rows of numbers, of an array or of sequences in a sequence.
pub fn table<'py>(
    place: &str,
    value: &Bound<'py, PyAny>,
) -> PyResult<PyArrayLike2<'py, f64, AllowTypeChange>> {
    refuse_unreal(place, value)?;
    value.extract().map_err(|_| {
        let found = value.get_type().to_string();
        wrong(place, "numbers, in rows of one length", found)
    })
}

/// What a mask marks as bad is not used as a number, nor is a real part alone, a truth value, a date or a text that holds one.
pub fn refuse_unreal(place: &str, value: &Bound<'_, PyAny>) -> PyResult<()> {
    if let Ok(entries) = value.cast::<PyList>() {
        // masks and kinds of arrays in a list are gone in the array of all
        let mut arrays = entries
            .iter()
            .filter(|e| e.hasattr("dtype").unwrap_or(false));
        arrays.try_for_each(|array| refuse_unreal(place, &array))?;
    }
    let masked = value
        .getattr("mask")
        .and_then(|mask| mask.call_method0("any"));
    if masked.is_ok_and(|any| any.is_truthy().unwrap_or(false)) {
        let expected = "numbers without a mask";
        return Err(wrong(place, expected, "masked entries".into()));
    }
    // rows of different lengths have no kind; what else they are is said where they are taken apart
    let Ok(array) = value
        .py()
        .import("numpy")?
        .call_method1("asarray", (value,))
    else {
        return Ok(());
    };
    let kind: String = array.getattr("dtype")?.getattr("kind")?.extract()?;
    let found = match kind.as_str() {
        "c" => return Err(wrong(place, "real numbers", "complex ones".into())),
        "b" => "truth values",
        "M" | "m" => "dates or times of NumPy",
        "U" | "S" => "texts",
        "O" => return refuse_objects(place, &array),
        _ => return Ok(()),
    };
    Err(wrong(
        place,
        "numbers, in one dimension or in rows",
        found.into(),
    ))
}

/// An array of objects is one of numbers where each is a number.
fn refuse_objects(place: &str, array: &Bound<'_, PyAny>) -> PyResult<()> {
    let text = |one: &Bound<'_, PyAny>| {
        one.is_instance_of::<PyString>()
            || one.is_instance_of::<PyBytes>()
            || one.is_instance_of::<PyBool>()
            || one.is_instance_of::<PyComplex>()
    };
    for one in array
        .call_method0("ravel")?
        .call_method0("tolist")?
        .try_iter()?
    {
        let one = one?;
        if text(&one) {
            let found = format!("a {}", one.get_type().name()?);
            return Err(wrong(place, "numbers, in one dimension or in rows", found));
        }
    }
    Ok(())
}

/// Rows as an array.
pub fn rows<'py>(
    py: Python<'py>,
    width: usize,
    rows: impl IntoIterator<Item = impl AsRef<[f64]>>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let flat: Vec<f64> = rows.into_iter().flat_map(|r| r.as_ref().to_vec()).collect();
    let count = flat.len() / width.max(1);
    numpy::PyArray1::from_vec(py, flat).reshape([count, width])
}

/// Calls a function of `aerodeck/_show.py` on `of`.
pub fn shown<'py>(
    of: &Bound<'py, PyAny>,
    function: &str,
    keywords: Option<&Bound<'py, PyDict>>,
) -> PyResult<Bound<'py, PyAny>> {
    in_python(of, "aerodeck._show", function, keywords)
}

/// Calls a function of `aerodeck/_frames.py` on `of`.
pub fn framed<'py>(
    of: &Bound<'py, PyAny>,
    function: &str,
    keywords: Option<&Bound<'py, PyDict>>,
) -> PyResult<Bound<'py, PyAny>> {
    in_python(of, "aerodeck._frames", function, keywords)
}

fn in_python<'py>(
    of: &Bound<'py, PyAny>,
    module: &str,
    function: &str,
    keywords: Option<&Bound<'py, PyDict>>,
) -> PyResult<Bound<'py, PyAny>> {
    let module = of.py().import(module)?;
    module.getattr(function)?.call((of,), keywords)
}
