"""Force FMU and structure as a system of FMUs (SSP 1.0), run by FMPy's own master: nothing of ours in between."""

import zipfile
from types import SimpleNamespace

import numpy as np
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
