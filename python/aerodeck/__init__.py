"""Bridge aeroelasticity from wind-tunnel data to an FMU.

Fifteen lines from a deck to its flutter onset::

    import aerodeck

    table = aerodeck.Derivatives.deck("LN21-5200")      # or Derivatives.read("workbook.xlsx")
    model = aerodeck.fit_laguerre(table)
    section = aerodeck.Section.table_4_1()
    onset = aerodeck.flutter(section, model)
    print(onset.headline)
    aerodeck.export_fmu("deck.fmu", section, model)

Conventions, everywhere: deck width B in full; heave y and lift positive up; sway x and drag positive downwind; rotation θ and
moment nose-up (windward edge up), about mid-chord; forces per metre of span; K = ωB/V; motions in the order vertical,
lateral (if present), torsion. Names with a unit end in it (`speed_m_s`).
"""

from ._aerodeck import (
    Bridge,
    BridgeScatter,
    Buffeting,
    Derivatives,
    Model,
    MonteCarlo,
    Motion,
    Onset,
    Onsets,
    Processing,
    Records,
    Section,
    Stepper,
    Sweep,
    __version__,
    export_fmu,
    fit_laguerre,
    fit_rational,
    flutter,
    monte_carlo,
    onsets,
    process,
    simulate,
    sweep,
)
from ._errors import AerodeckError, AerodeckWarning, FileError, InputError, NumericalError, UnstableError
from ._study import Study, StudyResult

__all__ = [
    "AerodeckError",
    "AerodeckWarning",
    "Bridge",
    "BridgeScatter",
    "Buffeting",
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
    "Study",
    "StudyResult",
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
