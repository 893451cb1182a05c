"""Dissipative fits of measured decks, independently of the program: reference figures for tests/identification/dissipative_fits.rs.

    python3 dissipative_fit.py        (needs numpy and cvxpy with Clarabel)

Continuous Laguerre filters with a given pole, residuals relative to |G| of the entry, each entry relative to its scatter in the
fit without constraints (rms of its residuals per degree of freedom over that of its data, at least 1 %). Semidefinite
conditions for the interior-point solver Clarabel: e2 symmetric, and for heave and torsion together and for sway by itself
-e2 >= m/K_max, -sym e1 >= 1e-3 s, P (K_max/K)^2 - sym Im G(K)/K >= m at 160 K from K_max to 200 K_max, with
s = |sym Im G(K_max)/K_max| (Frobenius) and P its positive part, both of the unconstrained fit, and m = 1e-6 s. Prints JSON.
"""

import csv
import json
from pathlib import Path

import cvxpy as cp
import numpy as np

DATA = Path(__file__).parents[2] / "data/decks"
PARTS = {  # entry: real, imaginary
    "yy": ("H4", "H1"), "yx": ("H6", "H5"), "yt": ("H3", "H2"),
    "xy": ("P6", "P5"), "xx": ("P4", "P1"), "xt": ("P3", "P2"),
    "ty": ("A4", "A1"), "tx": ("A6", "A5"), "tt": ("A3", "A2"),
}


def samples(deck):
    lines = [x for x in (DATA / f"{deck}.csv").read_text().splitlines() if not x.startswith("#")]
    points = {}
    for row in csv.DictReader(lines):
        k = 1 / float(row["v_hat"])
        points.setdefault(row["derivative"], []).append((k, float(row["value"]) * k * k))
    return points


def columns(k, pole, filters):
    s = 1j * k
    chain = [np.sqrt(2 * pole) / (pole + s) * ((pole - s) / (pole + s)) ** l for l in range(filters)]
    return np.array([1, s, s * s, *chain])


def entry(points, name, pole, filters):
    """Weighted rows and right-hand side."""
    rows, right, weight = [], [], []
    both = [[(k, v, part) for k, v in points[PARTS[name][part]]] for part in (0, 1)]
    magnitude = []
    for part in (0, 1):
        for k, v, _ in both[part]:
            other = min(both[1 - part], key=lambda o: abs(np.log(o[0] / k)))
            near = abs(np.log(other[0] / k)) < 0.05
            magnitude.append(np.hypot(v, other[1]) if near else abs(v))
            c = columns(k, pole, filters)
            rows.append(c.imag if part else c.real)
            right.append(v)
    magnitude = np.array(magnitude)
    weight = 1 / np.maximum(magnitude, 1e-3 * magnitude.max())
    a, b = np.array(rows) * weight[:, None], np.array(right) * weight
    return a, b, [k for k, *_ in both[0] + both[1]]


def fit(deck, dofs, pole, filters):
    points, n = samples(deck), len(dofs)
    systems = {f + m: entry(points, f + m, pole, filters) for f in dofs for m in dofs}
    k_max = max(k for _, _, ks in systems.values() for k in ks)
    alone = {e: np.linalg.lstsq(a, b, rcond=None)[0] for e, (a, b, _) in systems.items()}

    def matrix(x, row, part):
        return [[row @ x[f + m] for m in part] for f in part]

    def damping(k):
        return columns(k, pole, filters).imag / k

    # unknowns in the scale of the columns
    scale = {e: np.linalg.norm(a, axis=0) for e, (a, _, _) in systems.items()}
    z = {e: cp.Variable(3 + filters) for e in systems}
    x = {e: cp.multiply(1 / scale[e], z[e]) for e in systems}
    total = 0
    for e, (a, b, _) in systems.items():
        residual = np.sum((a @ alone[e] - b) ** 2)
        noise = max(0.01, np.sqrt(residual / (len(b) - 3 - filters) * len(b) / (b @ b)))
        total += cp.sum_squares(a / scale[e] @ z[e] - b) / (b @ b * noise**2)
    conditions = []
    for part in ["".join(d for d in dofs if d != "x"), "".join(d for d in dofs if d == "x")]:
        if not part:
            continue
        g = np.array(matrix(alone, damping(k_max), part))
        values, vectors = np.linalg.eigh((g + g.T) / 2)
        size = np.linalg.norm(values)
        own = (vectors * np.maximum(values, 0)) @ vectors.T
        eye = np.eye(len(part))
        for row, least, share in [
            (damping(k), 1e-6 * size, (k_max / k) ** 2) for k in np.geomspace(k_max, 200 * k_max, 160)
        ] + [
            (np.eye(3 + filters)[1], 1e-3 * size, 0),
            (np.eye(3 + filters)[2], 1e-6 * size / k_max, 0),
        ]:
            m = cp.bmat(matrix(x, row, part))
            conditions.append(own * share - (m + m.T) / 2 - least * eye >> 0)
    for i in range(n):
        for j in range(i):
            conditions.append(x[dofs[i] + dofs[j]][2] == x[dofs[j] + dofs[i]][2])
    problem = cp.Problem(cp.Minimize(total), conditions)
    problem.solve(solver=cp.CLARABEL, tol_gap_abs=1e-11, tol_gap_rel=1e-10, tol_feas=1e-10)
    part = lambda c: [[float(x[f + m].value[c]) for m in dofs] for f in dofs]
    return {
        "deck": deck, "dofs": dofs, "pole": pole, "filters": filters,
        "status": problem.status,
        "e0": part(0), "e1": part(1), "e2": part(2),
    }


CASES = [
    ("LN20-5500", "yt", 0.4, 3),
    ("LN21-5200", "yt", 0.7, 2),
    ("LN21-5800", "yt", 0.5, 1),
    ("LN21-6100", "yxt", 0.3, 3),
    ("LN21-5500", "yxt", 0.5, 1),
    ("LN21-5200", "yt", 0.5, 6),
]
print(json.dumps([fit(*case) for case in CASES], indent=1))
