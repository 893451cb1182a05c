"""Golden numbers of the zero-phase Butterworth low-pass: scipy.signal.butter(output="sos") and sosfiltfilt.

Run: python tests/data/make_butterworth.py   (writes butterworth_golden.json beside it; numpy and scipy needed)
"""

import json
import pathlib

import numpy as np
import scipy.signal

CASES = [(order, cutoff, 200.0) for order in range(1, 9) for cutoff in (0.02, 7.0, 90.0)]

cases = []
for number, (order, cutoff, sampling) in enumerate(CASES):
    samples = 60 + 7 * number
    t = np.arange(samples) / sampling
    signal = 2 + 1.5 * np.sin(2 * np.pi * 2.5 * t + 0.3) + np.cos(0.37 * np.arange(samples) ** 2)
    sections = scipy.signal.butter(order, cutoff, fs=sampling, output="sos")
    filtered = scipy.signal.sosfiltfilt(sections, signal)
    cases.append(
        {
            "order": order,
            "cutoff_hz": cutoff,
            "sampling_hz": sampling,
            "samples": samples,
            "output": filtered.tolist(),
        }
    )
target = pathlib.Path(__file__).with_name("butterworth_golden.json")
target.write_text(json.dumps(cases))
