"""A structure of our own beside a force FMU: masters that exchange in different ways, and the same system in one piece."""

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import expm

# IABSE TG 3.1, case 1.1a: full-scale section
MASS, INERTIA = 22740.0, 2.47e6
WIDTH, DENSITY = 31.0, 1.22
OMEGA = 2 * np.pi * np.array([0.100, 0.278])
DAMPING = 0.003
# of the same section with Jones's functions, computed independently
ONSET = 76.679
PERIOD = 5.15

M = np.array([MASS, INERTIA])
A = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.diag(OMEGA**2), -np.diag(2 * DAMPING * OMEGA)]])
B = np.vstack([np.zeros((2, 2)), np.diag(1 / M)])
START = np.array([0.2, 0.01, 0.0, 0.0])


def held(step):
    """State and held force to state, and what a rate of the force adds."""
    blocks = np.zeros((8, 8))
    blocks[:4, :4], blocks[:4, 4:6] = A, B
    blocks[4:6, 6:] = np.eye(2)
    full = expm(blocks * step)
    return full[:4, :4], full[:4, 4:6], full[:4, 6:]


def motion(x, rates):
    """The inputs that the structure sets."""
    values = {"heave": x[0], "rotation": x[1]}
    if rates:
        values |= {"heave_rate": x[2], "rotation_rate": x[3]}
    return values


def explicit(force, step, count, rates=False, spring=None):
    """Jacobi: the structure holds the force that it has read at the beginning of its step."""
    exact, driven, _ = held(step)
    x, rows = START.copy(), [START]
    for n in range(count):
        acting = np.array(force.get("lift", "moment"))
        force.set(**motion(x, rates))
        force.fmu.doStep(n * step, step)
        if spring is None:
            x = exact @ x + driven @ acting
        else:
            x = nonlinear_step(x, acting, step, spring)
        rows.append(x)
    return np.array(rows)


def staggered(force, step, count, rates=False):
    """Gauss and Seidel: the structure steps first, the forces follow with the motion of the end of its step."""
    exact, driven, _ = held(step)
    x, rows = START.copy(), [START]
    for n in range(count):
        x = exact @ x + driven @ np.array(force.get("lift", "moment"))
        force.set(**motion(x, rates))
        force.fmu.doStep(n * step, step)
        rows.append(x)
    return np.array(rows)


def extrapolating(force, step, count, rates=False):
    """The structure carries the force on by its derivative."""
    exact, driven, ramped = held(step)
    outputs = force.references(["lift", "moment"])
    x, rows = START.copy(), [START]
    for n in range(count):
        acting = np.array(force.get("lift", "moment"))
        slope = np.zeros(2)
        if n:
            slope = np.array(force.fmu.getRealOutputDerivatives(outputs, [1, 1]))
        force.set(**motion(x, rates))
        force.fmu.doStep(n * step, step)
        x = exact @ x + driven @ acting + ramped @ slope
        rows.append(x)
    return np.array(rows)


def implicit(force, step, count, rates=True, rounds=8):
    """Each step is repeated from a saved state until motion and force agree; the force runs on a straight line."""
    exact, driven, ramped = held(step)
    x, rows = START.copy(), [START]
    acting = np.zeros(2)
    for n in range(count):
        saved = force.fmu.getFMUstate()
        reached, guess = acting, x
        for _ in range(rounds):
            force.fmu.setFMUstate(saved)
            guess = exact @ x + driven @ acting + ramped @ (reached - acting) / step
            force.set(**motion(guess, rates))
            force.fmu.doStep(n * step, step)
            reached = np.array(force.get("lift", "moment"))
        force.fmu.freeFMUstate(saved)
        x, acting = guess, reached
        rows.append(x)
    return np.array(rows)


def nonlinear_step(x, acting, step, spring, parts=4):
    """Runge and Kutta under a held force, with a cubic spring against rotation."""
    def rate(x):
        return A @ x + B @ (acting - np.array([0.0, spring * x[1] ** 3]))

    h = step / parts
    for _ in range(parts):
        k1 = rate(x)
        k2 = rate(x + h / 2 * k1)
        k3 = rate(x + h / 2 * k2)
        k4 = rate(x + h * k3)
        x = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return x


def in_one_piece(model, wind, duration, spring, every):
    """Structure and rational functions as one system of differential equations, from the coefficients in model.json."""
    a0, a1, a2 = (np.array(model[k]) for k in ("a1", "a2", "a3"))
    lags, terms = np.array(model["lags"]), [np.array(t) for t in model["lag_terms"]]
    scale, into = np.array([WIDTH, WIDTH**2]), np.array([1 / WIDTH, 1.0])
    k = wind / WIDTH
    added = 0.5 * DENSITY * WIDTH**2 * scale[:, None] * a2 * into
    inverse = np.linalg.inv(np.diag(M) - added)

    def rate(_, z):
        y, v, lag = z[:2], z[2:4], z[4:].reshape(len(lags), 2)
        # a lag p/(p + d) of the motion is fed by its rate
        lag_rate = v * into - k * lags[:, None] * lag
        q = wind**2 * (a0 @ (into * y) + sum(t @ x for t, x in zip(terms, lag, strict=True)))
        q = q + wind * WIDTH * (a1 @ (into * v))
        force = 0.5 * DENSITY * scale * q - M * (OMEGA**2 * y + 2 * DAMPING * OMEGA * v)
        force = force - np.array([0.0, spring * y[1] ** 3])
        return np.concatenate([v, inverse @ force, lag_rate.ravel()])

    start = np.concatenate([START, np.zeros(2 * len(lags))])
    times = np.arange(0, duration, every)
    return solve_ivp(rate, (0, duration), start, t_eval=times, rtol=1e-9, atol=1e-12).y[:4].T


def growth(rows, step):
    """Growth rate of the rotation, 1/s: one mode is left over the second half, x'' = a x' + b x of neighbouring points."""
    x = rows[len(rows) // 2 :, 1]
    (_, b), *_ = np.linalg.lstsq(np.column_stack([x[1:-1], x[:-2]]), x[2:], rcond=None)
    return np.log(-b) / (2 * step)
