"""Builds the compiled part with the project's own CMake files: the analytic part alone."""

import os
import pathlib
import re
import shutil
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = pathlib.Path(__file__).resolve().parents[2]


def version():
    text = (ROOT / "CMakeLists.txt").read_text(encoding="utf-8")
    return re.search(r"project\(softfinger VERSION ([0-9.]+)", text)[1]


class BuildWithCMake(build_ext):
    def build_extension(self, extension):
        # Beside the project's other builds, where it is continued when it is asked for again.
        build = ROOT / "build" / f"wheel-{sys.implementation.cache_tag}"
        generator = ["-G", "Ninja"] if shutil.which("ninja") else []
        parts = [f"-DSOFTFINGER_BUILD_{part}=OFF" for part in ("COMPARISONS", "FEM", "TESTS")]
        subprocess.run(
            ["cmake", "-S", ROOT, "-B", build, *generator, *parts, "-DCMAKE_BUILD_TYPE=Release"]
            + [f"-DPython_EXECUTABLE={sys.executable}", "-DSOFTFINGER_REQUIRE_PYTHON=ON"],
            check=True,
        )
        jobs = str(os.cpu_count() or 1)
        what = ["--target", "softfinger_python_core", "--parallel", jobs]
        subprocess.run(["cmake", "--build", build, *what], check=True)
        built = next((build / "python" / "softfinger").glob("_core.*"))
        target = pathlib.Path(self.get_ext_fullpath(extension.name))
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(built, target)


setup(
    version=version(),
    ext_modules=[Extension("softfinger._core", sources=[])],
    cmdclass={"build_ext": BuildWithCMake},
)
