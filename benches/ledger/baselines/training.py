"""One training in SciPy and NumPy: the same low-pass, six filters and feed-through, least squares per motion."""

import numpy as np
from scipy.signal import bilinear, butter, lfilter


def train(records, filters, p):
    blocks = {0: ([], []), 1: ([], [])}
    for r in records:
        width, speed, fs = r["width"], r["speed"], r["sampling"]
        moving = 0 if np.ptp(r["motion"][0]) > 0 else 1
        low = butter(4, 0.1)
        motion = lfilter(*low, r["motion"][moving] * (1 / width if moving == 0 else 1.0))
        q = 0.5 * r["density"] * speed**2
        right = np.column_stack(
            [lfilter(*low, r["force"][0] / (q * width)), lfilter(*low, r["force"][1] / (q * width**2))]
        )
        ds = speed / width / fs
        rate = np.gradient(motion, ds)
        columns = [motion, rate, np.gradient(rate, ds)]
        x = lfilter(*bilinear([np.sqrt(2 * p)], [1, p], 1 / ds), motion)
        columns.append(x)
        b, a = bilinear([1, -p], [1, p], 1 / ds)
        for _ in range(filters - 1):
            x = lfilter(b, a, x)
            columns.append(x)
        blocks[moving][0].append(np.column_stack(columns))
        blocks[moving][1].append(right)
    for x, y in blocks.values():
        np.linalg.lstsq(np.vstack(x), np.vstack(y), rcond=None)


def prepare(d):
    records = [
        {**r, "motion": [np.array(x) for x in r["motion"]], "force": [np.array(x) for x in r["force"]]}
        for r in d["records"]
    ]
    return lambda: train(records, d["filters"], d["pole"])
