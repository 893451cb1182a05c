"""Writes the modes of an OpenSees model as `aerodeck bridge` reads them (format = "opensees").

Call `export(model_nodes, 40, "modes")` after the model has been built with openseespy. Nodes go from one end of the girder
to the other along up x downwind (with wind along -y and z up, along +x). `eigen` makes vectors of unit generalised mass.
"""

import os

import openseespy.opensees as ops


def export(girder_nodes, modes, folder):
    """Eigenvalues, nodes and eigenvectors of the girder's nodes."""
    os.makedirs(folder, exist_ok=True)
    eigenvalues = ops.eigen(modes)
    with open(os.path.join(folder, "eigenvalues.out"), "w") as out:
        out.write(" ".join(repr(float(square)) for square in eigenvalues) + "\n")
    with open(os.path.join(folder, "nodes.out"), "w") as out:
        for tag in girder_nodes:
            out.write(" ".join([str(tag)] + [repr(float(x)) for x in ops.nodeCoord(tag)]) + "\n")
    for mode in range(1, modes + 1):
        row = []
        for tag in girder_nodes:
            row += [repr(float(ops.nodeEigenvector(tag, mode, dof))) for dof in range(1, 7)]
        with open(os.path.join(folder, "mode_%d.out" % mode), "w") as out:
            out.write(" ".join(row) + "\n")
