"""Runs the libraries of all platforms that this machine can run, itself or with qemu and wine, and compares what they
compute: every FMU of a deck must move alike everywhere."""

import os
import pathlib
import platform
import re
import shutil
import struct
import subprocess
import tempfile
import zipfile

HERE = pathlib.Path(__file__).resolve().parent
# platform: target of zig, processor and system to compare with this machine, program that runs it elsewhere
LOADERS = {
    "linux64": ("x86_64-linux-gnu.2.17", ("Linux", "x86_64"), ["qemu-x86_64"]),
    "aarch64-linux": ("aarch64-linux-gnu.2.17", ("Linux", "aarch64"), ["qemu-aarch64", "-L", "/usr/aarch64-linux-gnu"]),
    "win64": ("x86_64-windows-gnu", ("Windows", "AMD64"), ["wine"]),
    "darwin64": ("x86_64-macos", ("Darwin", "x86_64"), None),
    "aarch64-darwin": ("aarch64-macos", ("Darwin", "arm64"), None),
}
# other processors multiply and add in one rounding, and have another libm
TOLERANCE = 1e-9


def runner(name):
    """(what to put in front of a program of this platform, or None; why it cannot run)"""
    _, here, foreign = LOADERS[name]
    if (platform.system(), platform.machine()) == here:
        return [], ""
    if foreign is None:
        return None, "macOS is not here"
    if not shutil.which(foreign[0]):
        return None, f"{foreign[0]} is not here"
    if "-L" in foreign and not pathlib.Path(foreign[-1]).is_dir():
        return None, f"{foreign[-1]}, the C library for {foreign[0]}, is not here"
    return foreign, ""


def values(python, name, library, folder):
    """What the library computes of the model in `folder`."""
    loader = folder / f"run_{name}{'.exe' if name == 'win64' else ''}"
    target, _, _ = LOADERS[name]
    compiler = [python, "-m", "ziglang", "cc", "-target", target, "-O1", HERE / "run_library.c", "-o", loader]
    subprocess.run([*map(str, compiler), *(["-ldl"] if "linux" in target else [])], check=True)
    description = (folder / "modelDescription.xml").read_text(encoding="utf-8")
    guid = re.search(r'guid="([^"]+)"', description).group(1)
    program, _ = runner(name)
    location = (folder / "resources").as_uri()
    if "wine" in program:
        location = location.replace("file:///", "file:///Z:/")
    # without arguments the loader complains: where it does not, it is the runner that does not work
    probe = subprocess.run([*program, str(loader)], capture_output=True, text=True, timeout=120)
    if "cannot load" not in probe.stderr:
        raise OSError((probe.stderr.strip().splitlines() or [f"it ended with {probe.returncode}"])[-1])
    # inputs and outputs of a section of two degrees of freedom come first
    run = [str(part) for part in [*program, loader, library, location, guid, "11"]]
    done = subprocess.run(run, capture_output=True, text=True, timeout=120, env={**os.environ, "WINEDEBUG": "-all"})
    if done.returncode:
        raise SystemExit(f"{name}: ended with {done.returncode}: {done.stderr.strip()}")
    return [struct.unpack(">d", bytes.fromhex(line.strip()))[0] for line in done.stdout.split()]


def compare(python, root, libraries, program=None):
    """Runs each library and prints how far it is from the first, or why it was not run; ends the program when one is wrong."""
    first = None
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        fmu = folder / "unit.fmu"
        model = root / "tests" / "data" / "models" / "continuous_laguerre.json"
        aerodeck = [program] if program else ["cargo", "run", "--release", "--locked", "--quiet", "--"]
        export = [*aerodeck, "fmu", "export", model, "--out", fmu]
        subprocess.run([*map(str, export), "--allow-unstable"], cwd=root, check=True)
        with zipfile.ZipFile(fmu) as archive:
            archive.extractall(folder)
        for name, library in libraries.items():
            foreign, why = runner(name)
            if foreign is None:
                print(f"  {name}: not run, {why}")
                continue
            try:
                found = values(python, name, library, folder)
            except (OSError, subprocess.SubprocessError) as error:
                # of its own machine a library must run
                if not foreign:
                    raise
                print(f"  {name}: not run, {foreign[0]} does not run it here: {error}")
                continue
            first = first or found
            size = max(map(abs, first))
            off = max(abs(a - b) for a, b in zip(found, first, strict=True)) / size
            print(f"  {name}: {len(found)} values, same to {off:.0e}")
            if not off <= TOLERANCE:
                raise SystemExit(f"{name}: differs by {off}")
