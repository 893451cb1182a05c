"""A million flutter onsets: in one process on one core, then over the workers of a Dask cluster, with the same bits.

    pip install "dask[distributed]"
    python monte_carlo_on_a_cluster.py [SAMPLES [WORKERS]]

`LocalCluster` stands for a cluster of machines: `Client("scheduler:8786")` takes its place.
"""

import sys
import time

import aerodeck
from aerodeck import distributed
from dask.distributed import Client, LocalCluster

SCATTER = {
    "torsion.frequency_hz": {"kind": "lognormal", "coefficient_of_variation": 0.05},
    "vertical.mass_kg_m": {"kind": "lognormal", "coefficient_of_variation": 0.03},
}


def main(samples=1_000_000, workers=2):
    section = aerodeck.Section.table_4_1()
    model = aerodeck.fit_laguerre(aerodeck.Derivatives.deck("LN21-5200"))
    keywords = {"samples": samples, "seed": 1, "aerodynamic_scatter": 0.05, "design_speed_m_s": 34.0}

    def timed(count):
        with (
            LocalCluster(n_workers=count, threads_per_worker=1, dashboard_address=None) as cluster,
            Client(cluster) as client,
        ):
            # workers import the package before the clock starts
            distributed.monte_carlo(client, section, model, SCATTER, samples=100 * count, part=100)
            start = time.perf_counter()
            found = distributed.monte_carlo(client, section, model, SCATTER, **keywords)
            return found, time.perf_counter() - start

    one, alone = timed(1)
    all_of_them, together = timed(workers)
    assert all_of_them.to_dict() == one.to_dict()
    print(f"{samples} onsets: {alone:.1f} s by one worker, {together:.1f} s by {workers}")
    print(f"efficiency {alone / together / workers:.2f}, {samples / together:.0f} onsets a second")
    probability, low, high = all_of_them.probability
    print(f"probability of flutter below 34 m/s: {probability:.3e} ({low:.3e} to {high:.3e})")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
