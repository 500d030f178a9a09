"""Builds the wheel as a user does, and checks what is in it.

usage: build_wheel.py SOURCE FOLDER

Copies what is needed of the sources (pip builds in the tree), builds without an index, installs into
an empty virtual environment beside the system's packages, and predicts there.
"""

import pathlib
import re
import shutil
import subprocess
import sys
import zipfile

LARGEST_BYTES = 3_000_000


def run(*command, **options):
    return subprocess.run(command, check=True, text=True, **options)


def main():
    source, folder = (pathlib.Path(argument) for argument in sys.argv[1:])
    shutil.rmtree(folder, ignore_errors=True)
    tree = folder / "tree"
    ignored = shutil.ignore_patterns("build", "__pycache__", "*.egg-info")
    shutil.copytree(source / "analytic", tree / "analytic", symlinks=True, ignore=ignored)
    for name in ("CMakeLists.txt", "LICENSE"):
        shutil.copy(source / name, tree / name)

    pip = (sys.executable, "-m", "pip", "--disable-pip-version-check")
    run(
        *pip,
        "wheel",
        "--quiet",
        "--no-index",
        "--no-build-isolation",
        "--no-deps",
        "--wheel-dir",
        folder,
        tree / "analytic" / "python",
    )
    (wheel,) = folder.glob("softfinger-*.whl")
    size = wheel.stat().st_size
    print(f"{wheel.name}: {size} bytes")
    assert size <= LARGEST_BYTES, size

    # Nothing but the package, its licence and the wheel's own files.
    names = zipfile.ZipFile(wheel).namelist()
    others = [n for n in names if not re.match(r"softfinger/|softfinger-[0-9.]+\.dist-info/", n)]
    assert not others, others
    assert any(name.endswith("dist-info/LICENSE") for name in names), names
    assert any(name.endswith("__init__.pyi") for name in names), names

    environment = folder / "environment"
    run(sys.executable, "-m", "venv", "--system-site-packages", environment)
    python = environment / "bin" / "python"
    run(
        python,
        "-m",
        "pip",
        "--disable-pip-version-check",
        "install",
        "--quiet",
        "--no-index",
        "--no-deps",
        wheel,
    )
    core = run(
        python,
        "-c",
        "import softfinger._core; print(softfinger._core.__file__)",
        capture_output=True,
    ).stdout.strip()
    assert core.startswith(str(environment)), core

    # The run time of C++ and no library more: nothing that would bring the GPL along.
    if ldd := shutil.which("ldd"):
        needed = run(ldd, core, capture_output=True).stdout
        for line in needed.splitlines():
            library = line.split()[0].rsplit("/", 1)[-1]
            assert re.match(r"(linux-vdso|libstdc\+\+|libm|libgcc_s|libc|ld-linux)", library), line

    print(
        run(
            python,
            "-c",
            """if True:
        import softfinger
        print(softfinger.__version__, softfinger.predict(
            normal_force_N=2, youngs_modulus_Pa=3e5, poisson_ratio=0.45, thickness_m=2e-3,
            radius_major_m=20e-3, radius_minor_m=5e-3, friction_coefficient=0.8))
        """,
            cwd=folder,
            capture_output=True,
        ).stdout
    )


if __name__ == "__main__":
    main()
