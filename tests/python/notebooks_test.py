"""The notebooks run from top to bottom.

Their code cells are executed by Python itself, one after the other in one namespace, as Jupyter would:
neither Jupyter nor its kernel is needed. A line may end with `;`, but no cell uses magics.
"""

import contextlib
import importlib.util
import io
import json
import os
import pathlib
import shutil
import struct
import tempfile
import unittest

os.environ["MPLBACKEND"] = "Agg"
os.environ.setdefault("MPLCONFIGDIR", os.environ.get("TMPDIR", "/tmp"))

import numpy

FOLDER = pathlib.Path(os.environ["SOFTFINGER_SOURCE"], "analytic", "python", "notebooks")


def run(notebook):
    """What the code cells print together."""
    printed = io.StringIO()
    namespace = {"__name__": "__main__"}
    for number, cell in enumerate(json.loads(notebook.read_text(encoding="utf-8"))["cells"]):
        if cell["cell_type"] == "code":
            code = compile("".join(cell["source"]), f"{notebook.name}, cell {number}", "exec")
            with contextlib.redirect_stdout(printed):
                exec(code, namespace)
    return printed.getvalue()


def write_ellipsoid(path, semi_axes_mm=(12, 7, 14), count=60):
    """A binary STL file, for where the built-in meshes were not made (they need gmsh)."""
    u = numpy.linspace(0, numpy.pi, count)[:, None]
    v = numpy.linspace(0, 2 * numpy.pi, 2 * count)[None, :]
    ring = numpy.stack(
        [numpy.sin(u) * numpy.cos(v), numpy.sin(u) * numpy.sin(v), numpy.cos(u) + 0 * v], -1
    )
    ring[:, -1] = ring[:, 0]
    p = ring * semi_axes_mm
    a, b, c, d = p[:-1, :-1], p[1:, :-1], p[1:, 1:], p[:-1, 1:]
    with open(path, "wb") as file:
        triangles = numpy.concatenate(
            [numpy.stack(t, 2).reshape(-1, 3, 3) for t in ((a, b, c), (a, c, d))]
        )
        file.write(bytes(80) + struct.pack("<I", len(triangles)))
        for triangle in triangles:
            file.write(struct.pack("<12fH", 0, 0, 0, *triangle.reshape(-1), 0))


@unittest.skipUnless(importlib.util.find_spec("matplotlib"), "no matplotlib")
class Notebooks(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(folder.name)
        mesh = pathlib.Path(os.environ.get("SOFTFINGER_MESHES", ""), "shadow_like_pad.stl")
        if mesh.is_file():
            shutil.copy(mesh, "tip.stl")
        else:
            write_ellipsoid("tip.stl")

    def test_all_of_them_run(self):
        notebooks = sorted(FOLDER.glob("*.ipynb"))
        self.assertGreaterEqual(len(notebooks), 3)
        for notebook in notebooks:
            with self.subTest(notebook.name):
                self.assertTrue(run(notebook))

    def test_the_lines_for_mujoco_are_those_of_the_table(self):
        printed = run(FOLDER / "from_a_scan_to_mujoco.ipynb")
        self.assertRegex(printed, r'friction="0\.8 0\.00[0-9]+ 0\.0001"')

    def test_they_are_kept_without_output(self):
        for notebook in FOLDER.glob("*.ipynb"):
            for cell in json.loads(notebook.read_text(encoding="utf-8"))["cells"]:
                self.assertFalse(cell.get("outputs"), notebook.name)


if __name__ == "__main__":
    unittest.main()
