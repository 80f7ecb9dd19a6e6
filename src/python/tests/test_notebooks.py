"""The notebooks run from top to bottom; they are stored without what they show."""

import importlib.util
import json
import warnings
from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[1] / "notebooks"
NOTEBOOKS = sorted(path.stem for path in FOLDER.glob("*.ipynb"))
#: What a notebook needs beside numpy.
NEEDS = {
    "parameter_sweep": ["pandas"],
    "pendulum_identification": ["scipy"],
    "rotor_hub": ["pandas"],
    "suspension_openmdao": ["openmdao", "scipy"],
}


def test_there_are_five():
    assert len(NOTEBOOKS) == 5 and set(NEEDS) < set(NOTEBOOKS)


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_a_notebook_is_stored_without_outputs(name):
    cells = json.loads((FOLDER / f"{name}.ipynb").read_text(encoding="utf-8"))["cells"]
    assert cells[0]["cell_type"] == "markdown" and cells[0]["source"][0].startswith("# ")
    for cell in cells:
        assert not cell.get("outputs") and cell.get("execution_count") is None


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_a_notebook_runs(name):
    missing = [own for own in ["nbclient", "ipykernel", *NEEDS.get(name, [])] if importlib.util.find_spec(own) is None]
    if missing:
        pytest.skip(f"without {', '.join(missing)}")
    import nbformat
    from nbclient import NotebookClient

    notebook = nbformat.read(FOLDER / f"{name}.ipynb", as_version=4)
    with warnings.catch_warnings():
        # of the client's own
        warnings.simplefilter("ignore")
        NotebookClient(notebook, timeout=300, kernel_name="python3", resources={"metadata": {"path": FOLDER}}).execute()
    outputs = [out for cell in notebook.cells for out in cell.get("outputs", [])]
    errors = [out.text for out in outputs if out.get("name") == "stderr"]
    assert not errors, errors
    shown = [out.data for out in outputs if out.output_type == "execute_result"]
    assert any("text/html" in data for data in shown)
