"""Builds the wheel and the Debian package as a user does, predicts with each by itself, and runs the
notebooks with the wheel.

usage: build_packages.py SOURCE FOLDER

Works on a copy of what is needed of the sources, because pip builds within them. Nothing is fetched.
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import zipfile

LARGEST_BYTES = 3_000_000

SAMPLE = """
import softfinger
print(softfinger.__file__)
print(softfinger.predict(
    normal_force_N=2, youngs_modulus_Pa=3e5, poisson_ratio=0.45, thickness_m=2e-3,
    radius_major_m=20e-3, radius_minor_m=5e-3, friction_coefficient=0.8))
"""


def run(*command, **options):
    """What the command prints. Fails as the command does, and then shows it."""
    done = subprocess.run(
        command, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, **options
    )
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))} ends with {done.returncode}:\n{done.stdout}")
    return done.stdout


def copy_of(source, tree):
    ignored = shutil.ignore_patterns("build", "__pycache__", "*.egg-info")
    shutil.copytree(source / "analytic", tree / "analytic", symlinks=True, ignore=ignored)
    for name in ("CMakeLists.txt", "LICENSE"):
        shutil.copy(source / name, tree / name)


def check_size(package):
    size = package.stat().st_size
    print(f"{package.name}: {size} bytes")
    assert size <= LARGEST_BYTES, size


def check_stated_size(wheel, page):
    stated = float(re.search(r"The wheel has ([0-9.]+) MB", page.read_text(encoding="utf-8")).group(1))
    size = 1e-6 * wheel.stat().st_size
    assert abs(size - stated) <= 0.1, f"{page.name} says {stated} MB, and it has {size:.2f}"


def check_sample(python, folder, path):
    """The sample runs with the package that is within the path, which links nothing unexpected."""
    file, prediction = run(python, "-c", SAMPLE, cwd=folder).split("\n", 1)
    assert file.startswith(str(path)), file
    print(prediction)
    # The run time of C++ and no library more: nothing that would bring the GPL along.
    (core,) = pathlib.Path(file).parent.glob("_core.*.so")
    if ldd := shutil.which("ldd"):
        for line in run(ldd, core).splitlines():
            library = line.split()[0].rsplit("/", 1)[-1]
            assert re.match(
                r"(linux-vdso|libstdc\+\+|libm|libgcc_s|libc|ld-linux)[.-]", library
            ), line


def check_notebooks(python, source):
    """The notebooks run with the package that this Python finds by itself."""
    run(
        *(python, "-m", "unittest", "notebooks_test"),
        cwd=source / "tests" / "python",
        env={**os.environ, "SOFTFINGER_SOURCE": str(source), "PYTHONDONTWRITEBYTECODE": "1"},
    )


def check_wheel(tree, folder, source):
    pip = ("-m", "pip", "--disable-pip-version-check", "--quiet")
    offline = ("--no-index", "--no-build-isolation", "--no-deps")
    project = tree / "analytic" / "python"
    run(sys.executable, *pip, "wheel", *offline, "--wheel-dir", folder, project)
    (wheel,) = folder.glob("softfinger-*.whl")
    check_size(wheel)
    check_stated_size(wheel, project / "README.md")
    # Nothing but the package, its licence and the wheel's own files.
    names = zipfile.ZipFile(wheel).namelist()
    others = [n for n in names if not re.match(r"softfinger/|softfinger-[0-9.]+\.dist-info/", n)]
    assert not others, others
    assert any(name.endswith("dist-info/LICENSE") for name in names), names
    assert "softfinger/__init__.pyi" in names, names

    environment = folder / "environment"
    run(sys.executable, "-m", "venv", "--system-site-packages", environment)
    python = environment / "bin" / "python"
    run(python, *pip, "install", *offline, wheel)
    check_sample(python, folder, environment)
    check_notebooks(python, source)


def check_deb(tree, folder):
    if not shutil.which("dpkg-shlibdeps"):
        print("no dpkg-dev: the Debian package is left out")
        return
    # What the wheel was built in has what the package needs.
    build = tree / "build" / f"wheel-{sys.implementation.cache_tag}"
    run("cmake", "--build", build, "--target", "softfinger_python")
    run("cpack", "--config", build / "CPackConfig.cmake", "-B", folder / "deb")
    (deb,) = (folder / "deb").glob("python3-softfinger_*.deb")
    check_size(deb)
    fields = run("dpkg-deb", "--field", deb, "Depends")
    assert "python3-numpy" in fields and "libstdc++6" in fields, fields
    unpacked = folder / "unpacked"
    run("dpkg-deb", "--extract", deb, unpacked)
    assert (unpacked / "usr/share/doc/python3-softfinger/copyright").is_file()
    os.environ["PYTHONPATH"] = str(unpacked / "usr/lib/python3/dist-packages")
    check_sample(sys.executable, folder, unpacked)


def main():
    source, folder = (pathlib.Path(argument) for argument in sys.argv[1:])
    shutil.rmtree(folder, ignore_errors=True)
    copy_of(source, folder / "tree")
    check_wheel(folder / "tree", folder, source)
    check_deb(folder / "tree", folder)


if __name__ == "__main__":
    main()
