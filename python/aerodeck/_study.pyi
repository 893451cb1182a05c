from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any

from . import Model

_Path = str | PathLike[str]

class Study:
    def __init__(self, file: _Path, text: str | None = None) -> None: ...
    @classmethod
    def from_toml(cls, path: _Path) -> Study: ...
    @classmethod
    def from_text(cls, text: str, directory: _Path = ".") -> Study: ...
    def run(
        self,
        out: _Path | None = None,
        *,
        values: Mapping[str, float | str] | None = None,
        figures: bool = True,
        progress: bool = False,
    ) -> StudyResult: ...

class StudyResult:
    def __init__(self, folder: Path, summary: dict[str, Any], code: int, temporary: Any = None) -> None: ...
    folder: Path
    summary: dict[str, Any]
    @property
    def headline(self) -> str: ...
    @property
    def verdict(self) -> dict[str, Any]: ...
    @property
    def onsets(self) -> list[dict[str, Any]]: ...
    @property
    def passed(self) -> bool: ...
    @property
    def models(self) -> list[str]: ...
    def model(self, name: str | None = None) -> Model: ...
