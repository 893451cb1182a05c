"""Start values in display units, and units that say what they mean."""

import math

import fmpy
import pytest


def test_degrees_and_kilometres_per_hour(model):
    options = {"stop_time": 0.5, "output_interval": 0.01}
    shown = fmpy.simulate_fmu(
        str(model.fmu),
        start_values={"initial_rotation": (5, "deg"), "wind_speed": (108, "km/h")},
        **options,
    )
    plain = fmpy.simulate_fmu(
        str(model.fmu),
        start_values={"initial_rotation": math.radians(5), "wind_speed": 30.0},
        **options,
    )
    assert shown["rotation"][0] == pytest.approx(math.radians(5), rel=1e-14)
    assert shown["rotation"] == pytest.approx(plain["rotation"], rel=1e-9, abs=1e-12)


def test_every_dimensional_variable_has_a_unit(model):
    without = {
        "heave_damping_ratio", "torsion_damping_ratio", "onset_reduced_velocity", "damping_now",
    }  # fmt: skip
    without |= {f"filter[{i + 1}]" for i in range(model.description.numberOfContinuousStates)}
    for variable in model.description.modelVariables:
        if variable.type == "Real":
            assert (variable.unit is None) == (variable.name in without), variable.name
            assert variable.description and variable.quantity


def test_units_are_coherent(model):
    # exponents of kg, m, s, rad and factor, by hand
    expected = {
        "m": (0, 1, 0, 0, 1.0),
        "m/s": (0, 1, -1, 0, 1.0),
        "m/s2": (0, 1, -2, 0, 1.0),
        "rad": (0, 0, 0, 1, 1.0),
        "rad/s": (0, 0, -1, 1, 1.0),
        "rad/s2": (0, 0, -2, 1, 1.0),
        "Hz": (0, 0, -1, 1, 2 * math.pi),
        "kg/m": (1, -1, 0, 0, 1.0),
        "kg/m3": (1, -3, 0, 0, 1.0),
        "kg.m2/m": (1, 1, 0, 0, 1.0),
        "N/m": (1, 0, -2, 0, 1.0),
        "N.m/m": (1, 1, -2, 0, 1.0),
    }
    found = {}
    for unit in model.description.unitDefinitions:
        base = unit.baseUnit
        found[unit.name] = (base.kg, base.m, base.s, base.rad, base.factor)
        assert base.offset == 0.0
    if not model.sampled:
        expected["1/s"] = (0, 0, -1, 0, 1.0)
    assert found == expected
    shown = {
        (u.name, d.name): d.factor
        for u in model.description.unitDefinitions
        for d in u.displayUnits
    }
    assert shown[("m/s", "km/h")] == 3.6
    assert shown[("rad", "deg")] == pytest.approx(180 / math.pi, rel=1e-15)


def test_starts_lie_within_their_limits(model):
    for variable in model.description.modelVariables:
        if variable.type == "Real" and variable.start is not None:
            start = float(variable.start)
            assert variable.min is None or start >= float(variable.min)
            assert variable.max is None or start <= float(variable.max)
