from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from typing import Any

from numpy.typing import ArrayLike

from . import Model, MonteCarlo, Onsets, Processing, Section

_Progress = Callable[[int, int], object] | None

def monte_carlo(
    client: Any,
    section: Section,
    model: Model,
    parameters: dict[str, dict[str, Any]],
    *,
    samples: int = 10_000,
    seed: int = 0,
    part: int = 20_000,
    progress: _Progress = None,
    **plan: Any,
) -> MonteCarlo: ...
def grid(
    client: Any,
    section: Section,
    model: Model,
    axes: Mapping[str, ArrayLike],
    *,
    speed_max_m_s: float | None = None,
    part: int = 20_000,
    progress: _Progress = None,
) -> Onsets: ...
def campaign(
    client: Any,
    campaigns: Sequence[str | PathLike[str]],
    *,
    progress: _Progress = None,
    **options: Any,
) -> list[Processing]: ...

__all__ = ["campaign", "grid", "monte_carlo"]
