"""Forces along a motion that is given: in steps of our own, and with the importer integrating."""

import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Model
from fmpy.model_description import read_model_description
from fmpy.sundials import CVodeSolver
from section import Section

# communication points
POINTS = 50
# what CVode is asked for
SOLVER = 1e-9
ORDERS = ["", "_rate", "_acceleration"]


class Motion:
    """From zero to `amplitudes` in `duration`, and gusts that grow evenly, as functions of time.

    A cubic: the forces' own steps are exact along it.
    """

    def __init__(self, amplitudes, duration, gusts=()):
        self.amplitudes, self.duration, self.gusts = amplitudes, duration, dict(gusts)

    def at(self, time):
        """All inputs at a point of time, by name."""
        t, duration = time / self.duration, self.duration
        step = [3 * t**2 - 2 * t**3, (6 * t - 6 * t**2) / duration, (6 - 12 * t) / duration**2]
        moved = {
            f"{name}{order}": amplitude * value
            for name, amplitude in self.amplitudes.items()
            for order, value in zip(ORDERS, step, strict=True)
        }
        return moved | {name: speed * t for name, speed in self.gusts.items()}

    def times(self):
        """Communication points."""
        return np.linspace(0.0, self.duration, POINTS + 1)


def stepped(fmu, folder, motion, outputs, **values):
    """The forces at all communication points by the unit's own steps, of the motion that was set last."""
    fmpy.extract(str(fmu), unzipdir=str(folder))
    found, times = [], motion.times()
    with Section(folder, read_model_description(str(fmu))) as section:
        section.set(**motion.at(0.0))
        section.initialize(**values, prediction=0.0)
        for n, time in enumerate(times):
            section.set(**motion.at(time))
            found.append(section.get(*outputs))
            if n < POINTS:
                section.fmu.doStep(time, times[n + 1] - time)
    return np.array(found)


def integrated(fmu, folder, motion, outputs, **values):
    """The same by CVode of FMPy on the unpacked archive, with inputs of the solver's own instants.

    `simulate_fmu` sets inputs after a step of the solver and lets them stand over the next one.
    """
    description = read_model_description(str(fmu))
    reference = {v.name: v.valueReference for v in description.modelVariables}
    unit = FMU2Model(
        guid=description.guid,
        unzipDirectory=str(folder),
        modelIdentifier=description.modelExchange.modelIdentifier,
    )

    def put(values):
        unit.setReal([reference[name] for name in values], list(values.values()))

    def advance_to(time):
        unit.setTime(time)
        put(motion.at(time))

    unit.instantiate()
    unit.setupExperiment()
    put(values | motion.at(0.0))
    unit.enterInitializationMode()
    unit.exitInitializationMode()
    unit.newDiscreteStates()
    unit.enterContinuousTimeMode()

    class Set:
        apply = staticmethod(lambda time: put(motion.at(time)))

    solver = CVodeSolver(
        nx=description.numberOfContinuousStates,
        nz=0,
        get_x=unit.getContinuousStates,
        set_x=unit.setContinuousStates,
        get_dx=unit.getDerivatives,
        get_z=unit.getEventIndicators,
        get_nominals=unit.getNominalsOfContinuousStates,
        set_time=advance_to,
        input=Set,
        startTime=0.0,
        relativeTolerance=SOLVER,
        maxNumSteps=100_000,
    )
    found, times = [], motion.times()
    for n, time in enumerate(times):
        advance_to(time)
        found.append(unit.getReal([reference[name] for name in outputs]))
        if n < POINTS:
            solver.step(time, times[n + 1])
            unit.completedIntegratorStep()
    unit.terminate()
    unit.freeInstance()
    return np.array(found)
