#!/usr/bin/env python3
"""Everything that the program prints and writes, kept and compared: whether a change leaves the outputs as they were.

    python3 tests/common/fixtures.py record target/release/aerodeck before     # runs every command, keeps what comes out
    python3 tests/common/fixtures.py compare before after                      # exit code 1 where something differs
    python3 tests/common/fixtures.py compare before after --tolerance 1e-12    # numbers may differ by that, relative to the largest of a file

Times, folders and digests of bytes are taken out before files are compared; archives (FMU, XLSX) are compared member by member.
Needs Python 3.9 or newer and nothing else.
"""

import argparse
import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

SCATTER = """schema = 1
model = "model.json"
samples = 2000
seed = 1
design_speed_m_s = 20.0

[aerodynamics]
covariance = "fits/laguerre.uncertainty.json"

[[parameter]]
name = "torsion.damping_ratio"
distribution = { kind = "lognormal", coefficient_of_variation = 0.4 }
"""

BUFFETING = """
[section.static]
drag = 0.08
lift = -0.15
moment = 0.03
drag_slope = 0.0
lift_slope = 4.5
moment_slope = 1.2

[buffeting]
along = { spectrum = { shape = { kind = "kaimal" }, length_m = 150.0, intensity = 0.12 } }
vertical = { spectrum = { shape = { kind = "kaimal" }, length_m = 15.0, intensity = 0.06 } }
coherence = { along = 10.0, vertical = 6.5 }
time = { records = 2, duration_s = 60.0, step_s = 0.1, seed = 1 }
"""

# Name of a folder, then what is done in it: a command as text, or a file and what is added to its end.
JOBS = {
    "demo": ["demo"],
    "chain": [
        "new --deck LN21-6100 --out study.toml",
        "tunnel study.toml",
        "train study.toml",
        "flutter study.toml --all",
        "simulate model.json --wind-speed 20 --stop-time 2",
        "fmu export model.json --out section.fmu",
        "fmu export model.json --fmi 3 --out section3.fmu",
        "fmu export model.json --kind force --strips 3 --strip-length 2 --out force.fmu",
        "fmu check section.fmu",
        ("scatter.toml", SCATTER),
        "monte-carlo scatter.toml --json",
    ],
    "study": [
        "new --deck LN20-5500 --out study.toml",
        "study study.toml --out results",
        "report results",
        "plot results/curves.csv --x speed_m_s --y frequency_hz,damping_ratio",
    ],
    "plate": ["new --out study.toml", "study study.toml --out results --json --set deck.source=flat\u00a0plate"],
    "wind": ["quasi-steady", "buffeting"],
    "select": ["new --deck LN21-5200 --out study.toml", "select study.toml --filters 3 --values 4 --write selected.toml"],
    "campaign": ["campaign virtual LN21-5200 --out campaign", "campaign check campaign/campaign.toml",
                 "process campaign/campaign.toml --out results"],
    "compare": ["compare decks --out decks", "compare models --deck LN21-5200 --out models"],
    "tables": ["derivatives show LN21-5500", "derivatives show LN21-5500 --json", "derivatives notations"],
    "references": ["validate --json", "thesis --out thesis"],
    "coverage": ["coverage --repetitions 20 --json"],
    "bridge": ["demo --bridge --out first", "bridge show first/bridge.toml --out modes",
               "bridge flutter first/bridge.toml --out flutter",
               ("first/bridge.toml", BUFFETING), "bridge buffeting first/bridge.toml --speed 30 --out wind",
               "bridge convert first/bridge.toml modes.csv --every 4",
               "fmu export first/bridge.toml --bridge --out bridge.fmu"],
    "refusals": ["study missing.toml", "simulate --wind-speed nan", "derivatives show LN99", "fmu check missing.fmu", "flutter missing.toml"],
}

ARCHIVES = {".fmu", ".xlsx", ".zip"}
# binaries follow from the sources, pictures from the vector files beside them
LEFT_OUT = {".so", ".png", ".wasm"}
VARYING = [
    (re.compile(r"\d{4}-\d\d-\d\d[T ]\d\d:\d\d(:\d\d)?(\.\d+)?(Z|[+-]\d\d:?\d\d)?"), "<time>"),
    (re.compile(r"\d{4}-\d\d-\d\d"), "<day>"),
    (re.compile(r"\b\d+(\.\d+)? (ms|s|min)\b(?= (of|after|by) )"), "<duration>"),
    (re.compile(r"\b[0-9a-f]{40}\b|\b[0-9a-f]{64}\b"), "<digest>"),
    (re.compile(r"\{?[0-9a-f]{8}-([0-9a-f]{4}-){3}[0-9a-f]{12}\}?"), "<guid>"),
]
NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")


def record(program: Path, folder: Path) -> int:
    """Runs every job in a folder of its own; what a command prints and its exit code stand beside what it writes."""
    if folder.exists():
        shutil.rmtree(folder)
    for name, commands in JOBS.items():
        place = folder / name
        place.mkdir(parents=True)
        for number, command in enumerate(commands):
            if isinstance(command, tuple):
                with (place / command[0]).open("a", encoding="utf-8") as file:
                    file.write(command[1])
                continue
            # a space inside an argument is written as one that does not break
            arguments = [argument.replace("\u00a0", " ") for argument in command.split(" ")]
            done = subprocess.run([program, "--quiet", *arguments], cwd=place, capture_output=True, text=True, check=False)
            said = f"$ aerodeck {command}\nexit code {done.returncode}\n{done.stdout}\n--- messages\n{done.stderr}"
            (place / f"said_{number}.txt").write_text(said.replace(str(place.resolve()), "<here>"))
            print(f"{name}: {command}: exit code {done.returncode}", flush=True)
    return 0


def contents(folder: Path) -> dict:
    """Texts and bytes by name; members of archives by the name of the archive and their own."""
    found = {}
    for path in sorted(p for p in folder.rglob("*") if p.is_file()):
        name = str(path.relative_to(folder))
        if path.suffix in ARCHIVES:
            with zipfile.ZipFile(path) as archive:
                found.update({f"{name}!{member}": archive.read(member) for member in sorted(archive.namelist())})
        else:
            found[name] = path.read_bytes()
    return {name: data for name, data in found.items() if Path(name).suffix not in LEFT_OUT}


def steady(data: bytes):
    """Text without what changes from run to run; bytes that are no text as they are."""
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError:
        return data
    for pattern, word in VARYING:
        text = pattern.sub(word, text)
    return text


def largest_difference(before: str, after: str):
    """Of all numbers, relative to the largest of the two texts; None where the texts differ in more than numbers."""
    if NUMBER.sub("#", before) != NUMBER.sub("#", after):
        return None
    pairs = [(float(a), float(b)) for a, b in zip(NUMBER.findall(before), NUMBER.findall(after))]
    size = max((max(abs(a), abs(b)) for a, b in pairs), default=0.0)
    return max((abs(a - b) for a, b in pairs), default=0.0) / (size or 1.0)


def compare(before: Path, after: Path, tolerance: float) -> int:
    """Lists what differs; the exit code."""
    old, new = contents(before), contents(after)
    if not old:
        print(f"{before}: nothing recorded there")
        return 1
    differing = 0
    for name in sorted(old.keys() | new.keys()):
        if name not in old or name not in new:
            differing += 1
            print(f"{name}: only in {before if name in old else after}")
            continue
        a, b = steady(old[name]), steady(new[name])
        if a == b:
            continue
        change = largest_difference(a, b) if isinstance(a, str) and isinstance(b, str) else None
        if change is None or change > tolerance:
            differing += 1
            print(f"{name}: " + ("differs" if change is None else f"numbers differ by up to {change:.1e} of the largest"))
    print(f"{len(old.keys() | new.keys())} files, {differing} differ")
    return 1 if differing else 0


def main() -> int:
    """Of the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    verbs = parser.add_subparsers(dest="verb", required=True)
    recorded = verbs.add_parser("record", help="run every command and keep what comes out")
    recorded.add_argument("program", type=Path)
    recorded.add_argument("folder", type=Path)
    compared = verbs.add_parser("compare", help="compare two recordings")
    compared.add_argument("before", type=Path)
    compared.add_argument("after", type=Path)
    compared.add_argument("--tolerance", type=float, default=0.0, help="allowed difference of numbers, relative to the largest of a file")
    chosen = parser.parse_args()
    if chosen.verb == "record":
        return record(chosen.program.resolve(), chosen.folder)
    return compare(chosen.before, chosen.after, chosen.tolerance)


if __name__ == "__main__":
    sys.exit(main())
