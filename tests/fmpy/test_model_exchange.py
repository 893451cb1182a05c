"""The importer integrates: CVode of FMPy against the FMU's own steps."""

import fmpy
import numpy as np
import pytest
from section import MOTION, OUTPUTS

# what CVode is asked for, relative; it keeps each step to it, and two seconds hold some thousand of them, whose errors add up
SOLVER = 1e-9
AGREEMENT = 1e4 * SOLVER


def both(model, start_values, **options):
    """The same run in both interfaces."""
    options = {"stop_time": 2.0, "output_interval": 0.01, "output": OUTPUTS, **options}
    run = lambda kind, **more: fmpy.simulate_fmu(
        str(model.fmu), fmi_type=kind, start_values=start_values, **options, **more
    )
    return run("CoSimulation"), run("ModelExchange", solver="CVode", relative_tolerance=SOLVER)


@pytest.mark.parametrize("of_onset", [0.0, 0.3, 1.0, 1.1])
def test_cvode_moves_as_the_steps_do(continuous_model, of_onset):
    speed = of_onset * continuous_model.expected["onset"]["speed_m_s"]
    own, foreign = both(continuous_model, {"wind_speed": speed, "external_lift": 2.0})
    assert len(own) == len(foreign)
    for name in OUTPUTS:
        size = np.abs(own[name]).max()
        assert np.abs(own[name] - foreign[name]).max() <= AGREEMENT * size, name


def test_what_the_archive_offers(model):
    continuous = not model.sampled
    assert (model.description.modelExchange is not None) == continuous
    if continuous:
        assert model.description.modelExchange.providesDirectionalDerivative
        assert model.description.modelExchange.canGetAndSetFMUstate
    variables = {v.name: v for v in model.description.modelVariables}
    rates = [u.variable for u in model.description.derivatives]
    assert model.description.numberOfContinuousStates == len(rates)
    assert len(rates) == (len(MOTION) + int(variables["filters"].start) if continuous else 0)
    for rate in rates:
        # a rate of a state is never its own
        assert rate.derivative is not None and rate.derivative.name != rate.name
