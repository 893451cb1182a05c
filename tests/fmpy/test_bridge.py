"""The FMU of a whole bridge: its onset, its nodes, its states, and the same bridge put together outside."""

import json
import zipfile

import fmpy
import numpy as np
import pytest
from exported import FOLDER
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave
from fmpy.model_description import read_model_description
from fmpy.validation import validate_fmu

BRIDGE = json.loads((FOLDER / "bridge.json").read_text(encoding="utf-8"))
ONSET = BRIDGE["onset_m_s"]


class Slave:
    """An instance by names."""

    def __init__(self, name, folder):
        self.description = read_model_description(str(FOLDER / f"{name}.fmu"))
        self.references = {v.name: v.valueReference for v in self.description.modelVariables}
        self.fmu = FMU2Slave(
            guid=self.description.guid,
            unzipDirectory=str(folder),
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName=name,
        )
        self.fmu.instantiate()
        self.time = 0.0

    def start(self, **values):
        self.fmu.setupExperiment(startTime=0.0)
        self.fmu.enterInitializationMode()
        self.set(values)
        self.fmu.exitInitializationMode()
        self.time = 0.0

    def set(self, values):
        self.fmu.setReal([self.references[n] for n in values], [float(v) for v in values.values()])

    def get(self, names):
        return np.array(self.fmu.getReal([self.references[n] for n in names]))

    def step(self, step):
        self.fmu.doStep(self.time, step)
        self.time += step

    def close(self):
        self.fmu.terminate()
        self.fmu.freeInstance()


@pytest.fixture(scope="module")
def unpacked(tmp_path_factory):
    folder = tmp_path_factory.mktemp("bridge")
    for name in ("bridge", "bridge_force", "bridge_fmi3", "bridge_gusts"):
        fmpy.extract(str(FOLDER / f"{name}.fmu"), unzipdir=str(folder / name))
    return folder


@pytest.fixture
def bridge(unpacked):
    slave = Slave("bridge", unpacked / "bridge")
    yield slave
    slave.close()


def coordinates():
    return [f"mode[{m['number']}].coordinate" for m in BRIDGE["modes"]]


def rate_of(energy, step):
    """Growth rate from the size of the motion over the second half of a run."""
    half = len(energy) // 2
    t = np.arange(half, len(energy)) * step
    return np.polyfit(t, np.log(energy[half:]), 1)[0]


def zero(speeds, rates):
    """The speed at which a parabola through the growth rates is zero, nearest to the lowest speed."""
    roots = np.roots(np.polyfit(speeds, rates, len(speeds) - 1))
    roots = roots[np.isreal(roots)].real
    return roots[np.argmin(np.abs(roots - speeds[0]))]


def test_fmpy_finds_no_problem():
    assert validate_fmu(str(FOLDER / "bridge.fmu")) == []
    with zipfile.ZipFile(FOLDER / "bridge.fmu") as archive:
        assert "resources/bridge.json" in archive.namelist()


def test_onset_is_that_of_the_eigenvalues(bridge):
    """The unit knows its onset, and stepping finds it again within a thousandth."""
    bridge.start(wind_speed=60.0)
    onset, frequency = bridge.get(["onset_speed", "onset_frequency"])
    assert onset == pytest.approx(ONSET, rel=1e-6)
    assert frequency == pytest.approx(BRIDGE["frequency_hz"], rel=1e-6)
    names, step = coordinates(), 0.5
    masses = np.array([m["generalised_mass"] for m in BRIDGE["modes"]])
    speeds = ONSET * np.array([1.006, 1.013, 1.02])
    rates = []
    for speed in speeds:
        bridge.fmu.reset()
        bridge.start(wind_speed=speed)
        energy = []
        for _ in range(12000):
            bridge.step(step)
            energy.append(np.sqrt(np.sum(masses * bridge.get(names) ** 2)))
        # a beat of the phase is averaged over some forty periods
        smooth = np.convolve(energy, np.ones(240) / 240, mode="valid")
        rates.append(rate_of(smooth, step))
    assert zero(speeds, rates) == pytest.approx(ONSET, rel=1e-3)


def test_nodes_are_sums_of_modes(bridge):
    bridge.start(wind_speed=50.0)
    for _ in range(200):
        bridge.set({"node[1156].external_lift": 1e6, "node[1081].external_moment": -2e6})
        bridge.step(0.1)
    node = next(i for i, n in enumerate(BRIDGE["nodes"]) if n["name"] == "1156")
    eta = bridge.get(coordinates())
    for i, name in enumerate(["heave", "sway", "rotation"]):
        expected = sum(m["shape"][node][i] * e for m, e in zip(BRIDGE["modes"], eta))
        assert bridge.get([f"node[1156].{name}"])[0] == pytest.approx(expected, rel=1e-9, abs=1e-12)
    # pushed up, it is up
    assert bridge.get(["node[1156].heave"])[0] > 0


def test_a_static_force_bends_the_bridge(bridge):
    """Still air: after the decay, the flexibility of the modes."""
    bridge.start(wind_speed=0.0)
    node = next(i for i, n in enumerate(BRIDGE["nodes"]) if n["name"] == "1156")
    expected = sum(
        m["shape"][node][0] ** 2 / (m["generalised_mass"] * (2 * np.pi * m["frequency_hz"]) ** 2)
        for m in BRIDGE["modes"]
    )
    bridge.set({"node[1156].external_lift": 1.0})
    # a step of any size is exact: twenty thousand seconds at once, damping ratio 0.002
    for _ in range(4):
        bridge.step(5000.0)
    assert bridge.get(["node[1156].heave"])[0] == pytest.approx(expected, rel=1e-6)


def test_states_are_restored_bit_for_bit(bridge):
    bridge.start(wind_speed=70.0)
    names = [f"node[1156].{n}" for n in ("heave", "rotation_acceleration")]
    for _ in range(20):
        bridge.step(0.1)
    state = bridge.fmu.getFMUState()
    data = bridge.fmu.serializeFMUstate(state)
    at = bridge.time

    def run():
        rows = []
        for _ in range(20):
            bridge.set({"wind_speed": 70.0 + 5.0 * np.sin(bridge.time)})
            bridge.step(0.1)
            rows.append(bridge.get(names))
        return np.array(rows)

    first = run()
    bridge.fmu.setFMUState(bridge.fmu.deSerializeFMUstate(data))
    bridge.time = at
    assert np.array_equal(run(), first)
    bridge.fmu.reset()
    bridge.start(wind_speed=70.0)
    for _ in range(20):
        bridge.step(0.1)
    assert np.array_equal(run(), first)


def test_directional_derivatives_are_differences(bridge):
    bridge.start(wind_speed=65.0)
    for _ in range(30):
        bridge.set({"node[1156].external_lift": 3e5})
        bridge.step(0.1)
    unknowns = ["node[1156].heave_acceleration", "node[1081].rotation_acceleration", "mode[17].force"]
    refs = [bridge.references[n] for n in unknowns]
    state = bridge.fmu.getFMUState()
    for known, size in [("wind_speed", 1e-3), ("node[1156].external_lift", 1e3)]:
        found = bridge.fmu.getDirectionalDerivative(refs, [bridge.references[known]], [1.0])
        value = bridge.get([known])[0]
        sides = []
        for sign in (-1, 1):
            bridge.fmu.setFMUState(state)
            bridge.set({known: value + sign * size})
            sides.append(bridge.get(unknowns))
        bridge.fmu.setFMUState(state)
        assert found == pytest.approx((sides[1] - sides[0]) / (2 * size), rel=1e-5)


def test_wrong_values_are_refused(bridge):
    bridge.start(wind_speed=10.0)
    with pytest.raises(Exception):
        bridge.set({"wind_speed": -1.0})


def test_fmi3_gives_the_same_bits(bridge, unpacked):
    """Modes and nodes are arrays; wind that changes, a force, and the same numbers to the last bit."""
    assert validate_fmu(str(FOLDER / "bridge_fmi3.fmu")) == []
    description = read_model_description(str(FOLDER / "bridge_fmi3.fmu"))
    reference = {v.name: v.valueReference for v in description.modelVariables}
    third = FMU3Slave(
        guid=description.guid,
        unzipDirectory=str(unpacked / "bridge_fmi3"),
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="third",
    )
    third.instantiate()
    third.enterInitializationMode(startTime=0.0)
    third.setFloat64([reference["wind_speed"]], [60.0])
    third.exitInitializationMode()
    bridge.start(wind_speed=60.0)
    count, names, step = len(BRIDGE["modes"]), coordinates(), 0.1
    for i in range(100):
        wind = 60.0 + 0.1 * max(i - 50, 0)
        lift = 1e6 * np.sin(0.3 * i)
        bridge.set({"wind_speed": wind, "node[1156].external_lift": lift})
        third.setFloat64([reference["wind_speed"]], [wind])
        # the nodes in the order of the export: 1156, 1081
        third.setFloat64([reference["node.external_lift"]], [lift, 0.0])
        bridge.step(step)
        third.doStep(i * step, step)
        modes = np.array(third.getFloat64([reference["mode.coordinate"]], nValues=count))
        assert np.array_equal(modes, bridge.get(names))
        heave = third.getFloat64([reference["node.heave"]], nValues=2)[0]
        assert heave == bridge.get(["node[1156].heave"])[0]
    assert third.getFloat64([reference["flutter_speed"]])[0] == pytest.approx(ONSET, rel=1e-6)
    third.terminate()
    third.freeInstance()


@pytest.fixture
def gusty(unpacked):
    slaves = [Slave("bridge_gusts", unpacked / "bridge_gusts") for _ in range(2)]
    yield slaves
    for slave in slaves:
        slave.close()


def gust_options():
    with zipfile.ZipFile(FOLDER / "bridge_gusts.fmu") as archive:
        read = lambda name: json.loads(archive.read(f"resources/{name}.json"))
        return read("bridge"), read("turbulence")


def test_gusts_are_forces(gusty):
    """Gusts on every node and the forces that they exert there are one."""
    assert validate_fmu(str(FOLDER / "bridge_gusts.fmu")) == []
    options, _ = gust_options()
    blown, pushed = gusty
    for slave in gusty:
        slave.start(wind_speed=35.0, turbulence_factor=0.0)
    matrix = np.array(options["gusts"]["coefficients"][0])
    width, step, random = options["groups"][0]["width_m"], 0.1, np.random.default_rng(5)
    scale = np.array([width, width, width**2])
    nodes = options["nodes"]
    for _ in range(100):
        gusts = random.normal(size=(len(nodes), 2)) * [4.0, 2.0]
        values, forces = {}, {}
        for i, (node, gust) in enumerate(zip(nodes, gusts)):
            values[f"strip[{i + 1}].gust_u"], values[f"strip[{i + 1}].gust_w"] = gust
            force = 0.5 * options["air_density_kg_m3"] * 35.0 * node["length_m"] * scale * (matrix @ gust)
            for name, f in zip(("lift", "drag", "moment"), force):
                forces[f"node[{node['name']}].external_{name}"] = f
        blown.set(values)
        pushed.set(forces)
        for slave in gusty:
            slave.step(step)
    names = [f"mode[{m['number']}].coordinate" for m in options["modes"]]
    expected = pushed.get(names)
    assert np.abs(blown.get(names) - expected).max() <= 1e-10 * np.abs(expected).max()
    assert np.abs(expected).max() > 0


def test_turbulence_of_the_archive_is_that_of_the_inputs(gusty):
    """The field in resources/ and the same field set as inputs with their slopes."""
    options, field = gust_options()
    own, driven = gusty
    own.start(wind_speed=35.0)
    driven.start(wind_speed=35.0, turbulence_factor=0.0)
    step, count = field["step_s"], len(field["u"])
    names = [f"strip[{i + 1}].gust_{g}" for g in "uw" for i in range(count)]
    references = [driven.references[n] for n in names]
    samples = np.array(field["u"] + field["w"])
    for i in range(120):
        now, then = samples[:, i % 50], samples[:, (i + 1) % 50]
        driven.fmu.setReal(references, now.tolist())
        driven.fmu.setRealInputDerivatives(references, [1] * len(references), ((then - now) / step).tolist())
        for slave in gusty:
            slave.step(step)
    names = [f"mode[{m['number']}].coordinate" for m in options["modes"]]
    expected = driven.get(names)
    assert np.abs(own.get(names) - expected).max() <= 1e-9 * np.abs(expected).max()


class Outside:
    """The same bridge as modal superposition in Python, driven by the forces of the force FMU: exact steps of each mode under
    a force that is held."""

    def __init__(self, force, step, speed):
        self.force, self.step_s = force, step
        modes = BRIDGE["modes"]
        self.shapes = np.array([m["shape"] for m in modes])
        self.mass = np.array([m["generalised_mass"] for m in modes])
        omega = 2 * np.pi * np.array([m["frequency_hz"] for m in modes])
        zeta = np.array([m["damping_ratio"] for m in modes])
        self.lengths = np.array([n["length_m"] for n in BRIDGE["nodes"]])
        damped, decay = omega * np.sqrt(1 - zeta**2), np.exp(-zeta * omega * step)
        c, s = np.cos(damped * step), np.sin(damped * step)
        self.a = decay * (c + zeta * omega / damped * s)
        self.b = decay * s / damped
        self.c = -decay * omega**2 / damped * s
        self.d = decay * (c - zeta * omega / damped * s)
        self.stiffness = self.mass * omega**2
        # released in the motion of flutter
        self.flutter = np.array([complex(*z) for z in BRIDGE["flutter"]])
        self.omega = 2 * np.pi * BRIDGE["frequency_hz"]
        self.eta, self.rate = self.flutter.real.copy(), (1j * self.omega * self.flutter).real
        count = len(self.lengths)
        strips = range(1, count + 1)
        reference = lambda name: [force.references[f"strip[{i}].{name}"] for i in strips]
        self.motion = [reference(n) for n in ("heave", "heave_rate", "rotation", "rotation_rate")]
        self.motion = sum(self.motion, [])
        self.forces = sum((reference(n) for n in ("total_lift", "total_moment")), [])
        self.nodes = count
        # the force of the middle of the step over which it is held
        force.start(wind_speed=speed, prediction=0.5)

    def advance(self):
        y, t = self.shapes[:, :, 0], self.shapes[:, :, 2]
        rows = [self.eta @ y, self.rate @ y, self.eta @ t, self.rate @ t]
        self.force.fmu.setReal(self.motion, np.concatenate(rows).tolist())
        self.force.step(self.step_s)
        forces = np.array(self.force.fmu.getReal(self.forces))
        load = y @ forces[: self.nodes] + t @ forces[self.nodes :]
        rest = load / self.stiffness
        eta = self.eta - rest
        self.eta, self.rate = rest + self.a * eta + self.b * self.rate, self.c * eta + self.d * self.rate

    def size(self):
        """Amplitude of the motion of flutter in the motion now."""
        return np.abs(np.sum(self.mass * self.flutter.conj() * (self.eta + self.rate / (1j * self.omega))))


def test_forces_on_strips_make_the_same_bridge(unpacked):
    """Onset of a structure outside with the forces of 63 strips, at a fiftieth of the period of flutter: that of the bridge
    within 0.3 %."""
    step = 1 / (50 * BRIDGE["frequency_hz"])
    force = Slave("bridge_force", unpacked / "bridge_force")
    speeds, rates = ONSET * np.array([1.004, 1.012, 1.02]), []
    for speed in speeds:
        force.fmu.reset()
        outside = Outside(force, step, speed)
        energy = []
        for _ in range(4000):
            outside.advance()
            energy.append(outside.size())
        smooth = np.convolve(energy, np.ones(500) / 500, mode="valid")
        rates.append(rate_of(smooth, step))
    force.close()
    found = zero(speeds, rates)
    print(found, ONSET, rates)
    assert found == pytest.approx(ONSET, rel=3e-3)


# what CVode is asked for, relative; it keeps each step to it, and a run holds some hundred of them, whose errors add up
SOLVER = 1e-9
AGREEMENT = 1e4 * SOLVER
SEEN = ["node[1156].heave", "node[1156].rotation", "node[1156].heave_rate", "node[1156].rotation_acceleration"]


@pytest.mark.parametrize("of_onset", [0.0, 0.001, 0.5, 1.0, 1.05])
def test_cvode_moves_the_bridge_as_its_own_steps_do(of_onset):
    start = {"wind_speed": of_onset * ONSET, "node[1156].external_lift": 1e6}
    options = {"stop_time": 20.0, "output_interval": 0.25, "output": SEEN, "start_values": start}
    fmu = str(FOLDER / "bridge.fmu")
    own = fmpy.simulate_fmu(fmu, fmi_type="CoSimulation", **options)
    foreign = fmpy.simulate_fmu(
        fmu, fmi_type="ModelExchange", solver="CVode", relative_tolerance=SOLVER, **options
    )
    assert len(own) == len(foreign)
    for name in SEEN:
        size = np.abs(own[name]).max()
        assert np.abs(own[name] - foreign[name]).max() <= AGREEMENT * size, name


def test_cvode_blows_gusts_on_the_bridge_as_its_own_steps_do():
    description = read_model_description(str(FOLDER / "bridge_gusts.fmu"))
    gusts = [v.name for v in description.modelVariables if v.name.endswith(".gust_w")]
    start = {"wind_speed": 0.5 * ONSET, **{name: 3.0 + i for i, name in enumerate(gusts)}}
    options = {"stop_time": 10.0, "output_interval": 0.25, "output": SEEN, "start_values": start}
    fmu = str(FOLDER / "bridge_gusts.fmu")
    own = fmpy.simulate_fmu(fmu, fmi_type="CoSimulation", **options)
    foreign = fmpy.simulate_fmu(
        fmu, fmi_type="ModelExchange", solver="CVode", relative_tolerance=SOLVER, **options
    )
    for name in SEEN:
        size = np.abs(own[name]).max()
        assert np.abs(own[name] - foreign[name]).max() <= AGREEMENT * size, name


def linear_system(slave):
    """A of the unit, by its directional derivatives: what each state does to all rates."""
    rates = [u.variable for u in slave.description.derivatives]
    states = [r.derivative.valueReference for r in rates]
    rates = [r.valueReference for r in rates]
    column = lambda state: slave.fmu.getDirectionalDerivative(rates, [state], [1.0])
    return np.array([column(state) for state in states]).T


def test_the_linear_system_flutters_at_the_onset(bridge):
    """Its eigenvalues, by NumPy, cross zero where the unit says; nothing grows below."""
    bridge.start(wind_speed=ONSET)
    bridge.step(0.1)
    at_onset = np.linalg.eigvals(linear_system(bridge))
    assert len(at_onset) == bridge.description.numberOfContinuousStates == 5 * len(BRIDGE["modes"])
    critical = at_onset[np.argmax(at_onset.real)]
    assert abs(critical.real) < 1e-7
    assert abs(critical.imag) == pytest.approx(2 * np.pi * BRIDGE["frequency_hz"], rel=1e-6)
    bridge.set({"wind_speed": 0.98 * ONSET})
    assert np.linalg.eigvals(linear_system(bridge)).real.max() < 0


def test_what_depends_on_what_is_all_there_is(bridge):
    """No entry of A that the description does not name."""
    bridge.start(wind_speed=0.7 * ONSET)
    bridge.step(0.1)
    a = linear_system(bridge)
    unknowns = bridge.description.derivatives
    states = [u.variable.derivative.name for u in unknowns]
    for row, unknown in zip(a, unknowns):
        named = {v.name for v in unknown.dependencies}
        acts = {state for state, slope in zip(states, row) if slope != 0.0}
        assert acts <= named, unknown.variable.name


def test_states_of_modes_are_arrays_in_fmi3(unpacked):
    """The rates of FMI 3.0 are those of FMI 2.0, bit for bit."""
    description = read_model_description(str(FOLDER / "bridge_fmi3.fmu"))
    states = [u.variable.derivative for u in description.derivatives]
    modes = len(BRIDGE["modes"])
    assert [s.name for s in states[:2]] == ["mode.normalised_coordinate", "mode.normalised_rate"]
    assert all(int(s.dimensions[0].start) == modes for s in states[:2])
    options = {"stop_time": 5.0, "output_interval": 0.25, "fmi_type": "ModelExchange", "solver": "CVode"}
    options["start_values"] = {"wind_speed": 0.5 * ONSET}
    nodes = [v.name for v in read_model_description(str(FOLDER / "bridge.fmu")).modelVariables]
    nodes = [name for name in nodes if name.startswith("node[") and name.endswith("].heave")]
    two = fmpy.simulate_fmu(str(FOLDER / "bridge.fmu"), output=nodes, **options)
    three = fmpy.simulate_fmu(str(FOLDER / "bridge_fmi3.fmu"), output=["node.heave"], **options)
    expected = np.array([two[name] for name in nodes]).T
    assert np.array_equal(three["node.heave"], expected)
