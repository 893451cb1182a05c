"""Inputs that change while running: wind and external forces, held or on a straight line over a step."""

import ctypes

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.simulation import Input
from section import MOTION


@pytest.fixture(autouse=True)
def room_for_derivatives(monkeypatch):
    """FMPy 0.3.32 makes room for nine input derivatives, however many inputs there are."""
    made = Input.__init__

    def mended(self, *arguments, **options):
        made(self, *arguments, **options)
        if self.t is not None:
            self.continuous = [
                group._replace(derivatives=(ctypes.c_double * len(group.vrs))())
                for group in self.continuous
            ]

    monkeypatch.setattr(Input, "__init__", mended)


def signal(*rows):
    """Time, wind speed, external lift and moment."""
    names = ["time", "wind_speed", "external_lift", "external_moment"]
    return np.array(list(rows), dtype=[(name, float) for name in names])


# from before the start: at the first point of a signal FMPy takes it for constant
RAMP = signal((-1.0, 16.5, -2.0, 0.075), (4.0, 34.0, 8.0, -0.3))


def last(model, interval, **options):
    result = fmpy.simulate_fmu(
        str(model.fmu), stop_time=4.0, output_interval=interval, output=MOTION, **options
    )
    return np.array([result[name][-1] for name in MOTION]), np.array(
        [np.abs(result[name]).max() for name in MOTION]
    )


def test_ramps_by_input_derivatives_do_not_depend_on_the_step(continuous_model):
    fine, scale = last(continuous_model, 0.005, input=RAMP, set_input_derivatives=True)
    coarse, _ = last(continuous_model, 0.1, input=RAMP, set_input_derivatives=True)
    # the wind changes inside the step: an integration of fourth order, no longer exact
    assert (np.abs(coarse - fine) < 1e-6 * scale).all()


def test_held_inputs_converge_to_the_ramp(model):
    ramp, scale = last(model, 0.01, input=RAMP, set_input_derivatives=True)
    errors = []
    for interval in (0.02, 0.01, 0.005):
        held, _ = last(model, interval, input=RAMP)
        errors.append(np.max(np.abs(held - ramp) / scale))
    # an input held over the step is half a step late: first order
    assert errors[0] < 0.05
    assert 1.6 < errors[0] / errors[1] < 2.4
    assert 1.6 < errors[1] / errors[2] < 2.4


def test_forces_on_a_ramp_are_exact(continuous_model):
    push = signal((-1.0, 25.0, -2.0, 0.075), (4.0, 25.0, 8.0, -0.3))
    fine, scale = last(continuous_model, 0.005, input=push, set_input_derivatives=True)
    coarse, _ = last(continuous_model, 0.2, input=push, set_input_derivatives=True)
    assert (np.abs(coarse - fine) < 1e-10 * scale).all()


def test_steps_in_a_signal(model):
    gust = signal(
        (0.0, 20.0, 0.0, 0.0), (1.0, 20.0, 0.0, 0.0), (1.0, 30.0, 5.0, 0.2), (4.0, 30.0, 5.0, 0.2)
    )
    fine, scale = last(model, 0.01, input=gust)
    # FMPy steps to the event although 0.3 does not divide it
    coarse, _ = last(model, 0.3, input=gust)
    assert (np.abs(coarse - fine) < 1e-9 * scale).all()


def test_a_constant_force_moves_the_section_to_its_balance(continuous_model):
    with continuous_model.section() as section:
        section.initialize(
            wind_speed=20.0, external_lift=10.0, heave_damping_ratio=0.2, torsion_damping_ratio=0.2
        )
        section.steps(300, 0.1)
        heave, lift, rotation, moment = section.get("heave", "lift", "rotation", "moment")
        mass, inertia = section.get("mass", "inertia")
        f_heave, f_torsion = section.get("heave_frequency", "torsion_frequency")
    # springs carry the external and the self-excited force
    assert mass * (2 * np.pi * f_heave) ** 2 * heave == pytest.approx(10.0 + lift, rel=1e-9)
    assert inertia * (2 * np.pi * f_torsion) ** 2 * rotation == pytest.approx(moment, rel=1e-7)


def test_equation_of_motion_at_every_step(model):
    with model.section() as section:
        section.initialize(wind_speed=28.0, external_lift=2.0, external_moment=0.3)
        mass, f, zeta = section.get("mass", "heave_frequency", "heave_damping_ratio")
        omega = 2 * np.pi * f
        rows = section.steps(200, 0.01)
    heave, rate, acceleration, lift = rows[:, 0], rows[:, 1], rows[:, 2], rows[:, 3]
    balance = mass * (acceleration + 2 * zeta * omega * rate + omega**2 * heave) - lift - 2.0
    assert np.abs(balance).max() < 1e-10 * np.abs(mass * acceleration).max()


def test_inputs_run_on_with_their_derivatives_until_these_are_set_anew(any_model):
    with any_model.section() as section:
        section.initialize()
        section.ramp(external_lift=100.0, wind_speed=-1.0)
        section.fmu.doStep(0.0, 0.01)
        assert section.get("external_lift", "wind_speed") == pytest.approx([1.0, 37.99])
        section.set(external_lift=5.0)
        section.fmu.doStep(0.01, 0.01)
        assert section.get("external_lift", "wind_speed") == pytest.approx([6.0, 37.98])
        section.ramp(external_lift=0.0, wind_speed=0.0)
        section.fmu.doStep(0.02, 0.01)
        assert section.get("external_lift", "wind_speed") == pytest.approx([6.0, 37.98])


def test_input_derivatives_that_cannot_be(any_model):
    for name, order in [("heave", 1), ("wind_speed", 2), ("wind_speed", 0)]:
        with any_model.section() as section:
            section.initialize()
            with pytest.raises(FMICallException):
                section.fmu.setRealInputDerivatives(section.references([name]), [order], [1.0])
            assert section.log[-1].text


def test_a_wind_that_would_turn_is_refused(any_model):
    with any_model.section() as section:
        section.initialize(wind_speed=1.0)
        section.ramp(wind_speed=-10.0)
        with pytest.raises(FMICallException):
            section.fmu.doStep(0.0, 1.0)
        assert any("wind" in m.text for m in section.log)
