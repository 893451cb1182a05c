"""Another importer (libcosim of the Open Simulation Platform, with FMI Library inside) runs the same FMUs."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from section import OUTPUTS

HERE = Path(__file__).parent


def test_libcosim_gives_the_same_motion(model, tmp_path):
    pytest.importorskip("libcosimpy", reason="libcosimpy has no wheel for this platform")
    references = [v.valueReference for v in model.description.modelVariables if v.name in OUTPUTS]
    result = tmp_path / "rows.npy"
    # in a process of its own: it unpacks next to nothing, but it brings its own C runtime
    done = subprocess.run(
        [sys.executable, HERE / "run_libcosim.py", model.fmu, result, *map(str, references)],
        capture_output=True,
        text=True,
        timeout=60,
        env={**os.environ, "TMPDIR": str(tmp_path)},
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "error" not in (done.stdout + done.stderr).lower()
    with model.section() as section:
        expected = section.initialize().steps(200, 0.01)
    found = np.load(result)
    # its clock counts nanoseconds: the same steps up to their last bits
    assert np.allclose(found, expected, rtol=1e-9, atol=1e-12)
