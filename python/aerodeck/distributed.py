"""Beyond one machine: the same work over the workers of a Dask client, with the same bits.

Each function cuts its work into parts that know their own numbers, so that neither the count of workers nor their order
matters. A part is done on one core: start workers with one thread each (`LocalCluster(n_workers=8, threads_per_worker=1)`). What a
worker was doing when it was lost is done again elsewhere.
"""

from types import SimpleNamespace

import numpy as np

from ._aerodeck import Onsets, _monte_carlo_of, _monte_carlo_part, onsets, process
from ._errors import InputError

__all__ = ["campaign", "grid", "monte_carlo"]


def _parts(count, part):
    if not part > 0:
        raise InputError(None, "part", "a positive number", str(part))
    return [(first, min(first + part, count)) for first in range(0, count, int(part))]


def _gathered(client, futures, sizes, progress):
    """Results in the order of the futures; `progress` is told what is done."""
    from dask.distributed import as_completed

    place = {future.key: i for i, future in enumerate(futures)}
    results, done = [None] * len(futures), 0
    try:
        for future in as_completed(futures):
            i = place[future.key]
            results[i] = future.result()
            done += sizes[i]
            if progress is not None:
                progress(done, sum(sizes))
    finally:
        # who asks no more needs nothing of what has not begun
        client.cancel(futures)
    return results


def _shared(*values):
    """What all parts need, as a task of its own: a worker that is lost does not take it along."""
    return values


def _samples(shared, first, last):
    return _monte_carlo_part(*shared, first, last)


def monte_carlo(client, section, model, parameters, *, samples=10_000, seed=0, part=20_000, progress=None, **plan):
    """The distribution of the onset, as `aerodeck.monte_carlo` finds it.

    Parameters
    ----------
    client : dask.distributed.Client
    section, model, parameters, samples, seed, **plan
        As in `aerodeck.monte_carlo`.
    part : int
        Samples of a task: some seconds of work.
    progress : callable, optional
        Called with (done, total).

    Returns
    -------
    MonteCarlo
    """
    keywords = plan | {"samples": samples, "seed": seed}
    ranges = _parts(samples, part)
    shared = client.submit(_shared, section, model, parameters, keywords, pure=False)
    futures = [client.submit(_samples, shared, *range_, pure=False) for range_ in ranges]
    parts = _gathered(client, futures, [last - first for first, last in ranges], progress)
    return _monte_carlo_of(section, model, parameters, keywords, parts)


def _onsets(shared, first, last):
    section, model, axes, speed_max_m_s = shared
    shape = [len(values) for values in axes.values()]
    places = np.unravel_index(np.arange(first, last), shape)
    values = {name: axis[at] for (name, axis), at in zip(axes.items(), places)}
    return onsets(section, model, values, speed_max_m_s=speed_max_m_s, threads=1)


def grid(client, section, model, axes, *, speed_max_m_s=None, part=20_000, progress=None):
    """The onsets of all combinations of some numbers of the section.

    Parameters
    ----------
    client : dask.distributed.Client
    section, model, speed_max_m_s
        As in `aerodeck.onsets`.
    axes : dict of str to array or sequence
        Numbers of the section by their names in a study file, each with its values.
    part : int
        Onsets of a task.
    progress : callable, optional
        Called with (done, total).

    Returns
    -------
    Onsets
        Of all combinations, the last name running fastest: `speed_m_s.reshape([len(v) for v in axes.values()])`.
    """
    axes = {name: np.asarray(values, float) for name, values in axes.items()}
    count = int(np.prod([len(values) for values in axes.values()]))
    ranges = _parts(count, part)
    shared = client.submit(_shared, section, model, axes, speed_max_m_s, pure=False)
    futures = [client.submit(_onsets, shared, *range_, pure=False) for range_ in ranges]
    parts = _gathered(client, futures, [last - first for first, last in ranges], progress)
    columns = ("speed_m_s", "frequency_hz", "tested", "unstable", "judged")
    of_all = {name: np.concatenate([getattr(p, name) for p in parts]) for name in columns}
    return Onsets._from_parts(SimpleNamespace(searched_to_m_s=parts[0].searched_to_m_s, **of_all))


def campaign(client, campaigns, *, progress=None, **options):
    """Process raw campaigns side by side, each as `aerodeck.process` does.

    Parameters
    ----------
    client : dask.distributed.Client
    campaigns : sequence of str or os.PathLike
        Campaign files, which every worker can read.
    progress : callable, optional
        Called with (campaigns done, campaigns).
    **options
        As in `aerodeck.process`.

    Returns
    -------
    list of Processing
    """
    futures = [client.submit(process, str(path), pure=False, **options) for path in campaigns]
    return _gathered(client, futures, [1] * len(futures), progress)
