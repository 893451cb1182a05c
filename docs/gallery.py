"""Draws the pictures of docs/gallery.md anew: python3 docs/gallery.py PROGRAM

PROGRAM is the aerodeck executable, for instance target/release/aerodeck."""

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent / "gallery"
SCATTER = """schema = 1
model = "demo/model.json"
samples = 20000
design_speed_m_s = 34.0
[[parameter]]
name = "torsion.frequency_hz"
distribution = { kind = "normal", coefficient_of_variation = 0.05 }
[[parameter]]
name = "vertical.mass_kg_m"
distribution = { kind = "normal", coefficient_of_variation = 0.03 }
"""
# commands, each with the pictures that it leaves: where, and the name here
RUNS = [
    (["demo", "--out", "demo"], [("demo/flutter.svg", "flutter"), ("demo/derivatives.svg", "derivatives"),
                                  ("demo/roots.svg", "roots"), ("demo/response.svg", "response")]),
    (["monte-carlo", "scatter.toml", "--out", "scatter"], [("scatter/monte_carlo.svg", "monte_carlo")]),
    (["select", "demo/study.toml", "--out", "select"], [("select/selection.svg", "selection")]),
    (["demo", "--bridge", "--out", "bridge"], [("bridge/bridge_flutter.svg", "bridge_flutter"), ("bridge/flutter_motion.svg", "bridge_motion")]),
    (["buffeting", "--out", "wind"], [("wind/buffeting.svg", "buffeting"), ("wind/buffeting_spectra_35.svg", "spectra")]),
    (["quasi-steady", "--out", "quasi"], [("quasi/equilibrium.svg", "equilibrium")]),
]


def main(program):
    program = str(Path(program).resolve())
    HERE.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "scatter.toml").write_text(SCATTER, encoding="utf-8")
        for line, pictures in RUNS:
            print("+ aerodeck", *line, flush=True)
            done = subprocess.run([program, *line, "--quiet"], cwd=folder, capture_output=True, text=True)
            if done.returncode not in (0, 3):
                sys.exit(done.stderr)
            for left, name in pictures:
                found = Path(folder) / left
                if not found.exists():
                    there = ", ".join(sorted(p.name for p in found.parent.glob("*.svg")))
                    sys.exit(f"{left}: expected a picture, found {there}")
                shutil.copy(found, HERE / f"{name}.svg")


if __name__ == "__main__":
    main(*sys.argv[1:])
