"""The package against the library's own figures, and what a user touches first."""

import copy
import json
import multiprocessing
import os
import pickle
import re
import subprocess
import sys
import threading
from concurrent.futures import ProcessPoolExecutor
from importlib.util import find_spec
from pathlib import Path

import aerodeck
import numpy as np
import pytest

ROOT = Path(__file__).parents[2]


def test_onset_is_that_of_the_library_with_an_interval_around_it(section, model):
    onset = aerodeck.flutter(section, model)
    # by five filters, as the command line has it
    assert onset.state == "onset" and abs(onset.speed_m_s - 36.92) < 0.01
    low, high = onset.interval
    assert low < onset.speed_m_s < high and onset.in_tested_range
    assert onset.card["onset"]["speed_m_s"] == onset.speed_m_s
    assert re.fullmatch(r"flutter onset 36\.9 m/s, \d+\.\d–\d+\.\d, inside the tested range", onset.headline)
    other = aerodeck.flutter(section, model, method="determinant")
    assert abs(other.speed_m_s / onset.speed_m_s - 1) < 1e-6


def test_the_verdict_is_that_of_the_program(section):
    """The interval holds scatter, speeds and form, and the deck is not its own witness: 36.3 m/s lies inside it."""
    model = aerodeck.fit_laguerre(aerodeck.Derivatives.deck("LN21-5200"))
    own = aerodeck.flutter(section, model, required_speed_m_s=36.3)
    assert own.outcome == "not_met"
    # as `aerodeck train` and `aerodeck flutter` state it
    assert own.interval == pytest.approx((36.272, 37.569), abs=2e-3)


def test_less_than_an_answer_is_not_stable(section, model):
    """Below the frequency ratio of one the data end before the search does."""
    slow = aerodeck.flutter(section.replace({"torsion.frequency_hz": 1.0}), model)
    assert slow.state == "not_judged" and slow.speed_m_s is None
    many = aerodeck.onsets(section, model, {"torsion.frequency_hz": [5.0, 1.0]})
    assert list(many.judged) == [True, False] and many.searched_to_m_s > many.speed_m_s[0]
    sway = aerodeck.Section(**_plain(section), lateral=(15.0, 1.0, 0.003))
    with pytest.raises(aerodeck.InputError, match="no forces of sway"):
        aerodeck.flutter(sway, "flat plate")
    for keyword in ("aerodynamic_scatter", "design_speed_m_s", "speed_max_m_s"):
        with pytest.raises(aerodeck.InputError, match=keyword):
            aerodeck.monte_carlo(section, model, {}, samples=10, **{keyword: float("nan")})


def _plain(section):
    stated = section.to_dict()
    vertical, torsion = stated["vertical"], stated["torsion"]
    return {
        "width_m": stated["width_m"],
        "mass_kg_m": vertical["mass_kg_m"],
        "inertia_kg_m2_m": torsion["inertia_kg_m2_m"],
        "vertical_frequency_hz": vertical["frequency_hz"],
        "torsion_frequency_hz": torsion["frequency_hz"],
        "vertical_damping_ratio": vertical["damping_ratio"],
        "torsion_damping_ratio": torsion["damping_ratio"],
    }


def test_files_that_cannot_be_written_are_named(section, model, table, tmp_path):
    missing = tmp_path / "missing" / "file"
    for write in (lambda: model.save(missing, section), lambda: table.write(missing)):
        with pytest.raises(aerodeck.FileError, match="missing"):
            write()
    records = aerodeck.Records.virtual_tunnel(table)
    again = aerodeck.Records.virtual_tunnel(table, noise_fraction=0.01)
    with pytest.raises(aerodeck.InputError, match="twice"):
        (records + again).write(tmp_path)
    with pytest.raises(aerodeck.InputError, match="each record once: what stands twice looks better known"):
        records + records
    # also by another name
    _, motion, force = records.to_numpy(0)
    head = records.header(0)
    plain = {key: head[key] for key in ("sampling_hz", "mean_speed_m_s", "width_m", "air_density_kg_m3")}
    with pytest.raises(aerodeck.InputError, match="again as another"):
        records + aerodeck.Records.from_arrays(motion, force, name="another", **plain)


def test_what_is_exported_starts_below_the_onset(section, model, tmp_path):
    model.save(tmp_path / "model.json", section)
    experiment = json.loads((tmp_path / "model.json").read_text())["experiment"]
    assert experiment["wind_speed_m_s"] == 36.1


def _states(terms):
    return aerodeck.fit_laguerre(aerodeck.Derivatives.deck("LN21-5200"), terms).states


def test_a_forked_process_has_threads_of_its_own(model):
    if "fork" not in multiprocessing.get_all_start_methods():
        pytest.skip("no fork here")
    with multiprocessing.get_context("fork").Pool(2) as pool:
        assert len(pool.map_async(_states, [3, 4]).get(60)) == 2


@pytest.mark.parametrize("deck", aerodeck.Derivatives.decks())
@pytest.mark.parametrize("at", ["table_4_1", "iabse_1_1a"])
def test_every_deck_at_both_scales(deck, at):
    section = getattr(aerodeck.Section, at)()
    measured = aerodeck.Derivatives.deck(deck)
    onset = aerodeck.flutter(section, aerodeck.fit_laguerre(measured))
    own = aerodeck.flutter(section, measured)
    assert onset.state == "onset"
    if own.state == "onset" and onset.in_tested_range:
        assert abs(onset.speed_m_s / own.speed_m_s - 1) < 0.04


def test_three_motions(table):
    section = aerodeck.Section(
        width_m=0.5, mass_kg_m=15, inertia_kg_m2_m=0.6, vertical_frequency_hz=2, torsion_frequency_hz=5,
        vertical_damping_ratio=0.003, torsion_damping_ratio=0.003, air_density_kg_m3=1.19, lateral=(15, 1.5, 0.003),
    )
    model = aerodeck.fit_laguerre(table, lateral=True)
    assert model.dofs == section.dofs == ["vertical", "lateral", "torsion"]
    assert model.transfer([0.3, 0.5]).shape == (2, 3, 3)
    assert 30 < aerodeck.flutter(section, model).speed_m_s < 45


def test_flat_plate_of_iabse():
    found = aerodeck.flutter(aerodeck.Section.iabse_1_1a(), "flat plate")
    assert abs(found.speed_m_s - 77) < 2 and found.in_tested_range is None


def test_transfer_is_the_formula_of_the_table(table, model):
    """At measured points V̂²·Re and Im of G are the derivatives the model was fitted to, up to its residual."""
    points = table.to_numpy()["H1"]
    fitted = (model.transfer(1 / points[:, 1])[:, 0, 0] * points[:, 1] ** 2).imag
    rms = np.sqrt(np.mean((fitted - points[:, 2]) ** 2) / np.mean(points[:, 2] ** 2))
    assert rms < 0.1


@pytest.mark.parametrize("notation", ["scanlan", "simiu", "wawi", "zasso", "classical", "polimi", "starossek"])
def test_notations_round_trip(table, notation):
    argument = "k_semi"
    columns = table.to_numpy(notation, argument=argument)
    again = aerodeck.Derivatives.from_arrays(columns, notation=notation, argument=argument, width_m=table.width_m)
    for name, points in table.to_numpy().items():
        np.testing.assert_allclose(again.to_numpy()[name][:, 1:], points[:, 1:], rtol=1e-12)


def test_a_pair_of_arrays_is_a_table_without_speeds(table):
    columns = {n: (p[:8, 1], p[:8, 2]) for n, p in table.to_numpy().items()}
    one_speed = aerodeck.Derivatives.from_arrays(columns, notation="scanlan", argument="v_hat", width_m=0.5)
    assert np.isnan(one_speed.to_numpy()["H1"][:, 0]).all()
    with pytest.raises(aerodeck.InputError, match="columns"):
        aerodeck.Derivatives.from_arrays({"H1": np.ones((3, 5))}, notation="scanlan", argument="v_hat", width_m=0.5)


def test_sweep_crosses_zero_at_the_onset(section, model):
    onset = aerodeck.flutter(section, model)
    speeds = onset.speed_m_s * np.array([0.5, 0.999, 1.001, 1.1])
    curves = aerodeck.sweep(section, model, speeds)
    lowest = curves.damping_ratio.min(axis=1)
    assert list(lowest > 0) == [True, True, False, False]
    assert curves.frequency_hz.shape == curves.tested.shape == (4, 2)


def test_motion_grows_above_the_onset_and_the_stepper_gives_the_same_bits(section, model):
    onset = aerodeck.flutter(section, model).speed_m_s
    for factor, grows in [(0.95, False), (1.05, True)]:
        motion = aerodeck.simulate(section, model, factor * onset, stop_time_s=20)
        rotation = np.abs(motion.displacement[:, 1])
        assert (rotation[-300:].max() > rotation[:300].max()) == grows
    stepper = aerodeck.Stepper(section, model)
    early = stepper.snapshot()
    first = [stepper.step(0.01, factor * onset) for _ in range(50)]
    np.testing.assert_array_equal(first, motion.displacement[1:51])
    copied = pickle.loads(pickle.dumps(stepper))
    for name in ["time_s", "displacement", "rate", "acceleration", "force"]:
        np.testing.assert_array_equal(getattr(copied, name), getattr(stepper, name))
    for length, step in [(10, 100.0), (10, -0.01), (10, float("nan"))]:
        with pytest.raises(aerodeck.InputError, match="step_s"):
            aerodeck.simulate(section, model, onset, stop_time_s=length, step_s=step)
    stepper.restore(early)
    for bad in [(float("nan"), *early[1:]), (*early[:3], -1.0, early[4])]:
        with pytest.raises(aerodeck.InputError, match="snapshot"):
            stepper.restore(bad)
    np.testing.assert_array_equal([stepper.step(0.01, factor * onset) for _ in range(50)], first)


def test_many_onsets_are_single_ones(section, model):
    mass = np.array([13.0, 15.0, 17.0])
    told = []
    many = aerodeck.onsets(section, model, {"vertical.mass_kg_m": mass}, progress=lambda *at: told.append(at))
    single = [aerodeck.flutter(section.replace({"vertical.mass_kg_m": m}), model).speed_m_s for m in mass]
    np.testing.assert_allclose(many.speed_m_s, single, rtol=1e-6)
    assert many.tested.all() and not many.unstable.any() and told[-1] == (3, 3)


def test_monte_carlo_is_seeded_and_the_design_speed_counts(section, model):
    scatter = {"torsion.frequency_hz": {"kind": "lognormal", "coefficient_of_variation": 0.05}}
    a, b = (aerodeck.monte_carlo(section, model, scatter, samples=2000, seed=7, design_speed_m_s=36) for _ in range(2))
    assert a.to_dict() == b.to_dict() and a.counts["onsets"] == 2000
    probability, low, high = a.probability
    assert low < probability < high
    edges, counts = a.histogram
    assert len(edges) == len(counts) + 1 and counts.sum() == 2000
    # what the model itself says of that speed, as `flutter` does
    assert a.verdict == aerodeck.flutter(section, model, required_speed_m_s=36).verdict == a.to_dict()["verdict"]
    assert aerodeck.monte_carlo(section, model, scatter, samples=10).verdict is None
    # what a sample cannot tell is said, and nothing that was asked for is dropped
    negative = {"torsion.damping_ratio": {"kind": "normal", "mean": 0.003, "standard_deviation": 0.003}}
    with pytest.warns(aerodeck.AerodeckWarning, match="failed"):
        some = aerodeck.monte_carlo(section, model, negative, samples=200, design_speed_m_s=20)
    assert some.probability[0] == some.counts["failed"] / 200 > 0.1
    # as is a mean that is not of the order of the section
    other = {"torsion.damping_ratio": {"kind": "normal", "mean": 0.3, "coefficient_of_variation": 0.05}}
    with pytest.warns(aerodeck.AerodeckWarning, match="where the model has"):
        odd = aerodeck.monte_carlo(section, model, other, samples=50, design_speed_m_s=20)
    assert any("where the model has" in doubt["text"] for doubt in odd.verdict["doubts"])
    # scatter of the forces as a file states it is what the keyword states
    stated, short = ({"aerodynamics": {"relative_scatter": 0.03}}, {"aerodynamic_scatter": 0.03})
    by_file, by_keyword = (aerodeck.monte_carlo(section, model, scatter, samples=50, **how) for how in (stated, short))
    assert by_file.to_dict() == by_keyword.to_dict() and by_file.mean_m_s != a.mean_m_s
    assert by_file.to_dict()["drawn_forces"]["relative_scatter"] == 0.03
    for keywords, place in [
        ({"aerodynamic_scatter": 0.05, "aerodynamics": {"relative_scatter": 0.1}}, "aerodynamic_scatter"),
        ({"parameter": []}, "parameter"),
    ]:
        with pytest.raises(aerodeck.InputError, match=place):
            aerodeck.monte_carlo(section, model, scatter, samples=10, **keywords)


def test_what_is_no_number_is_not_used_as_one(table, section, model):
    v_hat, values = np.array([0.5, 1.0, 2.0]), np.ones(3)
    names = ["H1", "H2", "H3", "H4", "A1", "A2", "A3", "A4"]
    bad = [
        (np.ma.array(values, mask=[0, 1, 0]), "without a mask"),
        (values + 1j, "real numbers"),
        (np.array(["1", "2", "3"]), "texts"),
        (np.array(["1", "2", "3"], dtype=object), "a str"),
        (np.array([True, False, True]), "truth values"),
        (np.arange(3).astype("datetime64[D]"), "dates"),
    ]
    how = dict(notation="scanlan", argument="v_hat", width_m=0.5)
    for array, said in bad:
        for pair in ((v_hat, array), (array, v_hat)):
            with pytest.raises(aerodeck.InputError, match=f"H1: .*{said}"):
                aerodeck.Derivatives.from_arrays({n: pair if n == "H1" else (v_hat, values) for n in names}, **how)
        with pytest.raises(aerodeck.InputError, match=f"K: .*{said}"):
            model.transfer(array)
        for given in (array, list(array)) if not np.ma.isMaskedArray(array) else (array,):
            with pytest.raises(aerodeck.InputError, match="torsion.frequency_hz: expected"):
                aerodeck.onsets(section, model, {"torsion.frequency_hz": given})
    with pytest.raises(aerodeck.InputError, match="H1: .*without a mask"):
        columns = np.ma.array(np.column_stack([v_hat, values]), mask=[[0, 0], [0, 1], [0, 0]])
        aerodeck.Derivatives.from_arrays({n: columns if n == "H1" else (v_hat, values) for n in names}, **how)
    with pytest.raises(aerodeck.InputError, match="H1: .*arrays of one length"):
        aerodeck.Derivatives.from_arrays({n: (v_hat, values[:2]) for n in names}, **how)
    # whole numbers and numbers among objects are numbers
    whole = {n: (v_hat.astype(object), np.ones(3, dtype=int)) for n in names}
    with pytest.warns(aerodeck.AerodeckWarning, match="flat plate's"):
        assert aerodeck.Derivatives.from_arrays(whole, **how).to_numpy()["H1"][0, 2] == 1.0


def test_onsets_take_whatever_has_names_and_arrays(section, model):
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame({"torsion.frequency_hz": [4.5, 5.0], "vertical.mass_kg_m": [15.0, 16.0]})
    by_dict = aerodeck.onsets(section, model, {name: frame[name].to_numpy() for name in frame})
    np.testing.assert_array_equal(aerodeck.onsets(section, model, frame).speed_m_s, by_dict.speed_m_s)
    with pytest.raises(aerodeck.InputError, match="values: expected a dict or DataFrame"):
        aerodeck.onsets(section, model, [4.5, 5.0])
    with pytest.raises(aerodeck.InputError, match="values: expected names of numbers of the section"):
        aerodeck.onsets(section, model, {1: [4.5, 5.0]})


def test_records_from_arrays_are_those_of_the_tunnel(table, section):
    records = aerodeck.Records.virtual_tunnel(table)
    direct = aerodeck.flutter(section, aerodeck.fit_laguerre(records))
    rebuilt = None
    for i in range(len(records)):
        _, motion, force = records.to_numpy(i)
        head = records.header(i)
        one = aerodeck.Records.from_arrays(
            motion, force, sampling_hz=head["sampling_hz"], mean_speed_m_s=head["mean_speed_m_s"],
            width_m=head["width_m"], air_density_kg_m3=head["air_density_kg_m3"], name=head["name"],
            segments=[(s["frequency_hz"], s["start_s"], s["end_s"]) for s in head["segments"]],
        )
        with pytest.raises(aerodeck.InputError, match="which no motion has there"):
            aerodeck.Records.from_arrays(
                motion, force, sampling_hz=head["sampling_hz"], mean_speed_m_s=head["mean_speed_m_s"],
                width_m=head["width_m"], air_density_kg_m3=head["air_density_kg_m3"], segments=[(7.0, 8.0, 34.0)],
            )
        rebuilt = one if rebuilt is None else rebuilt + one
    assert aerodeck.flutter(section, aerodeck.fit_laguerre(rebuilt)).speed_m_s == direct.speed_m_s
    assert direct.interval is not None
    plain = dict(sampling_hz=100.0, mean_speed_m_s=8.0, width_m=0.5, air_density_kg_m3=1.2)
    turned = aerodeck.Records.from_arrays(motion[:, ::-1], force[:, ::-1], dofs=["torsion", "vertical"], **plain)
    assert turned.dofs == ["vertical", "torsion"]
    np.testing.assert_array_equal(turned.to_numpy(0)[2], force)
    with pytest.raises(aerodeck.InputError, match="dofs: expected every motion once, found `torsion` twice"):
        aerodeck.Records.from_arrays(motion, force, dofs=("torsion", "torsion"), **plain)
    for bad, expected in [(force + np.nan, "finite numbers"), (force + 1j, "real numbers")]:
        with pytest.raises(aerodeck.InputError, match=expected):
            aerodeck.Records.from_arrays(motion, bad, **plain)
    for key, bad in [("sampling_hz", -1.0), ("mean_speed_m_s", np.nan), ("width_m", -5.0), ("air_density_kg_m3", 0.0)]:
        with pytest.raises(aerodeck.InputError, match=key):
            aerodeck.Records.from_arrays(motion, force, **{**plain, key: bad})


def test_records_in_another_unit_are_doubted(table, section):
    records = aerodeck.Records.virtual_tunnel(table)

    def fitted(factor, **other):
        scaled = None
        for i in range(len(records)):
            _, motion, force = records.to_numpy(i)
            head = {k: v for k, v in records.header(i).items() if k not in ("segments", "source", "licence")}
            segments = [(s["frequency_hz"], s["start_s"], s["end_s"]) for s in records.header(i)["segments"]]
            one = aerodeck.Records.from_arrays(motion, force * factor, segments=segments, **{**head, **other})
            scaled = one if scaled is None else scaled + one
        return aerodeck.fit_laguerre(scaled)

    def is_doubted(verdict):
        assert verdict["outcome"]["state"] == "cannot_be_judged"
        return any(d["kind"] == "implausible_input" for d in verdict["doubts"])

    assert aerodeck.flutter(section, fitted(1.0), required_speed_m_s=45.0).verdict["outcome"]["state"] == "not_met"
    in_kn = fitted(1e-3)
    for wrong in [in_kn, fitted(0.5), fitted(1.0, air_density_kg_m3=1250.0)]:
        assert is_doubted(aerodeck.flutter(section, wrong, required_speed_m_s=45.0).verdict)
    some = {"torsion.damping_ratio": {"kind": "lognormal", "coefficient_of_variation": 0.2}}
    scatter = aerodeck.monte_carlo(section, in_kn, some, samples=20, design_speed_m_s=45.0)
    assert is_doubted(scatter.verdict)


@pytest.mark.skipif("AERODECK_TRAINED" not in os.environ, reason="no model trained by the program")
def test_a_loaded_model_has_the_covariance_beside_it():
    model = aerodeck.Model.load(os.environ["AERODECK_TRAINED"])
    assert aerodeck.flutter(model.section, model).interval == pytest.approx((36.27, 37.57), abs=0.01)


def test_saved_models_and_records_come_back(tmp_path, table, section, model):
    model.save(tmp_path / "model.json", section)
    again = aerodeck.Model.load(tmp_path / "model.json")
    assert again.section == section
    np.testing.assert_array_equal(again.transfer([0.1, 1.0]), model.transfer([0.1, 1.0]))
    records = aerodeck.Records.virtual_tunnel(table)
    paths = records.write(tmp_path / "new" / "folder")
    np.testing.assert_array_equal(aerodeck.Records.read(*paths).to_numpy(0)[2], records.to_numpy(0)[2])
    table.write(tmp_path / "table.csv", "polimi")
    np.testing.assert_allclose(aerodeck.Derivatives.read(tmp_path / "table.csv").to_numpy()["A2"], table.to_numpy()["A2"], rtol=1e-12)


def test_fmu_runs_in_fmpy_and_gives_the_same_motion(tmp_path, section, model):
    fmpy = pytest.importorskip("fmpy")
    path = tmp_path / "deck.fmu"
    aerodeck.export_fmu(path, section, model, wind_speed_m_s=30.0)
    result = fmpy.simulate_fmu(str(path), stop_time=2.0, output_interval=0.01, output=["heave", "rotation"])
    motion = aerodeck.simulate(section, model, 30.0, stop_time_s=2.0)
    scale = np.abs(motion.displacement).max(axis=0)
    np.testing.assert_allclose(result["heave"] / scale[0], motion.displacement[:, 0] / scale[0], atol=1e-9)
    np.testing.assert_allclose(result["rotation"] / scale[1], motion.displacement[:, 1] / scale[1], atol=1e-9)
    with pytest.raises(aerodeck.AerodeckError):
        aerodeck.export_fmu(path, section, model)


def test_errors_say_file_place_expected_and_found(tmp_path, table, section, model):
    broken = tmp_path / "broken.json"
    broken.write_text('{"schema_version": 99}')
    with pytest.raises(aerodeck.InputError) as caught:
        aerodeck.Model.load(broken)
    error = pickle.loads(pickle.dumps(caught.value))
    assert (error.file, error.place, error.found) == (str(broken), "schema_version", "99")
    assert isinstance(error, ValueError) and "99" in str(error)
    with pytest.raises(aerodeck.FileError):
        aerodeck.Model.load(tmp_path / "none.json")
    with pytest.raises(aerodeck.InputError, match="torsion"):
        section.replace({"torsion.nonsense": 1.0})
    with pytest.raises(aerodeck.InputError, match="positive"):
        section.replace({"width_m": -1.0})
    with pytest.raises(aerodeck.InputError, match="scanlan"):
        aerodeck.Derivatives.deck("LN21-5200").to_numpy("nonsense")
    # a slip in a keyword names the keywords, and no place in a text that the user never wrote
    with pytest.raises(aerodeck.InputError, match="options: .*unknown field `filtres`.*`weights`") as caught:
        aerodeck.fit_laguerre(aerodeck.Derivatives.deck("LN21-5200"), filtres=1)
    assert "line" not in str(caught.value) and "column" not in str(caught.value)
    slips = [
        ("tunnel: .*unknown field `noise`.*`noise_fraction`", lambda: aerodeck.Records.virtual_tunnel(table, noise=0.1)),
        ("section: .*unknown field `widht_m`.*`width_m`", lambda: aerodeck.Section.from_dict(section.to_dict() | {"widht_m": 1.0})),
        ("parameters: .*unknown field `cov`", lambda: aerodeck.monte_carlo(
            section, model, {"torsion.frequency_hz": {"kind": "lognormal", "cov": 0.05}}, samples=10)),
        ("parameters: .*unknown field `sampels`.*`samples`", lambda: aerodeck.monte_carlo(
            section, model, {"torsion.frequency_hz": {"kind": "lognormal", "coefficient_of_variation": 0.05}}, sampels=10)),
    ]
    nan, scattered = np.array([2.0, np.nan]), {"torsion.frequency_hz": {"kind": "normal", "standard_deviation": np.inf}}
    slips += [
        ("options.poles.fixed: expected a finite number, found NaN", lambda: aerodeck.fit_rational(table, poles=nan)),
        ("options.weights.by: expected a finite", lambda: aerodeck.fit_laguerre(table, weights={"by": [[1.0], nan]})),
        ("tunnel.speeds_m_s: expected a finite", lambda: aerodeck.Records.virtual_tunnel(table, speeds_m_s=nan)),
        ("parameters.torsion.frequency_hz.standard_deviation: .*inf", lambda: aerodeck.monte_carlo(section, model, scattered)),
    ]
    for message, slip in slips:
        with pytest.raises(aerodeck.InputError, match=message) as caught:
            slip()
        assert " line " not in str(caught.value) and "column" not in str(caught.value)


def test_a_required_speed_that_is_none_is_refused(section, model):
    for speed in (float("nan"), 0.0, -1.0):
        with pytest.raises(aerodeck.InputError, match="required_speed_m_s: expected a positive number"):
            aerodeck.flutter(section, model, required_speed_m_s=speed)


def test_the_verdict_is_that_of_the_library(section, model, table):
    def judged(required_speed_m_s):
        onset = aerodeck.flutter(section, model, required_speed_m_s=required_speed_m_s)
        assert onset.verdict["outcome"]["state"] == onset.outcome
        return onset.outcome, onset.headline

    outcome, headline = judged(30.0)
    assert outcome == "met" and headline.startswith("✓ MET, required 30 m/s: flutter onset 36.9 m/s")
    # the search reaches what is required
    outcome, headline = judged(200.0)
    assert outcome == "not_met" and headline.startswith("✗ NOT MET, required 200 m/s")
    # without a requirement nothing is judged, and one is suggested
    free = aerodeck.flutter(section, model)
    assert free.outcome is None and 36 < free.verdict["suggested_m_s"] < 36.92
    # a table has no interval
    assert aerodeck.flutter(section, table, required_speed_m_s=30.0).outcome == "cannot_be_judged"


def test_what_is_odd_is_warned_of_and_doubted(table, section, tmp_path):
    """Numbers over V̂ labelled V*: 5.9 m/s for 36.9. Neither a fit nor records made from the table lose the doubt."""
    written = tmp_path / "right.csv"
    table.write(written)
    wrong = tmp_path / "wrong.csv"
    text = written.read_text(encoding="utf-8").replace("# argument: v_hat = V/(omega B)", "# argument: v_star = V/(f B)")
    wrong.write_text(text.replace(",v_hat,", ",v_star,"), encoding="utf-8")
    with pytest.warns(aerodeck.AerodeckWarning, match=r"read as Scanlan with 1/2, over v_hat"):
        mislabelled = aerodeck.Derivatives.read(wrong)
    records = aerodeck.Records.virtual_tunnel(mislabelled)
    both = records + aerodeck.Records.virtual_tunnel(mislabelled, noise_fraction=0.01)
    for data in (mislabelled, aerodeck.fit_laguerre(mislabelled), aerodeck.fit_rational(both)):
        onset = aerodeck.flutter(section, data, required_speed_m_s=5.0)
        assert onset.outcome == "cannot_be_judged", onset.headline
        said = [w for w in onset.warnings if "read as Scanlan with 1/2, over v_hat" in w]
        assert len(said) == 1, onset.warnings
    with pytest.warns(aerodeck.AerodeckWarning, match="were width_m the semi-chord, B would be 0.5 m"):
        halved = section.replace({"width_m": 0.25})
    onset = aerodeck.flutter(halved, aerodeck.fit_laguerre(table), required_speed_m_s=30.0)
    assert onset.outcome == "cannot_be_judged"
    assert sum("semi-chord" in w for w in onset.warnings) == 1


def test_names_that_a_terminal_obeys_are_refused(tmp_path, table, section, model):
    model.save(tmp_path / "model.json", section)
    text = (tmp_path / "model.json").read_text(encoding="utf-8")
    (tmp_path / "model.json").write_text(text.replace('"name": "', '"name": "\\u001b[2J', 1), encoding="utf-8")
    with pytest.raises(aerodeck.InputError, match="name: expected a text without control characters"):
        aerodeck.Model.load(tmp_path / "model.json")
    def named(name):
        return aerodeck.Records.from_arrays(
            np.zeros((64, 2)), np.zeros((64, 2)), sampling_hz=100.0, mean_speed_m_s=8.0, width_m=0.5,
            air_density_kg_m3=1.2, name=name,
        )

    with pytest.raises(aerodeck.InputError, match="name: expected a text without control characters"):
        named("a\x1b[31m")
    assert [p.name for p in named("../=a|b").write(tmp_path)] == ["__a_b.csv"]


def test_what_a_callback_raises_is_raised(table):
    def stop(done, total):
        raise KeyboardInterrupt

    records = aerodeck.Records.virtual_tunnel(table)
    with pytest.raises(KeyboardInterrupt):
        aerodeck.fit_laguerre(records, progress=stop)


def test_other_threads_run_while_the_library_works(section, model):
    ticks, stop = [], threading.Event()

    def tick():
        while not stop.wait(0.001):
            ticks.append(None)

    other = threading.Thread(target=tick)
    other.start()
    aerodeck.onsets(section, model, {"torsion.frequency_hz": np.linspace(4, 6, 50_000)})
    stop.set()
    other.join()
    assert len(ticks) > 5


def test_process_finds_the_derivatives_of_a_virtual_campaign():
    campaign = os.environ.get("AERODECK_CAMPAIGN")
    if not campaign:
        pytest.skip("AERODECK_CAMPAIGN names no campaign; tests/python_package.rs makes one")
    found = aerodeck.process(campaign)
    assert len(found.records) > 0 and found.report["runs"] and found.estimates
    onset = aerodeck.flutter(aerodeck.Section.table_4_1(), aerodeck.fit_laguerre(found.derivatives))
    assert abs(onset.speed_m_s / 36.92 - 1) < 0.02


def test_pages_for_notebooks(table, section, model):
    for shown in [table, section, model, aerodeck.flutter(section, model), aerodeck.sweep(section, model)]:
        html = shown._repr_html_()
        assert html.startswith("<table") and html.count("<tr>") >= 2 and repr(shown)


def test_plots(table, section, model):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("agg")
    onset = aerodeck.flutter(section, model)
    figures = [
        aerodeck.sweep(section, model).plot(onset=onset),
        table.plot(models=[model]),
        model.plot(derivatives=table),
        aerodeck.simulate(section, model, 30.0, stop_time_s=1.0).plot(),
    ]
    assert all(figure.axes[0].lines for figure in figures)


def test_objects_are_pickled_and_copied(section, model, table):
    """The same numbers to the last bit, as they are handed to the processes of joblib, multiprocessing or Dask."""
    def again(thing):
        for other in (pickle.loads(pickle.dumps(thing)), copy.deepcopy(thing)):
            assert type(other) is type(thing) and repr(other) == repr(thing)
            yield other

    for other in again(section):
        assert other == section
    onset = aerodeck.flutter(section, model)
    for other in again(model):
        assert np.array_equal(other.transfer([0.1, 0.7]), model.transfer([0.1, 0.7]))
        found = aerodeck.flutter(section, other)
        assert (found.speed_m_s, found.interval) == (onset.speed_m_s, onset.interval)
    for other in again(table):
        assert all(np.array_equal(a, b) for a, b in zip(other.to_numpy().values(), table.to_numpy().values()))
    for other in again(onset):
        assert (other.speed_m_s, other.headline, other.verdict) == (onset.speed_m_s, onset.headline, onset.verdict)
    sweep = aerodeck.sweep(section, model)
    for other in again(sweep):
        assert np.array_equal(other.damping_ratio, sweep.damping_ratio, equal_nan=True)
    many = aerodeck.onsets(section, model, {"vertical.mass_kg_m": np.array([14.0, 15.0])})
    for other in again(many):
        assert np.array_equal(other.speed_m_s, many.speed_m_s)
    records = aerodeck.Records.from_arrays(
        np.random.default_rng(1).normal(size=(50, 2)),
        np.zeros((50, 2)),
        sampling_hz=100.0,
        mean_speed_m_s=8.0,
        width_m=0.5,
        air_density_kg_m3=1.2,
    )
    for other in again(records):
        assert all(np.array_equal(a, b) for a, b in zip(other.to_numpy(0), records.to_numpy(0)))


def test_onsets_are_found_in_other_processes(section, model):
    with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")) as pool:
        found = list(pool.map(aerodeck.flutter, [section] * 2, [model] * 2))
    expected = aerodeck.flutter(section, model)
    assert [o.speed_m_s for o in found] == [expected.speed_m_s] * 2


def test_nothing_but_numpy_is_needed():
    script = (
        "import sys; sys.modules['matplotlib'] = None; import aerodeck; "
        "print(aerodeck.flutter(aerodeck.Section.table_4_1(), aerodeck.fit_laguerre(aerodeck.Derivatives.deck('LN21-5200'))).state)"
    )
    assert subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout == "onset\n"


def test_stubs_are_those_of_the_module():
    checked = subprocess.run(
        [sys.executable, "-m", "mypy.stubtest", "aerodeck", "--ignore-missing-stub"], capture_output=True, text=True
    )
    assert checked.returncode == 0, checked.stdout + checked.stderr


def test_readme_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = "".join((ROOT / page).read_text(encoding="utf-8") for page in ("python/README.md", "docs/python.md"))
    blocks = re.findall(r"```python\n(.*?)```", text, re.S)
    assert len(blocks) >= 5
    for block in blocks:
        needs = {"dask": "dask", "frame": "pandas"}
        if any(word in block and find_spec(package) is None for word, package in needs.items()):
            continue
        exec(compile(block, "README.md", "exec"), {})
