"""A bridge from its parts with a controller beside it: the structure, the wind forces, and a moment at mid-span against the rotation.

    aerodeck ssp export bridge.toml --out bridge.ssp
    python examples/bridge_with_controller.py bridge.ssp --wind 84 --node 1156 --gain 2e8

Needs FMPy. What is connected is read from the system, nothing is typed. Prints how fast the rotation of the node grows (1/s), without the
controller and with it.
"""

import argparse
import xml.etree.ElementTree as xml
import zipfile
from pathlib import Path
from tempfile import TemporaryDirectory

import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Slave

SSD = "{http://ssp-standard.org/SSP1/SystemStructureDescription}"


class Unit:
    """An FMU by the names of its variables."""

    def __init__(self, fmu, folder):
        description = fmpy.read_model_description(fmu)
        self.references = {v.name: v.valueReference for v in description.modelVariables}
        self.fmu = FMU2Slave(
            guid=description.guid,
            unzipDirectory=fmpy.extract(fmu, unzipdir=folder),
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName=Path(fmu).stem,
        )
        self.fmu.instantiate()

    def start(self, **values):
        self.fmu.reset()
        self.fmu.setupExperiment(startTime=0.0)
        self.set(list(values), list(values.values()))
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def set(self, names, values):
        self.fmu.setReal([self.references[n] for n in names], list(values))

    def get(self, names):
        return np.array(self.fmu.getReal([self.references[n] for n in names]))


def connections(folder):
    """Names of the outputs and inputs of each connection, by the units at its ends."""
    found = {}
    for c in xml.parse(folder / "SystemStructure.ssd").iter(f"{SSD}Connection"):
        ends = found.setdefault((c.get("startElement"), c.get("endElement")), ([], []))
        ends[0].append(c.get("startConnector"))
        ends[1].append(c.get("endConnector"))
    return found


def run(units, ends, wind, step, count, node, gain):
    """Rotation of the node after each step."""
    for name, unit in units.items():
        unit.start(**({} if name == "structure" else {"wind_speed": wind}))
    rotation, moment = f"node[{node}].rotation", f"node[{node}].external_moment"
    rows = []
    for n in range(count):
        values = {pair: units[pair[0]].get(outputs) for pair, (outputs, _) in ends.items()}
        for (start, end), (_, inputs) in ends.items():
            units[end].set(inputs, values[start, end])
        structure = units["structure"]
        # the wind's moment at the node is set already: the controller's comes on top
        own = [v for (_, end), (_, inputs) in ends.items() if end == "structure" for v in inputs if v == moment]
        if own and gain:
            [rate] = structure.get([f"node[{node}].rotation_rate"])
            acting = structure.get([moment])[0]
            structure.set([moment], [acting - gain * rate])
        for unit in units.values():
            unit.fmu.doStep(n * step, step)
        rows.append(structure.get([rotation])[0])
    return np.array(rows)


def growth(motion, step):
    """Rate at which the envelope grows over the second half, from the largest value in each eighth of it."""
    parts = np.array_split(np.abs(motion[len(motion) // 2 :]), 8)
    times = (np.arange(8) + 0.5) * len(parts[0]) * step
    return np.polyfit(times, [np.log(p.max()) for p in parts], 1)[0]


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("system")
    options.add_argument("--wind", type=float, default=84.0, help="m/s")
    options.add_argument("--node", default="1156")
    options.add_argument("--gain", type=float, default=2e8, help="moment over rate of rotation, N m s/rad")
    options.add_argument("--step", type=float, default=0.03, help="s")
    options.add_argument("--steps", type=int, default=6000)
    asked = options.parse_args()
    with TemporaryDirectory() as folder:
        folder = Path(folder)
        zipfile.ZipFile(asked.system).extractall(folder)
        files = sorted((folder / "resources").glob("*.fmu"))
        units = {f.stem: Unit(str(f), str(folder / f.stem)) for f in files}
        ends = connections(folder)
        for gain in (0.0, asked.gain):
            motion = run(units, ends, asked.wind, asked.step, asked.steps, asked.node, gain)
            print(f"gain {gain:g}: growth {growth(motion, asked.step):+.5f} 1/s")


if __name__ == "__main__":
    main()
