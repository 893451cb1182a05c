"""Times dtaidistance on two signals: `dtw_baseline.py <file of f64: X1 then X2> <repetitions>`.

Prints one JSON object: seconds of each repetition of the distance alone and of the path, the squared distance,
the peak memory of the process in MiB, and the version.
"""

import importlib.metadata
import json
import resource
import sys
import time

import numpy as np
from dtaidistance import dtw

signals = np.fromfile(sys.argv[1])
reference, compared = np.split(signals, 2)
repetitions = int(sys.argv[2])


def timed(function):
    seconds = []
    for _ in range(repetitions):
        start = time.perf_counter()
        result = function(compared, reference)
        seconds.append(time.perf_counter() - start)
    return seconds, result


distance_seconds, distance = timed(dtw.distance_fast)
path_seconds, path = timed(dtw.warping_path_fast)
json.dump(
    {
        "version": importlib.metadata.version("dtaidistance"),
        "distance_seconds": distance_seconds,
        "path_seconds": path_seconds,
        "squared_distance": distance**2,
        "path_length": len(path),
        "peak_mib": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
    },
    sys.stdout,
)
