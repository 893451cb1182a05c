"""Calculated parameters follow the tunable ones; tuning between steps acts from then on."""

import numpy as np
import pytest
from section import MOTION, OUTPUTS

CALCULATED = ["onset_speed", "onset_frequency", "onset_reduced_velocity", "divergence_speed"]
FLAGS = ["onset_found", "onset_in_tested_range", "divergence_found"]


def compare(section, expected):
    found = dict(zip(CALCULATED, section.get(*CALCULATED)))
    # the same search in process; only the way there differs in the last bits
    assert found == pytest.approx({name: expected[name] for name in CALCULATED}, rel=1e-9)
    assert [section.flag(name) for name in FLAGS] == [expected[name] for name in FLAGS]


def test_before_during_and_after_tuning(model):
    for case in model.expected["tuned"]:
        parameters = case["parameters"]
        with model.section() as section:
            # set before initialisation, read in it
            section.fmu.setupExperiment()
            if parameters:
                section.set(**parameters)
            section.fmu.enterInitializationMode()
            compare(section, case["calculated"])
        with model.section() as section:
            section.initialize().steps(5, 0.01)
            if parameters:
                section.set(**parameters)
            compare(section, case["calculated"])
            section.steps(5, 0.01, start=5)
            compare(section, case["calculated"])


def test_nothing_found_below_the_limit(model):
    with model.section() as section:
        section.initialize(onset_search_limit=10.0)
        # the torsion is faster than every test up to there, and nothing holds what a sampled model does to it
        judged = 0.0 if model.sampled else 10.0
        assert section.get(*CALCULATED) == [judged, 0.0, 0.0, 10.0]
        assert [section.flag(name) for name in FLAGS] == [False] * 3


def test_start_values_and_tuning_are_the_same_thing(model):
    with model.section() as section:
        # all but the width, on which the flow at release depends
        changed = {"mass": 18.0, "torsion_frequency": 4.0, "air_density": 1.25}
        before = section.initialize(**changed).steps(50, 0.01)
        section.fmu.reset()
        section.initialize()
        section.set(**changed)
        assert section.steps(50, 0.01).tobytes() == before.tobytes()


def test_tuning_to_the_same_value_changes_nothing(model):
    with model.section() as section:
        expected = section.initialize().steps(100, 0.01)
        section.fmu.reset()
        section.initialize()
        rows = np.empty_like(expected)
        for n in range(100):
            section.set(mass=section.get("mass")[0], air_density=1.19)
            rows[n] = section.steps(1, 0.01, start=n)[0]
        assert rows.tobytes() == expected.tobytes()


def test_motion_does_not_jump_when_tuned(model):
    with model.section() as section:
        section.initialize().steps(77, 0.01)
        before = section.get(*MOTION)
        section.set(mass=20.0, torsion_frequency=6.0, heave_damping_ratio=0.05)
        assert section.get(*MOTION) == before
        section.fmu.doStep(0.77, 1e-7)
        # in a tenth of a microsecond nothing has moved: 100 m/s² is far more than it has
        assert section.get("heave", "rotation") == pytest.approx(
            [before[0], before[2]], abs=1e-6 * 10
        )


def test_tuned_stiffness_shows_in_the_frequency(model):
    # light wind, little damping: the section vibrates at its own frequency
    with model.section() as section:
        section.initialize(wind_speed=0.5, initial_heave=0.0)
        section.set(torsion_frequency=3.0)
        rows = section.steps(2000, 0.005)
    rotation = rows[:, OUTPUTS.index("rotation")]
    up = np.flatnonzero((rotation[:-1] < 0) & (rotation[1:] >= 0))
    share = rotation[up] / (rotation[up] - rotation[up + 1])
    periods = np.diff((up + share) * 0.005)
    # added mass and apparent stiffness of the air are a few per mille here
    assert 1 / periods.mean() == pytest.approx(3.0, rel=0.02)
