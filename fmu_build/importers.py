"""Runs exported FMUs in every importer that can be installed here, each run in a process of its own, and prints which
took what:

    python3 fmu_build/importers.py             the table; fails when an importer that is there fails
    python3 fmu_build/importers.py --write     the same, and writes the table into docs/hosts.md

The importers come from the Python package index into `target/importers-env`, at the versions stated here; what cannot be
installed is named and skipped; its row in the manual stays as it was. fmi-sim is used where it is installed (`cargo install fmi-sim`,
which needs libclang), and so are fmusim, fmuCheck and VDMCheck, which no package registry has, where they are on the path; Ecos
needs the library libtbb (Debian: apt install libtbb12). All runs end with the values that FMPy gives when the functions
are called one by one; the table states the largest relative difference."""

import argparse
import json
import os
import pathlib
import shutil
import subprocess
import sys
import venv

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "hosts.md"
RUNS = pathlib.Path(__file__).with_name("importer_runs.py")
MODELS = ROOT / "tests" / "data" / "models"
SECONDS = 120
TOLERANCE = 1e-9  # of the largest output; importers that add steps up differ in the last bits of the time
BEGIN, END = "<!-- importers: python3 fmu_build/importers.py --write -->", "<!-- end of importers -->"

# name in words, run in importer_runs.py, package that it needs, further options of pip
IMPORTERS = [
    ("FMPy, `validate`", "fmpy_validate", "fmpy==0.3.32", []),
    ("FMPy, `simulate_fmu`", "fmpy", "fmpy==0.3.32", []),
    ("`aerodeck fmu check`", "aerodeck", "", []),
    ("`aerodeck fmu replay`", "aerodeck_replay", "", []),
    ("FMU manipulation toolbox, `-check`", "fmutool", "fmu-manipulation-toolbox==2.0", []),
    ("libcosim, Open Simulation Platform", "libcosim", "libcosimpy==0.0.6", []),
    ("Ecos", "ecos", "ecospy==0.7.2", []),
    ("PathSim", "pathsim", "pathsim==0.27.1", []),
    # preCICE itself is not needed: its runner runs on a stand-in
    ("preCICE's FMI runner, implicit", "precice", "fmiprecice==0.2.1", ["--no-deps"]),
    ("fmi-sim", "fmi_sim", "", []),
    ("OpenTURNS, FORM on `onset_speed`", "openturns", "openturns==1.27.post1", []),
    ("fmusim of the Reference FMUs", "fmusim", "", []),
    ("FMU Compliance Checker, `fmuCheck`", "fmucheck", "", []),
    ("VDMCheck2", "vdmcheck2", "", []),
    ("VDMCheck3", "vdmcheck3", "", []),
]
# what must be on the path, and what is said where it never was
PROGRAMS = {
    "fmi_sim": "fmi-sim", "fmusim": "fmusim", "fmucheck": "fmuCheck.linux64", "vdmcheck2": "VDMCheck2.sh",
    "vdmcheck3": "VDMCheck3.sh",
}  # fmt: skip
NOWHERE = "in no package registry"
# name in words, model, options of the export
UNITS = [
    ("continuous Laguerre", "continuous_laguerre", []),
    ("rational functions", "rational", []),
    ("discrete Laguerre", "discrete_laguerre", []),
    ("forces alone", "rational", ["--kind", "force"]),
    ("three strips", "continuous_laguerre", ["--kind", "force", "--strips", "3"]),
    ("real variables alone", "continuous_laguerre", ["--reals-only"]),
    ("FMI 3.0", "continuous_laguerre", ["--fmi", "3"]),
]
# what is left out, and why: importers that read every output as a real number, or know one version of the standard
FMI3 = UNITS[-1][0]
LEFT_OUT = {
    **{("pathsim", unit): "`--reals-only`" for unit in ("continuous Laguerre", "rational functions", "discrete Laguerre")},
    ("pathsim", FMI3): "reads truth values as real numbers",
    ("libcosim", FMI3): "FMI 2.0 alone",
    ("openturns", FMI3): "the example is for FMI 2.0",
    ("fmi_sim", FMI3): "reads no units",
    ("fmucheck", FMI3): "FMI 2.0 alone",
    ("vdmcheck2", FMI3): "FMI 2.0 alone",
    **{("vdmcheck3", unit): "FMI 3.0 alone" for unit, _, _ in UNITS[:-1]},
}


def environment(folder):
    """(interpreter, {package: why it is not there})"""
    python = folder / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    if not python.exists():
        venv.create(folder, with_pip=True)
    missing = {}
    for _, _, package, options in IMPORTERS:
        if package in missing or not package:
            continue
        command = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-input"]
        done = subprocess.run([*command, "--only-binary=:all:", *options, package], capture_output=True, text=True)
        if done.returncode:
            missing[package] = (done.stderr.strip().splitlines() or ["pip failed"])[-1]
    return python, missing


def exported(aerodeck, folder):
    """The FMUs, in the order of UNITS."""
    files = []
    for place, (_, model, options) in enumerate(UNITS):
        fmu = folder / f"unit{place}.fmu"
        export = [*aerodeck, "fmu", "export", MODELS / f"{model}.json", "--out", fmu, "--force", "--allow-unstable"]
        subprocess.run([*export, *options], check=True, stdout=subprocess.DEVNULL)
        files.append(fmu)
    return files


def run(python, importer, fmu):
    """(what the run printed, or None; what went wrong)"""
    try:
        done = subprocess.run([python, RUNS, importer, fmu], capture_output=True, text=True, timeout=SECONDS)
    except subprocess.TimeoutExpired:
        return None, f"still running after {SECONDS} s"
    if done.returncode:
        last = (done.stderr.strip().splitlines() or [f"ended with {done.returncode}"])[-1]
        return None, last
    return json.loads(done.stdout), ""


def verdict(found, expected):
    """(cell of the table, whether it is a failure)"""
    if found is None:
        return "–", False
    if isinstance(found, list):
        return ("no finding", False) if not found else (f"**{found[0]}**", True)
    if not found:
        return "**no outputs**", True
    size = max(abs(value) for value in expected.values())
    off = max(abs(found[name] - expected[name]) for name in found) / size
    if not off <= TOLERANCE:
        return f"**differs by {off:.1e}**", True
    return ("same bits" if off == 0.0 else f"same to {off:.0e}"), False


def not_here(words, importer, kept):
    """The row of an importer that cannot be run here: as it was in the manual, or what is known of it."""
    old = next((row for row in kept if row.startswith(f"| {words} ") and NOWHERE not in row), None)
    cells = old.strip("| ").split(" | ") if old else [words]
    new = [unit for unit, _, _ in UNITS[len(cells) - 1 :]]
    return "| " + " | ".join([*cells, *(LEFT_OUT.get((importer, unit), "–" if old else NOWHERE) for unit in new)]) + " |"


def table(python, missing, files):
    """(lines, reasons of what was skipped, failures)"""
    heads = ["importer", *(words for words, _, _ in UNITS)]
    lines = ["| " + " | ".join(heads) + " |", "|---" * len(heads) + "|"]
    skipped, failures = [], []
    kept = PAGE.read_text(encoding="utf-8").split(BEGIN)[1].split(END)[0].splitlines()
    expected = [run(python, "fmpy_calls", fmu) for fmu in files]
    for words, importer, package, _ in IMPORTERS:
        program = PROGRAMS.get(importer)
        if package in missing or program and not shutil.which(program):
            skipped.append(f"{words}: {missing.get(package, f'{program} is not on the path')}")
            lines.append(not_here(words, importer, kept))
            continue
        version = package.partition("==")[2]
        cells = [f"{words} ({version})" if version else words]
        for fmu, (reference, _), (unit, _, _) in zip(files, expected, UNITS, strict=True):
            if (importer, unit) in LEFT_OUT:
                cells.append(LEFT_OUT[importer, unit])
                continue
            found, why = run(python, importer, fmu)
            cell, failed = (f"**{why}**", True) if why else verdict(found, reference)
            cells.append(cell)
            if failed:
                failures.append(f"{words}, {unit}: {cell}")
            print(f"{words}, {unit}: {cell}", file=sys.stderr, flush=True)
        lines.append("| " + " | ".join(cells) + " |")
    return lines, skipped, failures


def into_manual(lines):
    text = PAGE.read_text(encoding="utf-8")
    head, rest = text.split(BEGIN)
    _, tail = rest.split(END)
    PAGE.write_text("\n".join([head + BEGIN, *lines, END + tail]), encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--aerodeck", help="the program [default: built from this source by cargo]")
    parser.add_argument("--folder", type=pathlib.Path, default=ROOT / "target" / "importers", help="folder for the FMUs")
    parser.add_argument("--write", action="store_true", help="write the table into docs/hosts.md")
    arguments = parser.parse_args()
    if arguments.aerodeck is None:
        subprocess.run(["cargo", "build", "--release", "--locked"], cwd=ROOT, check=True)
    program = str(pathlib.Path(arguments.aerodeck or ROOT / "target" / "release" / "aerodeck").resolve())
    os.environ["AERODECK"] = program
    arguments.folder.mkdir(parents=True, exist_ok=True)
    python, missing = environment(ROOT / "target" / "importers-env")
    lines, skipped, failures = table(python, missing, exported([program], arguments.folder.resolve()))
    print("\n".join(lines))
    for reason in skipped:
        print(f"not run: {reason}")
    if arguments.write:
        into_manual(lines)
    if failures:
        sys.exit("\n".join(["failed:", *failures]))


if __name__ == "__main__":
    main()
