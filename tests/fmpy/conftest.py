"""Fixtures. `cargo test --test fmpy` runs this suite; once that has made the FMUs and the environment, by hand:

    AERODECK_FMUS=target/tmp/fmpy target/python-env/bin/python -m pytest tests/fmpy
"""

import pytest
from exported import MODELS, Model


@pytest.fixture(scope="session")
def models(tmp_path_factory):
    """All exported models by name."""
    # a blank and a letter beyond ASCII: the resource location has to be decoded
    folder = tmp_path_factory.mktemp("Brücke 1")
    return {kind: Model(kind, folder) for kind in MODELS}


@pytest.fixture(params=list(MODELS))
def model(request, models):
    """Every exported model in turn."""
    return models[request.param]


@pytest.fixture(params=[kind for kind in MODELS if "discrete" not in kind])
def continuous_model(request, models):
    """Every exported model that is continuous in time."""
    return models[request.param]


@pytest.fixture
def any_model(models):
    """One model, for what does not depend on the kind."""
    return models["continuous_laguerre"]
