"""The notebooks run from top to bottom, and show what they are kept with."""

import importlib.util
import json
import os
import pathlib
import re
import shutil
import struct
import tempfile
import unittest

import numpy

PYTHON = pathlib.Path(os.environ["SOFTFINGER_SOURCE"], "analytic", "python")
FOLDER = PYTHON / "notebooks"

_spec = importlib.util.spec_from_file_location(
    "run_notebooks", PYTHON / "tools" / "run_notebooks.py"
)
run_notebooks = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(run_notebooks)


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
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.addClassCleanup(os.chdir, os.getcwd())
        os.chdir(folder.name)
        mesh = pathlib.Path(os.environ.get("SOFTFINGER_MESHES", ""), "shadow_like_pad.stl")
        cls.has_mesh = mesh.is_file()
        if cls.has_mesh:
            shutil.copy(mesh, "tip.stl")
        else:
            write_ellipsoid("tip.stl")
        cls.notebooks = {
            path.stem: (
                json.loads(path.read_text(encoding="utf-8")),
                run_notebooks.text_of(run_notebooks.run(path)),
            )
            for path in FOLDER.glob("*.ipynb")
        }

    def test_they_show_what_they_are_kept_with(self):
        """In words, and a picture where there is one. Of another scan than that of the built-in meshes
        the words are others."""
        self.assertGreaterEqual(len(self.notebooks), 3)
        for name, (kept, shown) in self.notebooks.items():
            with self.subTest(name):
                self.assertGreater(len("".join(shown)), 500)
                if self.has_mesh or "tip.stl" not in str(kept):
                    self.assertEqual(
                        shown,
                        run_notebooks.text_of(kept),
                        "run analytic/python/tools/run_notebooks.py",
                    )

    def test_the_lines_for_mujoco_are_those_of_the_table(self):
        _, shown = self.notebooks["from_a_scan_to_mujoco"]
        self.assertRegex("".join(shown), r'friction="0\.8 0\.00[0-9]+ 0\.0001"')

    def test_what_the_fit_leaves_open_is_part_of_the_bound(self):
        for name, part in (
            (
                "from_a_scan_to_mujoco",
                r"within ([0-9.]+) %, of which the fit of the radii ([0-9.]+) %",
            ),
            ("calibrate", r"within ([0-9.]+) %: what the data leave open ([0-9.]+) %"),
        ):
            found = re.findall(part, "".join(self.notebooks[name][1]))
            self.assertTrue(found, name)
            for whole, by_fit in found:
                self.assertGreater(float(by_fit), 0)
                self.assertGreater(float(whole), float(by_fit))


if __name__ == "__main__":
    unittest.main()
