"""An FMU with a lateral support: sway and drag, run by FMPy against the same run in process."""

import json

import fmpy
import numpy as np
import pytest
from exported import FOLDER, number, numbers
from fmpy.model_description import read_model_description
from fmpy.validation import validate_fmu
from growth import growth
from section import Section

FMU = FOLDER / "three_dof.fmu"
STATES = [f"{motion}{suffix}" for motion in ("heave", "sway", "rotation") for suffix in ("", "_rate")]
OUTPUTS = [
    f"{motion}{suffix}"
    for motion in ("heave", "sway", "rotation")
    for suffix in ("", "_rate", "_acceleration")
] + ["lift", "drag", "moment"]


@pytest.fixture(scope="module")
def expected():
    return json.loads((FOLDER / "expected.json").read_text(encoding="utf-8"))["three_dof"]


@pytest.fixture
def section(tmp_path):
    unpacked = tmp_path / "three"
    fmpy.extract(str(FMU), unzipdir=str(unpacked))
    with Section(unpacked, read_model_description(str(FMU))) as instance:
        yield instance


def test_description_is_valid_and_names_the_lateral_motion():
    assert validate_fmu(str(FMU)) == []
    names = {v.name: v for v in read_model_description(str(FMU)).modelVariables}
    for name in OUTPUTS:
        assert names[name].causality == "output"
    for name in ("sway_mass", "sway_frequency", "sway_damping_ratio", "initial_sway"):
        assert names[name].causality == "parameter"
    assert names["external_drag"].causality == "input"


def test_equal_bit_for_bit(section, expected):
    section.initialize()
    for n, step in enumerate(expected["steps"]):
        if step["set"]:
            section.set(**numbers(step["set"]))
        section.fmu.doStep(number(step["time"]), number(step["size"]))
        found = section.get(*expected["outputs"])
        assert found == [number(bits) for bits in step["outputs"]], f"step {n}"
    assert len(expected["steps"]) > 300


def test_drag_moves_the_deck_sideways(section):
    section.initialize(initial_heave=0.0, initial_rotation=0.0, wind_speed=0.5)
    section.set(external_drag=3.0)
    rows = section.steps(4000, 0.005, names=["sway", "heave", "rotation"])
    # a step force on an almost undamped spring: the mean is the static deflection F/k, k = m (2 pi f)^2
    stiffness = 15.0 * (2 * np.pi * 3.9) ** 2
    assert rows[:, 0].mean() == pytest.approx(3.0 / stiffness, rel=0.01)
    # at rest only the fitted added mass couples the motions: heave and the edges of the deck (B/2 = 0.25 m) move by a
    # few per cent of the sway
    sideways = abs(rows[:, 0]).max()
    assert abs(rows[:, 1]).max() < 0.05 * sideways
    assert abs(rows[:, 2] * 0.25).max() < 0.05 * sideways


def test_growth_at_the_onset_by_eigenvalues(section, expected):
    onset = expected["onset"]
    assert section.initialize().get("onset_speed")[0] == pytest.approx(
        onset["speed_m_s"], rel=1e-9
    )
    section.set(wind_speed=onset["speed_m_s"])
    rows = section.steps(6000, 0.005, names=STATES)
    # the two other modes have died out after twenty seconds
    rate, frequency = growth(rows[4000:], 0.005)
    assert rate == pytest.approx(0.0, abs=1e-6)
    assert frequency == pytest.approx(onset["frequency_hz"], rel=1e-6)


def test_simulate_fmu_runs_it():
    result = fmpy.simulate_fmu(str(FMU), stop_time=1.0, output=["sway", "drag", "rotation"])
    assert len(result) > 50 and np.isfinite(result["sway"]).all()
    assert abs(result["sway"]).max() > 0.0
