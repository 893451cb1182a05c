"""Runs the experiments of an FMU (FMI-LS-REF) in FMPy and compares: python replay.py unit.fmu"""
import csv, math, shutil, sys, xml.etree.ElementTree as xml
from pathlib import Path
import fmpy

folder = Path(fmpy.extract(sys.argv[1]))
description, reference = fmpy.read_model_description(folder), folder / "extra/org.fmi-standard.fmi-ls-ref"
variables, is_fmi2 = {v.name: v for v in description.modelVariables}, description.fmiVersion == "2.0"
by_reference = {v.valueReference: v for v in description.modelVariables}
# a dimension is a number, or that of a structural parameter
length = lambda d: int(d.start if d.start is not None else by_reference[d.valueReference].start)
size = lambda v: 1 if is_fmi2 else math.prod(map(length, v.dimensions))
# array and place in it of a column like heave[2], which FMI 2.0 knows as a variable
split = lambda column: (column, 0) if column in variables else (column[: column.rindex("[")], int(column[column.rindex("[") + 1 : -1]) - 1)

def put(unit, values):
    arrays = {}
    for (name, place), value in ((split(column), value) for column, value in values.items()):
        arrays.setdefault(name, [float(x) for x in str(variables[name].start).split()])[place] = value
    for name, numbers in arrays.items():
        (unit.setReal if is_fmi2 else unit.setFloat64)([variables[name].valueReference], numbers)

def get(unit, columns):
    read = lambda v: unit.getReal([v.valueReference]) if is_fmi2 else unit.getFloat64([v.valueReference], size(v))
    return [read(variables[name])[place] for name, place in map(split, columns)]

def table(file):
    head, *rows = csv.reader(open(reference / file))
    return head[1:], [[float(x) for x in row] for row in rows]

worst = 0.0
for file in sorted(reference.glob("*.exp")):
    for experiment in xml.parse(file).getroot():
        times, parameters, stimuli, references = experiment
        stop, step = float(times.get("stopTime")), float(times.get("stepSize"))
        (inputs, driven), (outputs, expected) = table(stimuli.get("source")), table(references.get("source"))
        values = xml.parse(reference / parameters.get("source")).getroot().iter("{*}Parameter")
        unit = fmpy.instantiate_fmu(str(folder), description, "CoSimulation")
        put(unit, {p.get("name"): float(p[0].get("value")) for p in values})
        if is_fmi2:
            unit.setupExperiment(startTime=0.0, stopTime=stop)
        unit.enterInitializationMode(**({} if is_fmi2 else {"startTime": 0.0, "stopTime": stop}))
        put(unit, dict(zip(inputs, driven[0][1:])))
        unit.exitInitializationMode()
        found = [get(unit, outputs)]
        for time, *row in driven[:-1]:
            put(unit, dict(zip(inputs, row)))
            unit.doStep(time, step)
            found.append(get(unit, outputs))
        unit.freeInstance()
        for i, name in enumerate(outputs):
            largest = max(abs(row[i + 1]) for row in expected) or 1.0
            off = max(abs(a[i] - b[i + 1]) for a, b in zip(found, expected, strict=True)) / largest
            worst = max(worst, off if off == off else math.inf)
        print(f"{experiment.get('name')}: largest difference so far {worst:.1e} of the largest value of a variable")
shutil.rmtree(folder, ignore_errors=True)
sys.exit(0 if worst <= 1e-9 else "not as the exporter meant")
