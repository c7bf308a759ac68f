# SPDX-License-Identifier: GPL-2.0-only
"""The notebooks of the docs run from top to bottom, and are stored without what they have shown."""

import json
from pathlib import Path

import pytest

NOTEBOOKS = sorted((Path(__file__).parents[1] / "docs" / "notebooks").glob("*.ipynb"))


@pytest.fixture(scope="module")
def outputs(tmp_path_factory):
    """Outputs of the cells of each notebook: all run in one kernel, where each begins without names of the one before it."""
    import nbformat
    from nbclient import NotebookClient

    notebooks = [nbformat.read(path, as_version=4) for path in NOTEBOOKS]
    together = nbformat.v4.new_notebook()
    forget = nbformat.v4.new_code_cell("%reset -f")
    together.cells = [cell for notebook in notebooks for cell in (forget.copy(), *notebook.cells)]
    place = {"metadata": {"path": str(tmp_path_factory.mktemp("notebooks"))}}
    NotebookClient(together, timeout=120, kernel_name="python3", resources=place).execute()
    errors = [output.text for cell in together.cells for output in cell.get("outputs", ()) if output.get("name") == "stderr"]
    return {"errors": errors} | {
        path.stem: [output.get("data", {}) for cell in notebook.cells for output in cell.get("outputs", ())]
        for path, notebook in zip(NOTEBOOKS, notebooks)
    }


@pytest.mark.parametrize("name", [path.stem for path in NOTEBOOKS])
def test_runs(name, outputs):
    """Every cell; scenes and results show a picture, runs a bar."""
    shown = outputs[name]
    text = "".join("".join(data.get("text/html", "")) for data in shown)
    assert "<progress " in text and ("<img " in text or "<table" in text)
    assert any("image/png" in data for data in shown), "no plot"
    assert (name == "first-scene") == (" srcdoc=" in text)


def test_nothing_is_warned_of(outputs):
    """A reader's notebook shows results, and no remark of a library with a path of the machine."""
    assert outputs["errors"] == []


def test_are_stored_without_output():
    """Outputs are made when the docs are built; differences of versions stay readable."""
    assert len(NOTEBOOKS) == 3
    for path in NOTEBOOKS:
        cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
        assert not any(cell.get("outputs") or cell.get("execution_count") for cell in cells), path.name
