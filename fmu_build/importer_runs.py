"""One run of one FMU in one importer: `importer_runs.py IMPORTER FMU`, called by `importers.py`, each in a process of
its own. Prints a line of JSON: the outputs after the last step, or what a checker found.

Every importer gets the same inputs and parameters and takes the same steps, so that all must end alike."""

import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import types

STEPS, STEP = 100, 0.02  # s
BEGIN = "initial_rotation", "rotation", "strip[1].rotation"  # whichever the FMU has is set to this
ROTATION = 0.02  # rad


class Unit:
    """The variables of an FMU that are of interest here."""

    def __init__(self, fmu):
        from fmpy.model_description import read_model_description

        self.fmu = str(fmu)
        self.description = read_model_description(self.fmu)
        reals = [v for v in self.description.modelVariables if v.type in ("Real", "Float64")]
        self.references = {v.name: v.valueReference for v in reals}
        self.inputs = {v.name: float(v.start) for v in reals if v.causality == "input"}
        self.outputs = [v.name for v in reals if v.causality == "output"]
        begin = next(name for name in BEGIN if name in self.references)
        self.begin = {} if begin in self.inputs else {begin: ROTATION}
        if begin in self.inputs:
            self.inputs[begin] = ROTATION
        self.values = {**self.inputs, **self.begin}


def fmpy_calls(unit):
    """The functions one by one; what the others are compared with."""
    import fmpy

    is_fmi2 = unit.description.fmiVersion == "2.0"
    slave = fmpy.instantiate_fmu(fmpy.extract(unit.fmu), unit.description, "CoSimulation")
    put, get = (slave.setReal, slave.getReal) if is_fmi2 else (slave.setFloat64, slave.getFloat64)
    if is_fmi2:
        slave.setupExperiment(startTime=0.0)
    put([unit.references[name] for name in unit.values], list(unit.values.values()))
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    for n in range(STEPS):
        slave.doStep(n * STEP, STEP)
    values = get([unit.references[name] for name in unit.outputs])
    slave.terminate()
    slave.freeInstance()
    return dict(zip(unit.outputs, values, strict=True))


def fmpy(unit):
    from fmpy import simulate_fmu

    rows = simulate_fmu(
        unit.fmu, fmi_type="CoSimulation", stop_time=STEPS * STEP, output_interval=STEP, start_values=unit.values,
        output=unit.outputs,
    )  # fmt: skip
    return {name: float(rows[-1][name]) for name in unit.outputs}


def fmpy_validate(unit):
    from fmpy.validation import validate_fmu

    return validate_fmu(unit.fmu)


def fmutool(unit):
    tool = pathlib.Path(sys.executable).with_name("fmutool")
    done = subprocess.run([tool, "-input", unit.fmu, "-check"], capture_output=True, text=True)
    lines = (done.stdout + done.stderr).splitlines()
    found = [line for line in lines if re.match(r"(?:.*\|)?\s*(WARNING|ERROR|CRITICAL)", line)]
    return found + ([f"ended with {done.returncode}"] if done.returncode else [])


def aerodeck(unit):
    done = subprocess.run([os.environ["AERODECK"], "fmu", "check", unit.fmu, "--json"], capture_output=True, text=True)
    report = json.loads(done.stdout)
    failed = [trial["detail"] for trial in report["trials"] if not trial["passed"]]
    return failed + [str(finding) for finding in report["findings"]]


def aerodeck_replay(unit):
    done = subprocess.run([os.environ["AERODECK"], "fmu", "replay", unit.fmu, "--json"], capture_output=True, text=True)
    platforms = json.loads(done.stdout)["platforms"]
    return [platform["refusal"] or "differs" for platform in platforms if platform["ran"] and not platform["same"]]


def ecos(unit):
    from ecospy import EcosSimulation, EcosSimulationStructure

    structure = EcosSimulationStructure()
    structure.add_model("unit", unit.fmu)
    with EcosSimulation(structure=structure, step_size=STEP) as simulation:
        for name, value in unit.values.items():
            simulation.set_real(f"unit::{name}", value)
        simulation.init()
        simulation.step(STEPS)
        return {name: simulation.get_real(f"unit::{name}") for name in unit.outputs}


def libcosim(unit):
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    execution = CosimExecution.from_step_size(round(STEP * 1e9))
    index = execution.add_local_slave(local_slave=CosimLocalSlave(fmu_path=unit.fmu, instance_name="unit"))
    assert index == 0, "not loaded"
    for name, value in unit.values.items():
        assert execution.real_initial_value(index, unit.references[name], value), name
    observer = CosimObserver.create_last_value()
    assert execution.add_observer(observer=observer)
    assert execution.step(STEPS), "a step failed"
    references = [unit.references[name] for name in unit.outputs]
    return dict(zip(unit.outputs, observer.last_real_values(index, references), strict=True))


def pathsim(unit):
    import warnings

    warnings.simplefilter("ignore")
    from pathsim import Connection, Simulation
    from pathsim.blocks import CoSimulationFMU, Constant

    block = CoSimulationFMU(unit.fmu, start_values=unit.values, dt=STEP)
    wrapper = block.fmu_wrapper
    order = [v.name for v in unit.description.modelVariables if v.causality == "input"]
    sources = [Constant(unit.inputs[name]) for name in order]
    wires = [Connection(source, block[i]) for i, source in enumerate(sources)]
    simulation = Simulation([block, *sources], wires, dt=STEP, log=False)
    # its first step is taken at the time zero
    simulation.run((STEPS - 1) * STEP)
    values = wrapper.get_real([unit.references[name] for name in unit.outputs])
    return dict(zip(unit.outputs, map(float, values), strict=True))


def stand_in(unit):
    """preCICE as its runner sees it, where the library itself is not there: implicit coupling, two iterations a step,
    the first with other inputs."""
    import numpy as np

    class Participant:
        def __init__(self, *_):
            self.steps, self.first, self.result = 0, True, None

        def get_mesh_dimensions(self, _):
            return 2

        def get_data_dimensions(self, _, name):
            return len(unit.inputs) if name == "inputs" else len(unit.outputs)

        def set_mesh_vertices(self, *_):
            return [0]

        def requires_initial_data(self):
            return True

        def write_data(self, *arguments):
            self.result = arguments[-1]

        def initialize(self):
            pass

        def is_coupling_ongoing(self):
            return self.steps < STEPS

        def requires_writing_checkpoint(self):
            return self.first

        def get_max_time_step_size(self):
            return STEP

        def read_data(self, *_):
            values = np.array([list(unit.inputs.values())])
            return values * (1.5 if self.first else 1.0)

        def advance(self, _):
            self.first = not self.first
            self.steps += self.first

        def requires_reading_checkpoint(self):
            return not self.first

        def finalize(self):
            pass

    module = types.ModuleType("precice")
    module.Participant = Participant
    module.get_version_information = lambda: b"3.0.0;stand-in"
    return module


def precice(unit):
    """The runner of preCICE itself, on a stand-in of the library."""
    sys.modules["precice"] = stand_in(unit)
    from fmiprecice import runner

    written = pathlib.Path("precice.csv").resolve()
    settings = {
        "simulation_params": {
            "fmu_file_name": unit.fmu, "fmu_instance_name": "unit", "output": unit.outputs,
            "fmu_read_data_names": list(unit.inputs), "fmu_write_data_names": unit.outputs,
            "output_file_name": str(written),
        },
        "initial_conditions": unit.values,
    }  # fmt: skip
    names = ("participant_name", "config_file_name", "mesh_name")
    coupling = dict.fromkeys(names, "unit") | {"read_data_name": "inputs", "write_data_name": "outputs"}
    files = {"fmi.json": settings, "precice.json": {"coupling_params": coupling}}
    for name, contents in files.items():
        pathlib.Path(name).write_text(json.dumps(contents), encoding="utf-8")
    sys.argv = ["fmiprecice", *files]
    runner.main()
    head, *_, last = written.read_text(encoding="utf-8").splitlines()
    row = dict(zip((name.strip('"') for name in head.split(",")), map(float, last.split(",")), strict=True))
    return {name: row[name] for name in unit.outputs}


def fmi_sim(unit):
    written = pathlib.Path("fmi_sim.csv").resolve()
    initial = [part for name, value in unit.values.items() for part in ("--init-values", f"{name}={value!r}")]
    steps = ["--step", str(STEP), "--output-interval", str(STEP), "-f", str(STEPS * STEP)]
    command = ["fmi-sim", "--model", unit.fmu, "-o", written, "co-simulation", *initial, *steps]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr.splitlines()[0]
    head, *_, last = written.read_text(encoding="utf-8").splitlines()
    row = dict(zip(head.split(","), last.split(","), strict=True))
    return {name: float(row[name]) for name in unit.outputs if name in row}


def fmusim(unit):
    written = pathlib.Path("fmusim.csv").resolve()
    initial = [part for name, value in unit.values.items() for part in ("--start-value", name, repr(value))]
    steps = ["--output-interval", str(STEP), "--stop-time", str(STEPS * STEP), "--output-file", written]
    done = subprocess.run(["fmusim", "--interface-type", "cs", *initial, *steps, unit.fmu], capture_output=True, text=True)
    assert done.returncode == 0, (done.stdout + done.stderr).splitlines()[-1]
    head, *_, last = written.read_text(encoding="utf-8").splitlines()
    row = dict(zip((name.strip('"') for name in head.split(",")), last.split(","), strict=True))
    return {name: float(row[name]) for name in unit.outputs if name in row}


def complaints(*command):
    """Lines of a checker that name a defect."""
    done = subprocess.run(command, capture_output=True, text=True)
    lines = [line for line in (done.stdout + done.stderr).splitlines() if re.search(r"\b(?:ERROR|FATAL|error:|fails)", line)]
    return lines + ([f"ended with {done.returncode}"] if done.returncode else [])


def fmucheck(unit):
    return complaints("fmuCheck.linux64", "-k", "cs", unit.fmu)


def vdmcheck2(unit):
    return complaints("VDMCheck2.sh", unit.fmu)


def vdmcheck3(unit):
    return complaints("VDMCheck3.sh", unit.fmu)


def openturns(unit):
    """The example: reliability of the first order on the onset speed of the FMU."""
    if "onset_speed" not in unit.references:
        return None
    sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "examples"))
    from openturns_form import form

    beta, probability = form(unit.fmu)
    return [] if 0.0 < beta < 10.0 and probability < 0.5 else [f"beta {beta}"]


RUNS = {
    run.__name__: run
    for run in (
        fmpy_calls, fmpy, fmpy_validate, aerodeck, aerodeck_replay, fmutool, ecos, libcosim, pathsim, precice, fmi_sim, openturns, fmusim,
        fmucheck, vdmcheck2, vdmcheck3,
    )
}  # fmt: skip


def main():
    name, fmu = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        # what importers unpack and write goes with the folder
        os.environ["TMPDIR"] = tempfile.tempdir = folder
        os.chdir(folder)
        # importers print to where they like
        result = os.dup(1)
        os.dup2(2, 1)
        found = RUNS[name](Unit(pathlib.Path(fmu)))
        os.write(result, (json.dumps(found) + "\n").encode())
        # some C runtimes do not survive their end
        sys.stderr.flush()
        os.chdir("/")
    os._exit(0)


if __name__ == "__main__":
    main()
