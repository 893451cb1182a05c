"""Forces on all sections of a bridge in one unit: other filters and motions from section to section, in both versions of FMI."""

import fmpy
import numpy as np
import pytest
from exported import FOLDER
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu

STEP = 0.05


def of(name, folder):
    """Description and a running instance."""
    fmu = str(FOLDER / f"{name}.fmu")
    assert validate_fmu(fmu) == []
    description = fmpy.read_model_description(fmu)
    slave = FMU3Slave if description.fmiVersion == "3.0" else FMU2Slave
    unit = slave(
        guid=description.guid,
        unzipDirectory=fmpy.extract(fmu, unzipdir=str(folder / name)),
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName=name,
    )
    unit.instantiate()
    return description, unit


def value(name, time):
    return 40.0 if name == "wind_speed" else 0.02 * np.sin(1.3 * time + 0.1 * sum(map(ord, name)))


def in_arrays(description, unit):
    """Names with nodes (`node[1156].heave`) of every array, from the names of its elements."""
    names = {}
    nodes = {
        v.name: unit.getString([v.valueReference], int(v.dimensions[0].start))
        for v in description.modelVariables
        if v.name.startswith("node_name")
    }
    for v in description.modelVariables:
        if "named in " not in (v.description or ""):
            names[v.name] = [v.name]
            continue
        which = v.description.rsplit("named in ", 1)[1].rstrip(")")
        names[v.name] = [f"node[{n}].{v.name}" for n in nodes[which]]
    return names


def test_both_versions_give_the_same_bit_for_bit(tmp_path):
    (two, unit2), (three, unit3) = (of(n, tmp_path) for n in ("sections_force", "sections_force_fmi3"))
    assert three.modelExchange is not None
    unit2.setupExperiment(startTime=0.0)
    for unit in (unit2, unit3):
        unit.enterInitializationMode()
        unit.exitInitializationMode()
    arrays = in_arrays(three, unit3)
    inputs = [v for v in two.modelVariables if v.causality == "input"]
    outputs = {v.name: v.valueReference for v in two.modelVariables if v.causality == "output"}
    sizes = {len(names) for names in arrays.values()}
    # all nodes, those with filters, those with six, those with sway
    assert {62, 60, 42, 31} <= sizes, sizes
    for step in range(5):
        time = step * STEP
        unit2.setReal([v.valueReference for v in inputs], [value(v.name, time) for v in inputs])
        for v in three.modelVariables:
            if v.causality == "input":
                unit3.setFloat64([v.valueReference], [value(name, time) for name in arrays[v.name]])
        unit2.doStep(time, STEP)
        unit3.doStep(time, STEP)
        for v in three.modelVariables:
            if v.causality == "output":
                names = arrays[v.name]
                found = unit3.getFloat64([v.valueReference], len(names))
                assert list(found) == unit2.getReal([outputs[name] for name in names]), v.name


@pytest.mark.parametrize("name", ["sections_force", "sections_force_fmi3"])
def test_fmpy_integrates_it(name):
    """As model exchange under held motion the filters stay settled, and so do the forces."""
    drag = "drag" if "fmi3" in name else "node[1156].drag"
    lift = "lift" if "fmi3" in name else "node[1001].lift"
    heave = "rotation" if "fmi3" in name else "node[1001].rotation"
    start = {"wind_speed": 40.0, heave: 0.01 if "fmi3" not in name else [0.01] * 62}
    found = fmpy.simulate_fmu(
        str(FOLDER / f"{name}.fmu"),
        fmi_type="ModelExchange",
        stop_time=1.0,
        output_interval=0.1,
        start_values=start,
        output=[lift, drag],
    )
    first = np.array(found[lift])
    assert np.all(np.abs(first - first[0]) <= 1e-9 * np.abs(first[0]).max()) and np.any(first != 0)
