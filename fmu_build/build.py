"""Builds the FMU runtime for every platform that this machine can build for, checks and runs each library, and packs a
model with all of them.

    python3 fmu_build/build.py                          runtimes in target/runtimes, nothing packed
    python3 fmu_build/build.py --pack model.json x.fmu  the same, then x.fmu for all platforms and, for importers on ARM
                                                        Linux, x_arm_linux.fmu

What was built from the same sources by the same tools is not built, checked or run again: a digest of them stands in
target/runtimes/built_from.json. `--again` builds all the same.

A program that carries all runtimes: AERODECK_RUNTIME=$PWD/target/runtimes cargo install --path .

Rust alone builds for this machine. The Python packages ziglang and cargo-zigbuild, which this script installs into
target/fmu-build-env if it can, link for the other systems without their compilers, and for Linux against glibc 2.17, so
that libraries run on systems ten years old. Of Rust, each platform needs its standard library (`rustup target add …`);
what is missing is said and skipped. Libraries for other processors and systems are run where qemu or wine is there."""

import argparse
import hashlib
import json
import os
import pathlib
import re
import shutil
import struct
import subprocess
import sys
import venv

import run_library

ROOT = pathlib.Path(__file__).resolve().parent.parent
NAME = "aerodeck_section"
OLD_GLIBC = "2.17"
TOOLS = ["ziglang==0.17.1", "cargo-zigbuild==0.24.0", "lief==1.0.0"]
# Rust target: file that cargo makes, ending, folders below binaries/
TARGETS = {
    "x86_64-unknown-linux-gnu": ("libaerodeck_section.so", "so", ["linux64"]),
    "aarch64-unknown-linux-gnu": ("libaerodeck_section.so", "so", ["aarch64-linux"]),
    "x86_64-pc-windows-gnu": ("aerodeck_section.dll", "dll", ["win64"]),
    "x86_64-apple-darwin": ("libaerodeck_section.dylib", "dylib", ["darwin64"]),
    "aarch64-apple-darwin": ("libaerodeck_section.dylib", "dylib", ["aarch64-darwin"]),
}
RECORD = "built_from.json"
# no platform of FMI: the module that answers the sliders of reports, of which one target is enough
LIVE = ["wasm32-unknown-unknown", "wasm32-wasip2"]
# the runtime as a component, of the draft FMI-LS-WASM, which archives of FMI 3.0 hold where they are asked for it
COMPONENT = "wasm32-wasip2"
# linkers that export less than zig's, where they are there
LINKERS = {"x86_64-pc-windows-gnu": "x86_64-w64-mingw32-gcc"}
MACHINES = {"x86_64-apple-darwin": (0x01000007, 3), "aarch64-apple-darwin": (0x0100000C, 0)}  # of Mach-O
PAGE = 14  # bits of Apple's pages, to which the parts of a universal library are aligned


def run(*command, **options):
    print("+", " ".join(map(str, command)), flush=True)
    return subprocess.run([str(c) for c in command], cwd=ROOT, check=True, **options)


def text_of(*command):
    return subprocess.run([str(c) for c in command], cwd=ROOT, capture_output=True, text=True).stdout


def installed_targets():
    sysroot = pathlib.Path(text_of("rustc", "--print", "sysroot").strip())
    return {p.name for p in (sysroot / "lib" / "rustlib").iterdir() if (p / "lib").is_dir()}


def host():
    return re.search(r"^host: (\S+)", text_of("rustc", "-vV"), re.M).group(1)


def tools():
    """The interpreter of an environment with the tools, which come first on the path from then on; None without."""
    folder = ROOT / "target" / "fmu-build-env"
    python = folder / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    if not python.exists():
        venv.create(folder, with_pip=True)
    install = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-input", *TOOLS]
    done = subprocess.run(install, capture_output=True, text=True)
    if done.returncode:
        print("tools that could not be installed:", (done.stderr.strip().splitlines() or ["pip failed"])[-1])
        return None
    os.environ["PATH"] = str(python.parent) + os.pathsep + os.environ["PATH"]
    return python


def flags(target):
    """No trace of this machine in panic messages; nor in the name that a dylib calls itself."""
    home = pathlib.Path(os.environ.get("CARGO_HOME", pathlib.Path.home() / ".cargo"))
    pairs = [(ROOT, "aerodeck"), (home, "cargo")]
    sources = home / "registry" / "src"
    pairs += [(p, "crates") for p in sorted(sources.iterdir())] if sources.is_dir() else []
    remap = [f"--remap-path-prefix={old}={new}" for old, new in pairs]
    name = [f"-Clink-arg=-Wl,-install_name,@rpath/{NAME}.dylib"] * (target in MACHINES)
    return "\x1f".join(remap + name)


def build(target, zig):
    """The library of a target."""
    file, ending, _ = TARGETS[target]
    linker = LINKERS.get(target, "")
    zig = zig and not shutil.which(linker)
    target_dir = ROOT / "target" / "fmu-release"
    wanted = f"{target}.{OLD_GLIBC}" if zig and ending == "so" else target
    tool = ["cargo-zigbuild", "rustc"] if zig else ["cargo", "rustc"]
    environment = dict(os.environ, CARGO_ENCODED_RUSTFLAGS=flags(target))
    if shutil.which(linker):
        environment[f"CARGO_TARGET_{target.upper().replace('-', '_')}_LINKER"] = linker
    run(*tool, "--locked", "--package", "aerodeck-runtime", "--lib", "--crate-type", "cdylib",
        "--release", "--target", wanted, "--target-dir", target_dir, env=environment)  # fmt: skip
    return target_dir / target / "release" / file


def build_live(target, out):
    """The module for the sliders of reports, beside the runtimes."""
    target_dir = ROOT / "target" / "fmu-release"
    run("cargo", "rustc", "--locked", "--package", "aerodeck-live", "--lib", "--crate-type", "cdylib",
        "--profile", "live", "--target", target, "--target-dir", target_dir,
        env=dict(os.environ, CARGO_ENCODED_RUSTFLAGS=flags(target), CARGO_TARGET_WASM32_WASIP2_LINKER="rust-lld"))  # fmt: skip
    file = out / "wasm32" / f"{NAME}.wasm"
    file.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(target_dir / target / "live" / "aerodeck_live.wasm", file)
    print(f"{file}: {file.stat().st_size} bytes")


def build_component(out):
    """The runtime for WebAssembly, beside the others; every engine has vectors of two numbers."""
    target_dir = ROOT / "target" / "fmu-release"
    run("cargo", "build", "--locked", "--package", "aerodeck-component", "--profile", "component",
        "--target", COMPONENT, "--target-dir", target_dir,
        env=dict(os.environ, CARGO_ENCODED_RUSTFLAGS=flags(COMPONENT) + "\x1f-Ctarget-feature=+simd128"))  # fmt: skip
    file = out / COMPONENT / f"{NAME}.wasm"
    file.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(target_dir / COMPONENT / "component" / "aerodeck_component.wasm", file)
    print(f"{file}: {file.stat().st_size} bytes")


def universal(libraries):
    """Both libraries for macOS in one file: (target, bytes) to bytes."""
    head = struct.pack(">II", 0xCAFEBABE, len(libraries))
    at, parts = 1 << PAGE, []
    for target, library in libraries:
        machine, kind = MACHINES[target]
        head += struct.pack(">IIIII", machine, kind, at, len(library), PAGE)
        parts.append((at, library))
        at += -(-len(library) >> PAGE) << PAGE
    out = bytearray(head)
    for at, library in parts:
        out += bytes(at - len(out)) + library
    return bytes(out)


def digest(targets):
    """Of all that the runtimes are made from: sources, locked dependencies, compiler, this script, and what is to be built."""
    found = hashlib.sha256(text_of("rustc", "-vV").encode())
    found.update(repr((sorted(targets), TOOLS)).encode())
    crates = [p for name in ("component", "core", "unit", "runtime", "live") for p in (ROOT / "crates" / name).rglob("*") if p.is_file()]
    scripts = [p for p in pathlib.Path(__file__).parent.iterdir() if p.suffix in (".py", ".c")]
    for file in sorted([ROOT / "Cargo.toml", ROOT / "Cargo.lock", *crates, *scripts]):
        found.update(str(file.relative_to(ROOT)).encode() + b"\0" + file.read_bytes())
    return found.hexdigest()


def is_built(out, wanted):
    """Whether the runtimes of that digest are there, as they were left."""
    try:
        left = json.loads((out / RECORD).read_text(encoding="utf-8"))
        sums = {name: hashlib.sha256((out / name).read_bytes()).hexdigest() for name in left["files"]}
    except (OSError, ValueError, KeyError):
        return False
    return left["digest"] == wanted and left["files"] == sums


def leave_record(out, wanted):
    names = sorted(p.relative_to(out).as_posix() for p in out.rglob("*") if p.is_file() and p.name != RECORD)
    files = {name: hashlib.sha256((out / name).read_bytes()).hexdigest() for name in names}
    (out / RECORD).write_text(json.dumps({"digest": wanted, "files": files}, indent=1) + "\n", encoding="utf-8")


def place(built, out):
    """Lays the libraries out as in an archive; returns their files."""
    files = []

    def write(folder, ending, library):
        file = out / folder / f"{NAME}.{ending}"
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(library)
        files.append(file)

    shutil.rmtree(out, ignore_errors=True)
    libraries = {target: file.read_bytes() for target, file in built.items()}
    apple = [(target, library) for target, library in libraries.items() if target in MACHINES]
    for target, library in libraries.items():
        _, ending, folders = TARGETS[target]
        for folder in folders:
            # importers look into darwin64 on both processors
            whole = universal(apple) if folder == "darwin64" and len(apple) == 2 else library
            write(folder, ending, whole)
    return files


def pack(model, fmu, out, program):
    """The archives."""
    environment = dict(os.environ, AERODECK_RUNTIME_DIR=str(out))
    aerodeck = [program] if program else ["cargo", "run", "--release", "--locked", "--quiet", "--"]
    archives = [(fmu, [])]
    if (out / "aarch64-linux").is_dir():
        archives.append((fmu.with_name(f"{fmu.stem}_arm_linux.fmu"), ["--platforms", "arm-linux"]))
    for archive, options in archives:
        run(*aerodeck, "fmu", "export", model, "--out", archive, "--force", *options, env=environment)
        if shutil.which("fmpy"):
            run("fmpy", "validate", archive)
    run(*aerodeck, "fmu", "replay", fmu)


def runtimes(out, targets, python, program):
    """Builds, checks and runs what can be built; the digest says of what."""
    built = {target: build(target, python is not None) for target in targets if target not in LIVE}
    files = place(built, out)
    for target in set(LIVE) & set(targets):
        build_live(target, out)
    if COMPONENT in installed_targets():
        build_component(out)
    if python:
        run(python, pathlib.Path(__file__).with_name("check_library.py"), *files)
        run_library.compare(python, ROOT, {file.parent.name: file for file in files}, program)
    else:
        print("not checked: lief is not there")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "target" / "runtimes", help="folder for the runtimes")
    parser.add_argument("--pack", nargs=2, metavar=("MODEL", "FMU"), type=pathlib.Path, help="pack this model")
    parser.add_argument("--aerodeck", type=pathlib.Path, help="the program that packs [default: built from this source by cargo]")
    parser.add_argument("--again", action="store_true", help="build what was built before")
    arguments = parser.parse_args()
    out, program = arguments.out.resolve(), arguments.aerodeck and arguments.aerodeck.resolve()
    here, there = host(), installed_targets()
    live = [target for target in LIVE if target in there][:1]
    for target in [*TARGETS, *([] if live else LIVE[:1])]:
        if target not in there:
            print(f"skipped {target}: rustup target add {target}")
    targets = [target for target in [*TARGETS, *live] if target in there]
    if not arguments.again and is_built(out, digest(targets)):
        print(f"{out}: built before from these sources")
    else:
        python = tools()
        alone = [target for target in targets if target in (here, *LIVE) or shutil.which(LINKERS.get(target, ""))]
        for target in set(targets) - set(alone) if python is None else ():
            print(f"skipped {target}: ziglang and cargo-zigbuild are not there")
        targets = targets if python else alone
        runtimes(out, targets, python, program)
        # what could not be checked is built again
        if python:
            leave_record(out, digest(targets))
    if arguments.pack:
        pack(*(p.resolve() for p in arguments.pack), out, program)


if __name__ == "__main__":
    main()
