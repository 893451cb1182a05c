"""What `export_fmu` can ask for, read back by FMPy."""

import json
import zipfile

import aerodeck
import numpy as np
import pytest

fmpy = pytest.importorskip("fmpy")


def described(path):
    return fmpy.read_model_description(str(path))


@pytest.mark.parametrize(("fmi", "version"), [(2, "2.0"), (3, "3.0")])
def test_both_versions_of_the_standard_move_alike(tmp_path, section, model, fmi, version):
    path = tmp_path / "deck.fmu"
    aerodeck.export_fmu(path, section, model, fmi=fmi, wind_speed_m_s=30.0, name="Deck", author="A", copyright="C")
    head = described(path)
    assert (head.fmiVersion, head.modelName, head.author, head.copyright) == (version, "Deck", "A", "C")
    result = fmpy.simulate_fmu(str(path), stop_time=1.0, output_interval=0.01, output=["rotation"])
    expected = aerodeck.simulate(section, model, 30.0, stop_time_s=1.0).displacement[:, 1]
    np.testing.assert_allclose(result["rotation"], expected, atol=1e-9 * np.abs(expected).max())


def test_the_interval_goes_with_the_section(tmp_path, section, model):
    path = tmp_path / "deck.fmu"
    aerodeck.export_fmu(path, section, model)
    with zipfile.ZipFile(path) as archive:
        carried = json.loads(archive.read("resources/onset_interval.json"))
    low, high = aerodeck.flutter(section, model).interval
    np.testing.assert_allclose([carried["low_m_s"], carried["high_m_s"]], [low, high], rtol=1e-9)


def test_gusts_become_inputs(tmp_path, section, model):
    path = tmp_path / "deck.fmu"
    aerodeck.export_fmu(path, section, model, gusts="flat plate", admittance="sears")
    names = {v.name for v in described(path).modelVariables}
    aerodeck.export_fmu(path, section, model, overwrite=True)
    without = {v.name for v in described(path).modelVariables}
    assert without < names and any("gust" in n for n in names - without)
    with pytest.raises(aerodeck.InputError, match="coefficients"):
        aerodeck.export_fmu(path, section, model, admittance="sears", overwrite=True)


def test_strips_of_forces(tmp_path, section, model):
    path = tmp_path / "force.fmu"
    aerodeck.export_fmu(path, section, model, kind="force", strips=[(0.5, 1.0), (0.4, 2.0)], prediction=0.0)
    variables = {v.name: v for v in described(path).modelVariables}
    assert "strip[2].heave" in variables and float(variables["prediction"].start) == 0.0
    for wrong in ({"strips": [(0.5, 1.0)]}, {"prediction": 1.0}, {"kind": "nonsense"}, {"fmi": 1}):
        with pytest.raises(aerodeck.InputError):
            aerodeck.export_fmu(tmp_path / "none.fmu", section, model, **wrong)
    assert not (tmp_path / "none.fmu").exists()


def test_reals_only_and_platforms(tmp_path, section, model):
    path = tmp_path / "deck.fmu"
    aerodeck.export_fmu(path, section, model, reals_only=True)
    assert {v.type for v in described(path).modelVariables} == {"Real"}
    with pytest.raises(aerodeck.InputError, match="platform"):
        aerodeck.export_fmu(path, section, model, platforms=["nowhere"], overwrite=True)
