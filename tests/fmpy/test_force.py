"""The force FMU beside a structure of our own: where it flutters, strips, non-linear structures, wrong input."""

import json
import zipfile

import numpy as np
import pytest
from exported import FOLDER
from fmpy import extract
from fmpy.fmi1 import FMICallException
from fmpy.model_description import read_model_description
from fmpy.validation import validate_fmu
from foreign_structure import (
    ONSET, PERIOD, explicit, extrapolating, growth, implicit, in_one_piece, staggered,
)  # fmt: skip
from section import DISCARD, ERROR, Section


class Forces:
    """An exported force FMU."""

    def __init__(self, name, folder):
        self.fmu = FOLDER / f"{name}.fmu"
        self.unpacked = folder / name
        extract(str(self.fmu), unzipdir=str(self.unpacked))
        self.description = read_model_description(str(self.fmu))

    def start(self, **values):
        """An instance at the first communication point."""
        return Section(self.unpacked, self.description).initialize(**values)


@pytest.fixture(scope="module")
def single(tmp_path_factory):
    return Forces("force", tmp_path_factory.mktemp("force"))


@pytest.fixture(scope="module")
def strips(tmp_path_factory):
    return Forces("force_strips", tmp_path_factory.mktemp("strips"))


def onset(forces, master, parts, prediction=None, rates=False, periods=60):
    """Wind speed of zero growth between two near the onset."""
    step = PERIOD / parts
    speeds, found = (0.995 * ONSET, 1.005 * ONSET), []
    for wind in speeds:
        extra = {} if prediction is None else {"prediction": prediction}
        with forces.start(wind_speed=wind, heave=0.2, rotation=0.01, **extra) as force:
            found.append(growth(master(force, step, periods * parts, rates=rates), step))
    low, high = found
    return speeds[0] - low * (speeds[1] - speeds[0]) / (high - low)


def test_fmpy_finds_no_problem(single, strips):
    for forces in (single, strips):
        assert validate_fmu(str(forces.fmu)) == []
        with zipfile.ZipFile(forces.fmu) as archive:
            assert "resources/force.json" in archive.namelist()


@pytest.mark.parametrize(
    ("rates", "parts", "goal"),
    [(False, 100, 0.001), (False, 50, 0.005), (True, 100, 0.0005), (True, 50, 0.003)],
)
def test_an_explicit_master_finds_the_onset(single, rates, parts, goal):
    found = onset(single, explicit, parts, rates=rates) / ONSET - 1
    print(f"explicit, T/{parts}, rates {rates}: {100 * found:+.3f} %")
    assert abs(found) < goal


def test_without_prediction_the_onset_is_too_high(single):
    assert onset(single, explicit, 100, prediction=0.0) > 1.03 * ONSET


def test_other_masters_find_it_with_their_prediction(single):
    one_after_the_other = onset(single, staggered, 100, prediction=0.5) / ONSET - 1
    print(f"staggered {100 * one_after_the_other:+.3f} %")
    assert abs(one_after_the_other) < 0.001
    extrapolated = onset(single, extrapolating, 100, prediction=1.0) / ONSET - 1
    iterated = onset(single, implicit, 50, prediction=0.0, rates=True, periods=30) / ONSET - 1
    print(f"extrapolating {100 * extrapolated:+.3f} %, implicit {100 * iterated:+.3f} %")
    assert abs(extrapolated) < 0.002
    assert abs(iterated) < 0.002
    # with the default, meant for others, no worse than without prediction
    unadapted = onset(single, extrapolating, 100) / ONSET - 1
    late = onset(single, extrapolating, 100, prediction=0.0) / ONSET - 1
    print(f"extrapolating with the default {100 * unadapted:+.3f} %, without {100 * late:+.3f} %")
    assert abs(unadapted) <= abs(late)


def test_a_nonlinear_structure_reaches_the_same_limit_cycle(single):
    wind, spring, parts = 1.06 * ONSET, 4e7, 200
    step = PERIOD / parts
    with zipfile.ZipFile(single.fmu) as archive:
        model = json.loads(archive.read("resources/model.json"))["model"]
    periods = 120
    whole = in_one_piece(model, wind, periods * PERIOD, spring, step)
    with single.start(wind_speed=wind, heave=0.2, rotation=0.01) as force:
        beside = explicit(force, step, periods * parts, rates=True, spring=spring)
    last = slice(-20 * parts, None)
    expected, found = np.abs(whole[last, 1]).max(), np.abs(beside[last, 1]).max()
    print(f"limit cycle {expected:.5f} rad, beside the FMU {found:.5f} rad")
    assert expected > 0.02
    assert found == pytest.approx(expected, rel=1e-3)


def test_strips_are_single_forces_side_by_side(single, strips):
    def moved(t, scale):
        return {"heave": 0.3 * scale * np.sin(t), "rotation": 0.02 * scale * np.cos(1.3 * t)}

    scales = [1.0, -0.5, 2.0]
    factors = [1.0, 1.2, 0.5]
    both = ("lift", "moment")
    with strips.start(wind_speed=30.0) as three:
        three.set(**{f"strip[{i + 1}].wind_factor": f for i, f in enumerate(factors)})
        three.set(**{"strip[2].length": 40.0})
        apart = []
        for factor, scale in zip(factors, scales, strict=True):
            with single.start(wind_speed=30.0 * factor) as one:
                for n in range(50):
                    one.set(**moved(0.1 * n, scale))
                    one.fmu.doStep(0.1 * n, 0.1)
                apart.append(one.get(*both))
        for n in range(50):
            for i, scale in enumerate(scales):
                values = moved(0.1 * n, scale)
                three.set(**{f"strip[{i + 1}].{k}": v for k, v in values.items()})
            three.fmu.doStep(0.1 * n, 0.1)
        for i, expected in enumerate(apart):
            assert three.get(*(f"strip[{i + 1}].{name}" for name in both)) == expected
        per_length, total = three.get("strip[2].lift", "strip[2].total_lift")
        assert total == 40.0 * per_length


def test_motion_set_before_reading_counts(single):
    """Newer motion of the same point of time moves the force; derivatives say how."""
    with single.start(wind_speed=40.0) as force:
        for n in range(20):
            force.set(heave=0.1 * np.sin(0.3 * n), rotation=0.01 * np.cos(0.2 * n))
            force.fmu.doStep(0.1 * n, 0.1)
        knowns, unknowns = ["heave", "rotation", "wind_speed"], ["lift", "moment"]
        force.set(heave=0.05, rotation=0.004)
        exact = [
            force.fmu.getDirectionalDerivative(
                force.references(unknowns), force.references([known]), [1.0]
            )
            for known in knowns
        ]
        for known, column in zip(knowns, exact, strict=True):
            (value,) = force.get(known)
            ends = []
            for end in (value + 1e-3, value - 1e-3):
                force.set(**{known: end})
                ends.append(np.array(force.get(*unknowns)))
            force.set(**{known: value})
            assert column == pytest.approx((ends[0] - ends[1]) / 2e-3, rel=1e-5)


def test_rates_by_input_derivatives_are_rates(single):
    """An importer that sets input derivatives need not connect rates."""
    found = []
    for by_derivative in (False, True):
        with single.start(wind_speed=40.0) as force:
            for n in range(20):
                t = 0.1 * n
                force.set(heave=0.1 * np.sin(t))
                if by_derivative:
                    force.ramp(heave=0.1 * np.cos(t))
                else:
                    force.set(heave_rate=0.1 * np.cos(t))
                force.fmu.doStep(t, 0.1)
            found.append(force.get("lift", "moment"))
    assert found[0] == pytest.approx(found[1], rel=1e-12)


def test_wrong_input_is_refused_and_nothing_is_lost(single):
    with single.start(wind_speed=20.0) as force:
        force.set(heave=0.1)
        force.fmu.doStep(0.0, 0.1)
        for values in ({"prediction": 3.5}, {"prediction": -0.1}, {"width": 0.0}, {"wind_speed": -1.0}):
            with pytest.raises(FMICallException):
                force.set(**values)
        assert len(force.said(DISCARD)) == 4
        force.set(wind_speed=1e12)
        with pytest.raises(FMICallException):
            force.fmu.doStep(0.1, 0.1)
        assert "parts" in force.said(DISCARD)[-1]
    for values, ramp, words in [
        ({}, {"wind_speed": -400.0}, "zero or a positive wind speed"),
        ({"heave": 1e305, "wind_speed": 1e5}, {}, "overflow"),
    ]:
        with single.start(wind_speed=20.0) as force:
            force.set(**values)
            force.ramp(**ramp)
            with pytest.raises(FMICallException):
                force.fmu.doStep(0.0, 0.1)
            assert words in force.said(DISCARD)[-1]
    with single.start(wind_speed=20.0) as force:
        force.set(rotation=0.3)
        for n in range(3):
            force.fmu.doStep(0.1 * n, 0.1)
        assert len([m for m in force.log if "beyond linear theory" in m.text]) == 1
    with single.start(wind_speed=20.0) as force:
        with pytest.raises(FMICallException):
            force.set(heave=float("nan"))
        assert "`heave`: expected a finite number" in force.said(ERROR)[-1]


def test_calm_air_gives_added_mass_alone(single):
    with single.start(wind_speed=0.0) as force:
        for n in range(200):
            t = 0.01 * n
            sine, cosine = 0.1 * np.sin(t), 0.1 * np.cos(t)
            force.set(heave=sine, heave_rate=cosine, heave_acceleration=-sine)
            force.fmu.doStep(t, 0.01)
        ahead = 0.01 * 199 + 1.5 * 0.01
        # half of the density, width squared, pi/2 of Jones's functions
        expected = 0.5 * 1.22 * 31.0**2 * (np.pi / 2) * 0.1 * np.sin(ahead)
        assert force.get("lift")[0] == pytest.approx(expected, rel=1e-3)
