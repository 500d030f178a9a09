"""Runs notebooks from top to bottom and keeps what their cells show in the files, as Jupyter does.

usage: python3 analytic/python/tools/run_notebooks.py NOTEBOOK..     with the built package in PYTHONPATH

Run it in a folder that holds the files that a notebook reads. Neither Jupyter nor its kernel is needed:
the code cells are executed by Python itself, one after the other in one namespace. A cell shows what it
prints, the value of its last expression (unless a `;` ends it) and the figures that it draws; no cell
uses magics.
"""

import ast
import base64
import contextlib
import io
import json
import os
import pathlib
import sys

os.environ["MPLBACKEND"] = "Agg"
os.environ.setdefault("MPLCONFIGDIR", os.environ.get("TMPDIR", "/tmp"))


def run(notebook):
    """The notebook with the outputs of its code cells."""
    document = json.loads(pathlib.Path(notebook).read_text(encoding="utf-8"))
    namespace = {"__name__": "__main__"}
    cells = [cell for cell in document["cells"] if cell["cell_type"] == "code"]
    for count, cell in enumerate(cells, start=1):
        cell["execution_count"] = count
        name = f"{pathlib.Path(notebook).name}, cell {count}"
        cell["outputs"] = _outputs("".join(cell["source"]), name, namespace, count)
    return document


def _outputs(source, name, namespace, count):
    tree = ast.parse(source, name)
    last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    printed, value = io.StringIO(), None
    with contextlib.redirect_stdout(printed):
        exec(compile(tree, name, "exec"), namespace)
        if last is not None:
            value = eval(compile(ast.Expression(last.value), name, "eval"), namespace)
    outputs = []
    if printed.getvalue():
        text = printed.getvalue().splitlines(keepends=True)
        outputs.append({"output_type": "stream", "name": "stdout", "text": text})
    if value is not None and not source.rstrip().endswith(";"):
        shown = {"text/plain": repr(value).splitlines(keepends=True)}
        outputs.append(
            {
                "output_type": "execute_result",
                "execution_count": count,
                "metadata": {},
                "data": shown,
            }
        )
    return outputs + [
        {"output_type": "display_data", "metadata": {}, "data": {"image/png": picture}}
        for picture in _pictures()
    ]


def _pictures():
    """The figures drawn since the last call, as text."""
    if "matplotlib.pyplot" not in sys.modules:
        return []
    plots = sys.modules["matplotlib.pyplot"]
    pictures = []
    for number in plots.get_fignums():
        file = io.BytesIO()
        # Without the date and the version, so that the same figure has the same bytes.
        plots.figure(number).savefig(file, format="png", dpi=72, metadata={"Software": None})
        pictures.append(base64.b64encode(file.getvalue()).decode("ascii"))
    plots.close("all")
    return pictures


def text_of(document):
    """What the code cells of a notebook show in words, cell by cell; a picture by its kind."""
    cells = [cell for cell in document["cells"] if cell["cell_type"] == "code"]
    return [
        "".join(
            "".join(output["text"])
            if output["output_type"] == "stream"
            else "".join(output["data"].get("text/plain", ["(a picture)"]))
            for output in cell["outputs"]
        )
        for cell in cells
    ]


if __name__ == "__main__":
    for path in sys.argv[1:]:
        text = json.dumps(run(path), indent=1, ensure_ascii=False)
        pathlib.Path(path).write_text(text + "\n", encoding="utf-8")
