"""Builds what is uploaded of the Python package, in one command, and checks it: the wheel for any Linux of the last ten years
(manylinux2014, linked by zig) and the packed sources.

    python3 python/release.py [--out FOLDER]

The tools are installed into target/release-env. `AERODECK_RUNTIME=$PWD/target/runtimes` packs runtimes of all platforms into the wheel
(`python3 fmu_build/build.py` makes them); without, that of this machine. On other systems than Linux the wheel is that of the system.
"""

import argparse
import os
import pathlib
import subprocess
import sys
import venv

ROOT = pathlib.Path(__file__).resolve().parent.parent
TOOLS = ["maturin==1.16.0", "ziglang==0.17.1", "twine==7.0.0"]
# of the packed sources, in bytes: they stay small enough to read
MOST_SOURCES = 2_000_000


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--out", type=pathlib.Path, default=ROOT / "target" / "wheels")
    out = arguments.parse_args().out.resolve()
    environment = ROOT / "target" / "release-env"
    venv.create(environment, with_pip=True)
    python = environment / ("Scripts/python.exe" if sys.platform == "win32" else "bin/python")

    # maturin asks the first Python of the path for zig
    path = os.pathsep.join([str(python.parent), os.environ.get("PATH", "")])

    def run(*command):
        print("+", *command, flush=True)
        subprocess.run([python, "-m", *map(str, command)], cwd=ROOT, check=True, env=os.environ | {"PATH": path})

    run("pip", "install", "--quiet", "--only-binary=:all:", *TOOLS)
    out.mkdir(parents=True, exist_ok=True)
    for old in [*out.glob("*.whl"), *out.glob("*.tar.gz")]:
        old.unlink()
    manifest = ["--manifest-path", ROOT / "python" / "Cargo.toml", "--out", out]
    old_linux = ["--zig", "--compatibility", "manylinux2014"] if sys.platform == "linux" else []
    run("maturin", "build", "--release", *old_linux, *manifest)
    run("maturin", "sdist", *manifest)
    built = sorted(out.iterdir())
    run("twine", "check", "--strict", *built)
    for file in built:
        print(f"{file.stat().st_size / 1e6:6.2f} MB  {file.name}")
        if file.name.endswith(".tar.gz") and file.stat().st_size > MOST_SOURCES:
            sys.exit(f"{file.name}: expected at most {MOST_SOURCES} bytes of sources, found {file.stat().st_size}")


if __name__ == "__main__":
    main()
