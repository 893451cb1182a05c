"""How long a step takes as a component for WebAssembly, against the library of this machine in the same archive.

    target/python-env/bin/python benches/component.py deck.fmu

Both are called through ctypes with arguments that are made once, in turns of ten thousand steps; medians and their ratio are printed.
How to export such an archive stands in docs/fmu.md, below "WebAssembly"."""

import ctypes
import statistics
import sys
import time
from pathlib import Path

import fmpy
from fmpy.fmi3 import FMU3Slave

sys.path.insert(0, str(Path(__file__).parent.parent / "tests" / "fmpy"))
from wasm_unit import Unit  # noqa: E402
from wasmtime import _ffi as ffi  # noqa: E402

H, STEPS, TURNS = 0.01, 10_000, 11


def of_component(archive, token):
    """A function that makes a step of the component, without Python's conversion of its arguments."""
    unit = Unit(archive, token)
    assert unit.enter_initialization_mode(None, 0.0, None) == "ok"
    assert unit.exit_initialization_mode() == "ok"
    function = unit._function("co-simulation", "[method]co-simulation-instance.do-step")
    arguments = (ffi.wasmtime_component_val_t * 4)()
    for at, ((_, kind), value) in enumerate(
        zip(function.type(unit.store).params, (unit.handle, 0.0, H, True), strict=True)
    ):
        kind.convert_to_c(unit.store, value, ctypes.pointer(arguments[at]))
    result, context = ffi.wasmtime_component_val_t(), unit.store._context()
    handle, answer = ctypes.byref(function._func), ctypes.byref(result)

    def step(i):
        arguments[1].of.f64 = i * H
        error = ffi.wasmtime_component_func_call(handle, context, arguments, 4, answer, 1)
        assert not error
        ffi.wasmtime_component_func_post_return(handle, context)

    # all of it lives as long as the function
    step.keeps = (unit, arguments, result)
    return step


def of_library(archive, description):
    unit = FMU3Slave(
        guid=description.instantiationToken,
        unzipDirectory=fmpy.extract(archive),
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="native",
    )
    unit.instantiate()
    unit.enterInitializationMode(startTime=0.0)
    unit.exitInitializationMode()
    return lambda i: unit.doStep(i * H, H)


def main():
    archive = sys.argv[1]
    description = fmpy.read_model_description(archive)
    ways = {
        "component": of_component(archive, description.instantiationToken),
        "library": of_library(archive, description),
    }
    seconds = {name: [] for name in ways}
    for turn in range(TURNS):
        for name, step in ways.items():
            begun = time.process_time()
            for i in range(turn * STEPS, (turn + 1) * STEPS):
                step(i)
            seconds[name].append((time.process_time() - begun) / STEPS)
    medians = {name: statistics.median(of_each) for name, of_each in seconds.items()}
    for name, median in medians.items():
        print(f"{name:10} {1e6 * median:8.3f} µs a step")
    print(f"ratio      {medians['component'] / medians['library']:8.2f}")


if __name__ == "__main__":
    main()
