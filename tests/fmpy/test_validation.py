"""What can be judged without running: archive and description."""

import zipfile
from pathlib import Path

import pytest
from exported import MODELS
from fmpy.validation import validate_fmu


def test_fmpy_finds_no_problem(model):
    assert validate_fmu(str(model.fmu)) == []


@pytest.mark.parametrize("kind", [kind for kind in MODELS if MODELS[kind]["description"]])
def test_description_is_the_committed_one(models, kind):
    golden = Path(MODELS[kind]["description"])
    with zipfile.ZipFile(models[kind].fmu) as archive:
        assert archive.read("modelDescription.xml") == golden.read_bytes()


def test_archive_is_complete_and_plain(model):
    with zipfile.ZipFile(model.fmu) as archive:
        assert archive.testzip() is None
        names = archive.namelist()
        for entry in archive.infolist():
            # stored or deflated, not encrypted, no link, forward slashes, relative
            assert entry.compress_type in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
            assert entry.flag_bits & 1 == 0
            assert (entry.external_attr >> 16) & 0o170000 != 0o120000
            assert "\\" not in entry.filename and not entry.filename.startswith("/")
    for needed in [
        "modelDescription.xml",
        "model.png",
        "resources/model.json",
        "documentation/index.html",
    ]:
        assert needed in names
    assert any(n.startswith("documentation/licenses/") for n in names)
    assert any(n.startswith("binaries/") and "aerodeck_section" in n for n in names)


def test_capabilities_are_the_complete_set(model):
    cs = model.description.coSimulation
    assert cs.canHandleVariableCommunicationStepSize
    assert cs.canInterpolateInputs
    assert cs.maxOutputDerivativeOrder >= 1
    assert cs.canGetAndSetFMUstate
    assert cs.canSerializeFMUstate
    assert cs.providesDirectionalDerivative
    assert cs.canNotUseMemoryManagementFunctions
    assert not cs.canBeInstantiatedOnlyOncePerProcess
    assert not cs.canRunAsynchronuously
