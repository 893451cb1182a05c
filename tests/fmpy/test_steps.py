"""The motion does not depend on how the importer cuts time into steps."""

import math
import random

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from section import MOTION, OUTPUTS


def close(a, b, tolerance):
    """Columns equal relative to the largest value of each."""
    scale = np.abs(a).max(axis=0)
    return (np.abs(a - b) <= tolerance * scale).all()


def run_through(section, points, names=OUTPUTS):
    """Outputs at the end of steps from point to point, after a reset."""
    section.fmu.reset()
    section.initialize()
    for start, end in zip(points[:-1], points[1:]):
        section.fmu.doStep(start, end - start)
    return np.array(section.get(*names))


def test_two_step_sizes_agree(model):
    with model.section() as section:
        fine = section.initialize().steps(1000, 0.005)
        section.fmu.reset()
        coarse = section.initialize().steps(100, 0.05)
    # a thousand steps of rounding on a motion that keeps its size
    assert close(fine[9::10], coarse, 1e-10)


def test_one_step_is_two_halves(continuous_model):
    with continuous_model.section() as section:
        whole = section.initialize().steps(100, 0.02)
        section.fmu.reset()
        halves = section.initialize().steps(200, 0.01)
    assert close(whole, halves[1::2], 1e-12)


def test_variable_steps(model):
    generator = random.Random(5)
    cuts = sorted(generator.uniform(0.0, 3.0) for _ in range(200))
    with model.section() as section:
        regular = run_through(section, [n * 0.01 for n in range(301)])
        irregular = run_through(section, [0.0, *cuts, 3.0])
        at_once = run_through(section, [0.0, 3.0])
    scale = np.abs(regular)
    assert (np.abs(irregular - regular) <= 1e-9 * scale).all()
    assert (np.abs(at_once - regular) <= 1e-9 * scale).all()


def test_steps_jitter_in_the_last_bits(model):
    # t_next - t of accumulated points, as FMPy computes it
    points = [0.0]
    while points[-1] < 5.0 - 1e-6:
        points.append(points[-1] + 0.01)
    sizes = {b - a for a, b in zip(points[:-1], points[1:])}
    assert len(sizes) > 5
    with model.section() as section:
        jittering = run_through(section, points)
        regular = section.fmu.reset() or section.initialize().steps(500, 0.01)[-1]
    assert (np.abs(jittering - regular) <= 1e-9 * np.abs(regular)).all()


def test_communication_points_may_be_off_by_rounding_only(any_model):
    with any_model.section() as section:
        section.initialize()
        section.fmu.doStep(0.0, 0.01)
        section.fmu.doStep(math.nextafter(0.01, 1.0), 0.01)
        with pytest.raises(FMICallException):
            section.fmu.doStep(0.5, 0.01)


def test_clock_after_many_steps_and_a_late_start(any_model):
    # own clock and importer's clock must not drift apart
    with any_model.section() as section:
        section.initialize(start_time=1e6)
        for n in range(2000):
            section.fmu.doStep(1e6 + n * 0.001, 0.001)
        late = section.get(*MOTION)
        section.fmu.reset()
        early = section.initialize().steps(2000, 0.001, names=MOTION)[-1]
    assert late == pytest.approx(list(early), rel=1e-9)


def test_last_partial_step(model):
    # 0.7 does not fit into 2: FMPy cuts the last step
    partial = fmpy.simulate_fmu(str(model.fmu), stop_time=2.0, output_interval=0.7, output=MOTION)
    whole = fmpy.simulate_fmu(str(model.fmu), stop_time=2.0, output_interval=0.01, output=MOTION)
    assert list(partial["time"]) == pytest.approx([0.0, 0.7, 1.4, 2.0])
    for name in MOTION:
        assert partial[name][-1] == pytest.approx(whole[name][-1], rel=1e-9)


def test_stop_time_is_kept(any_model):
    with any_model.section() as section:
        section.initialize(stop_time=1.0)
        section.fmu.doStep(0.0, 0.9)
        # rounding beyond the end is none of the importer's fault
        section.fmu.doStep(0.9, 0.1 + 1e-13)
        with pytest.raises(FMICallException):
            section.fmu.doStep(1.0, 0.5)
        assert any("stop" in text for text in section.said(3))
