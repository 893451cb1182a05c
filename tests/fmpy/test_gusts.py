"""Gusts as inputs of the section and of its forces alone."""

import zipfile

import fmpy
import numpy as np
import pytest
from exported import FOLDER
from fmpy.model_description import read_model_description
from fmpy.validation import validate_fmu
from foreign_structure import START, held
from section import Section

WIND, STEP, COUNT = 40.0, 0.02, 3000


def gust(n):
    """Two sines of incommensurable periods, slow against the step."""
    t = n * STEP
    return np.sin(2 * np.pi * 0.13 * t) + 0.5 * np.cos(2 * np.pi * 0.31 * t)


@pytest.fixture
def unpacked(tmp_path):
    def unpack(name):
        fmu = FOLDER / f"{name}.fmu"
        fmpy.extract(str(fmu), unzipdir=str(tmp_path / name))
        return Section(tmp_path / name, read_model_description(str(fmu)))

    return unpack


@pytest.mark.parametrize("name", ["gusts_section", "gusts_force"])
def test_fmpy_finds_no_problem(name):
    fmu = FOLDER / f"{name}.fmu"
    assert validate_fmu(str(fmu)) == []
    with zipfile.ZipFile(fmu) as archive:
        assert "resources/gusts.json" in archive.namelist()


def section_rows(section):
    rows = [START[:2]]
    with section.initialize(
        wind_speed=WIND, gust_w=gust(0), initial_heave=START[0], initial_rotation=START[1]
    ) as section:
        vr = section.references(["gust_w"])
        for n in range(COUNT):
            section.set(gust_w=gust(n))
            section.fmu.setRealInputDerivatives(vr, [1], [(gust(n + 1) - gust(n)) / STEP])
            section.fmu.doStep(n * STEP, STEP)
            rows.append(section.get("heave", "rotation"))
    return np.array(rows)


def foreign_rows(force):
    """An explicit master: the structure holds the force that it has read at the beginning of its step."""
    exact, driven, _ = held(STEP)
    x, rows = START.copy(), [START[:2]]
    with force.initialize(
        wind_speed=WIND, gust_w=gust(0), heave=x[0], rotation=x[1], prediction=1.5
    ) as force:
        vr = force.references(["gust_w"])
        for n in range(COUNT):
            acting = np.array(force.get("lift", "moment"))
            force.set(
                heave=x[0], rotation=x[1], heave_rate=x[2], rotation_rate=x[3], gust_w=gust(n)
            )
            force.fmu.setRealInputDerivatives(vr, [1], [(gust(n + 1) - gust(n)) / STEP])
            force.fmu.doStep(n * STEP, STEP)
            x = exact @ x + driven @ acting
            rows.append(x[:2])
    return np.array(rows)


def test_a_structure_outside_feels_the_gusts_of_the_section(unpacked):
    one, two = section_rows(unpacked("gusts_section")), foreign_rows(unpacked("gusts_force"))
    late = slice(COUNT // 2, None)
    for column in range(2):
        size = np.abs(one[late, column]).max()
        off = np.abs(one[late, column] - two[late, column]).max() / size
        print(f"column {column}: {off:.2e}")
        assert off < 2e-3


def test_gusts_move_a_section_at_rest(unpacked):
    with unpacked("gusts_section").initialize(wind_speed=WIND) as section:
        section.set(gust_u=2.0)
        section.fmu.doStep(0.0, 1.0)
        # the plate has no drag: a gust along the wind exerts nothing
        still = section.get("heave")
        section.set(gust_u=0.0, gust_w=1.0)
        section.fmu.doStep(1.0, 1.0)
        moved = section.get("heave")
    assert np.abs(np.subtract(still, moved)) > 1e-3
