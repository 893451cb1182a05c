"""Tables of pandas and xarray, where they are installed. Nothing is computed here."""

import numpy as np

from ._errors import InputError

ARGUMENTS = ("v_hat", "v_star", "k_full", "k_semi")
MOTION_UNITS = {"vertical": "m", "lateral": "m", "torsion": "rad"}


def _module(name):
    try:
        return __import__(name)
    except ImportError as missing:
        raise ImportError(f"this needs {name}: pip install {name}") from missing


def _usual_argument(table, notation, argument):
    """The argument that `to_numpy` expresses points over when none is stated."""
    if argument is not None:
        return argument
    own = next(iter(table.to_numpy(notation).values()))[:, 1]
    for name in ARGUMENTS:
        if np.array_equal(next(iter(table.to_numpy(notation, argument=name).values()))[:, 1], own):
            return name
    raise AssertionError(f"no argument of {notation}")


def derivatives_frame(table, notation="scanlan", *, argument=None, axes=None):
    pandas = _module("pandas")
    argument = _usual_argument(table, notation, argument)
    columns = {
        name: pandas.Series(points[:, 2], index=points[:, 1])
        for name, points in table.to_numpy(notation, argument=argument, axes=axes).items()
    }
    # a point that was tested twice has two rows
    numbered = {n: pandas.Series(c.values, index=[c.index, c.groupby(level=0).cumcount()]) for n, c in columns.items()}
    frame = pandas.DataFrame(numbered).sort_index().droplevel(1).rename_axis(argument)
    frame.attrs = {"notation": notation, "argument": argument, "width_m": table.width_m, "name": table.name}
    if axes is not None:
        frame.attrs["axes"] = axes
    return frame


def derivatives_from_frame(frame, *, notation=None, argument=None, axes=None, width_m=None, name=None):
    from . import Derivatives

    stated = {"notation": notation, "argument": argument, "axes": axes, "width_m": width_m, "name": name}
    known = {key: value for key in stated if (value := getattr(frame, "attrs", {}).get(key)) is not None}
    stated = known | {key: value for key, value in stated.items() if value is not None}
    if "argument" not in stated:
        there = [n for n in (frame.index.name, *frame.columns) if n in ARGUMENTS]
        if len(there) != 1:
            raise InputError(None, "argument", f"one of {', '.join(ARGUMENTS)} as the index or a column", f"{there or 'none'}")
        stated["argument"] = there[0]
    for needed in ("notation", "width_m"):
        if needed not in stated:
            raise InputError(None, needed, "one that is stated, as a keyword or in frame.attrs", "none")
    argument = stated["argument"]
    over = frame[argument] if argument in frame.columns else frame.index.to_series()
    over = np.asarray(over, float)
    columns = {}
    for column in frame.columns:
        if column == argument:
            continue
        values = np.asarray(frame[column], float)
        there = ~np.isnan(values)
        columns[str(column).removesuffix("*")] = (over[there], values[there])
    return Derivatives.from_arrays(columns, **stated)


def derivatives_array(table, notation="scanlan", *, argument=None, axes=None):
    xarray = _module("xarray")
    frame = derivatives_frame(table, notation, argument=argument, axes=axes)
    over = frame.index.name
    return xarray.DataArray(
        frame.to_numpy().T,
        coords={"derivative": list(frame.columns), over: frame.index.to_numpy()},
        dims=("derivative", over),
        name=table.name,
        attrs=frame.attrs,
    )


def sweep_dataset(sweep):
    xarray = _module("xarray")
    over = ("speed", "mode")
    return xarray.Dataset(
        {
            "frequency": (over, sweep.frequency_hz, {"units": "Hz"}),
            "damping_ratio": (over, sweep.damping_ratio),
            "tested": (over, sweep.tested),
        },
        coords={"speed": ("speed", sweep.speed_m_s, {"units": "m/s"}), "mode": sweep.modes},
    )


def sweep_frame(sweep):
    pandas = _module("pandas")
    count = len(sweep.modes)
    return pandas.DataFrame(
        {
            "speed_m_s": np.repeat(sweep.speed_m_s, count),
            "mode": np.tile(sweep.modes, len(sweep.speed_m_s)),
            "frequency_hz": sweep.frequency_hz.ravel(),
            "damping_ratio": sweep.damping_ratio.ravel(),
            "tested": sweep.tested.ravel(),
        }
    )


def motion_frame(motion):
    pandas = _module("pandas")
    columns = {
        f"{name}_{what}": getattr(motion, what)[:, i]
        for what in ("displacement", "rate", "acceleration", "force")
        for i, name in enumerate(motion.dofs)
    }
    return pandas.DataFrame(columns, index=pandas.Index(motion.time_s, name="time_s"))


def motion_dataset(motion):
    xarray = _module("xarray")
    over = ("time", "motion")
    units = [MOTION_UNITS[name] for name in motion.dofs]
    return xarray.Dataset(
        {what: (over, getattr(motion, what)) for what in ("displacement", "rate", "acceleration", "force")},
        coords={
            "time": ("time", motion.time_s, {"units": "s"}),
            "motion": motion.dofs,
            "unit": ("motion", units),
        },
        attrs={"wind_speed_m_s": motion.wind_speed_m_s},
    )


def onsets_frame(onsets):
    pandas = _module("pandas")
    names = ("speed_m_s", "frequency_hz", "tested", "unstable", "judged")
    return pandas.DataFrame({name: getattr(onsets, name) for name in names})
