"""Growth rate and onset from nothing but stepped outputs."""

import numpy as np
from section import MOTION


def growth(rows, step):
    """Growth rate (1/s) and frequency (Hz) of the slowest decaying or fastest growing motion.

    Once the aerodynamic filters follow the motion, one step takes the four numbers of the motion to the next by a
    constant 4×4 matrix: least squares over all pairs of neighbours, then its eigenvalues.
    """
    scaled = rows / np.abs(rows).max(axis=0)
    # directions that have died away carry rounding only
    transition, *_ = np.linalg.lstsq(scaled[:-1], scaled[1:], rcond=1e-9)
    eigenvalues = np.linalg.eigvals(transition.T)
    dominant = eigenvalues[np.argmax(np.abs(eigenvalues))]
    return np.log(np.abs(dominant)) / step, np.abs(np.angle(dominant)) / (2 * np.pi * step)


def growth_at(section, wind_speed, step, settle=4.0, length=4.0):
    """Growth rate and frequency of a released section at a wind speed; the instance is reset first."""
    section.fmu.reset()
    section.initialize(wind_speed=wind_speed)
    rows = section.steps(round((settle + length) / step), step, names=MOTION)
    return growth(rows[round(settle / step) :], step)


def onset(section, low, high, step, width=1e-5):
    """Wind speed and frequency at which the growth rate changes sign, by bisection between two speeds."""
    assert growth_at(section, low, step)[0] < 0 < growth_at(section, high, step)[0]
    while high - low > width * high:
        middle = (low + high) / 2
        rate, frequency = growth_at(section, middle, step)
        low, high = (low, middle) if rate > 0 else (middle, high)
    return (low + high) / 2, frequency
