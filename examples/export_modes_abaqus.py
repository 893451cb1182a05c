"""Writes the modes of an Abaqus output database as `aerodeck bridge` reads them (format = "abaqus").

    abaqus python export_modes_abaqus.py model.odb GIRDER Frequency modes

GIRDER is a node set of the assembly, Frequency the name of the frequency step, modes the folder. The node labels have to
rise along the girder, along up x downwind (with wind along -y and z up, along +x).
"""

import os
import sys

from odbAccess import openOdb


def export(path, node_set, step_name, folder):
    """Nodes, frequencies, generalised masses and one file per mode."""
    if not os.path.isdir(folder):
        os.makedirs(folder)
    odb = openOdb(path, readOnly=True)
    girder = odb.rootAssembly.nodeSets[node_set]
    nodes = sorted((n for part in girder.nodes for n in part), key=lambda n: n.label)
    with open(os.path.join(folder, "nodes.csv"), "w") as out:
        out.write("node,x,y,z\n")
        for n in nodes:
            out.write("%d,%r,%r,%r\n" % ((n.label,) + tuple(float(x) for x in n.coordinates)))
    step = odb.steps[step_name]
    frames = [frame for frame in step.frames if frame.mode]
    history = [r for r in step.historyRegions.values() if "GM" in r.historyOutputs.keys()][0]
    masses = [value for _, value in history.historyOutputs["GM"].data]
    with open(os.path.join(folder, "eigenfrequencies.csv"), "w") as out:
        out.writelines("%r\n" % float(frame.frequency) for frame in frames)
    with open(os.path.join(folder, "generalised_masses.csv"), "w") as out:
        out.writelines("%r\n" % float(mass) for mass in masses)
    for i, frame in enumerate(frames):
        moved, turned = ({v.nodeLabel: v.data for v in frame.fieldOutputs[name].getSubset(region=girder).values}
                         for name in ("U", "UR"))
        with open(os.path.join(folder, "mode_%d.csv" % (i + 1)), "w") as out:
            out.write("node,U1,U2,U3,UR1,UR2,UR3\n")
            for n in nodes:
                values = list(moved[n.label][:3]) + list(turned[n.label][:3])
                out.write(",".join([str(n.label)] + [repr(float(x)) for x in values]) + "\n")
    odb.close()


if __name__ == "__main__":
    export(*sys.argv[1:5])
