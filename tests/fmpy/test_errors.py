"""Whatever goes wrong: the right status, a reason in the log, and the process goes on."""

import json
import math
import shutil

import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import fmi2DoStepStatus, fmi2LastSuccessfulTime, fmi2Terminated
from section import DISCARD, ERROR, OUTPUTS, Refused, Section


def fails(section, status, reason, call, *arguments):
    """The call returns `status` and the log names the reason."""
    before = len(section.log)
    with pytest.raises(FMICallException) as failure:
        call(*arguments)
    assert failure.value.status == status
    new = section.log[before:]
    assert any(reason in m.text and m.status == status for m in new), (reason, new)
    # the name of the function comes first, so that a user finds the call
    assert any(failure.value.function in m.text for m in new), new


def works(model):
    """A new instance still does what it should."""
    with model.section() as section:
        rows = section.initialize().steps(3, 0.01)
        assert all(math.isfinite(x) for x in rows.ravel())


# ------------------------------------------------------------------ instantiation


def test_wrong_guid(any_model):
    for guid in ["{00000000-0000-0000-0000-000000000000}", "", "nonsense"]:
        with pytest.raises(Refused, match="(?i)guid"):
            any_model.section(guid=guid or " ")
    works(any_model)


@pytest.fixture
def copy(any_model, tmp_path):
    """An unpacked archive to be spoilt."""
    return shutil.copytree(any_model.unpacked, tmp_path / "copy")


def test_missing_model(any_model, copy):
    (copy / "resources" / "model.json").unlink()
    with pytest.raises(Refused, match="model.json"):
        Section(copy, any_model.description)
    works(any_model)


def spoil(text, how):
    data = json.loads(text)
    match how:
        case "cut":
            return text[: len(text) // 2]
        case "empty":
            return ""
        case "no text":
            return text.replace("{", "\udcff", 1)
        case "not JSON":
            return "wind = 38.0"
        case "schema":
            data["schema_version"] = 999
        case "key":
            data["surplus"] = 1
        case "negative mass":
            data["section"]["vertical"]["mass_kg_m"] = -15.0
        case "other number":
            data["section"]["vertical"]["mass_kg_m"] += 1e-9
    return json.dumps(data, indent=2)


@pytest.mark.parametrize(
    "how, reasons",
    [
        ("cut", ["line"]),
        ("empty", ["line"]),
        ("no text", ["UTF-8"]),
        ("not JSON", ["line 1"]),
        ("schema", ["schema_version", "expected 1", "999"]),
        ("key", ["surplus"]),
        ("negative mass", ["mass_kg_m", "-15"]),
        ("other number", ["GUID"]),
    ],
)
def test_damaged_model(any_model, copy, how, reasons):
    file = copy / "resources" / "model.json"
    spoilt = spoil(file.read_text(encoding="utf-8"), how)
    file.write_bytes(spoilt.encode("utf-8", errors="surrogateescape"))
    with pytest.raises(Refused) as refusal:
        Section(copy, any_model.description)
    (message,) = [m for m in refusal.value.log if m.status >= ERROR]
    assert all(reason in message.text for reason in reasons), message.text
    if how != "other number":
        assert "model.json" in message.text
    works(any_model)


def test_model_of_another_export(any_model, models, copy):
    other = next(m for m in models.values() if m is not any_model)
    shutil.copy(other.unpacked / "resources" / "model.json", copy / "resources")
    with pytest.raises(Refused, match="GUID"):
        Section(copy, any_model.description)


def test_errors_are_logged_without_logging(any_model, copy):
    (copy / "resources" / "model.json").unlink()
    with pytest.raises(Refused, match="model.json"):
        Section(copy, any_model.description, logging=False)
    with any_model.section(logging=False) as section:
        section.initialize()
        assert section.log == []
        fails(section, ERROR, "-0.01", section.fmu.doStep, 0.0, -0.01)


# ------------------------------------------------------------------ values


def test_wrong_value_reference(any_model):
    with any_model.section() as section:
        section.initialize()
        fails(section, ERROR, "9999", section.fmu.getReal, [9999])
    with any_model.section() as section:
        section.initialize()
        fails(section, ERROR, "4294967295", section.fmu.setReal, [4294967295], [1.0])
    works(any_model)


def test_wrong_type(any_model):
    flag = any_model.description.modelVariables
    flag = next(v.valueReference for v in flag if v.name == "onset_found")
    for call in ("getReal", "getInteger", "getString"):
        with any_model.section() as section:
            section.initialize()
            fails(section, ERROR, "onset_found", getattr(section.fmu, call), [flag])
    with any_model.section() as section:
        section.initialize()
        wind = section.references(["wind_speed"])
        fails(section, ERROR, "wind_speed", section.fmu.setInteger, wind, [1])


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("name", ["wind_speed", "external_lift", "mass"])
def test_numbers_that_are_none(any_model, name, value):
    with any_model.section() as section:
        section.initialize()
        before = section.get("wind_speed", "external_lift", "mass", *OUTPUTS)
        fails(section, ERROR, name, section.fmu.setReal, section.references([name]), [value])
        # nothing has changed, but the run is over: an importer that goes on would not notice
        assert section.get("wind_speed", "external_lift", "mass", *OUTPUTS) == before
        fails(section, ERROR, "`error`", section.fmu.doStep, 0.0, 0.01)
        section.fmu.reset()
        section.initialize().steps(3, 0.01)


@pytest.mark.parametrize(
    "name, value",
    [
        ("wind_speed", -1.0),
        ("mass", 0.0),
        ("mass", -15.0),
        ("inertia", 0.0),
        ("width", -0.5),
        ("air_density", 0.0),
        ("heave_damping_ratio", -0.01),
        ("torsion_frequency", -5.0),
    ],
)
def test_values_out_of_range(any_model, name, value):
    with any_model.section() as section:
        section.initialize()
        before = section.get(name)
        fails(section, DISCARD, name, section.fmu.setReal, section.references([name]), [value])
        assert section.get(name) == before
        section.fmu.doStep(0.0, 0.01)


def test_several_values_are_set_all_or_none(any_model):
    with any_model.section() as section:
        section.initialize()
        before = section.get("external_lift", "wind_speed")
        references = section.references(["external_lift", "wind_speed"])
        fails(section, DISCARD, "wind_speed", section.fmu.setReal, references, [5.0, -1.0])
        assert section.get("external_lift", "wind_speed") == before


def test_what_cannot_be_set(any_model):
    for name in ["heave", "onset_speed"]:
        with any_model.section() as section:
            section.initialize()
            fails(section, ERROR, name, section.fmu.setReal, section.references([name]), [1.0])
    # fixed parameters not any more after initialisation
    with any_model.section() as section:
        section.initialize()
        reference = section.references(["initial_heave"])
        fails(section, ERROR, "initial_heave", section.fmu.setReal, reference, [1.0])


# ------------------------------------------------------------------ steps


@pytest.mark.parametrize("size", [0.0, -0.01, math.nan, math.inf])
def test_steps_that_are_none(any_model, size):
    with any_model.section() as section:
        section.initialize()
        fails(section, ERROR, "communication step", section.fmu.doStep, 0.0, size)
        fails(section, ERROR, "`error`", section.fmu.doStep, 0.0, 0.01)
        section.fmu.reset()
        section.initialize().steps(3, 0.01)


def test_a_motion_that_overflows(any_model):
    with any_model.section() as section:
        section.initialize(wind_speed=90.0)
        time, step = 0.0, 10.0
        with pytest.raises(FMICallException) as failure:
            for _ in range(1000):
                section.fmu.doStep(time, step)
                time += step
        assert failure.value.status == DISCARD
        assert any("overflowed" in text for text in section.said(DISCARD))
        assert section.fmu.getRealStatus(fmi2LastSuccessfulTime) == time
        assert section.fmu.getBooleanStatus(fmi2Terminated) is False
        assert all(math.isfinite(x) for x in section.get(*OUTPUTS))
        section.fmu.reset()
        section.initialize().steps(3, 0.01)


def test_status_with_nothing_to_report(any_model):
    with any_model.section() as section:
        section.initialize()
        for kind in (fmi2DoStepStatus, fmi2LastSuccessfulTime, fmi2Terminated):
            for call in ("getStatus", "getRealStatus", "getIntegerStatus", "getBooleanStatus"):
                fails(section, DISCARD, "nothing to report", getattr(section.fmu, call), kind)
        section.fmu.doStep(0.0, 0.01)


# ------------------------------------------------------------------ order of calls


def prepared(section, state):
    """Brings a new instance to a state."""
    if state == "instantiated":
        return
    section.fmu.setupExperiment()
    section.fmu.enterInitializationMode()
    if state == "initialisation mode":
        return
    section.fmu.exitInitializationMode()
    if state == "terminated":
        section.fmu.terminate()


@pytest.mark.parametrize(
    "state, call, arguments",
    [
        ("instantiated", "doStep", (0.0, 0.01)),
        ("instantiated", "exitInitializationMode", ()),
        ("instantiated", "terminate", ()),
        ("instantiated", "getStatus", (fmi2DoStepStatus,)),
        ("initialisation mode", "doStep", (0.0, 0.01)),
        ("initialisation mode", "setupExperiment", ()),
        ("initialisation mode", "enterInitializationMode", ()),
        ("initialisation mode", "terminate", ()),
        ("step complete", "setupExperiment", ()),
        ("step complete", "enterInitializationMode", ()),
        ("step complete", "exitInitializationMode", ()),
        ("terminated", "doStep", (0.0, 0.01)),
        ("terminated", "terminate", ()),
        ("terminated", "enterInitializationMode", ()),
    ],
)
def test_calls_in_the_wrong_order(any_model, state, call, arguments):
    with any_model.section() as section:
        prepared(section, state)
        fails(section, ERROR, state, getattr(section.fmu, call), *arguments)
        section.fmu.reset()
        section.initialize().steps(3, 0.01)


def test_no_step_is_ever_pending(any_model):
    with any_model.section() as section:
        section.initialize().steps(1, 0.01)
        fails(section, ERROR, "pending", section.fmu.cancelStep)
        # a function that is not offered leaves the run alone
        section.steps(1, 0.01, start=1)


def test_initialisation_without_a_start_time(any_model):
    with any_model.section() as section:
        section.fmu.enterInitializationMode()
        assert any("has not been set up" in m.text for m in section.log)
        section.fmu.exitInitializationMode()
        section.steps(3, 0.01)


def test_outputs_before_initialisation(any_model):
    with any_model.section() as section:
        reference = section.references(["heave"])
        fails(section, ERROR, "heave", section.fmu.getReal, reference)


def test_debug_logging_by_category(any_model):
    with any_model.section(logging=False) as section:
        section.fmu.setDebugLogging(True, ["logEvents"])
        section.initialize()
        assert section.log and {m.category for m in section.log} == {"logEvents"}
        fails(section, ERROR, "noSuchCategory", section.fmu.setDebugLogging, True, ["noSuchCategory"])
        section.steps(3, 0.01)  # the run goes on


def test_resource_locations_of_careless_importers(any_model, tmp_path):
    folder = shutil.copytree(any_model.unpacked, tmp_path / "a%20b")
    raw = f"file://{folder}/resources".encode()
    # a path that was not encoded; none at all: the archive that the library lies in
    for location in [raw, b"", None]:
        with Section(folder, any_model.description, location=location) as section:
            section.initialize().steps(3, 0.01)


def test_getters_answer_for_every_legal_parameter(any_model):
    for parameters in [
        {"heave_frequency": 0.0},
        {"torsion_frequency": 0.0},
        {"heave_damping_ratio": 1.2},
        {"torsion_frequency": 2.0},
    ]:
        with any_model.section() as section:
            section.initialize(**parameters)
            speed, limit = section.get("onset_speed", "onset_search_limit")
            # without an onset it is as far as was judged, and 0 where nothing could be
            assert 0.0 <= speed <= limit
            if section.flag("onset_found"):
                assert speed > 0.0
            section.get("divergence_speed", "onset_frequency", "onset_reduced_velocity")
            section.steps(3, 0.01)


def test_percent_signs_reach_the_user_as_they_are(any_model, copy):
    # messages are printf formats: a file name must not become one
    folder = copy.rename(copy.with_name("100% %s %n #r0#"))
    (folder / "resources" / "model.json").unlink()
    with pytest.raises(Refused, match="100% %s %n"):
        Section(folder, any_model.description)
