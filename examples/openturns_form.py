"""Reliability of the first order against flutter with OpenTURNS, the limit state being an exported FMU:

    pip install openturns fmpy
    python examples/openturns_form.py deck_section.fmu

Failure is a wind speed above the onset of the section with uncertain damping, frequencies and air density. The FMU is
loaded once; each evaluation sets tunable parameters and reads the calculated parameter `onset_speed`."""

import shutil
import sys

import fmpy
import openturns as ot
from fmpy.fmi2 import FMU2Slave
from fmpy.model_description import read_model_description


class Onset:
    """Flutter onset (m/s) as a function of parameters of the section, by name."""

    def __init__(self, fmu):
        description = read_model_description(fmu)
        self.variables = {v.name: v for v in description.modelVariables}
        self.folder = fmpy.extract(fmu)
        self.slave = FMU2Slave(
            guid=description.guid, unzipDirectory=self.folder, instanceName="limit_state",
            modelIdentifier=description.coSimulation.modelIdentifier,
        )  # fmt: skip
        self.slave.instantiate()
        self.slave.setupExperiment(startTime=0.0)
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()

    def __call__(self, **parameters):
        references = [self.variables[name].valueReference for name in parameters]
        self.slave.setReal(references, list(parameters.values()))
        return self.slave.getReal([self.variables["onset_speed"].valueReference])[0]

    def start(self, name):
        return float(self.variables[name].start)

    def close(self):
        self.slave.terminate()
        self.slave.freeInstance()
        shutil.rmtree(self.folder)


def form(fmu):
    """(reliability index, probability that the yearly strongest wind exceeds the onset)"""
    onset = Onset(fmu)
    frequency, damping, density = (onset.start(n) for n in ("torsion_frequency", "torsion_damping_ratio", "air_density"))
    spread = ot.ParametrizedDistribution
    names = ["torsion_frequency", "torsion_damping_ratio", "air_density"]
    distribution = ot.JointDistribution([
        ot.Normal(frequency, 0.03 * frequency),
        spread(ot.LogNormalMuSigma(damping, 0.3 * damping)),
        ot.Normal(density, 0.03 * density),
        spread(ot.GumbelMuSigma(0.6 * onset(), 0.06 * onset())),  # strongest wind of a year, m/s
    ])  # fmt: skip
    margin = ot.PythonFunction(4, 1, lambda x: [onset(**dict(zip(names, x))) - x[3]])
    event = ot.ThresholdEvent(ot.CompositeRandomVector(margin, ot.RandomVector(distribution)), ot.Less(), 0.0)
    solver = ot.Cobyla()
    solver.setStartingPoint(distribution.getMean())
    algorithm = ot.FORM(solver, event)
    algorithm.run()
    result = algorithm.getResult()
    onset.close()
    return result.getHasoferReliabilityIndex(), result.getEventProbability()


if __name__ == "__main__":
    beta, probability = form(sys.argv[1])
    print(f"reliability index {beta:.3f}, probability of flutter in a year {probability:.2e}")
