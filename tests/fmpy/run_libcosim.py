"""Runs an FMU with libcosim: `run_libcosim.py FMU RESULT.npy REFERENCE…`, 200 steps of 0.01 s."""

import sys

import numpy as np
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave

fmu, result, *references = sys.argv[1:]
references = [int(r) for r in references]

execution = CosimExecution.from_step_size(10_000_000)
slave = CosimLocalSlave(fmu_path=fmu, instance_name="deck")
index = execution.add_local_slave(local_slave=slave)
assert index == 0, "not loaded"
observer = CosimObserver.create_last_value()
assert execution.add_observer(observer=observer)
rows = []
for _ in range(200):
    assert execution.step(), "a step failed"
    rows.append(observer.last_real_values(slave_index=index, variable_references=references))
np.save(result, np.array(rows))
