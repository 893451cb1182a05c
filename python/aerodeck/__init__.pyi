from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from typing import Any, Literal, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

_Path = str | PathLike[str]
_Floats = NDArray[np.float64]
_Progress = Callable[[int, int], object] | None
_Snapshot = tuple[float, Sequence[float], float, float | None]

__version__: str

class AerodeckError(Exception): ...

class InputError(AerodeckError, ValueError):
    file: str | None
    place: str
    expected: str
    found: str
    def __init__(self, file: str | None, place: str, expected: str, found: str) -> None: ...

class FileError(AerodeckError, OSError):
    file: str
    reason: str
    def __init__(self, file: str, reason: str) -> None: ...

class NumericalError(AerodeckError, ArithmeticError): ...
class UnstableError(AerodeckError): ...

@final
class Derivatives:
    @staticmethod
    def read(
        path: _Path,
        *,
        notation: str | None = None,
        argument: str | None = None,
        axes: str | None = None,
        width_m: float | None = None,
        missing: str | None = None,
    ) -> Derivatives: ...
    @staticmethod
    def deck(name: str) -> Derivatives: ...
    @staticmethod
    def decks() -> list[str]: ...
    @staticmethod
    def from_arrays(
        values: Mapping[str, ArrayLike | tuple[ArrayLike, ArrayLike]],
        *,
        notation: str,
        argument: str,
        width_m: float,
        axes: str | None = None,
        name: str = "deck",
    ) -> Derivatives: ...
    def to_numpy(self, notation: str = "scanlan", *, argument: str | None = None, axes: str | None = None) -> dict[str, _Floats]: ...
    def write(self, path: _Path, notation: str = "scanlan", *, argument: str | None = None, axes: str | None = None) -> None: ...
    @property
    def name(self) -> str: ...
    @property
    def width_m(self) -> float: ...
    @property
    def source(self) -> str: ...
    @property
    def licence(self) -> str: ...
    @property
    def dofs(self) -> list[str]: ...
    @property
    def tested_range(self) -> tuple[float, float]: ...
    def plot(self, **keywords: Any) -> Any: ...
    def _repr_html_(self) -> str: ...

@final
class Records:
    @staticmethod
    def read(*paths: _Path) -> Records: ...
    @staticmethod
    def from_arrays(
        motion: _Floats,
        force: _Floats,
        *,
        sampling_hz: float,
        mean_speed_m_s: float,
        width_m: float,
        air_density_kg_m3: float,
        dofs: Sequence[str] = ...,
        segments: Sequence[tuple[float, float, float]] = ...,
        name: str = "record",
    ) -> Records: ...
    @staticmethod
    def virtual_tunnel(derivatives: Derivatives, *, lateral: bool = False, **plan: Any) -> Records: ...
    def write(self, folder: _Path) -> list[Any]: ...
    def to_numpy(self, index: int) -> tuple[_Floats, _Floats, _Floats]: ...
    def header(self, index: int) -> dict[str, Any]: ...
    @property
    def dofs(self) -> list[str]: ...
    def __len__(self) -> int: ...
    def __add__(self, value: Records, /) -> Records: ...
    def __radd__(self, value: Any, /) -> Any: ...

@final
class Section:
    def __new__(
        cls,
        *,
        width_m: float,
        mass_kg_m: float,
        inertia_kg_m2_m: float,
        vertical_frequency_hz: float,
        torsion_frequency_hz: float,
        vertical_damping_ratio: float,
        torsion_damping_ratio: float,
        air_density_kg_m3: float = 1.25,
        lateral: tuple[float, float, float] | None = None,
        axis_offset_m: float | None = None,
        mass_offset_m: float | None = None,
    ) -> Section: ...
    @staticmethod
    def table_4_1() -> Section: ...
    @staticmethod
    def iabse_1_1a() -> Section: ...
    @staticmethod
    def from_dict(values: dict[str, Any]) -> Section: ...
    def to_dict(self) -> dict[str, Any]: ...
    def replace(self, values: dict[str, float]) -> Section: ...
    @property
    def width_m(self) -> float: ...
    @property
    def dofs(self) -> list[str]: ...
    def __eq__(self, value: object, /) -> bool: ...
    def _repr_html_(self) -> str: ...

@final
class Model:
    @staticmethod
    def load(path: _Path) -> Model: ...
    def save(self, path: _Path, section: Section | None = None) -> None: ...
    def transfer(self, K: ArrayLike) -> NDArray[np.complex128]: ...
    @property
    def report(self) -> dict[str, Any] | None: ...
    @property
    def kind(self) -> str: ...
    @property
    def method(self) -> str: ...
    @property
    def states(self) -> int: ...
    @property
    def dofs(self) -> list[str]: ...
    @property
    def tested_range(self) -> tuple[float, float]: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def section(self) -> Section | None: ...
    def plot(self, **keywords: Any) -> Any: ...
    def _repr_html_(self) -> str: ...

@final
class Onset:
    @property
    def state(self) -> Literal["onset", "unstable", "stable"]: ...
    @property
    def speed_m_s(self) -> float | None: ...
    @property
    def frequency_hz(self) -> float | None: ...
    @property
    def reduced_velocity(self) -> float | None: ...
    @property
    def interval(self) -> tuple[float, float] | None: ...
    @property
    def no_interval(self) -> str | None: ...
    @property
    def in_tested_range(self) -> bool | None: ...
    @property
    def headline(self) -> str: ...
    @property
    def warnings(self) -> list[str]: ...
    @property
    def method(self) -> str: ...
    @property
    def card(self) -> dict[str, Any]: ...
    def _repr_html_(self) -> str: ...

@final
class Sweep:
    @property
    def speed_m_s(self) -> _Floats: ...
    @property
    def frequency_hz(self) -> _Floats: ...
    @property
    def damping_ratio(self) -> _Floats: ...
    @property
    def tested(self) -> NDArray[np.bool_]: ...
    @property
    def modes(self) -> list[str]: ...
    @property
    def ended(self) -> str | None: ...
    def plot(self, **keywords: Any) -> Any: ...
    def _repr_html_(self) -> str: ...

@final
class Onsets:
    @property
    def speed_m_s(self) -> _Floats: ...
    @property
    def frequency_hz(self) -> _Floats: ...
    @property
    def tested(self) -> NDArray[np.bool_]: ...
    @property
    def unstable(self) -> NDArray[np.bool_]: ...
    def __len__(self) -> int: ...

@final
class Motion:
    @property
    def time_s(self) -> _Floats: ...
    @property
    def displacement(self) -> _Floats: ...
    @property
    def rate(self) -> _Floats: ...
    @property
    def acceleration(self) -> _Floats: ...
    @property
    def force(self) -> _Floats: ...
    @property
    def dofs(self) -> list[str]: ...
    @property
    def wind_speed_m_s(self) -> float: ...
    def plot(self, **keywords: Any) -> Any: ...

@final
class Stepper:
    def __new__(
        cls,
        section: Section,
        model: Model,
        *,
        displacement: Sequence[float] | None = None,
        rate: Sequence[float] | None = None,
    ) -> Stepper: ...
    def step(
        self,
        step_s: float,
        wind_speed_m_s: float,
        force: Sequence[float] | None = None,
        *,
        wind_speed_rate_m_s2: float = 0.0,
        force_rate: Sequence[float] | None = None,
    ) -> _Floats: ...
    def snapshot(self) -> _Snapshot: ...
    def restore(self, snapshot: _Snapshot) -> None: ...
    @property
    def time_s(self) -> float: ...
    @property
    def displacement(self) -> _Floats: ...
    @property
    def rate(self) -> _Floats: ...
    @property
    def acceleration(self) -> _Floats: ...
    @property
    def force(self) -> _Floats: ...

@final
class MonteCarlo:
    @property
    def nominal_m_s(self) -> float | None: ...
    @property
    def mean_m_s(self) -> float | None: ...
    @property
    def standard_deviation_m_s(self) -> float | None: ...
    @property
    def counts(self) -> dict[str, int]: ...
    @property
    def quantiles(self) -> list[tuple[float, float | None]]: ...
    @property
    def histogram(self) -> tuple[_Floats, NDArray[np.uint64]]: ...
    @property
    def probability(self) -> tuple[float, float, float] | None: ...
    def to_dict(self) -> dict[str, Any]: ...
    def plot(self, **keywords: Any) -> Any: ...
    def _repr_html_(self) -> str: ...

@final
class Processing:
    @property
    def records(self) -> Records: ...
    @property
    def derivatives(self) -> Derivatives: ...
    @property
    def estimates(self) -> list[dict[str, Any]]: ...
    @property
    def report(self) -> dict[str, Any]: ...
    @property
    def warnings(self) -> list[str]: ...

def fit_laguerre(
    data: Derivatives | Records,
    filters: int = 3,
    *,
    lateral: bool = False,
    poles: Sequence[float] | None = None,
    progress: _Progress = None,
    **options: Any,
) -> Model: ...
def fit_rational(
    data: Derivatives | Records,
    lags: int = 2,
    *,
    added_mass: bool = True,
    lateral: bool = False,
    poles: Sequence[float] | None = None,
    progress: _Progress = None,
    **options: Any,
) -> Model: ...
def flutter(
    section: Section,
    model: Model | Derivatives | Literal["flat plate"],
    *,
    speed_max_m_s: float | None = None,
    method: Literal["eigenvalues", "determinant", "pk"] | None = None,
) -> Onset: ...
def sweep(section: Section, model: Model, speeds_m_s: _Floats | None = None) -> Sweep: ...
def onsets(
    section: Section,
    model: Model,
    values: dict[str, _Floats],
    *,
    speed_max_m_s: float | None = None,
    progress: _Progress = None,
) -> Onsets: ...
def simulate(
    section: Section,
    model: Model,
    wind_speed_m_s: float,
    *,
    stop_time_s: float = 10.0,
    step_s: float = 0.01,
    displacement: Sequence[float] | None = None,
) -> Motion: ...
def monte_carlo(
    section: Section,
    model: Model,
    parameters: dict[str, dict[str, Any]],
    *,
    samples: int = 10_000,
    seed: int = 0,
    aerodynamic_scatter: float | None = None,
    design_speed_m_s: float | None = None,
    speed_max_m_s: float | None = None,
    progress: _Progress = None,
    **plan: Any,
) -> MonteCarlo: ...
def export_fmu(
    path: _Path,
    section: Section | None,
    model: Model,
    *,
    kind: Literal["section", "force"] = "section",
    strips: Sequence[tuple[float, float]] | None = None,
    overwrite: bool = False,
    allow_unstable: bool = False,
    **experiment: Any,
) -> None: ...
def process(campaign: _Path, *, progress: _Progress = None, **options: Any) -> Processing: ...

__all__ = [
    "AerodeckError",
    "Derivatives",
    "FileError",
    "InputError",
    "Model",
    "MonteCarlo",
    "Motion",
    "NumericalError",
    "Onset",
    "Onsets",
    "Processing",
    "Records",
    "Section",
    "Stepper",
    "Sweep",
    "UnstableError",
    "__version__",
    "export_fmu",
    "fit_laguerre",
    "fit_rational",
    "flutter",
    "monte_carlo",
    "onsets",
    "process",
    "simulate",
    "sweep",
]
