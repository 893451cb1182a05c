"""Constrained fit of rational functions to the flat plate, independently of the program: reference figures for
crates/fit/src/identification/frequency/constrained_tests.rs.

    python3 constrained_fit.py        (needs numpy and scipy)

Theodorsen's G at the eight K of Table 3.2 at 8.17 m/s on a width of 0.5 m; one lag shared by all entries, added mass,
residuals relative to |G| of the entry. At K -> 0 quasi-steady theory holds exactly: G(0) = [[0, 2 pi], [0, pi/2]] and
dG/d(iK) = -2 pi and -pi/2 in the column of heave. Equality-constrained least squares by LAPACK's dgglse (generalised RQ
factorisation), the lag by scipy.optimize.minimize_scalar.
"""

import numpy as np
from scipy.linalg import lapack
from scipy.optimize import minimize_scalar
from scipy.special import hankel2

FREQUENCIES = np.array([0.25, 0.5, 0.8, 1.1, 1.4, 1.7, 2.0, 2.5])
K = 2 * np.pi * FREQUENCIES * 0.5 / 8.17
P = 1j * K
C = hankel2(1, K / 2) / (hankel2(1, K / 2) + 1j * hankel2(0, K / 2))
G = {
    "yy": -np.pi / 2 * P**2 - 2 * np.pi * C * P,
    "yt": np.pi / 2 * P + 2 * np.pi * C * (1 + P / 4),
    "ty": -np.pi / 2 * C * P,
    "tt": -np.pi / 8 * P - np.pi / 64 * P**2 + np.pi / 2 * C * (1 + P / 4),
}
LIMITS = {"yy": (0, -2 * np.pi), "yt": (2 * np.pi, None), "ty": (0, -np.pi / 2), "tt": (np.pi / 2, None)}


def entry(name, lag):
    """Coefficients a1, a2, a3, a4 and the sum of squared relative residuals."""
    columns = np.array([np.ones_like(P), P, P**2, P / (P + lag)]).T
    weight = 1 / np.maximum(abs(G[name]), 1e-3 * abs(G[name]).max())
    weighted = weight[:, None] * columns
    rows = np.vstack([weighted.real, weighted.imag])
    right = np.concatenate([(weight * G[name]).real, (weight * G[name]).imag])
    value, slope = LIMITS[name]
    constraints, targets = [[1.0, 0, 0, 0]], [value]
    if slope is not None:
        constraints.append([0, 1.0, 0, 1 / lag])
        targets.append(slope)
    found = lapack.dgglse(rows, np.array(constraints), right.copy(), np.array(targets, float))
    coefficients = found[3]
    return coefficients, np.sum((rows @ coefficients - right) ** 2), np.sum(right**2)


def objective(log_lag):
    parts = [entry(name, np.exp(log_lag)) for name in G]
    return np.sqrt(sum(s / t for _, s, t in parts) / len(parts))


bounds = np.log([0.5 * K.min(), 2 * K.max()])
grid = np.linspace(*bounds, 400)
start = grid[np.argmin([objective(x) for x in grid])]
best = minimize_scalar(objective, bounds=(start - 0.05, start + 0.05), method="bounded", options={"xatol": 1e-12})
lag = np.exp(best.x)
print(f"lag {lag:.8f}  objective {best.fun:.10f}")
for name in G:
    print(name, " ".join(f"{c:.9f}" for c in entry(name, 0.3)[0]), "(lag 0.3)")
