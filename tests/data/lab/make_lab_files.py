"""Small laboratory files of every kind that is read, with known samples.

Channel j (from 0) at sample i is  j + (j + 1) sin(pi (j + 1) t)  with  t = i / 200 s.

    python make_lab_files.py        needs numpy, scipy, h5py, npTDMS

Written with numpy 2.4.6, scipy 1.17.1, h5py 3.16.0, npTDMS 1.13.0.
"""

import datetime
from pathlib import Path

import h5py
import numpy as np
import scipy.io
from nptdms import ChannelObject, GroupObject, RootObject, TdmsWriter

HERE = Path(__file__).parent
RATE = 200.0
N = 128


def channel(j, n=N):
    t = np.arange(n) / RATE
    return j + (j + 1) * np.sin(np.pi * (j + 1) * t)


def matrix(first, columns, n=N):
    return np.column_stack([channel(first + j, n) for j in range(columns)])


def write_csv():
    rows = ["y [mm];theta [deg];Fx (N);remark"]
    for a, b, c in matrix(0, 3):
        cells = [f"{x:.9f}".replace(".", ",") for x in (a, b, c)]
        rows.append(";".join(cells + ["ok"]))
    (HERE / "semicolons.csv").write_text("\r\n".join(rows) + "\r\n")
    rows = ["# sampling_hz: 200", "# operator: nobody", "y,theta,Fx", "mm,deg,N"]
    rows += [",".join(f"{x:.12g}" for x in row) for row in matrix(0, 3)]
    (HERE / "units_row.csv").write_text("\n".join(rows) + "\n")


def write_matlab():
    variables = {
        "motion": matrix(0, 3),
        "row": channel(3).reshape(1, -1),
        "run": {"force": channel(4), "counts": np.round(1000 * channel(5)).astype(np.int16), "label": "still air"},
        "fs": RATE,
        "cells": np.array([channel(6), "text"], dtype=object),
        "single": channel(7).astype(np.float32),
    }
    scipy.io.savemat(HERE / "v5_compressed.mat", variables, do_compression=True)
    scipy.io.savemat(HERE / "v5_plain.mat", variables)
    runs = np.array([(channel(0), 1.0), (2.0, channel(1))], dtype=[("p", "O"), ("q", "O")])
    variables = {"info": {"rig": {"y": channel(0)}}, "runs": runs}
    scipy.io.savemat(HERE / "v5_short_compressed.mat", variables, do_compression=True)
    scipy.io.savemat(HERE / "v5_short_plain.mat", variables)
    with h5py.File(HERE / "v73.mat", "w", userblock_size=512, libver="earliest") as f:
        def put(where, name, values, kind="double"):
            d = where.create_dataset(name, data=values)
            d.attrs["MATLAB_class"] = np.bytes_(kind)
        # MATLAB's dimensions come reversed
        put(f, "motion", matrix(0, 3).T)
        put(f, "row", channel(3).reshape(-1, 1))
        run = f.create_group("run")
        run.attrs["MATLAB_class"] = np.bytes_("struct")
        put(run, "force", channel(4).reshape(1, -1))
        put(run, "counts", np.round(1000 * channel(5)).astype(np.int16).reshape(1, -1), "int16")
        put(run, "label", np.array([[ord(c)] for c in "still air"], dtype=np.uint16), "char")
        put(f, "fs", np.array([[RATE]]))
    with open(HERE / "v73.mat", "r+b") as f:
        f.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(116) + bytes(8) + b"\x00\x02IM")


def write_hdf5():
    """The layout of NTNU's tools: one group per run. Forces of two cells of four are zero."""
    with h5py.File(HERE / "ntnu.h5", "w", libver="earliest") as f:
        for name, speed, factor in [("in_wind", 8.0, 1.5), ("still_air", 0.0, 1.0)]:
            g = f.create_group(name)
            g.attrs["sampling frequency"] = RATE
            g.attrs["forced motion"] = "vertical"
            g.attrs["test operator"] = "nobody"
            g.create_dataset("temperature", data=21.5)
            g.create_dataset("air_density", data=1.195)
            g.create_dataset("wind_velocity", data=speed + 0.0 * channel(0))
            motion = np.column_stack([np.zeros(N), 0.01 * channel(0), np.zeros(N)])
            g.create_dataset("motion", data=motion, compression="gzip")
            forces = np.hstack([factor * matrix(0, 12), np.zeros((N, 12))])
            g.create_dataset("forces_global_coord", data=forces, compression="gzip", shuffle=True)


def write_links():
    """A soft link, a dataset whose data lie in another one, and one of a layout that is newer than the reader."""
    with h5py.File(HERE / "links.h5", "w", libver="earliest") as f:
        f["run/y"] = channel(0)
        f["y"] = h5py.SoftLink("/run/y")
        f["z"] = channel(1)
    with h5py.File(HERE / "virtual.h5", "w", libver="latest") as f:
        f["y"] = channel(0)
        layout = h5py.VirtualLayout(shape=(N,), dtype="f8")
        layout[:] = h5py.VirtualSource("virtual.h5", "y", shape=(N,))
        f.create_virtual_dataset("v", layout)
        f.create_dataset("packed", data=channel(1), compression="gzip")


def write_tdms():
    root = RootObject({"operator": "nobody"})
    group = GroupObject("Forces", {"cell": 1})
    step = {"wf_increment": 1 / RATE, "unit_string": "N"}
    with TdmsWriter(HERE / "forces.tdms") as f:
        for a, b in [(0, 50), (50, 60), (60, N)]:
            f.write_segment([
                root, group,
                ChannelObject("Forces", "double", channel(0)[a:b], step),
                ChannelObject("Forces", "it's single", channel(1).astype(np.float32)[a:b], step),
                ChannelObject("Forces", "counts", np.round(1000 * channel(2)).astype(np.int16)[a:b], {"wf_increment": 1 / RATE}),
                ChannelObject("Clock", "time", [datetime.datetime(2021, 3, 4)] * (b - a)),
            ])


write_csv()
write_matlab()
write_hdf5()
write_links()
write_tdms()
