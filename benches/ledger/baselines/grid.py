"""One grid over L and the decay factor (or pole) in SciPy and NumPy.

For every cell of the grid as a script does it: the filters of that cell by `scipy.signal.lfilter`, one regression a
motion by `numpy.linalg.lstsq` with both forces as right-hand sides, and the relative residual of every transfer function.
Filters are vectorised over time; nothing is computed twice that the cell does not need again, low-pass and rates are
made once before the grid. BLAS may use all cores.
"""

import numpy as np
from scipy.signal import bilinear, butter, lfilter


def dimensionless(records, continuous):
    """Dimensionless motion and forces of each record, low-passed for the continuous filters, and fixed columns."""
    prepared = []
    for r in records:
        width, speed, fs = r["width"], r["speed"], r["sampling"]
        moving = 0 if np.ptp(r["motion"][0]) > 0 else 1
        q = 0.5 * r["density"] * speed**2
        motion = r["motion"][moving] * (1 / width if moving == 0 else 1.0)
        force = np.column_stack([r["force"][0] / (q * width), r["force"][1] / (q * width**2)])
        ds = speed / width / fs
        if continuous:
            low = butter(4, 0.1)
            motion, force = lfilter(*low, motion), lfilter(*low, force, axis=0)
            rate = np.gradient(motion, ds)
            fixed = [motion, rate, np.gradient(rate, ds)]
        else:
            fixed = [np.ones_like(motion)]
        prepared.append((moving, ds, motion, fixed, force))
    return prepared


def filters(motion, ds, value, count, continuous):
    if continuous:
        x = lfilter(*bilinear([np.sqrt(2 * value)], [1, value], 1 / ds), motion)
        b, a = bilinear([1, -value], [1, value], 1 / ds)
    else:
        root = np.sqrt(value)
        x = lfilter([np.sqrt(1 - value)], [1, -root], motion)
        b, a = [root, -1], [1, -root]
    columns = [x]
    for _ in range(count - 1):
        columns.append(lfilter(b, a, columns[-1]))
    return columns


def grid(prepared, values, count, continuous):
    residuals = np.empty((len(values), count, 2, 2))
    for v, value in enumerate(values):
        for filters_used in range(1, count + 1):
            blocks = {0: ([], []), 1: ([], [])}
            for moving, ds, motion, fixed, force in prepared:
                columns = filters(motion, ds, value, filters_used, continuous)
                blocks[moving][0].append(np.column_stack(fixed + columns))
                blocks[moving][1].append(force)
            for moving, (x, y) in blocks.items():
                x, y = np.vstack(x), np.vstack(y)
                c = np.linalg.lstsq(x, y, rcond=None)[0]
                residuals[v, filters_used - 1, :, moving] = np.linalg.norm(
                    y - x @ c, axis=0
                ) / np.linalg.norm(y, axis=0)
    return residuals


def prepare(d):
    records = [
        {**r, "motion": [np.array(x) for x in r["motion"]], "force": [np.array(x) for x in r["force"]]}
        for r in d["records"]
    ]
    prepared = dimensionless(records, d["continuous"])

    def work():
        grid(prepared, d["values"], d["filters"], d["continuous"])

    return work
