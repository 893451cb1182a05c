"""An exported section as the tests see it: variables by name, statuses as exceptions, the log as a list."""

import ctypes
import itertools
from typing import NamedTuple

import numpy as np
from fmpy import calloc, free
from fmpy.fmi2 import (
    FMU2Slave,
    fmi2CallbackAllocateMemoryTYPE,
    fmi2CallbackFreeMemoryTYPE,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
)
from fmpy.logging import addLoggerProxy

OK, WARNING, DISCARD, ERROR, FATAL, PENDING = range(6)

MOTION = ["heave", "heave_rate", "rotation", "rotation_rate"]
OUTPUTS = [
    "heave", "heave_rate", "heave_acceleration", "lift",
    "rotation", "rotation_rate", "rotation_acceleration", "moment",
]  # fmt: skip


# outputs that say whether the others can be trusted
# real ones first, as FMPy reads them
STATUS = [
    "flutter_margin", "damping_now", "flutter_speed",
    "wind_in_tested_range", "amplitude_in_linear_range",
]  # fmt: skip


class Message(NamedTuple):
    """What the FMU said through the logger."""

    instance: str
    status: int
    category: str
    text: str


_logs: dict[int, list[Message]] = {}
_handles = itertools.count(1)


def _log(environment, instance, status, category, text):
    message = Message(
        instance.decode(), status, category.decode() if category else "", text.decode()
    )
    # FMPy's own instances share the callback and have no environment
    _logs.setdefault(environment, []).append(message)


_LOGGER = fmi2CallbackLoggerTYPE(_log)


# the resource location is the one that FMPy states
STATED = object()


class Section:
    """One instance of an unpacked FMU; a context manager that frees it."""

    def __init__(self, unpacked, description, name="deck", guid=None, logging=True, location=STATED):
        self.description = description
        self.variables = {v.name: v for v in description.modelVariables}
        self.handle = next(_handles)
        self.log = _logs.setdefault(self.handle, [])
        callbacks = fmi2CallbackFunctions()
        callbacks.logger = _LOGGER
        callbacks.allocateMemory = fmi2CallbackAllocateMemoryTYPE(calloc)
        callbacks.freeMemory = fmi2CallbackFreeMemoryTYPE(free)
        callbacks.componentEnvironment = self.handle
        # formats the message as printf does, and hands it to the logger that was registered last
        addLoggerProxy(ctypes.byref(callbacks))
        self.fmu = FMU2Slave(
            guid=guid or description.guid,
            unzipDirectory=str(unpacked),
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName=name,
        )
        if location is not STATED:
            instantiate = self.fmu.fmi2Instantiate
            self.fmu.fmi2Instantiate = lambda name, kind, guid, _, *rest: instantiate(
                name, kind, guid, location, *rest
            )
        try:
            self.fmu.instantiate(callbacks=callbacks, loggingOn=logging)
        except Exception as refusal:
            self.fmu.freeLibrary()
            raise Refused(self.log) from refusal

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.fmu.freeInstance()

    def references(self, names):
        """Value references of variables."""
        return [self.variables[name].valueReference for name in names]

    def get(self, *names):
        """Values of real variables."""
        return self.fmu.getReal(self.references(names))

    def flag(self, name):
        """Value of a Boolean variable."""
        return bool(self.fmu.getBoolean(self.references([name]))[0])

    def set(self, **values):
        """Sets real variables."""
        self.fmu.setReal(self.references(values), list(values.values()))

    def ramp(self, **rates):
        """Sets the first derivatives of real inputs."""
        self.fmu.setRealInputDerivatives(
            self.references(rates), [1] * len(rates), list(rates.values())
        )

    def initialize(self, start_time=0.0, stop_time=None, **values):
        """From instantiated to the first communication point."""
        self.fmu.setupExperiment(startTime=start_time, stopTime=stop_time)
        if values:
            self.set(**values)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()
        return self

    def steps(self, count, step, start=0, names=OUTPUTS):
        """`count` communication steps from point `start` on; the outputs after each, one row per step."""
        references = self.references(names)
        rows = np.empty((count, len(names)))
        for n in range(count):
            self.fmu.doStep((start + n) * step, step)
            rows[n] = self.fmu.getReal(references)
        return rows

    def said(self, status):
        """Texts of the messages with this status."""
        return [m.text for m in self.log if m.status == status]


class Refused(Exception):
    """The FMU returned no instance; carries what it said about it."""

    def __init__(self, log):
        super().__init__("; ".join(m.text for m in log))
        self.log = log
