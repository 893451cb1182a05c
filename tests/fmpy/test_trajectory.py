"""A run of the FMU is the same computation as in process: equal bit for bit."""

import pytest
from exported import MODELS, number, numbers

CASES = [(kind, i) for kind in MODELS for i in range(len(MODELS[kind]["trajectories"]))]


@pytest.mark.parametrize(
    "kind, index", CASES, ids=[f"{k}-{MODELS[k]['trajectories'][i]['name']}" for k, i in CASES]
)
def test_equal_bit_for_bit(models, kind, index):
    run = MODELS[kind]["trajectories"][index]
    with models[kind].section() as section:
        section.initialize()
        wanted = [number(bits) for bits in run["initial_outputs"]]
        assert section.get(*run["outputs"]) == wanted
        for n, step in enumerate(run["steps"]):
            if step["set"]:
                section.set(**numbers(step["set"]))
            if step["rates"]:
                section.ramp(**numbers(step["rates"]))
            section.fmu.doStep(number(step["time"]), number(step["size"]))
            wanted = [number(bits) for bits in step["outputs"]]
            found = section.get(*run["outputs"])
            assert found == wanted, f"step {n} of {len(run['steps'])}"
