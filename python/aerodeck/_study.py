"""Studies: the whole chain of a file, as `aerodeck study` runs it."""

import json
import tempfile
import warnings
from contextlib import contextmanager
from pathlib import Path

from ._aerodeck import Model, _command
from ._errors import AerodeckError, AerodeckWarning, InputError


class Study:
    """A study file: deck, section, models, wind speeds, what is exported.

    `Study.from_toml("study.toml").run("results")` is `aerodeck study study.toml --out results`.
    """

    def __init__(self, file, text=None):
        self._file = Path(file)
        self._text = text

    @classmethod
    def from_toml(cls, path):
        """The study of a file; the files that it names are looked for beside it."""
        return cls(path)

    @classmethod
    def from_text(cls, text, directory="."):
        """The study of a text, as a file in `directory` would hold it."""
        return cls(Path(directory) / "study.toml", text)

    def run(self, out=None, *, values=None, figures=True, progress=False):
        """Run it.

        Parameters
        ----------
        out : str or os.PathLike, optional
            Folder of the results; left out, one that goes with the result.
        values : dict of str to number or str, optional
            Values that stand for those of the file, by their places: `{"section.torsion.frequency_hz": 4.5}`.
        figures : bool
            Whether figures are drawn.
        progress : bool
            Whether progress is shown on a terminal.

        Returns
        -------
        StudyResult
        """
        temporary = None
        if out is None:
            temporary = tempfile.TemporaryDirectory(prefix="aerodeck-study-")
            out = temporary.name
        options = ["--out", str(out)] + ["--no-figures"] * (not figures) + ["--quiet"] * (not progress)
        options += [a for key, value in (values or {}).items() for a in ("--set", f"{key}={value}")]
        with self._as_file() as file:
            _, code = _command(["study", str(file), *options])
        # the file and not the answer in the terminal, which names itself otherwise
        summary = json.loads((Path(out) / "summary.json").read_text(encoding="utf-8"))
        for sentence in summary["warnings"]:
            warnings.warn(sentence, AerodeckWarning, stacklevel=2)
        return StudyResult(Path(out), summary, code, temporary)

    @contextmanager
    def _as_file(self):
        if self._text is None:
            yield self._file
            return
        # beside the files that it names
        with tempfile.NamedTemporaryFile("w", suffix=".toml", dir=self._file.parent, encoding="utf-8", delete=False) as file:
            file.write(self._text)
        try:
            yield Path(file.name)
        except AerodeckError as error:
            kind, said = error.__reduce__()[:2]
            raise kind(*(part and part.replace(file.name, "text") for part in said)) from None
        finally:
            Path(file.name).unlink(missing_ok=True)


class StudyResult:
    """What a study found: its answers and its folder.

    Attributes
    ----------
    folder : pathlib.Path
        All files of the study, `report.html` among them.
    summary : dict
        What `summary.json` holds.
    """

    def __init__(self, folder, summary, code, temporary=None):
        self.folder = folder
        self.summary = summary
        self._code = code
        self._temporary = temporary

    @property
    def headline(self):
        """The sentence above the numbers."""
        return self.summary["verdict"]["headline"]

    @property
    def verdict(self):
        """The verdict as a dict."""
        return self.summary["verdict"]

    @property
    def onsets(self):
        """Onsets of all models by all methods, as dicts."""
        return self.summary["onsets"]

    @property
    def passed(self):
        """Whether no stage failed and, where a wind speed is required, it is met."""
        return self._code == 0

    @property
    def models(self):
        """Names of the models that were trained."""
        return sorted(self._files())

    def _files(self):
        files = (self.folder / "models").glob("*.json")
        return {json.loads(file.read_text(encoding="utf-8"))["name"]: file for file in files}

    def model(self, name=None):
        """A trained model; left out, the one that the study exports."""
        name = name or self.summary["model"]
        files = self._files()
        if name not in files:
            raise InputError(None, "name", f"one of {', '.join(sorted(files))}", name)
        return Model.load(files[name])

    def __repr__(self):
        return f"StudyResult({self.headline})"
