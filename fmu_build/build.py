"""Builds the FMU runtime for every platform that this machine can build for, checks each library, and packs a model
with all of them.

    python3 fmu_build/build.py                          runtimes in target/runtimes, nothing packed
    python3 fmu_build/build.py --pack model.json x.fmu  the same, then one FMU for all platforms, checked

Native builds need Rust only. With cargo-zigbuild the Linux library is built against glibc 2.17 and runs on systems ten
years old. Other platforms are built when their Rust target and linker are installed (`rustup target add …`).
Standard library only; uses nm, objdump and fmpy where they are there."""

import argparse
import os
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
NAME = "aerodeck_section"
# folder below binaries/, Rust target, file that cargo makes, ending, linker beside rustc
PLATFORMS = [
    ("linux64", "x86_64-unknown-linux-gnu", "libaerodeck.so", "so", None),
    ("aarch64-linux", "aarch64-unknown-linux-gnu", "libaerodeck.so", "so", "aarch64-linux-gnu-gcc"),
    ("win64", "x86_64-pc-windows-gnu", "aerodeck.dll", "dll", "x86_64-w64-mingw32-gcc"),
    ("darwin64", "x86_64-apple-darwin", "libaerodeck.dylib", "dylib", None),
    ("aarch64-darwin", "aarch64-apple-darwin", "libaerodeck.dylib", "dylib", None),
]
OLD_GLIBC = "2.17"
# what a library may ask of the system
NEEDED = {
    "so": re.compile(r"lib(c|m|gcc_s|dl|pthread|rt)\.so\.\d+|ld-linux.*"),
    "dll": re.compile(r"(?i)(kernel32|ntdll|msvcrt|bcryptprimitives|userenv|ws2_32)\.dll|api-ms-win-.*\.dll"),
}


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


def zig_works():
    """cargo-zigbuild takes `zig` or the Python package ziglang."""
    if not shutil.which("cargo-zigbuild"):
        return False
    return bool(shutil.which("zig") or text_of("python3", "-m", "ziglang", "version").strip())


def buildable():
    """(platform, target, file, ending, zig?) of all that can be built here."""
    targets, here = installed_targets(), host()
    zig = zig_works()
    for platform, target, file, ending, linker in PLATFORMS:
        if target not in targets:
            continue
        with_zig = zig and ending != "dll"
        if target == here or with_zig or (linker and shutil.which(linker)):
            yield platform, target, file, ending, with_zig


def flags():
    """As build.rs: no trace of this machine in panic messages."""
    home = pathlib.Path(os.environ.get("CARGO_HOME", pathlib.Path.home() / ".cargo"))
    pairs = [(ROOT, "aerodeck"), (home, "cargo")]
    sources = home / "registry" / "src"
    pairs += [(p, "crates") for p in sorted(sources.iterdir())] if sources.is_dir() else []
    return "\x1f".join(f"--remap-path-prefix={old}={new}" for old, new in pairs)


def build(platform, target, file, ending, with_zig, out):
    target_dir = ROOT / "target" / "fmu-release"
    wanted = f"{target}.{OLD_GLIBC}" if with_zig and ending == "so" else target
    tool = ["cargo-zigbuild", "rustc"] if with_zig else ["cargo", "rustc"]
    environment = dict(os.environ, CARGO_ENCODED_RUSTFLAGS=flags())
    linker = next(p[4] for p in PLATFORMS if p[0] == platform)
    if linker and not with_zig:
        environment[f"CARGO_TARGET_{target.upper().replace('-', '_')}_LINKER"] = linker
    run(*tool, "--locked", "--lib", "--crate-type", "cdylib", "--no-default-features", "--profile", "fmu",
        "--target", wanted, "--target-dir", target_dir, env=environment)
    library = out / platform / f"{NAME}.{ending}"
    library.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(target_dir / target / "fmu" / file, library)
    return library


def exports(library, ending):
    if ending == "dll":
        table = text_of("objdump", "-p", library).split("[Ordinal/Name Pointer] Table", 1)[-1]
        return set(re.findall(r"\[\s*\d+\](?: \+base\[\s*\d+\]\s+\w+)? (\w+)", table))
    symbols = text_of("nm", "-D", "--defined-only", library).split("\n")
    return {line.split()[-1] for line in symbols if line.strip()}


def check(library, ending):
    """Exports the interface and nothing else, needs the system's own libraries only."""
    if ending == "dylib" or not shutil.which("objdump"):
        return
    found = exports(library, ending)
    foreign = sorted(s for s in found if not s.startswith("fmi2"))
    if foreign or len(found) < 34:
        sys.exit(f"{library}: {len(found)} exports, not of FMI: {foreign}")
    headers = text_of("objdump", "-p", library)
    needed = re.findall(r"(?:NEEDED|DLL Name:)\s+(\S+)", headers)
    strange = [n for n in needed if not NEEDED[ending].fullmatch(n)]
    if strange:
        sys.exit(f"{library}: needs {strange}")
    versions = sorted({tuple(map(int, v.split("."))) for v in re.findall(r"GLIBC_([\d.]+)", headers)})
    glibc = f", GLIBC {'.'.join(map(str, versions[-1]))}" if versions else ""
    print(f"  {library.relative_to(ROOT)}: {library.stat().st_size} bytes, {len(found)} exports, "
          f"needs {', '.join(needed)}{glibc}")


def pack(model, fmu, out):
    environment = dict(os.environ, AERODECK_RUNTIME_DIR=str(out))
    aerodeck = ["cargo", "run", "--release", "--locked", "--quiet", "--", "fmu"]
    run(*aerodeck, "export", model, "--out", fmu, "--force", env=environment)
    run(*aerodeck, "check", fmu)
    if shutil.which("fmpy"):
        run("fmpy", "validate", fmu)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "target" / "runtimes", help="folder for the runtimes")
    parser.add_argument("--pack", nargs=2, metavar=("MODEL", "FMU"), type=pathlib.Path, help="pack this model")
    arguments = parser.parse_args()
    out = arguments.out.resolve()
    for platform, target, file, ending, with_zig in buildable():
        check(build(platform, target, file, ending, with_zig, out), ending)
    if arguments.pack:
        pack(*(p.resolve() for p in arguments.pack), out)


if __name__ == "__main__":
    main()
