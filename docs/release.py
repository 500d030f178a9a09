#!/usr/bin/env python3
"""Puts a release into one folder, build/release/softfinger-VERSION: Debian packages, the wheel, the site, the list of
changes and checksums. VERSION is project(VERSION) of CMakeLists.txt.

usage: docs/release.py [BUILD]                     a configured build; default: build/release
       docs/release.py --check VERSION CHANGES     only whether a list of changes has a section for the version

That is checked first, because all else takes minutes.
"""

import hashlib
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]


def check_changes(version, changes):
    """Fails unless a section of the list begins with the version and says something."""
    sections = re.split(r"^## ", changes.read_text(encoding="utf-8"), flags=re.MULTILINE)[1:]
    for section in sections:
        heading, _, text = section.partition("\n")
        if heading.split()[:1] == [version] and re.search(r"^[^#\s]", text, re.MULTILINE):
            if "in development" in heading:
                print(f'{changes.name} has "{heading}": put the date of the release there before you pass it on')
            return
    sys.exit(f'no release: {changes} says nothing of version {version}, which is project(VERSION) in CMakeLists.txt; '
             f'add a section "## {version} (DATE)"')


def run(*command):
    status = subprocess.run([str(word) for word in command], check=False).returncode
    if status != 0:
        sys.exit(f"no release: {' '.join(map(str, command))} ends with {status}")


def make_release(version, changes, build):
    if not (build / "CMakeCache.txt").is_file():
        sys.exit(f"no release: {build} is no configured build; `cmake --preset release` makes build/release")
    run("cmake", "--build", build, "--target", "all", "softfinger_python", "docs")
    folder = build / f"softfinger-{version}"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    run("cpack", "--config", build / "CPackConfig.cmake", "-G", "DEB", "-B", folder)
    shutil.rmtree(folder / "_CPack_Packages")
    # The system's interpreter has pybind11 and numpy; another one may be the first in the PATH.
    run("/usr/bin/python3", "-m", "pip", "--disable-pip-version-check", "--quiet", "wheel", "--no-index",
        "--no-build-isolation", "--no-deps", "--wheel-dir", folder, ROOT / "analytic" / "python")
    shutil.copytree(build / "docs" / "html", folder / "site")
    for file in (changes, ROOT / "LICENSE"):
        shutil.copy(file, folder)
    packages = sorted([*folder.glob("*.deb"), *folder.glob("*.whl")])
    for package in packages:
        if not re.search(f"[_-]{re.escape(version)}[_-]", package.name):
            sys.exit(f"no release: {package} is not of version {version}")
    (folder / "SHA256SUMS").write_text("".join(
        f"{hashlib.sha256(package.read_bytes()).hexdigest()}  {package.name}\n" for package in packages))
    print(f"{folder}: the site and {', '.join(package.name for package in packages)}")


def main():
    arguments = sys.argv[1:]
    if arguments[:1] == ["--check"] and len(arguments) == 3:
        check_changes(arguments[1], pathlib.Path(arguments[2]))
    elif len(arguments) > 1 or "".join(arguments).startswith("-"):
        sys.exit(__doc__)
    else:
        version = re.search(r"project\(softfinger VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text())[1]
        changes = ROOT / ".github" / "CHANGELOG.md"
        check_changes(version, changes)
        make_release(version, changes, pathlib.Path(*arguments or [ROOT / "build" / "release"]).resolve())


if __name__ == "__main__":
    main()
