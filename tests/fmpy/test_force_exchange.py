"""Forces alone with the importer integrating their filters."""

import fmpy
import numpy as np
import pytest
from driven import Motion, integrated, stepped
from exported import FOLDER
from fmpy.fmi1 import FMICallException
from fmpy.model_description import read_model_description

OUTPUTS = ["lift", "moment"]
# as in test_model_exchange.py
AGREEMENT = 1e-5
KINDS = ["continuous_laguerre", "rational"]


@pytest.mark.parametrize(("name", "gusts"), [("force", {}), ("gusts_force", {"gust_w": 3.0})])
@pytest.mark.parametrize("wind", [0.0, 5.0, 40.0, 90.0])
def test_cvode_finds_the_forces_of_the_steps(name, gusts, wind, tmp_path):
    fmu = FOLDER / f"{name}.fmu"
    motion = Motion({"heave": 0.4, "rotation": 0.02}, 5.0, gusts)
    own = stepped(fmu, tmp_path, motion, OUTPUTS, wind_speed=wind)
    foreign = integrated(fmu, tmp_path, motion, OUTPUTS, wind_speed=wind)
    size = np.abs(own).max(axis=0)
    assert (size > 0.0).all()
    assert (np.abs(own - foreign) <= AGREEMENT * size).all()


@pytest.mark.parametrize("kind", KINDS)
def test_both_shells_integrate_alike(kind):
    """Three strips, named one by one and as arrays, in steps of the importer's that are the same."""
    times = np.linspace(0.0, 1.0, 1001)
    motion = Motion({"heave": 0.02, "rotation": 0.01}, 1.0)
    names = list(motion.at(0.0))
    scales = np.array([1.0, 0.5, -2.0])
    one_by_one = [(f"strip[{s + 1}].{name}", "f8") for s in range(3) for name in names]
    two = np.zeros(len(times), [("time", "f8"), *one_by_one])
    three = np.zeros(len(times), [("time", "f8"), *((name, "f8", (3,)) for name in names)])
    two["time"] = three["time"] = times
    for name in names:
        three[name] = np.array([motion.at(t)[name] for t in times])[:, None] * scales
        for s in range(3):
            two[f"strip[{s + 1}].{name}"] = three[name][:, s]
    options = {
        "fmi_type": "ModelExchange", "solver": "Euler", "step_size": 1e-3, "stop_time": 1.0,
        "output_interval": 0.02, "start_values": {"wind_speed": 20.0},
    }  # fmt: skip
    apart = fmpy.simulate_fmu(
        str(FOLDER / f"fmi2_force_{kind}.fmu"), input=two,
        output=[f"strip[{s + 1}].lift" for s in range(3)], **options,
    )  # fmt: skip
    arrays = fmpy.simulate_fmu(
        str(FOLDER / f"fmi3_force_{kind}.fmu"), input=three, output=["lift"], **options
    )
    assert np.ptp(arrays["lift"]) > 0.0
    for s in range(3):
        assert np.array_equal(apart[f"strip[{s + 1}].lift"], arrays["lift"][:, s]), s


def test_displacements_alone_are_refused():
    rows = np.array([(0.0, 0.0), (1.0, 0.4)], [("time", "f8"), ("heave", "f8")])
    said = []
    with pytest.raises(FMICallException):
        fmpy.simulate_fmu(
            str(FOLDER / "force.fmu"), fmi_type="ModelExchange", stop_time=1.0,
            input=rows, logger=lambda *words: said.append(str(words[-1])),
        )  # fmt: skip
    assert any("`heave_rate` has never been set" in text for text in said)


@pytest.mark.parametrize("name", ["force", "force_strips", "gusts_force"])
def test_what_the_archive_offers(name):
    description = read_model_description(str(FOLDER / f"{name}.fmu"))
    exchange = description.modelExchange
    assert exchange.providesDirectionalDerivative and exchange.canGetAndSetFMUstate
    rates = [u.variable for u in description.derivatives]
    filters = {v.name: v for v in description.modelVariables}["filters"]
    lags = 8 if "gusts" in name else 0
    strips = 3 if "strips" in name else 1
    assert len(rates) == strips * (int(filters.start) + lags)
    for rate in rates:
        assert rate.name == f"der({rate.derivative.name})"
