"""A bridge from its parts in libcosim of the Open Simulation Platform.

    aerodeck ssp export bridge.toml --out bridge.ssp
    python examples/bridge_in_libcosim.py bridge.ssp "node[1156].rotation"

Needs libcosimpy and FMPy, which is asked for the number of the variable. Prints the largest value in each sixth of the run.
"""

import sys
import zipfile
from pathlib import Path
from tempfile import TemporaryDirectory

import fmpy
import numpy as np
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimObserver import CosimObserver

STEP_S, STEPS = 0.03, 3000

system, variable = sys.argv[1:]
with TemporaryDirectory() as folder:
    zipfile.ZipFile(system).extractall(folder)
    description = fmpy.read_model_description(str(Path(folder, "resources", "structure.fmu")))
    reference = next(v.valueReference for v in description.modelVariables if v.name == variable)
    execution = CosimExecution.from_ssp_file(f"{folder}/", step_size=STEP_S * 1e9)
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer=observer)
    structure = execution.slave_index_from_instance_name("structure")
    values = []
    for _ in range(STEPS):
        if not execution.step():
            sys.exit("a step failed")
        values += observer.last_real_values(slave_index=structure, variable_references=[reference])
    del execution
for part in np.array_split(np.abs(values), 6):
    print(f"{part.max():.6g}")
