"""The reference runs of FMI-LS-REF: the script in the archive repeats them in FMPy, and tells what was spoilt."""

import subprocess
import sys
import zipfile

import pytest
from exported import FOLDER

LS_REF = "extra/org.fmi-standard.fmi-ls-ref"
UNITS = ["rational", "discrete_laguerre", "fmi3_section_rational", "fmi3_force_rational", "bridge", "bridge_fmi3", "bridge_force"]


def repeated(script, fmu):
    return subprocess.run([sys.executable, script, fmu], capture_output=True, text=True, timeout=300)


@pytest.fixture
def script(tmp_path):
    with zipfile.ZipFile(FOLDER / "rational.fmu") as archive:
        return archive.extract(f"{LS_REF}/replay.py", tmp_path)


@pytest.mark.parametrize("unit", UNITS)
def test_the_script_repeats_every_run(unit, script):
    done = repeated(script, FOLDER / f"{unit}.fmu")
    assert done.returncode == 0, done.stderr
    assert len(done.stdout.splitlines()) >= 4, done.stdout


def test_the_script_tells_what_was_spoilt(script, tmp_path):
    spoilt, entry = tmp_path / "spoilt.fmu", f"{LS_REF}/at_out.csv"
    with zipfile.ZipFile(FOLDER / "rational.fmu") as archive, zipfile.ZipFile(spoilt, "w") as copy:
        for name in archive.namelist():
            text = archive.read(name)
            if name == entry:
                lines = text.decode().splitlines()
                cells = lines[50].split(",")
                cells[1] = repr(2.0 * float(cells[1]) + 1e-3)
                lines[50] = ",".join(cells)
                text = "\n".join(lines).encode()
            copy.writestr(name, text)
    done = repeated(script, spoilt)
    assert done.returncode == 1 and "not as the exporter meant" in done.stderr
