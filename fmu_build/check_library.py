"""Checks shared libraries of the FMU runtime and prints what each is: `check_library.py LIBRARY…`. Fails when one exports
anything but the functions of FMI or not all of them, needs more than the system's own libraries or a glibc newer than 2.17,
or holds a path of this machine. Reads ELF, PE and Mach-O with lief (target/fmu-build-env has it)."""

import os
import pathlib
import re
import sys

import lief

ROOT = pathlib.Path(__file__).resolve().parent.parent
GLIBC = (2, 17)
# what a library may ask of the system
SYSTEM = {
    "ELF": r"lib(c|m|dl|pthread|rt)\.so\.\d+|ld-linux.*",
    "PE": r"(?i)(kernel32|ntdll|msvcrt|bcryptprimitives|userenv|ws2_32|ucrtbase)\.dll|api-ms-win-.*\.dll",
    "MACHO": r"/usr/lib/(libSystem\.B|libiconv\.2)\.dylib",
}

# what linkers export beside the functions: the language's own, and the header of a library for macOS
BESIDE = {
    "ELF": r"",
    "PE": r"_CRT_INIT|__mingw_\w+|atexit|_*unw_getcontext|rust_eh_personality|_RNv\w+EMPTY_PANIC",
    "MACHO": r"rust_eh_personality|__dso_handle|_mh_dylib_header|_RNv\w+EMPTY_PANIC",
}


def functions():
    """Names of the C interface, from its sources."""
    unit = ROOT / "crates" / "unit" / "src"
    read = lambda sources: "".join(re.sub(r"//.*", "", source.read_text(encoding="utf-8")) for source in sources)
    # some are made by macros, which are given their names
    two = re.findall(r"\bfmi2[A-Z]\w+(?=\()", read((unit / "fmi2").glob("exports_*.rs")))
    three = re.findall(r"\bfmi3[A-Z]\w+", read((unit / "fmi3").glob("*.rs")))
    return {*two, *three}


def paths():
    """What must not be found: where this build was made."""
    home = pathlib.Path.home()
    cargo = pathlib.Path(os.environ.get("CARGO_HOME", home / ".cargo"))
    return [str(path) for path in (ROOT, home, cargo, cargo / "registry") if len(str(path)) > 2] + [".cargo/registry"]


def described(binary):
    """(format and processor, exports, libraries that are needed, newest glibc)"""
    kind = binary.format.name
    exports, glibc = {f.name for f in binary.exported_functions}, ()
    if kind == "ELF":
        machine, needed = binary.header.machine_type.name, binary.libraries
        exports = {s.name for s in binary.exported_symbols}
        versions = [a.name for v in binary.symbols_version_requirement for a in v.get_auxiliary_symbols()]
        numbers = [tuple(map(int, v.split("_")[1].split("."))) for v in versions if re.fullmatch(r"GLIBC_[\d.]+", v)]
        glibc = max(numbers, default=())
    elif kind == "PE":
        machine, needed = binary.header.machine.name, [i.name for i in binary.imports]
        exports = {e.name for e in binary.get_export().entries}
    else:
        machine = binary.header.cpu_type.name
        needed = [lib.name for lib in binary.libraries if lib.command.name != "ID_DYLIB"]
        exports = {name.removeprefix("_") for name in {s.name for s in binary.exported_symbols}}
    return (kind, machine), exports, list(needed), glibc


def check(file):
    """Complaints about a library; prints what it is."""
    contents = file.read_bytes()
    complaints = [f"holds the path {path}" for path in paths() if path.encode() in contents]
    parsed = lief.MachO.parse(str(file)) if file.suffix == ".dylib" else [lief.parse(str(file))]
    wanted = functions()
    for binary in parsed:
        (kind, machine), exports, needed, glibc = described(binary)
        missing, foreign = sorted(wanted - exports), sorted(exports - wanted)
        foreign = [name for name in foreign if not re.fullmatch(BESIDE[kind], name)]
        strange = [name for name in needed if not re.fullmatch(SYSTEM[kind], name)]
        complaints += [f"does not export {missing}"] * bool(missing) + [f"exports also {foreign}"] * bool(foreign)
        complaints += [f"needs {strange}"] * bool(strange)
        complaints += [f"needs glibc {glibc}"] * (glibc > GLIBC)
        newest = f", glibc {'.'.join(map(str, glibc))}" if glibc else ""
        print(f"  {file.parent.name}/{file.name}: {kind} {machine}, {len(contents)} bytes, {len(exports)} exports, "
              f"needs {', '.join(needed) or 'nothing'}{newest}")  # fmt: skip
    return [f"{file}: {complaint}" for complaint in complaints]


def main():
    complaints = [complaint for name in sys.argv[1:] for complaint in check(pathlib.Path(name))]
    if complaints:
        sys.exit("\n".join(complaints))


if __name__ == "__main__":
    main()
