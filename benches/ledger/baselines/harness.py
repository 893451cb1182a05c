"""`harness.py SCRIPT ARGUMENT PACKAGE…`: does the work of a baseline once for every line on standard input.

A script has `prepare(argument)`, which gives a function that does the work and returns the numbers it found, or nothing.
Prints the versions of the packages, then for every round seconds, numbers and the largest resident memory so far.
"""

import importlib.metadata
import importlib.util
import json
import resource
import sys
import time

script, argument, *packages = sys.argv[1:]
spec = importlib.util.spec_from_file_location("baseline", script)
module = importlib.util.module_from_spec(spec)
spec.loader.exec_module(module)
with open(argument) as file:
    work = module.prepare(json.load(file))
print(json.dumps([f"{p} {importlib.metadata.version(p)}" for p in packages]), flush=True)
for _ in sys.stdin:
    start = time.perf_counter()
    answer = work()
    seconds = time.perf_counter() - start
    peak_mib = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (1 << 20 if sys.platform == "darwin" else 1 << 10)
    print(json.dumps({"seconds": seconds, "answer": answer or [], "peak_mib": peak_mib}), flush=True)
