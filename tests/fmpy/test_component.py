"""The runtime as a component for WebAssembly (draft FMI-LS-WASM), stepped by wasmtime, beside the library of this machine."""

import zipfile

import fmpy
import numpy as np
import pytest
from exported import FOLDER
from fmpy.fmi3 import FMU3Slave

pytest.importorskip("wasmtime", reason="wasmtime has no wheel for this platform")
from wasm_unit import Unit  # noqa: E402

ARCHIVES = sorted(path.stem for path in FOLDER.glob("component_*.fmu"))
if not ARCHIVES:
    pytest.skip("Rust has no target wasm32-wasip2 here", allow_module_level=True)
H = 0.01
# functions of the C library differ in their last bits; what is stepped is theirs at most once a wind speed
TOLERANCE = 1e-12


class Pair:
    """The same unit twice: as a component and as a library."""

    def __init__(self, name, folder):
        self.archive = archive = str(FOLDER / f"{name}.fmu")
        self.description = fmpy.read_model_description(archive)
        self.references = {v.name: v.valueReference for v in self.description.modelVariables}
        self.token = self.description.instantiationToken
        self.component = Unit(archive, self.token)
        self.native = FMU3Slave(
            guid=self.token,
            unzipDirectory=fmpy.extract(archive, unzipdir=str(folder)),
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName="native",
        )
        self.native.instantiate()

    def outputs(self):
        variables = self.description.modelVariables
        outputs = [v for v in variables if v.causality == "output" and v.type == "Float64"]
        return [v.valueReference for v in outputs if v.name not in ("damping_now", "frequency_now")]

    def begin(self):
        self.native.enterInitializationMode(startTime=0.0)
        self.native.exitInitializationMode()
        assert self.component.enter_initialization_mode(None, 0.0, None) == "ok"
        assert self.component.exit_initialization_mode() == "ok"

    def set(self, name, *values):
        self.native.setFloat64([self.references[name]], list(values))
        assert self.component.set_float64([self.references[name]], list(values)) == "ok"

    def read(self):
        """Values of both, one array for each output."""
        both = []
        for reference in self.outputs():
            found = self.component.get_float64([reference])
            both.append((self.native.getFloat64([reference], nValues=len(found)), found))
        return both

    def step(self, i):
        self.native.doStep(i * H, H)
        made = self.component.do_step(i * H, H, True)
        assert made.__dict__["last-successful-time"] == pytest.approx((i + 1) * H, abs=1e-12)


def as_near(rows):
    """Both the same but for rounding, seen from the largest value of each output, over time and along an array."""
    moved = 0.0
    for of_one in zip(*rows, strict=True):
        native, component = np.array(of_one).transpose(1, 0, 2)
        assert np.abs(native - component).max() <= TOLERANCE * np.abs(native).max()
        moved = max(moved, np.abs(native).max())
    assert moved > 0.0


@pytest.fixture(params=ARCHIVES)
def pair(request, tmp_path):
    return Pair(request.param, tmp_path)


def test_it_announces_itself(pair):
    assert pair.component.version == "3.0"
    assert pair.component.log == []
    with zipfile.ZipFile(FOLDER / f"{ARCHIVES[0]}.fmu") as archive:
        manifest = archive.read("extra/org.modelica.fmi-ls-wasm/manifest.xml").decode()
    assert 'fmi-ls-name="org.modelica.fmi-ls-wasm"' in manifest


def test_a_hundred_thousand_steps(tmp_path):
    pair = Pair("component_section_continuous_laguerre", tmp_path)
    pair.begin()
    rows = []
    for i in range(100_000):
        if i % 1000 == 0:
            rows.append(pair.read())
            # it is pushed again, else nothing would be left to compare
            pair.set("external_lift", float(i % 3))
        pair.step(i)
    as_near(rows)


def test_wind_that_changes_at_every_step(pair):
    pair.begin()
    rows = []
    strips = [(name, 3) for name in pair.references if name in ("heave", "heave_rate", "rotation")]
    driven = strips if "component_force" in pair.archive else []
    for i in range(100):
        pair.set("wind_speed", 10.0 + 0.1 * i)
        for name, count in driven:
            pair.set(name, *(0.01 * np.sin(0.3 * i + k) for k in range(count)))
        pair.step(i)
        rows.append(pair.read())
    as_near(rows)


def test_a_state_is_bytes_and_comes_back(pair):
    pair.begin()
    state = pair.component.get_fmu_state()

    def run():
        for i in range(20):
            pair.component.do_step(i * H, H, True)
        return pair.component.get_float64(pair.outputs())

    first = run()
    assert pair.component.set_fmu_state(state) == "ok"
    assert run() == first
    assert pair.component.set_fmu_state(b"no state" * 8) == "error"
    assert "state" in pair.component.log[-1][-1]


def test_texts_and_dependencies(pair):
    names = [v for v in pair.description.modelVariables if v.type == "String"]
    for variable in names[:3]:
        found = pair.component.get_string([variable.valueReference])
        assert found and all(found), variable.name
    some = pair.outputs()[0]
    count = pair.component.get_number_of_variable_dependencies(some)
    assert len(pair.component.get_variable_dependencies(some)) == count > 0


def test_what_is_wrong_is_said(pair):
    component = pair.component
    assert component.do_step(0.0, H, True) == "error"
    assert component.log[-1][:2] == ("unit", "error")
    assert component.get_float64([10_000_000]) == "error"
    assert "10000000" in component.log[-1][-1]
    assert component.reset() == "ok"
    wind = [pair.references["wind_speed"]]
    assert component.set_float64(wind, [float("nan")]) == "error"
    assert "wind_speed" in component.log[-1][-1]
    other = Unit(FOLDER / f"{ARCHIVES[0]}.fmu", "no token")
    assert other.handle is None
    assert "expected" in other.log[-1][-1] and "no token" in other.log[-1][-1]
    empty = Unit(FOLDER / f"{ARCHIVES[0]}.fmu", pair.token, resources={})
    assert empty.handle is None
    assert "resources/model.json" in empty.log[-1][-1]


def test_two_units_do_not_know_each_other(tmp_path):
    """A run goes on as the library's, whatever becomes of another instance of the same module."""
    pair = Pair(ARCHIVES[-1], tmp_path)
    pair.begin()
    make = pair.component._function(
        "co-simulation", "[static]co-simulation-instance.instantiate-co-simulation"
    )
    second = make(pair.component.store, "other", pair.token, False, True, False, False, [])
    assert second is not None
    second.drop(pair.component.store)
    pair.step(0)
    as_near([pair.read()])
