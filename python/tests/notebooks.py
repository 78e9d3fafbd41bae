"""Runs every notebook; any error in one ends it. With --write their outputs are kept.

usage: python notebooks.py [--write]
"""

import sys
import tempfile
from pathlib import Path

import nbformat
from nbclient import NotebookClient

#: Bytes that a notebook with its pictures may have.
LARGEST = 200_000

for path in sorted((Path(__file__).parents[1] / "notebooks").glob("*.ipynb")):
    notebook = nbformat.read(path, as_version=4)
    with tempfile.TemporaryDirectory() as folder:
        NotebookClient(notebook, timeout=600, resources={"metadata": {"path": folder}}).execute()
    for cell in notebook.cells:
        cell.metadata.pop("execution", None)
        for output in cell.get("outputs", []):
            # What people see is enough.
            output.pop("execution_count", None) if output.output_type != "execute_result" else None
    if "--write" in sys.argv[1:]:
        nbformat.write(notebook, path)
    size = len(nbformat.writes(notebook))
    print(f"{path.name}: {size} bytes")
    assert size < LARGEST, f"{path.name} has {size} bytes; keep its pictures small"
