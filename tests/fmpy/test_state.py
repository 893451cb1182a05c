"""States are saved, kept as bytes, restored, replayed; damaged bytes are refused."""

import ctypes

import fmpy
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import fmi2FMUstate
from section import DISCARD, ERROR


def moving(section):
    """An instance in the middle of a run in which nothing has its default."""
    section.initialize(
        start_time=2.0, wind_speed=31.0, mass=16.0, initial_rotation=0.02, external_moment=0.1
    )
    section.ramp(external_lift=0.7)
    for n in range(37):
        section.fmu.doStep(2.0 + n * 0.013, 0.013)
    return 2.0 + 37 * 0.013


def onward(section, time):
    """A hundred steps, a parameter tuned and an input changed in between."""
    rows = [section.steps(50, 0.01, start=round(time / 0.01, 9)).tobytes()]
    section.set(heave_damping_ratio=0.01, external_lift=-1.0)
    rows.append(section.steps(50, 0.01, start=round(time / 0.01, 9) + 50).tobytes())
    return rows, section.get("onset_speed")


def test_restored_states_replay_bit_for_bit(model):
    with model.section() as section:
        time = moving(section)
        state = section.fmu.getFMUstate()
        first = onward(section, time)
        for _ in range(3):
            section.fmu.setFMUstate(state)
            assert onward(section, time) == first
        # also after everything else has changed
        section.fmu.reset()
        section.initialize(width=0.7, wind_speed=3.0).steps(5, 0.01)
        section.fmu.setFMUstate(state)
        assert onward(section, time) == first
        section.fmu.freeFMUstate(state)


def test_states_are_copies(any_model):
    with any_model.section() as section:
        time = moving(section)
        early = section.fmu.getFMUstate()
        first = onward(section, time)
        late = section.fmu.getFMUstate()
        section.fmu.freeFMUstate(late)
        section.fmu.setFMUstate(early)
        assert onward(section, time) == first
        # the memory of a state is taken again for the next
        before = early.value
        section.fmu.fmi2GetFMUstate(section.fmu.component, ctypes.byref(early))
        assert early.value == before
        section.fmu.freeFMUstate(early)
        assert early.value is None
        section.fmu.freeFMUstate(early)


def test_serialised_states_move_between_instances(model):
    with model.section() as section:
        time = moving(section)
        state = section.fmu.getFMUstate()
        kept = section.fmu.serializeFMUstate(state)
        assert section.fmu.serializeFMUstate(state) == kept
        section.fmu.freeFMUstate(state)
        first = onward(section, time)
    with model.section(name="another") as other:
        other.initialize()
        state = other.fmu.deSerializeFMUstate(kept)
        assert other.fmu.serializeFMUstate(state) == kept
        other.fmu.setFMUstate(state)
        other.fmu.freeFMUstate(state)
        assert onward(other, time) == first


def test_fmpy_goes_on_from_serialised_bytes(any_model):
    options = {"filename": str(any_model.unpacked), "model_description": any_model.description}
    whole = fmpy.simulate_fmu(**options, stop_time=2.0, output_interval=0.01)
    with any_model.section() as section:
        section.initialize().steps(100, 0.01)
        state = section.fmu.getFMUstate()
        kept = section.fmu.serializeFMUstate(state)
        section.fmu.freeFMUstate(state)
    second_half = fmpy.simulate_fmu(
        **options, start_time=1.0, stop_time=2.0, output_interval=0.01, fmu_state=kept
    )
    for name in ("heave", "rotation", "lift", "moment"):
        assert second_half[name] == pytest.approx(whole[name][100:], rel=1e-9, abs=1e-12)


def refused(section, data):
    """Whether these bytes are refused, with a reason and without harm."""
    before = len(section.log)
    with pytest.raises(FMICallException) as failure:
        section.fmu.deSerializeFMUstate(data)
    assert failure.value.status in (DISCARD, ERROR)
    assert any("state" in m.text for m in section.log[before:])


def test_damaged_bytes_are_refused(any_model, models):
    with any_model.section() as section:
        moving(section)
        state = section.fmu.getFMUstate()
        kept = section.fmu.serializeFMUstate(state)
        for data in [
            b"",
            kept[:1],
            kept[: len(kept) // 2],
            kept[:-1],
            kept + b"\0",
            bytes(len(kept)),
            b"x" + kept[1:],
            bytes(255 - b for b in kept),
        ]:
            refused(section, data)
        for at in range(0, len(kept), max(1, len(kept) // 97)):
            refused(section, kept[:at] + bytes([kept[at] ^ 0x10]) + kept[at + 1 :])
        stranger = next(m for m in models.values() if m is not any_model)
        with stranger.section() as other:
            other.initialize()
            refused(other, kept)
        # none of this has harmed anything
        section.fmu.setFMUstate(state)
        section.fmu.doStep(2.0 + 37 * 0.013, 0.01)
        section.fmu.freeFMUstate(state)


def test_a_buffer_too_small_is_refused(any_model):
    with any_model.section() as section:
        section.initialize()
        state = section.fmu.getFMUstate()
        size = len(section.fmu.serializeFMUstate(state))
        buffer = ctypes.create_string_buffer(size)
        with pytest.raises(FMICallException):
            section.fmu.fmi2SerializeFMUstate(section.fmu.component, state, buffer, size - 1)
        with pytest.raises(FMICallException):
            section.fmu.fmi2SetFMUstate(section.fmu.component, fmi2FMUstate())
        section.fmu.freeFMUstate(state)


def test_states_lead_out_of_an_error(any_model):
    with any_model.section() as section:
        time = moving(section)
        state = section.fmu.getFMUstate()
        first = onward(section, time)
        with pytest.raises(FMICallException):
            section.fmu.doStep(time + 99.0, 0.01)
        with pytest.raises(FMICallException):
            section.fmu.doStep(time, 0.01)
        section.fmu.setFMUstate(state)
        assert onward(section, time) == first
        section.fmu.freeFMUstate(state)
