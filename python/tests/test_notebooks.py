"""The notebooks in examples/ run from the first cell to the last, in an empty folder, and print what is stored with them."""

import ast
import contextlib
import io
import json
from pathlib import Path

import pytest

NOTEBOOKS = sorted((Path(__file__).parents[2] / "examples").glob("*.ipynb"))


def test_there_are_notebooks():
    assert len(NOTEBOOKS) >= 4


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_notebook(path, tmp_path, monkeypatch):
    notebook = json.loads(path.read_text(encoding="utf-8"))
    for package in notebook["metadata"]["aerodeck_requires"]:
        pytest.importorskip(package)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("AERODECK_RUNS", "200")
    monkeypatch.setenv("MPLBACKEND", "agg")
    names = {"__name__": "__main__"}
    cells = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    for cell in cells:
        printed = io.StringIO()
        body = ast.parse("".join(cell["source"]), path.name)
        results = [o["data"]["text/plain"] for o in cell["outputs"] if o["output_type"] == "execute_result"]
        last = body.body.pop() if results else None
        with contextlib.redirect_stdout(printed):
            exec(compile(body, path.name, "exec"), names)
            shown = last and eval(compile(ast.Expression(last.value), path.name, "eval"), names)
        stored = "".join("".join(o["text"]) for o in cell["outputs"] if o["output_type"] == "stream")
        # of fewer runs here, or of a generator that promises no bits from one version to the next
        if "varies" not in cell["metadata"].get("tags", []):
            assert printed.getvalue() == stored, "stored otherwise: python examples/run_notebooks.py"
            assert all(repr(shown) == "".join(text) for text in results), "stored otherwise: python examples/run_notebooks.py"
    assert any(cell["outputs"] for cell in cells), "no outputs: python examples/run_notebooks.py"
