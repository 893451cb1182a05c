"""Tables of pandas and xarray, plots on given axes, studies, and what is shown beside."""

import copy
import json
import pickle
import warnings
from pathlib import Path

import aerodeck
import numpy as np
import pytest

STUDY = """
schema = 1
name = "girder"
section = { width_m = 0.5, air_density_kg_m3 = 1.19, vertical = { mass_kg_m = 15.0, frequency_hz = 2.0, damping_ratio = 0.003 }, torsion = { inertia_kg_m2_m = 0.6, frequency_hz = 5.0, damping_ratio = 0.003 } }
deck = { source = "LN21-5200" }
model = [{ name = "by 5 filters", table = { form = { kind = "laguerre", filters = 5 } } }]
"""


@pytest.mark.parametrize("deck", aerodeck.Derivatives.decks())
@pytest.mark.parametrize("notation, argument", [("scanlan", None), ("polimi", "v_star"), ("starossek", "k_semi")])
def test_a_table_goes_through_a_frame(deck, notation, argument):
    pytest.importorskip("pandas")
    table = aerodeck.Derivatives.deck(deck)
    frame = table.to_frame(notation=notation, argument=argument)
    again = aerodeck.Derivatives.from_frame(frame)
    for name, points in table.to_numpy().items():
        order = np.argsort(points[:, 1], kind="stable")
        back = again.to_numpy()[name]
        back = back[np.argsort(back[:, 1], kind="stable")]
        np.testing.assert_allclose(back[:, 1:], points[order, 1:], rtol=1e-12)
        assert name not in frame or np.isfinite(frame[name]).sum() == len(points)


def test_a_frame_of_a_laboratory(table):
    pandas = pytest.importorskip("pandas")
    numbers = {f"{name}*": points[:8, 2] for name, points in table.to_numpy().items() if name in "H1 H2 H3 H4 A1 A2 A3 A4"}
    v_hat = table.to_numpy()["H1"][:8, 1]
    own = pandas.DataFrame(numbers | {"v_hat": v_hat})
    read = aerodeck.Derivatives.from_frame(own, notation="scanlan", width_m=0.5)
    np.testing.assert_allclose(read.to_numpy()["A2"][:, 2], numbers["A2*"], rtol=1e-14)
    with pytest.raises(aerodeck.InputError, match="argument: expected one of v_hat, v_star"):
        aerodeck.Derivatives.from_frame(pandas.DataFrame(numbers), notation="scanlan", width_m=0.5)
    with pytest.raises(aerodeck.InputError, match="width_m"):
        aerodeck.Derivatives.from_frame(own, notation="scanlan")
    with pytest.raises(aerodeck.InputError, match="H9"):
        aerodeck.Derivatives.from_frame(own.assign(H9=1.0), notation="scanlan", width_m=0.5)


def test_curves_and_motion_as_frames_and_datasets(section, model, table):
    pytest.importorskip("pandas")
    curves = aerodeck.sweep(section, model, [10, 20, 30])
    frame = curves.to_frame()
    assert list(frame["speed_m_s"]) == [10, 10, 20, 20, 30, 30]
    np.testing.assert_array_equal(frame["damping_ratio"].to_numpy().reshape(3, 2), curves.damping_ratio)
    motion = aerodeck.simulate(section, model, 30.0, stop_time_s=1.0)
    np.testing.assert_array_equal(motion.to_frame()["torsion_rate"], motion.rate[:, 1])
    many = aerodeck.onsets(section, model, {"vertical.mass_kg_m": [13, 15]})
    np.testing.assert_array_equal(many.to_frame()["speed_m_s"], many.speed_m_s)
    pytest.importorskip("xarray")
    assert float(curves.to_xarray()["frequency"].sel(speed=20, mode="torsion")) == curves.frequency_hz[1, 1]
    assert motion.to_xarray()["force"].sel(motion="vertical").shape == motion.time_s.shape
    array = table.to_xarray()
    points = table.to_numpy()["H1"]
    assert float(array.sel(derivative="H1").dropna("v_hat")[0]) == points[np.argmin(points[:, 1]), 2]


def test_lists_are_arrays(section, model):
    given = {"vertical.mass_kg_m": [13, 15], "torsion.frequency_hz": (5, 5.0)}
    lists = aerodeck.onsets(section, model, given)
    arrays = aerodeck.onsets(section, model, {name: np.array(v, float) for name, v in given.items()}, threads=1)
    np.testing.assert_array_equal(lists.speed_m_s, arrays.speed_m_s)
    # no more threads than cores are made: a hundred thousand did not come to an end
    many = aerodeck.onsets(section, model, given, threads=100_000)
    np.testing.assert_array_equal(lists.speed_m_s, many.speed_m_s)
    with pytest.raises(aerodeck.InputError, match="vertical.mass_kg_m: expected numbers"):
        aerodeck.onsets(section, model, {"vertical.mass_kg_m": ["heavy"]})
    with pytest.raises(aerodeck.InputError, match="motion: expected numbers"):
        aerodeck.Records.from_arrays("x", "y", sampling_hz=1, mean_speed_m_s=1, width_m=1, air_density_kg_m3=1)


def test_a_section_says_what_it_was_made_of():
    numbers = {
        "width_m": 20.0, "mass_kg_m": 9e3, "inertia_kg_m2_m": 4e5, "vertical_frequency_hz": 0.2, "torsion_frequency_hz": 0.5,
        "vertical_damping_ratio": 0.004, "torsion_damping_ratio": 0.005, "lateral": (9e3, 0.1, 0.006), "mass_offset_m": 0.1,
    }
    section = aerodeck.Section(**numbers)
    assert {name: getattr(section, name) for name in numbers} == numbers
    assert section.air_density_kg_m3 == 1.25 and section.axis_offset_m is None
    stiff = section.to_dict()
    stiff["torsion"] = {"inertia_kg_m2_m": 4e5, "stiffness_n": 4e5 * (2 * np.pi * 0.5) ** 2, "damping_ratio": 0.005}
    assert abs(aerodeck.Section.from_dict(stiff).torsion_frequency_hz - 0.5) < 1e-12


def test_plots_go_on_given_axes(section, model, table):
    pyplot = pytest.importorskip("matplotlib.pyplot")
    pyplot.switch_backend("agg")
    motion = aerodeck.simulate(section, model, 30.0, stop_time_s=1.0)
    scatter = {"torsion.frequency_hz": {"kind": "lognormal", "coefficient_of_variation": 0.05}}
    distribution = aerodeck.monte_carlo(section, model, scatter, samples=500)
    for shown, count in [(aerodeck.sweep(section, model), 2), (motion, 2), (distribution, 1)]:
        figure, axes = pyplot.subplots(count, 1)
        assert shown.plot(ax=axes) is figure
        assert all(a.has_data() for a in np.atleast_1d(axes))
        with pytest.raises(aerodeck.InputError, match="ax: expected"):
            shown.plot(ax=pyplot.subplots(3, 1)[1])
    figure, axes = pyplot.subplots(3, 6)
    measured = {name for name in table.to_numpy()}
    count = len(measured | {"H1", "H2", "H3", "H4", "A1", "A2", "A3", "A4"})
    chosen = axes.ravel()[:count]
    assert table.plot(models=model, ax=chosen) is figure and all(a.get_title() for a in chosen)
    pyplot.close("all")


@pytest.mark.parametrize("again", [copy.deepcopy, lambda value: pickle.loads(pickle.dumps(value))])
def test_results_are_pickled(section, model, again):
    scatter = {"torsion.frequency_hz": {"kind": "lognormal", "coefficient_of_variation": 0.05}}
    found = aerodeck.monte_carlo(section, model, scatter, samples=500, design_speed_m_s=36)
    assert again(found).to_dict() == found.to_dict()
    motion = aerodeck.simulate(section, model, 30.0, stop_time_s=1.0)
    np.testing.assert_array_equal(again(motion).force, motion.force)
    stepper = aerodeck.Stepper(section, model)
    for _ in range(20):
        stepper.step(0.01, 30.0)
    other = again(stepper)
    assert other.time_s == stepper.time_s
    np.testing.assert_array_equal(other.step(0.01, 31.0), stepper.step(0.01, 31.0))


def test_a_study_runs_as_the_program_runs_it(tmp_path):
    (tmp_path / "study.toml").write_text(STUDY, encoding="utf-8")
    study = aerodeck.Study.from_toml(tmp_path / "study.toml")
    found = study.run(tmp_path / "results", figures=False)
    assert found.headline == found.summary["verdict"]["headline"] and found.onsets
    assert found.summary == json.loads((found.folder / "summary.json").read_text(encoding="utf-8"))
    assert (tmp_path / "results" / "report.html").exists() and not list((tmp_path / "results").glob("*.svg"))
    assert found.model().states > 0 and found.summary["model"] in found.models
    with pytest.raises(aerodeck.InputError, match="name: expected one of"):
        found.model("no such")
    text = (tmp_path / "results" / "study.toml").read_text(encoding="utf-8")
    again = aerodeck.Study.from_text(text).run(figures=False)
    assert again.headline == found.headline and not list(Path.cwd().glob("tmp*.toml"))
    damped = aerodeck.Study.from_text(text).run(figures=False, values={"section.vertical.damping_ratio": 0.02})
    assert damped.onsets[0]["speed_m_s"] != found.onsets[0]["speed_m_s"]
    with pytest.raises(aerodeck.InputError, match="^text: line 1: .*nonsense"):
        aerodeck.Study.from_text("nonsense = 1\n" + text).run()


def test_a_study_warns_once_and_prints_nothing(tmp_path, capfd):
    text = STUDY.replace("damping_ratio = 0.003", "damping_ratio = 0.3")
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        found = aerodeck.Study.from_text(text, tmp_path).run(figures=False)
    assert [str(w.message) for w in caught] == found.summary["warnings"] != []
    assert capfd.readouterr() == ("", "")
