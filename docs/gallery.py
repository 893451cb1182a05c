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


# the sliders of a report, moved and alone on their page
MOVED = """<script>addEventListener("load", () => setTimeout(() => {
  for (const [id, value] of [["torsion-frequency_hz", 112], ["torsion-damping_ratio", 250]]) {
    const slider = document.getElementById("live-" + id);
    slider.value = value;
    slider.dispatchEvent(new Event("input"));
  }
  document.body.replaceChildren(document.getElementById("live"));
}, 3000))</script>"""


def sliders(page, folder):
    """Photographs the sliders in a browser of the Chromium family, where there is one and the program carries their module."""
    browser = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    text = page.read_text(encoding="utf-8")
    if not browser or "live-data" not in text:
        return print("no browser, or no module for the sliders: gallery/sliders.png stays as it is")
    moved = folder / "moved.html"
    moved.write_text(text.replace("</body>", MOVED + "</body>"), encoding="utf-8")
    subprocess.run([browser, "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking",
                    "--hide-scrollbars", "--virtual-time-budget=20000", f"--user-data-dir={folder / 'profile'}",
                    "--window-size=980,1030", f"--screenshot={HERE / 'sliders.png'}", f"file://{moved}"],
                   check=True, capture_output=True)  # fmt: skip


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
        sliders(Path(folder) / "demo/report.html", Path(folder))


if __name__ == "__main__":
    main(*sys.argv[1:])
