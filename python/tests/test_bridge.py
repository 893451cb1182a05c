"""A whole bridge: what the command line says of it, as arrays."""

import pickle

import aerodeck
import numpy as np
import pytest

BRIDGE = """
schema = 1
name = "Langenuen"
air_density_kg_m3 = 1.25
[modes]
format = "embedded"
path = "langenuen"
damping_ratio = 0.002
[[section]]
name = "girder"
width_m = 31.0
derivatives = "LN21-5200"
motions = ["vertical", "torsion"]
static = { drag = 0.08, lift = -0.15, moment = 0.03, drag_slope = 0.0, lift_slope = 4.5, moment_slope = 1.2, \
arms = { vertical = 0.25, lateral = 0.25, torsion = 0.25 } }
[flutter]
speed_max_m_s = 110.0
speeds = 55
[buffeting]
along = { spectrum = { shape = { kind = "kaimal" }, length_m = 150.0, intensity = 0.12 } }
time = { records = 2, duration_s = 200.0, step_s = 0.1 }
"""


@pytest.fixture(scope="module")
def bridge(tmp_path_factory):
    path = tmp_path_factory.mktemp("bridge") / "bridge.toml"
    path.write_text(BRIDGE)
    return aerodeck.Bridge.read(path)


def test_modes_and_nodes_are_arrays(bridge):
    n, m = len(bridge.nodes), len(bridge.modes)
    assert bridge.shapes.shape == (m, n, 3) and bridge.along_m.shape == (n,)
    assert bridge.frequency_hz.shape == bridge.damping_ratio.shape == (m,)
    assert np.all(np.diff(bridge.along_m) > 0) and np.all(bridge.damping_ratio == 0.002)


def test_a_bridge_is_pickled(bridge):
    """By its file and folder, from which it is read again."""
    other = pickle.loads(pickle.dumps(bridge))
    assert other.name == bridge.name and np.array_equal(other.shapes, bridge.shapes)


@pytest.fixture(scope="module")
def onset(bridge):
    return bridge.flutter()


def test_onsets_by_both_routes_are_those_of_the_manual(bridge, onset):
    # docs/bridge.md
    assert abs(onset.speed_m_s - 76.752) < 0.001
    assert abs(bridge.flutter(forces="tables").speed_m_s / onset.speed_m_s - 1) < 0.01
    shares = [mode["energy_share"] for mode in onset.card["motion"]["modes"]]
    assert shares == sorted(shares, reverse=True) and abs(sum(shares) - 1) < 1e-9
    with pytest.raises(aerodeck.InputError, match="models or tables"):
        bridge.flutter(forces="nonsense")


def test_what_is_odd_is_warned_of_and_doubted(tmp_path):
    """Half the width of the deck: what is said on reading is a doubt of the verdict."""
    path = tmp_path / "bridge.toml"
    path.write_text(BRIDGE.replace("width_m = 31.0", "width_m = 15.5").replace("[flutter]", "[flutter]\nrequired_speed_m_s = 60.0"))
    with pytest.warns(aerodeck.AerodeckWarning, match="were width_m the semi-chord, B would be 31 m"):
        odd = aerodeck.Bridge.read(path)
    found = odd.flutter()
    assert found.outcome == "cannot_be_judged", found.headline
    assert sum("semi-chord" in w for w in found.warnings) == 1


def test_damping_of_the_sweep_crosses_zero_at_the_onset(bridge, onset):
    speeds = onset.speed_m_s * np.array([0.25, 0.5, 0.75, 0.999, 1.001])
    curves = bridge.sweep(speeds)
    assert curves.damping_ratio.shape == (5, len(bridge.modes)) == (5, len(curves.modes))
    assert list(np.nanmin(curves.damping_ratio, axis=1) > 0) == [True] * 4 + [False]


def test_onsets_scatter_with_what_scatters(bridge, onset):
    told = []
    found = bridge.scatter(50, derivatives="measured", progress=lambda *at: told.append(at))
    assert found.speeds_m_s.shape == (50 - found.without_onset,) and max(told) == (50, 50)
    assert np.all(np.diff(found.speeds_m_s) >= 0) and abs(found.mean_m_s / onset.speed_m_s - 1) < 0.05
    assert abs(np.std(found.speeds_m_s, ddof=1) / found.standard_deviation_m_s - 1) < 1e-12
    low, high = found.interval_m_s
    assert low < found.mean_m_s < high and f"{low:.3f} and {high:.3f}" in repr(found)
    assert repr(pickle.loads(pickle.dumps(found))) == repr(found)
    fixed = bridge.scatter(2, frequency=0, damping=0, derivatives=0.0)
    assert abs(fixed.mean_m_s / onset.speed_m_s - 1) < 1e-8
    with pytest.raises(aerodeck.InputError, match="derivatives: expected a standard deviation over the mean, or measured"):
        bridge.scatter(2, derivatives="much")


def test_buffeting_by_spectra_and_by_records(bridge):
    told = []
    found = bridge.buffeting(30.0, progress=lambda *at: told.append(at))
    assert found.rms.shape == (len(found.nodes), 3) == (3, 3) and told[-1] == (2, 2)
    assert np.all(np.abs(found.rms_of_records - found.rms) < 5 * found.standard_error + 0.2 * found.rms)
    other = pickle.loads(pickle.dumps(found))
    assert other.to_dict() == found.to_dict() and np.array_equal(other.rms_of_records, found.rms_of_records)
    assert found.to_dict()["nodes"] == found.nodes and found._repr_html_().count("<tr>") == 3


def test_fmu_of_the_bridge_runs(bridge, tmp_path):
    fmpy = pytest.importorskip("fmpy")
    path = tmp_path / "bridge.fmu"
    bridge.export_fmu(path, nodes=["1081"], name="Girder")
    description = fmpy.read_model_description(str(path))
    assert description.modelName == "Girder"
    result = fmpy.simulate_fmu(str(path), stop_time=5.0, output_interval=0.1, output=["node[1081].heave"])
    motion = result["node[1081].heave"]
    assert len(motion) == 51 and np.all(np.isfinite(motion)) and np.abs(motion).max() > 0
    with pytest.raises(aerodeck.AerodeckError):
        bridge.export_fmu(path)


def test_pages_and_plots(bridge):
    assert bridge._repr_html_().count("<tr>") > len(bridge.modes)
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("agg")
    assert len(bridge.plot(modes=3).axes) == 3
