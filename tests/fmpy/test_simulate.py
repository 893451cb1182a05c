"""`simulate_fmu` as a user would call it."""

import fmpy
import numpy as np
from growth import growth
from section import MOTION, OUTPUTS, STATUS


def test_default_arguments_show_a_deck_just_below_onset(model):
    result = fmpy.simulate_fmu(str(model.fmu))
    experiment = model.description.defaultExperiment
    assert list(result.dtype.names) == ["time", *OUTPUTS, *STATUS]
    assert result["time"][0] == 0.0
    assert result["time"][-1] == float(experiment.stopTime)
    # FMPy doubles the default step until no more than a thousand are left: it must have had no reason to
    assert np.allclose(np.diff(result["time"]), float(experiment.stepSize), rtol=1e-9)
    for name in OUTPUTS:
        assert np.isfinite(result[name]).all()
    rotation = result["rotation"]
    crossings = np.count_nonzero(np.diff(np.sign(rotation)))
    frequency = crossings / 2 / result["time"][-1]
    assert abs(frequency / model.expected["onset"]["frequency_hz"] - 1) < 0.1
    assert 0.01 * np.abs(rotation).max() < np.abs(rotation[-200:]).max() < np.abs(rotation).max()


def test_growth_is_that_of_the_eigenvalues(continuous_model):
    # the FMU's own default experiment, long after the filters have settled
    result = fmpy.simulate_fmu(str(continuous_model.fmu), stop_time=8.0, output=MOTION)
    step = result["time"][1]
    late = result["time"] > 4.0
    rows = np.column_stack([result[name][late] for name in MOTION])
    rate, frequency = growth(rows, step)
    expected = continuous_model.expected["default_mode"]
    assert abs(rate - expected["growth_1_s"]) < 1e-4
    assert abs(frequency / expected["frequency_hz"] - 1) < 1e-5


def test_faster_wind_flutters(model):
    speed = 1.05 * model.expected["onset"]["speed_m_s"]
    result = fmpy.simulate_fmu(str(model.fmu), start_values={"wind_speed": speed}, stop_time=10.0)
    rotation = np.abs(result["rotation"])
    assert rotation[-200:].max() > 2 * rotation[:200].max()


def test_start_and_stop_anywhere(model):
    early = fmpy.simulate_fmu(str(model.fmu), stop_time=1.0, output=MOTION)
    late = fmpy.simulate_fmu(str(model.fmu), start_time=-2.5, stop_time=-1.5, output=MOTION)
    for name in MOTION:
        # the same motion up to the last bits of t_next - t
        assert np.allclose(early[name], late[name], rtol=0, atol=1e-12 * np.abs(early[name]).max())


def test_steps_far_longer_than_the_motion(any_model):
    result = fmpy.simulate_fmu(
        str(any_model.fmu), stop_time=600.0, output_interval=20.0, output=MOTION
    )
    assert len(result) == 31 and result["time"][-1] == 600.0
    # ten minutes below onset: at rest
    assert np.abs(result["rotation"][-1]) < 1e-6
