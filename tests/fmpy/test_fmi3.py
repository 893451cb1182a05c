"""FMI 3.0: the same units through the other shell."""

import zipfile
from pathlib import Path

import fmpy
import numpy as np
import pytest
from exported import FOLDER, MODELS
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu
from lxml import etree
from section import OUTPUTS

KINDS = ["continuous_laguerre", "rational", "discrete_laguerre"]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("unit", ["section", "force"])
def test_fmpy_finds_no_problem(unit, kind):
    fmu = str(FOLDER / f"fmi3_{unit}_{kind}.fmu")
    assert validate_fmu(fmu) == []
    description = fmpy.read_model_description(fmu)
    assert description.fmiVersion == "3.0"
    assert (description.modelExchange is not None) == ("discrete" not in kind)


@pytest.mark.parametrize("kind", KINDS)
def test_the_trajectory_is_the_same_bit_for_bit(kind):
    options = {
        "fmi_type": "CoSimulation",
        "stop_time": 2.0,
        "output_interval": 0.01,
        "output": OUTPUTS,
        "start_values": {"wind_speed": 25.0, "external_lift": 1.0},
    }
    two = fmpy.simulate_fmu(str(FOLDER / f"{kind}.fmu"), **options)
    three = fmpy.simulate_fmu(str(FOLDER / f"fmi3_section_{kind}.fmu"), **options)
    assert kind in MODELS
    for name in ["time", *OUTPUTS]:
        assert np.array_equal(two[name], three[name]), name


@pytest.mark.parametrize("kind", KINDS[:2])
def test_cvode_moves_as_the_steps_do(kind):
    options = {"stop_time": 2.0, "output_interval": 0.01, "output": OUTPUTS}
    fmu = str(FOLDER / f"fmi3_section_{kind}.fmu")
    own = fmpy.simulate_fmu(fmu, fmi_type="CoSimulation", **options)
    foreign = fmpy.simulate_fmu(
        fmu, fmi_type="ModelExchange", solver="CVode", relative_tolerance=1e-9, **options
    )
    for name in OUTPUTS:
        # as in FMI 2.0, see test_model_exchange.py
        assert np.abs(own[name] - foreign[name]).max() <= 1e-5 * np.abs(own[name]).max(), name


@pytest.mark.parametrize(
    "unit, terminals",
    [
        ("fmi3_section_rational", {"wind", "vertical", "torsion"}),
        ("fmi3_force_rational", {"wind", "vertical", "torsion"}),
        ("bridge_fmi3", {"wind", "vertical", "lateral", "torsion"}),
        # of FMI 2.0, which has no arrays
        ("rational", {"wind", "vertical", "torsion"}),
        (
            "bridge",
            {"wind"} | {f"node[{n}].{d}" for n in (1081, 1156) for d in ("vertical", "lateral", "torsion")},
        ),
    ],
)
def test_terminals_name_variables(unit, terminals):
    """The file is as the schema of FMI 3.0 has it, of which FMI 2.0.4 makes use, and its members are variables of the unit."""
    fmu = FOLDER / f"{unit}.fmu"
    with zipfile.ZipFile(fmu) as archive:
        text = archive.read("terminalsAndIcons/terminalsAndIcons.xml")
    schema = Path(fmpy.__file__).parent / "schema/fmi3/fmi3TerminalsAndIcons.xsd"
    tree = etree.fromstring(text)
    etree.XMLSchema(etree.parse(str(schema))).assertValid(tree)
    names = {v.name for v in fmpy.read_model_description(str(fmu)).modelVariables}
    assert {t.get("name") for t in tree.iter("Terminal")} == terminals
    for terminal in tree.iter("Terminal"):
        members = [(m.get("memberName"), m.get("variableName")) for m in terminal]
        assert len({member for member, _ in members}) == len(members) > 0
        assert names.issuperset(name for _, name in members)


def test_strips_are_chosen(tmp_path):
    """Five strips of an archive of three; FMPy's own loop knows no configuration mode."""
    fmu = str(FOLDER / "fmi3_force_rational.fmu")
    description = fmpy.read_model_description(fmu)
    vr = {v.name: v.valueReference for v in description.modelVariables}
    unit = FMU3Slave(
        guid=description.guid,
        unzipDirectory=fmpy.extract(fmu, str(tmp_path)),
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="strips",
    )
    unit.instantiate()
    unit.enterConfigurationMode()
    assert list(unit.getUInt64([vr["strips"]])) == [3]
    unit.setUInt64([vr["strips"]], [5])
    unit.exitConfigurationMode()
    unit.setFloat64([vr["wind_speed"]], [20.0])
    unit.enterInitializationMode()
    unit.exitInitializationMode()
    unit.setFloat64([vr["rotation"]], [0.001 * i for i in range(5)])
    for step in range(10):
        unit.doStep(0.01 * step, 0.01)
    lift = list(unit.getFloat64([vr["lift"]], nValues=5))
    assert lift[0] == 0.0 and lift[1] != 0.0
    for i, value in enumerate(lift):
        assert value == pytest.approx(i * lift[1], rel=1e-12)
    unit.terminate()
    unit.freeInstance()


def test_strips_are_arrays():
    result = fmpy.simulate_fmu(
        str(FOLDER / "fmi3_force_rational.fmu"),
        stop_time=0.1,
        output_interval=0.01,
        start_values={"wind_speed": 20.0, "heave": [0.01, 0.0, -0.02]},
        output=["lift", "moment"],
    )
    lift = result["lift"][-1]
    assert lift.shape == (3,) and lift[0] != 0.0
    # forces are linear in the motion
    assert lift[1] == 0.0 and lift[2] == pytest.approx(-2 * lift[0], rel=1e-12)
