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
    """What to put in front of a program of this platform; None where it cannot run."""
    _, here, foreign = LOADERS[name]
    if (platform.system(), platform.machine()) == here:
        return []
    return foreign if foreign and shutil.which(foreign[0]) else None


def values(python, name, library, folder):
    """What the library computes of the model in `folder`."""
    loader = folder / f"run_{name}{'.exe' if name == 'win64' else ''}"
    target, _, _ = LOADERS[name]
    compiler = [python, "-m", "ziglang", "cc", "-target", target, "-O1", HERE / "run_library.c", "-o", loader]
    subprocess.run([*map(str, compiler), *(["-ldl"] if "linux" in target else [])], check=True)
    description = (folder / "modelDescription.xml").read_text(encoding="utf-8")
    guid = re.search(r'guid="([^"]+)"', description).group(1)
    program = runner(name)
    location = (folder / "resources").as_uri()
    if "wine" in program:
        location = location.replace("file:///", "file:///Z:/")
    # inputs and outputs of a section of two degrees of freedom come first
    run = [str(part) for part in [*program, loader, library, location, guid, "11"]]
    done = subprocess.run(run, capture_output=True, text=True, timeout=120, env={**os.environ, "WINEDEBUG": "-all"})
    if done.returncode:
        raise SystemExit(f"{name}: ended with {done.returncode}: {done.stderr.strip()}")
    return [struct.unpack(">d", bytes.fromhex(line.strip()))[0] for line in done.stdout.split()]


def compare(python, root, libraries):
    """Runs each library and prints how far it is from the first; ends the program when one is wrong."""
    first = None
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        fmu = folder / "unit.fmu"
        model = root / "tests" / "data" / "models" / "continuous_laguerre.json"
        export = ["cargo", "run", "--release", "--locked", "--quiet", "--", "fmu", "export", model, "--out", fmu]
        subprocess.run([*map(str, export), "--allow-unstable"], cwd=root, check=True)
        with zipfile.ZipFile(fmu) as archive:
            archive.extractall(folder)
        for name, library in libraries.items():
            if runner(name) is None:
                print(f"  {name}: not run, {LOADERS[name][2][0] if LOADERS[name][2] else 'macOS'} is not here")
                continue
            found = values(python, name, library, folder)
            first = first or found
            size = max(map(abs, first))
            off = max(abs(a - b) for a, b in zip(found, first, strict=True)) / size
            print(f"  {name}: {len(found)} values, same to {off:.0e}")
            if not off <= TOLERANCE:
                raise SystemExit(f"{name}: differs by {off}")
