"""Opens an HDF5 file of `aerodeck campaign virtual --format ntnu` as `Experiment.fromWTT` of the laboratory's package w3t does.

The forces about the centre, summed over the cells, are then compared with those of the same campaign written as CSV
(second argument): load cells in axes of their own, turned and moved here once more.
"""

import sys
import tomllib
from pathlib import Path

import h5py
import numpy as np


def experiment(group):
    dt = 1.0 / group.attrs["sampling frequency"]
    motion = group["motion"][:]
    n_samples = motion.shape[0]
    temperature, air_density = group["temperature"][()], group["air_density"][()]
    wind_speed = group["wind_velocity"][:]
    forces, center = group["forces_global_coord"][:], group["forces_global_coord_center"][:]
    assert abs(dt - 1 / 200) < 1e-12
    assert motion.shape == (n_samples, 3) and wind_speed.shape == (n_samples,)
    assert forces.shape == center.shape == (n_samples, 24)
    assert np.ndim(temperature) == 0 and np.ndim(air_density) == 0
    assert -50 < temperature < 60 and 1.0 < air_density < 1.4
    for name in ["test_type", "test operator", "forced motion"]:
        assert isinstance(group.attrs[name], str), name
    assert group["forces_global_coord_center"].attrs["eccentricity"].shape == (2,)
    return motion, center


def sums_of_csv(campaign, file):
    names = next(line for line in open(file) if not line.startswith("#")).strip().split(",")
    names = [name.split(" [")[0] for name in names]
    data = dict(zip(names, np.loadtxt(file, delimiter=",", skiprows=2).T))
    theta = data["torsion"]
    total = np.zeros((3, len(theta)))
    for cell in campaign["rig"]["cells"]:
        axes = np.array(cell["axes"])
        c, s = np.cos(theta), np.sin(theta)  # nose-up is a turn about -z
        local = np.array([data[f"{cell['name']}.{k}"] for k in ["fx", "fy", "fz", "mx", "my", "mz"]])
        force, moment = axes @ local[:3], axes @ local[3:]
        fx, fy = c * force[0] + s * force[1], -s * force[0] + c * force[1]
        x, y, _ = cell["position_m"]
        px, py = c * x + s * y, -s * x + c * y
        total += [fx, fy, -(moment[2] + px * fy - py * fx)]
    return total


campaign = tomllib.loads((Path(sys.argv[2]) / "campaign.toml").read_text())
with h5py.File(sys.argv[1], "r") as f:
    groups = list(f)
    for name in groups:
        motion, center = experiment(f[name])
        # drag, lift, pitching moment: columns 0, 2, 4 of each cell
        ours = [center[:, k::6].sum(axis=1) for k in (0, 2, 4)]
        theirs = sums_of_csv(campaign, Path(sys.argv[2]) / "runs" / f"{name}.csv")
        for a, b in zip(ours, theirs):
            assert np.abs(a - b).max() < 1e-9, name
        assert np.ptp(motion, axis=0).max() > 0
print(len(groups), "groups")
