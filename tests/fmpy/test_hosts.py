"""What particular hosts do differently: call orders of their own, real variables alone."""

import fmpy
import pytest
from exported import FOLDER, MODELS, Model
from fmpy.model_description import read_model_description
from fmpy.simulation import apply_start_values
from fmpy.validation import validate_fmu
from section import OUTPUTS, Section

COMMITTED = [kind for kind in MODELS if MODELS[kind]["description"]]


@pytest.mark.parametrize("unit", ["section", "force"])
@pytest.mark.parametrize("kind", COMMITTED)
def test_real_variables_alone(unit, kind, tmp_path):
    path = FOLDER / f"reals_{unit}_{kind}.fmu"
    assert validate_fmu(str(path)) == []
    description = read_model_description(str(path))
    assert {v.type for v in description.modelVariables} == {"Real"}
    fmpy.extract(str(path), unzipdir=str(tmp_path))
    with Section(tmp_path, description) as instance:
        instance.initialize()
        for n in range(5):
            instance.fmu.doStep(0.1 * n, 0.1)
        outputs = [v.name for v in description.modelVariables if v.causality == "output"]
        assert len(outputs) > 3
        instance.get(*outputs)


@pytest.mark.parametrize("kind", COMMITTED)
def test_real_variables_alone_move_alike(kind, models, tmp_path):
    path = FOLDER / f"reals_section_{kind}.fmu"
    description = read_model_description(str(path))
    fmpy.extract(str(path), unzipdir=str(tmp_path))
    with models[kind].section() as full, Section(tmp_path, description) as reals:
        expected = full.initialize(wind_speed=25.0).steps(50, 0.02)
        assert reals.initialize(wind_speed=25.0).steps(50, 0.02).tobytes() == expected.tobytes()


def test_the_calls_of_precice(model: Model):
    """Its runner (fmiprecice 0.2.1) sets up no experiment, sets parameters in the initialisation mode, reads outputs
    before the first step, saves and restores the state at every step of an implicit coupling."""
    wind = {"wind_speed": 25.0, "initial_rotation": 0.02}
    with model.section() as section:
        section.initialize(**wind)
        expected = section.steps(20, 0.05)
    with model.section() as section:
        fmu = section.fmu
        fmu.enterInitializationMode()
        apply_start_values(fmu, model.description, wind)
        fmu.exitInitializationMode()
        fmu.getReal(section.references(OUTPUTS))
        inputs = section.references(["external_lift", "external_moment"])
        outputs = section.references(OUTPUTS)
        for n in range(20):
            checkpoint = fmu.getFMUState()
            for guess in ([1e3, -1e3], [0.0, 0.0]):
                fmu.setReal(inputs, guess)
                fmu.doStep(n * 0.05, 0.05)
                found = fmu.getReal(outputs)
                if guess[0]:
                    fmu.setFMUState(checkpoint)
            fmu.freeFMUState(checkpoint)
            assert list(expected[n]) == found
        assert any("not been set up" in m.text for m in section.log)
        fmu.terminate()
