"""Directional derivatives and derivatives of outputs against finite differences."""

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from section import OUTPUTS

INPUTS = ["wind_speed", "external_lift", "external_moment"]


def jacobian(section, unknowns, knowns):
    """Columns by directional derivatives."""
    rows, columns = section.references(unknowns), section.references(knowns)
    return np.array([section.fmu.getDirectionalDerivative(rows, [c], [1.0]) for c in columns]).T


def differences(section, unknowns, knowns, size=1e-4):
    """Columns by central differences; everything is set back."""
    columns = []
    for name in knowns:
        (value,) = section.get(name)
        delta = size * max(abs(value), 0.1)
        ends = []
        for end in (value + delta, value - delta):
            section.set(**{name: end})
            ends.append(np.array(section.get(*unknowns)))
        section.set(**{name: value})
        columns.append((ends[0] - ends[1]) / (2 * delta))
    return np.array(columns).T


def agree(exact, approximate, tolerance=1e-6):
    scale = np.abs(approximate).max(axis=1, keepdims=True) + 1e-9
    assert (np.abs(exact - approximate) <= tolerance * scale).all(), (exact, approximate)


def test_outputs_by_inputs_while_stepping(model):
    with model.section() as section:
        section.initialize(wind_speed=25.0, external_lift=1.0).steps(50, 0.01)
        agree(jacobian(section, OUTPUTS, INPUTS), differences(section, OUTPUTS, INPUTS))


def test_margin_and_damping_by_the_wind(model):
    with model.section() as section:
        section.initialize(wind_speed=25.0).steps(5, 0.01)
        unknowns, knowns = ["flutter_margin", "damping_now"], ["wind_speed"]
        agree(jacobian(section, unknowns, knowns), differences(section, unknowns, knowns), 1e-5)
        section.ramp(wind_speed=2.0)
        references = section.references(unknowns)
        rates = section.fmu.getRealOutputDerivatives(references, [1, 1])
        assert rates == pytest.approx(list(2.0 * jacobian(section, unknowns, knowns)[:, 0]))


def test_a_direction_is_the_sum_of_its_parts(any_model):
    with any_model.section() as section:
        section.initialize().steps(20, 0.01)
        seed = [0.5, -2.0, 0.25]
        parts = jacobian(section, OUTPUTS, INPUTS) @ seed
        whole = section.fmu.getDirectionalDerivative(
            section.references(OUTPUTS), section.references(INPUTS), seed
        )
        assert whole == pytest.approx(list(parts), rel=1e-12)


def test_outputs_by_parameters_at_initialisation(model):
    knowns = [
        v.name
        for v in model.description.modelVariables
        if v.type == "Real" and v.causality in ("parameter", "input")
    ]
    knowns.remove("onset_search_limit")
    with model.section() as section:
        section.fmu.setupExperiment()
        section.set(initial_heave_rate=0.1, initial_rotation_rate=-0.2, external_lift=3.0)
        section.fmu.enterInitializationMode()
        agree(jacobian(section, OUTPUTS, knowns), differences(section, OUTPUTS, knowns), 1e-5)


def test_declared_dependencies_hold_all_true_ones(model):
    rates = [u.variable for u in model.description.derivatives]
    states = [rate.derivative.name for rate in rates]
    knowns = INPUTS + states
    unknowns = OUTPUTS + [rate.name for rate in rates if rate.name not in OUTPUTS]
    with model.section() as section:
        section.initialize(wind_speed=25.0, external_lift=1.0).steps(50, 0.01)
        matrix = jacobian(section, unknowns, knowns)
    stated = [*model.description.outputs, *model.description.derivatives]
    stated = {u.variable.name: {d.name for d in u.dependencies} for u in stated}
    for name, row in zip(unknowns, matrix):
        acting = {n for n, x in zip(knowns, row) if x != 0.0}
        assert acting <= stated[name], name
        # displacements and rates are states: no input reaches them at once, and importers may rely on that
        assert bool(acting & set(INPUTS)) == bool(stated[name] & set(INPUTS)), name
        if name in states:
            assert stated[name] == {name}


def test_derivatives_of_outputs(continuous_model):
    step = 1e-4
    with continuous_model.section() as section:
        section.initialize(wind_speed=30.0, external_lift=2.0)
        section.steps(100, step)
        rows = section.steps(2, step, start=100)
        references = section.references(OUTPUTS)
        exact = section.fmu.getRealOutputDerivatives(references, [1] * len(OUTPUTS))
        later = section.steps(1, step, start=102)
    central = (later[0] - rows[0]) / (2 * step)
    found = dict(zip(OUTPUTS, exact))
    now = dict(zip(OUTPUTS, rows[1]))
    # motion: exactly the outputs next in line
    for dof in ("heave", "rotation"):
        assert found[dof] == now[f"{dof}_rate"]
        assert found[f"{dof}_rate"] == pytest.approx(now[f"{dof}_acceleration"], rel=1e-12)
    # all: central differences, error h²·ω³/6 of the fastest part
    assert exact == pytest.approx(list(central), rel=1e-4, abs=1e-5)


def test_derivatives_of_outputs_follow_ramps(continuous_model):
    step = 1e-4
    with continuous_model.section() as section:
        section.initialize(wind_speed=25.0)
        section.ramp(wind_speed=3.0, external_lift=50.0, external_moment=-2.0)
        section.fmu.doStep(0.0, step)
        first = section.get(*OUTPUTS)
        section.fmu.doStep(step, step)
        exact = section.fmu.getRealOutputDerivatives(
            section.references(OUTPUTS), [1] * len(OUTPUTS)
        )
        section.fmu.doStep(2 * step, step)
        central = (np.array(section.get(*OUTPUTS)) - first) / (2 * step)
    assert exact == pytest.approx(list(central), rel=1e-3, abs=1e-3)


def test_sampled_forces_stand_still(models):
    with models["discrete_laguerre"].section() as section:
        section.initialize().steps(50, 0.01)
        found = section.fmu.getRealOutputDerivatives(section.references(OUTPUTS), [1] * 8)
        now = section.get(*OUTPUTS)
    found, now = dict(zip(OUTPUTS, found)), dict(zip(OUTPUTS, now))
    assert found["heave"] == now["heave_rate"] and found["rotation"] == now["rotation_rate"]
    assert found["lift"] == found["moment"] == 0.0


def test_higher_orders_are_refused(any_model):
    with any_model.section() as section:
        section.initialize().steps(2, 0.01)
        order = any_model.description.coSimulation.maxOutputDerivativeOrder + 1
        with pytest.raises(FMICallException):
            section.fmu.getRealOutputDerivatives(section.references(["heave"]), [order])
        assert any(str(order) in m.text for m in section.log)
