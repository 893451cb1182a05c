"""A NumPy loop over random sections: stacked eigenvalues on a coarse grid of speeds, then regula falsi; gives the onsets."""

import numpy as np


def assemble(a_filters, b_filters, sample, v):
    """State matrices for an array of wind speeds, (speeds, states, states)."""
    n, nx = 2, a_filters.shape[0]
    width, rho = sample["width"], sample["density"]
    force, motion = np.diag([width, width**2]), np.diag([1 / width, 1.0])
    p0, p1, p2 = (force @ sample[k] @ motion for k in ("e0", "e1", "e2"))
    m, r, k = (np.diag(sample[key]) for key in ("mass", "damping", "stiffness"))
    inverse = np.linalg.inv(m - 0.5 * rho * width**2 * p2)
    fc, bm = inverse @ force @ sample["c"], b_filters @ motion
    v = np.atleast_1d(v)[:, None, None]
    a = np.zeros((len(v), 2 * n + nx, 2 * n + nx))
    a[:, :n, n : 2 * n] = np.eye(n)
    a[:, n : 2 * n, :n] = 0.5 * rho * v**2 * (inverse @ p0) - inverse @ k
    a[:, n : 2 * n, n : 2 * n] = 0.5 * rho * v * width * (inverse @ p1) - inverse @ r
    a[:, n : 2 * n, 2 * n :] = 0.5 * rho * v**2 * fc
    a[:, 2 * n :, :n] = v / width * bm
    a[:, 2 * n :, 2 * n :] = v / width * a_filters
    return a


def growth(a, b, sample, v):
    """Largest real part of the oscillating eigenvalues at each wind speed."""
    values = np.linalg.eigvals(assemble(a, b, sample, v))
    return np.where(np.abs(values.imag) > 1e-6, values.real, -np.inf).max(axis=1)


def onset(a, b, sample, speeds):
    coarse = growth(a, b, sample, speeds)
    unstable = np.flatnonzero(coarse > 0)
    if len(unstable) == 0 or unstable[0] == 0:
        return None
    i = unstable[0]
    low, high, f_low, f_high = speeds[i - 1], speeds[i], coarse[i - 1], coarse[i]
    for _ in range(60):
        v = high - f_high * (high - low) / (f_high - f_low)
        f = growth(a, b, sample, v)[0]
        if f > 0:
            high, f_high, f_low = v, f, f_low / 2
        else:
            low, f_low, f_high = v, f, f_high / 2
        if abs(high - low) < 1e-9 * high or abs(f) < 1e-10:
            break
    return float(v)


def prepare(d):
    a, b = np.array(d["a"]), np.array(d["b"])
    speeds = np.linspace(d["speed_min"], d["speed_max"], d["speeds"])
    matrices = ("mass", "damping", "stiffness", "e0", "e1", "e2", "c")
    samples = [{**s, **{k: np.array(s[k]) for k in matrices}} for s in d["samples"]]
    return lambda: [onset(a, b, sample, speeds) for sample in samples]
