"""Over the processes of a cluster: the same bits as on one machine, whatever happens to a worker."""

import os
import signal
import warnings

import aerodeck
import numpy as np
import pytest

distributed = pytest.importorskip("dask.distributed")
import aerodeck.distributed as beyond  # noqa: E402

SCATTER = {
    "torsion.frequency_hz": {"kind": "lognormal", "coefficient_of_variation": 0.05},
    "vertical.mass_kg_m": {"kind": "normal", "mean": 15.0, "standard_deviation": 0.5},
}


@pytest.fixture(scope="module")
def client():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        cluster = distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None)
        with cluster, distributed.Client(cluster) as connected:
            yield connected


def test_a_distribution_has_the_bits_of_one_process(client, section, model):
    keywords = {"samples": 20_001, "seed": 5, "aerodynamic_scatter": 0.05, "design_speed_m_s": 36.0, "quantiles": [0.01, 0.5]}
    told = []
    far = beyond.monte_carlo(
        client, section, model, SCATTER, part=3000, progress=lambda *at: told.append(at), **keywords
    )
    near = aerodeck.monte_carlo(section, model, SCATTER, **keywords)
    assert far.to_dict() == near.to_dict()
    assert told[-1] == (20_001, 20_001) and len(told) == 7


def test_a_grid_is_all_combinations(client, section, model):
    axes = {"vertical.mass_kg_m": [13, 15, 17], "torsion.frequency_hz": np.linspace(4.5, 5.5, 5)}
    far = beyond.grid(client, section, model, axes, part=4)
    mass, frequency = np.meshgrid(*axes.values(), indexing="ij")
    near = aerodeck.onsets(section, model, {"vertical.mass_kg_m": mass.ravel(), "torsion.frequency_hz": frequency.ravel()})
    for name in ("speed_m_s", "frequency_hz", "tested", "unstable"):
        np.testing.assert_array_equal(getattr(far, name), getattr(near, name))
    assert far.speed_m_s.reshape(3, 5)[1, 2] == aerodeck.onsets(section, model, {}).speed_m_s[0]


def test_a_killed_worker_loses_nothing(client, section, model):
    workers = client.run(os.getpid)
    victim = next(iter(workers.values()))
    killed = []

    def kill(done, total):
        if not killed:
            killed.append(victim)
            os.kill(victim, signal.SIGKILL)

    keywords = {"samples": 60_000, "seed": 3}
    far = beyond.monte_carlo(client, section, model, SCATTER, part=4000, progress=kill, **keywords)
    assert killed and far.to_dict() == aerodeck.monte_carlo(section, model, SCATTER, **keywords).to_dict()


def test_campaigns_side_by_side(client):
    campaign = os.environ.get("AERODECK_CAMPAIGN")
    if not campaign:
        pytest.skip("AERODECK_CAMPAIGN names no campaign; tests/python_package.rs makes one")
    far = beyond.campaign(client, [campaign, campaign])
    near = aerodeck.process(campaign)
    for one in far:
        assert one.report == near.report and one.warnings == near.warnings
        for name, points in near.derivatives.to_numpy().items():
            np.testing.assert_array_equal(one.derivatives.to_numpy()[name], points)


def test_what_is_wrong_is_said_at_once(client, section, model):
    with pytest.raises(aerodeck.InputError, match="part: expected a positive number"):
        beyond.monte_carlo(client, section, model, SCATTER, part=0)
    with pytest.raises(aerodeck.InputError, match="torsion.frequency_hz|cov"):
        beyond.monte_carlo(client, section, model, {"torsion.frequency_hz": {"kind": "lognormal", "cov": 0.05}}, samples=10)
    with pytest.raises(aerodeck.InputError, match="in one dimension"):
        beyond.grid(client, section, model, {"vertical.mass_kg_m": [[1.0, 2.0]]})
