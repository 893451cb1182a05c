"""Several instances in one process do not notice each other."""

import threading
from contextlib import ExitStack

import numpy as np
from section import OUTPUTS


def alone(model, wind_speed):
    with model.section() as section:
        return section.initialize(wind_speed=wind_speed).steps(200, 0.01)


def test_interleaved_instances_are_as_alone(model):
    speeds = [5.0, 20.0, 30.0, 38.0]
    expected = [alone(model, speed) for speed in speeds]
    with ExitStack() as stack:
        sections = [
            stack.enter_context(model.section(name=f"strip {i}")) for i, _ in enumerate(speeds)
        ]
        for section, speed in zip(sections, speeds):
            section.initialize(wind_speed=speed)
        rows = np.empty((4, 200, len(OUTPUTS)))
        for n in range(200):
            for i, section in enumerate(sections):
                rows[i, n] = section.steps(1, 0.01, start=n)[0]
    for found, wanted in zip(rows, expected):
        assert found.tobytes() == wanted.tobytes()


def test_different_models_at_once(models):
    expected = {kind: alone(model, 20.0) for kind, model in models.items()}
    with ExitStack() as stack:
        sections = {
            kind: stack.enter_context(model.section(name=kind)).initialize(wind_speed=20.0)
            for kind, model in models.items()
        }
        for n in range(200):
            for kind, section in sections.items():
                row = section.steps(1, 0.01, start=n)[0]
                assert row.tobytes() == expected[kind][n].tobytes()


def test_instances_in_threads(model):
    speeds = [10.0, 20.0, 30.0, 35.0]
    expected = [alone(model, speed) for speed in speeds]
    found = [None] * len(speeds)

    def work(i):
        found[i] = alone(model, speeds[i])

    threads = [threading.Thread(target=work, args=(i,)) for i in range(len(speeds))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for one, other in zip(found, expected):
        assert one.tobytes() == other.tobytes()


def test_many_instances_come_and_go(any_model):
    expected = alone(any_model, 20.0)[:3]
    for _ in range(100):
        with any_model.section() as section:
            rows = section.initialize(wind_speed=20.0).steps(3, 0.01)
            assert rows.tobytes() == expected.tobytes()


def test_name_and_environment_come_back_through_the_logger(any_model):
    with any_model.section(name="Brücke 1") as one, any_model.section(name="two") as other:
        one.initialize()
        other.initialize()
        assert one.log and {m.instance for m in one.log} == {"Brücke 1"}
        assert other.log and {m.instance for m in other.log} == {"two"}
        categories = {c.name for c in any_model.description.logCategories}
        assert {m.category for m in one.log} <= categories
