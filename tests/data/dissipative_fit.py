"""Dissipative fits of measured decks, independently of the program: reference figures for tests/identification/dissipative_fits.rs.

    python3 dissipative_fit.py            coefficients at given poles, as JSON (needs numpy and cvxpy with Clarabel)
    python3 dissipative_fit.py onsets     onsets of fits with five filters and a searched pole, for data/reference

Continuous Laguerre filters with a given pole, residuals relative to |G| of the entry, each entry relative to its scatter in the
fit without constraints (rms of its residuals per degree of freedom over that of its data, at least 1 %). Semidefinite
conditions for the interior-point solver Clarabel: e2 symmetric, and for heave and torsion together and for sway by itself
-e2 >= m/K_max, -sym e1 >= 1e-3 s, P (K_max/K)^2 - sym Im G(K)/K >= m at 160 K from K_max to 200 K_max, with
s = |sym Im G(K_max)/K_max| (Frobenius) and P its positive part, both of the unconstrained fit, and m = 1e-6 s. A searched pole
has the least geometric mean over the entries of the constrained residuals. The onset is where an eigenvalue of section and
filters together first has no damping.
"""

import csv
import json
import sys
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
    }, {
        "c": [part(3 + l) for l in range(filters)],
        "score": np.mean([np.log(1e-4 + np.sum((a @ x[e].value - b) ** 2) / (b @ b)) for e, (a, b, _) in systems.items()]),
    }


def growth(speed, section, found, rest):
    """Largest growth rate, 1/s, of heave and rotation with their filters; forces 1/2 rho V^2 B on heave and times B on rotation."""
    width, density, inertias, hertz, damping = section
    m = np.diag(inertias) / np.array([[1, 1], [1, width**2]])  # displacements of width B
    omega = 2 * np.pi * np.array(hertz)
    inertia = np.diag(m)
    q = 0.5 * density * speed**2
    # in tau = V t / B
    rate = speed / width
    e0, e1, e2 = (np.array(found[e]) for e in ("e0", "e1", "e2"))
    mass = np.diag(inertia) * rate**2 - q * e2
    damp = np.diag(2 * damping * omega * inertia) * rate - q * e1
    stiff = np.diag(omega**2 * inertia) - q * e0
    pole, filters = found["pole"], len(rest["c"])
    n = 4 + 2 * filters
    a = np.zeros((n, n))
    a[0:2, 2:4] = np.eye(2)
    solve = np.linalg.inv(mass)
    a[2:4, 0:2], a[2:4, 2:4] = -solve @ stiff, -solve @ damp
    root = np.sqrt(2 * pole)
    for l in range(filters):
        here = slice(4 + 2 * l, 6 + 2 * l)
        # the states are what leaves the filters: first sqrt(2p)/(s+p), then (p-s)/(s+p) each, whose output is -in + 2p/(s+p) in
        a[2:4, 4:] += solve @ (q * np.array(rest["c"][l])) @ output(l, pole, root, filters)
        a[here, 4:] = state(l, pole, root, filters)
        if l == 0:
            a[here, 0:2] = np.eye(2)
    return max(np.linalg.eigvals(a).real) * rate


def output(l, pole, root, filters):
    """Output of filter l from the states x' = -p x + input: sqrt(2p) x_0 for the first, then -previous + 2p x_l."""
    row = np.zeros(filters)
    row[0] = root
    for m in range(1, l + 1):
        row = -row
        row[m] += 2 * pole
    return np.kron(row, np.eye(2))


def state(l, pole, root, filters):
    row = np.kron(np.eye(filters)[l], -pole * np.eye(2))
    return row if l == 0 else row + output(l - 1, pole, root, filters)


SECTIONS = {  # width m, density kg/m3, inertias per metre, Hz, damping ratio
    "Table 4.1": (0.5, 1.19, (15.0, 0.6), (2.0, 5.0), 0.003),
    "IABSE 1.1a": (31.0, 1.19, (22_740.0, 2.47e6), (0.100, 0.278), 0.003),
}


def onset(section, found, rest):
    fastest = 60 if section[0] < 1 else 130
    speeds = np.linspace(fastest / 400, fastest, 400)
    rates = [growth(v, section, found, rest) for v in speeds]
    first = next(i for i, r in enumerate(rates) if r > 0)
    low, high = speeds[first - 1], speeds[first]
    for _ in range(50):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if growth(middle, section, found, rest) > 0 else (middle, high)
    return high


def onsets(filters=5):
    for deck in ["LN20-5500", "LN21-5200", "LN21-5500", "LN21-5800", "LN21-6100"]:
        k = [k for rows in samples(deck).values() for k, _ in rows]
        best = None
        for pole in np.geomspace(0.3 * min(k), 3 * max(k), 40):
            try:
                tried = fit(deck, "yt", pole, filters)
            except cp.SolverError:
                continue
            if best is None or tried[1]["score"] < best[1]["score"]:
                best = tried
        for name, section in SECTIONS.items():
            print(f"{deck}, {name}: {onset(section, *best):.3f} m/s (pole {best[0]['pole']:.3f})")


CASES = [
    ("LN20-5500", "yt", 0.4, 3),
    ("LN21-5200", "yt", 0.7, 2),
    ("LN21-5800", "yt", 0.5, 1),
    ("LN21-6100", "yxt", 0.3, 3),
    ("LN21-5500", "yxt", 0.5, 1),
    ("LN21-5200", "yt", 0.5, 6),
]
if sys.argv[1:] == ["onsets"]:
    onsets()
else:
    print(json.dumps([fit(*case)[0] for case in CASES], indent=1))
