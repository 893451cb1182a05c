"""The exported FMUs and what the same models gave in process, both written by `tests/fmpy.rs`."""

import json
import os
import struct
from pathlib import Path

import fmpy
import pytest
from fmpy.model_description import read_model_description
from section import Section

FOLDER = Path(os.environ.get("AERODECK_FMUS", ""))
if not (FOLDER / "expected.json").is_file():
    pytest.exit("AERODECK_FMUS names no folder of exported FMUs: run `cargo test --test fmpy`", 2)
EXPECTED = json.loads((FOLDER / "expected.json").read_text(encoding="utf-8"))
MODELS = EXPECTED["models"]


def number(bits):
    """A double from the sixteen hexadecimal digits of its bits."""
    return struct.unpack(">d", bytes.fromhex(bits))[0]


def numbers(table):
    """The same for all values of a dictionary."""
    return {name: number(bits) for name, bits in table.items()}


class Model:
    """An exported model: archive, unpacked folder, description, expectations."""

    def __init__(self, kind, folder):
        self.kind = kind
        self.fmu = FOLDER / f"{kind}.fmu"
        self.unpacked = folder / kind
        fmpy.extract(str(self.fmu), unzipdir=str(self.unpacked))
        self.description = read_model_description(str(self.fmu))
        self.expected = MODELS[kind]
        self.sampled = "discrete" in kind

    def section(self, **options):
        """A new instance."""
        return Section(self.unpacked, self.description, **options)
