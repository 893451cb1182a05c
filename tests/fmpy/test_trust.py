"""What an importer can read about the answer: margin, damping, tested range, linear range."""

import numpy as np
import pytest


def warnings(section):
    return [m.text for m in section.log if m.category == "logStatusWarning"]


def test_margin_and_damping_change_sign_at_the_onset(continuous_model):
    with continuous_model.section() as section:
        section.initialize(wind_speed=10.0)
        (onset,) = section.get("onset_speed")
        for wind, sign in [(0.98 * onset, 1), (1.02 * onset, -1)]:
            section.set(wind_speed=wind)
            margin, damping = section.get("flutter_margin", "damping_now")
            assert margin == pytest.approx(onset - wind, rel=1e-9)
            assert section.get("flutter_speed") == section.get("onset_speed")
            assert np.sign(damping) == sign
        section.set(wind_speed=onset)
        assert section.get("damping_now")[0] == pytest.approx(0.0, abs=1e-8)


def test_damping_in_still_air_is_that_of_the_structure(continuous_model):
    with continuous_model.section() as section:
        section.initialize(wind_speed=0.0)
        stated = section.get("heave_damping_ratio", "torsion_damping_ratio")
        # the added mass of the air lowers frequency and damping ratio together
        assert section.get("damping_now")[0] == pytest.approx(min(stated), rel=0.05)


def test_the_tested_range_and_the_linear_range_are_said_once(any_model):
    with any_model.section() as section:
        section.initialize(wind_speed=0.0)
        assert not section.flag("wind_in_tested_range")
        assert section.flag("amplitude_in_linear_range")
        inside = [v for v in np.linspace(1.0, 60.0, 60) if inside_range(section, v)]
        assert inside
        section.set(wind_speed=inside[0])
        section.fmu.doStep(0.0, 0.01)
        before = len(warnings(section))
        for n, wind in enumerate([0.1, inside[0], 0.1]):
            section.set(wind_speed=wind)
            section.fmu.doStep(0.01 * (n + 1), 0.01)
        told = [text for text in warnings(section)[before:] if "was tested" in text]
        assert len(told) == 1, told
    with any_model.section() as section:
        section.initialize(wind_speed=0.0, initial_rotation=0.3)
        assert not section.flag("amplitude_in_linear_range")
        for n in range(10):
            section.fmu.doStep(0.01 * n, 0.01)
        told = [text for text in warnings(section) if "linear theory" in text]
        assert len(told) == 1, told


def inside_range(section, wind):
    section.set(wind_speed=wind)
    return section.flag("wind_in_tested_range")


def test_models_that_do_not_grow_are_called_stable(continuous_model):
    with continuous_model.section() as section:
        section.initialize()
        assert not any("grows where it should not" in text for text in warnings(section))
        assert section.flag("stable_below_onset")
