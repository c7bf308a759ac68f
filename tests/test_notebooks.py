# SPDX-License-Identifier: GPL-2.0-only
"""The notebooks of the docs run from top to bottom, and are stored without what they have shown."""

import json
from pathlib import Path

import pytest

NOTEBOOKS = sorted((Path(__file__).parents[1] / "docs" / "notebooks").glob("*.ipynb"))


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_runs(path, tmp_path):
    """Every cell, in a fresh kernel; scenes and results show a picture, runs a bar."""
    import nbformat
    from nbclient import NotebookClient

    notebook = nbformat.read(path, as_version=4)
    NotebookClient(notebook, timeout=120, kernel_name="python3", resources={"metadata": {"path": str(tmp_path)}}).execute()
    shown = [output.get("data", {}) for cell in notebook.cells for output in cell.get("outputs", ())]
    text = "".join("".join(data.get("text/html", "")) for data in shown)
    assert "<progress " in text and ("<img " in text or "<table" in text)
    assert any("image/png" in data for data in shown), "no plot"


def test_are_stored_without_output():
    """What they show is made when the docs are built; differences of versions stay readable."""
    assert len(NOTEBOOKS) == 3
    for path in NOTEBOOKS:
        cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
        assert not any(cell.get("outputs") or cell.get("execution_count") for cell in cells), path.name
