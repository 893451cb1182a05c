"""Every deck on every section, bluff ones among them: gusts, wind from rest to beyond the onset, both shells, both interfaces."""

import fmpy
import numpy as np
import pytest
from driven import Motion, integrated, stepped
from exported import EXPECTED, FOLDER
from fmpy.validation import validate_fmu

CELLS = EXPECTED["matrix"]
MOTIONS = {2: ["heave", "rotation"], 3: ["heave", "sway", "rotation"]}
# communication steps per period of the flutter motion, and how long: the wind is at rest, then rises to 1.2 of the onset
STEPS, PERIODS, BEYOND = 40, 20, 1.2


@pytest.fixture(params=CELLS, ids=lambda cell: cell["what"])
def cell(request):
    return request.param


def archive(cell, shell):
    return str(FOLDER / f"{cell['fmu']}_{shell}.fmu")


def motion(cell):
    return [f"{name}{rate}" for name in MOTIONS[cell["motions"]] for rate in ("", "_rate")]


def step_s(cell):
    return 1.0 / (STEPS * cell["frequency_hz"])


def blown(cell):
    """Wind that rises from rest and gusts of two frequencies, as a table in time."""
    time = np.arange(STEPS * PERIODS + 1) * step_s(cell)
    rise = np.clip(1.25 * time / time[-1] - 0.125, 0.0, 1.0)
    omega = 2 * np.pi * cell["frequency_hz"]
    rows = np.zeros(len(time), [(n, "f8") for n in ("time", "wind_speed", "gust_u", "gust_w")])
    rows["time"] = time
    rows["wind_speed"] = BEYOND * cell["speed_m_s"] * rise
    rows["gust_u"] = 0.1 * rows["wind_speed"] * np.sin(0.3 * omega * time)
    rows["gust_w"] = 0.05 * rows["wind_speed"] * np.cos(0.7 * omega * time)
    return rows


def test_fmpy_finds_no_problem(cell):
    for shell in ("fmi2", "fmi3", "force"):
        assert validate_fmu(archive(cell, shell)) == []


def test_the_onset_is_that_of_the_eigenvalues(cell):
    names = ["onset_speed", "onset_frequency", "flutter_speed", "onset_in_tested_range"]
    result = fmpy.simulate_fmu(archive(cell, "fmi2"), stop_time=0.0, output=names)
    speed, frequency, output, tested = (result[name][0] for name in names)
    assert speed == output == pytest.approx(cell["speed_m_s"], rel=1e-9)
    assert frequency == pytest.approx(cell["frequency_hz"], rel=1e-9)
    assert not tested or cell["answered"]


def test_both_shells_move_alike_in_rising_wind_and_gusts(cell):
    rows = blown(cell)
    options = {
        "stop_time": rows["time"][-1],
        "step_size": step_s(cell),
        "output_interval": step_s(cell),
        "input": rows,
        "output": motion(cell),
        "fmi_type": "CoSimulation",
    }
    two = fmpy.simulate_fmu(archive(cell, "fmi2"), **options)
    three = fmpy.simulate_fmu(archive(cell, "fmi3"), **options)
    assert len(two) == len(rows)
    for name in motion(cell):
        assert np.isfinite(two[name]).all(), name
        assert np.ptp(two[name]) > 0.0, name
        assert np.array_equal(two[name], three[name]), name


@pytest.mark.parametrize("of_onset", [0.0, 1e-3, 0.5, 1.0, BEYOND])
def test_an_importer_that_integrates_moves_as_the_steps_do(cell, of_onset):
    speed = of_onset * cell["speed_m_s"]
    options = {
        "stop_time": 2.0 / cell["frequency_hz"],
        "output_interval": step_s(cell),
        "output": motion(cell),
        "start_values": {"wind_speed": speed, "gust_w": 0.05 * speed, "gust_u": -0.1 * speed},
    }
    own = fmpy.simulate_fmu(archive(cell, "fmi2"), fmi_type="CoSimulation", **options)
    foreign = fmpy.simulate_fmu(
        archive(cell, "fmi2"), fmi_type="ModelExchange", relative_tolerance=1e-9, **options
    )
    for name in motion(cell):
        size = np.abs(own[name]).max()
        # as in test_model_exchange.py
        assert np.abs(own[name] - foreign[name]).max() <= 1e-5 * size, name


@pytest.mark.parametrize("of_onset", [0.0, 1e-3, 1.0])
def test_forces_of_an_instant_are_those_of_the_steps(cell, of_onset, tmp_path):
    outputs = {2: ["lift", "moment"], 3: ["lift", "drag", "moment"]}[cell["motions"]]
    speed = of_onset * cell["speed_m_s"]
    motion = Motion(
        dict.fromkeys(MOTIONS[cell["motions"]], 0.02),
        1.0 / cell["frequency_hz"],
        {"gust_u": 0.1 * speed, "gust_w": 0.05 * speed},
    )
    fmu = archive(cell, "force")
    own = stepped(fmu, tmp_path, motion, outputs, wind_speed=speed)
    foreign = integrated(fmu, tmp_path, motion, outputs, wind_speed=speed)
    # as in test_model_exchange.py
    assert (np.abs(own - foreign) <= 1e-5 * np.abs(own).max(axis=0)).all()
