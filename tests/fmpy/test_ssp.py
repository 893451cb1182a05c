"""Force FMU and structure as a system of FMUs (SSP 1.0), run by FMPy's own master: nothing of ours in between."""

import json
import os
import subprocess
import sys
import zipfile
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from exported import FOLDER
from fmpy.ssp.simulation import simulate_ssp
from foreign_structure import ONSET, PERIOD, growth

SSD = "http://ssp-standard.org/SSP1/SystemStructureDescription"
SSC = "http://ssp-standard.org/SSP1/SystemStructureCommon"


def component(name, fmu, inputs, outputs):
    def connector(kind):
        return lambda n: f'<ssd:Connector name="{n}" kind="{kind}"><ssc:Real/></ssd:Connector>'

    connectors = [*map(connector("input"), inputs), *map(connector("output"), outputs)]
    return (
        f'<ssd:Component name="{name}" type="application/x-fmu-sharedlibrary" source="resources/{fmu}">'
        f"<ssd:Connectors>{''.join(connectors)}</ssd:Connectors></ssd:Component>"
    )


def archive(path):
    """The structure drives the forces, the forces drive the structure."""
    motion = ["heave", "heave_rate", "rotation", "rotation_rate"]
    forces = {"lift": "external_lift", "moment": "external_moment"}

    def connection(start, of, end, to):
        return (
            f'<ssd:Connection startElement="{start}" startConnector="{of}" '
            f'endElement="{end}" endConnector="{to}"/>'
        )

    connections = [connection("structure", m, "force", m) for m in motion]
    connections += [connection("force", f, "structure", e) for f, e in forces.items()]
    text = (
        f'<?xml version="1.0" encoding="UTF-8"?><ssd:SystemStructureDescription xmlns:ssd="{SSD}" '
        f'xmlns:ssc="{SSC}" version="1.0" name="bridge"><ssd:System name="bridge"><ssd:Elements>'
        f"{component('structure', 'full_scale.fmu', forces.values(), motion)}"
        f"{component('force', 'force.fmu', motion, forces)}</ssd:Elements>"
        f"<ssd:Connections>{''.join(connections)}</ssd:Connections></ssd:System>"
        "</ssd:SystemStructureDescription>"
    )
    with zipfile.ZipFile(path, "w") as ssp:
        ssp.writestr("SystemStructure.ssd", text)
        for fmu in ("full_scale.fmu", "force.fmu"):
            ssp.write(FOLDER / fmu, f"resources/{fmu}")


def run(path, wind, step, count):
    # the section without air is a structure: its own forces vanish
    values = {
        "structure.air_density": 1e-6,
        "structure.wind_speed": 0.0,
        "structure.initial_heave": 0.2,
        "structure.initial_rotation": 0.01,
        "force.wind_speed": wind,
    }
    parameters = [SimpleNamespace(name=n, value=v) for n, v in values.items()]
    found = simulate_ssp(
        str(path),
        stop_time=count * step,
        step_size=step,
        parameter_set=SimpleNamespace(parameters=parameters),
    )
    names = ["heave", "rotation", "heave_rate", "rotation_rate"]
    return np.column_stack([found[f"structure.{n}"] for n in names])


def test_a_system_of_fmus_finds_the_onset(tmp_path):
    path = tmp_path / "bridge.ssp"
    archive(path)
    step, speeds = PERIOD / 100, (0.995 * ONSET, 1.005 * ONSET)
    low, high = (growth(run(path, wind, step, 6000), step) for wind in speeds)
    onset = speeds[0] - low * (speeds[1] - speeds[0]) / (high - low)
    print(f"SSP, T/100, rates: {100 * (onset / ONSET - 1):+.3f} %")
    assert abs(onset / ONSET - 1) < 5e-4


def eigenvalue(motion, step, hertz, rank=24, delays=8):
    """The eigenvalue near a frequency of a motion that dies away or grows, from its samples and the next ones (dynamic mode
    decomposition)."""
    rows = len(motion) - delays
    history = np.hstack([motion[i : i + rows] for i in range(delays)]).T
    u, s, v = np.linalg.svd(history[:, :-1], full_matrices=False)
    u, s, v = u[:, :rank], s[:rank], v[:rank]
    values = np.log(np.linalg.eigvals(u.T @ history[:, 1:] @ v.T / s).astype(complex)) / step
    return values[np.argmin(abs(values - 2j * np.pi * hertz))]


@pytest.mark.parametrize("name", ["bridge", "sections"])
def test_a_bridge_in_parts_finds_its_onset(name):
    """The system as it is exported, nothing connected by hand: the onset of the whole bridge, also with five sections of other
    models, motions and numbers of filters, whose forces are one unit."""
    bridge = json.loads((FOLDER / f"{name}.json").read_text(encoding="utf-8"))
    onset, hertz = bridge["onset_m_s"], bridge["frequency_hz"]
    step, every, periods = 1 / (100 * hertz), 10, 60
    speeds, growths = onset * np.array([0.998, 1.002]), []
    for wind in speeds:
        parameters = [SimpleNamespace(name="force.wind_speed", value=wind)]
        found = simulate_ssp(
            str(FOLDER / f"{name}.ssp"),
            stop_time=100 * periods * step,
            step_size=step,
            parameter_set=SimpleNamespace(parameters=parameters),
        )
        names = [n for n in found.dtype.names if n.startswith("structure.") and n.endswith((".heave", ".rotation"))]
        # one node of `sections` is in none of them
        assert len(names) == {"bridge": 126, "sections": 124}[name]
        scale = [15.5 if n.endswith(".rotation") else 1.0 for n in names]
        motion = np.column_stack([found[n] * f for n, f in zip(names, scale)])
        growths.append(eigenvalue(motion[len(motion) // 3 :: every], step * every, hertz).real)
    low, high = growths
    assert low < high
    found = speeds[0] - low * (speeds[1] - speeds[0]) / (high - low)
    print(f"SSP of {name}, T/100: {100 * (found / onset - 1):+.3f} %")
    assert abs(found / onset - 1) < 5e-4


def example(name, *arguments, folder):
    script = Path(__file__).parents[2] / "examples" / name
    done = subprocess.run(
        [sys.executable, script, FOLDER / "bridge.ssp", *arguments],
        capture_output=True,
        text=True,
        timeout=120,
        env={**os.environ, "TMPDIR": str(folder)},
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_a_controller_beside_the_bridge_holds_it(tmp_path):
    """Above the onset the bridge grows without it, and not with it."""
    printed = example("bridge_with_controller.py", "--wind", "90", "--steps", "3000", folder=tmp_path)
    without, beside = (float(line.split()[-2]) for line in printed.splitlines())
    assert without > 0.01 and beside < -0.005, printed


def test_libcosim_reads_the_system(tmp_path):
    """Another master, which passes values on before the first step as well: the same motion up to what that step changes."""
    pytest.importorskip("libcosimpy", reason="libcosimpy has no wheel for this platform")
    name = "node[1156].rotation"
    printed = example("bridge_in_libcosim.py", name, folder=tmp_path)
    # its own log stands between
    largest = [float(line) for line in printed.splitlines() if not line.startswith("[")]
    found = simulate_ssp(str(FOLDER / "bridge.ssp"), stop_time=3000 * 0.03, step_size=0.03)
    expected = [part.max() for part in np.array_split(np.abs(found[f"structure.{name}"]), 6)]
    assert largest == pytest.approx(expected, rel=0.05), expected
