"""A reset brings everything back: replays are equal bit for bit."""

PARAMETERS = {"mass": 17.0, "torsion_frequency": 4.0, "air_density": 1.25, "width": 0.6}
FIXED = {"initial_heave": 0.002, "initial_rotation_rate": 0.3, "onset_search_limit": 60.0}
INPUTS = {"wind_speed": 25.0, "external_lift": 3.0, "external_moment": -0.4}


def defaults(section):
    names = [
        v.name
        for v in section.description.modelVariables
        if v.type == "Real" and v.causality in ("parameter", "input")
    ]
    starts = [float(section.variables[name].start) for name in names]
    return names, starts


def test_replay_after_reset(model):
    with model.section() as section:
        first = section.initialize().steps(300, 0.01)
        section.fmu.reset()
        second = section.initialize().steps(300, 0.01)
    with model.section() as fresh:
        third = fresh.initialize().steps(300, 0.01)
    assert first.tobytes() == second.tobytes() == third.tobytes()


def test_every_default_is_restored(model):
    with model.section() as section:
        first = section.initialize().steps(100, 0.01)
        onset = section.get("onset_speed", "divergence_speed")
        section.fmu.reset()
        section.initialize(start_time=7.0, **PARAMETERS, **FIXED, **INPUTS)
        section.ramp(external_lift=5.0)
        section.fmu.doStep(7.0, 0.013)
        changed = section.get("onset_speed", "divergence_speed")
        assert changed[0] != onset[0] and changed[1] != onset[1]
        section.fmu.reset()
        names, starts = defaults(section)
        assert section.get(*names) == starts
        assert section.initialize().get("onset_speed", "divergence_speed") == onset
        assert section.steps(100, 0.01).tobytes() == first.tobytes()


def test_reset_from_every_state(any_model):
    with any_model.section() as section:
        first = section.initialize().steps(10, 0.01)

        def replay():
            section.fmu.reset()
            assert section.initialize().steps(10, 0.01).tobytes() == first.tobytes()

        replay()  # from stepping
        section.fmu.terminate()
        replay()  # from terminated
        section.fmu.reset()
        replay()  # from instantiated
        section.fmu.reset()
        section.fmu.setupExperiment()
        section.fmu.enterInitializationMode()
        replay()  # from initialisation


def test_start_values_of_the_description_are_those_of_the_instance(model):
    with model.section() as section:
        names, starts = defaults(section)
        assert section.get(*names) == starts
        section.initialize()
        assert section.get(*names) == starts
        constants = [v for v in section.description.modelVariables if v.variability == "constant"]
        for variable in constants:
            read = getattr(section.fmu, f"get{variable.type}")([variable.valueReference])[0]
            read = read.decode() if isinstance(read, bytes) else str(read)
            assert read == variable.start
