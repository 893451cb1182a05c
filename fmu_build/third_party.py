"""Writes src/fmu/package/THIRD-PARTY.txt: the crates linked into the FMU runtime, their licences and the texts these
ask to be passed on. Needs cargo and the sources it has fetched: python3 fmu_build/third_party.py"""

import collections
import json
import pathlib
import re
import subprocess

ROOT = pathlib.Path(__file__).parent.parent
LINKED = [("aerodeck-runtime", "x86_64-unknown-linux-gnu"), ("aerodeck-component", "wasm32-wasip2")]
HEAD = """Third-party software in the FMU runtime
=======================================

The libraries in binaries/ are made of aerodeck and of the Rust crates listed here, and of the Rust standard
library (MIT OR Apache-2.0, Copyright The Rust Project Contributors). Where a crate offers a choice of licences, it
is used under the first of MIT, Apache-2.0, BSD-3-Clause, Zlib that it offers. The licence texts that the crates ship
follow the list; equal texts are given once.

"""


def cargo(*arguments):
    return subprocess.run(["cargo", *arguments], cwd=ROOT, check=True, capture_output=True, text=True).stdout


def linked():
    """(name, version) of every crate of the runtime but build scripts, procedural macros and aerodeck."""
    trees = [
        cargo(
            "tree", "--package", package, "--edges", "normal,no-proc-macro", "--target", target,
            "--prefix", "none", "--format", "{p}", "--no-dedupe",
        )
        for package, target in LINKED
    ]  # fmt: skip
    lines = [line for tree in trees for line in tree.splitlines()]
    crates = {tuple(line.split()[:2]) for line in lines if line.strip()}
    return sorted((name, version.lstrip("v")) for name, version in crates if not name.startswith("aerodeck"))


def texts(folder, licence):
    """Licence files of a crate; of a choice that includes MIT only the MIT text."""
    files = sorted(p for p in folder.iterdir() if re.match(r"(?i)(licen[sc]e|copying|notice|copyright)", p.name))
    files = [p for p in files if p.is_file()]
    mit = [p for p in files if "MIT" in p.name.upper()]
    chosen = mit if "MIT" in licence and mit else files
    return [p.read_text(encoding="utf-8", errors="replace").strip().replace("\r\n", "\n") for p in chosen]


def main():
    packages = json.loads(cargo("metadata", "--format-version", "1"))["packages"]
    by_name = {(p["name"], p["version"]): p for p in packages}
    lines, given = [], collections.OrderedDict()
    for name, version in linked():
        package = by_name[(name, version)]
        licence = (package["license"] or "see below").replace("/", " OR ")
        lines.append(f"{name} {version}: {licence}; {package['repository'] or 'no repository stated'}")
        found = texts(pathlib.Path(package["manifest_path"]).parent, licence)
        if not found:
            lines.append(f"    (ships no licence text; authors: {', '.join(package['authors']) or 'not stated'})")
        for text in found:
            given.setdefault(text, []).append(f"{name} {version}")
    out = HEAD + "\n".join(lines) + "\n"
    for text, crates in given.items():
        out += "\n" + "-" * 100 + "\n" + ", ".join(crates) + "\n\n" + text + "\n"
    (ROOT / "src" / "fmu" / "package" / "THIRD-PARTY.txt").write_text(out, encoding="utf-8")


if __name__ == "__main__":
    main()
