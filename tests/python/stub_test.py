"""The stubs are what the package is."""

import ast
import importlib.util
import os
import pathlib
import unittest

PYTHON = pathlib.Path(os.environ["SOFTFINGER_SOURCE"], "analytic", "python")


class Stubs(unittest.TestCase):
    def test_they_are_those_of_the_package(self):
        path = PYTHON / "tools" / "write_stubs.py"
        spec = importlib.util.spec_from_file_location("write_stubs", path)
        write_stubs = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(write_stubs)
        for name, text in write_stubs.stubs().items():
            kept = (PYTHON / "softfinger" / name).read_text(encoding="utf-8")
            # Without their layout.
            self.assertEqual(
                ast.dump(ast.parse(kept)),
                ast.dump(ast.parse(text)),
                f"{name} is not that of the package: run tools/write_stubs.py",
            )

    def test_every_public_name_is_documented(self):
        import softfinger
        import softfinger.arrays

        for module in (softfinger, softfinger.arrays):
            for name in module.__all__:
                self.assertTrue(getattr(module, name).__doc__, name)


if __name__ == "__main__":
    unittest.main()
