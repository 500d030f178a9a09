"""Puts a release into one folder: Debian packages, the wheel, the site, the list of changes and checksums.

usage: release.py VERSION CHANGES                  checks that the list of changes has a section for the version
       release.py VERSION CHANGES BUILD CPACK SITE  and makes BUILD/softfinger-VERSION of a finished build

The target `release` runs it, first to check, because all else takes minutes.
"""

import hashlib
import pathlib
import re
import shutil
import subprocess
import sys


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
    done = subprocess.run([str(word) for word in command], text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          check=False)
    if done.returncode != 0:
        sys.exit(f"no release: {' '.join(map(str, command))} ends with {done.returncode}:\n{done.stdout}")


def make_release(version, changes, build, cpack, site):
    checkout = changes.parents[1]
    folder = build / f"softfinger-{version}"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    run(cpack, "--config", build / "CPackConfig.cmake", "-G", "DEB", "-B", folder)
    shutil.rmtree(folder / "_CPack_Packages")
    run(sys.executable, "-m", "pip", "--disable-pip-version-check", "wheel", "--no-index", "--no-build-isolation",
        "--no-deps", "--wheel-dir", folder, checkout / "analytic" / "python")
    shutil.copytree(site, folder / "site")
    for file in (changes, checkout / "LICENSE"):
        shutil.copy(file, folder)
    packages = sorted([*folder.glob("*.deb"), *folder.glob("*.whl")])
    for package in packages:
        if not re.search(f"[_-]{re.escape(version)}[_-]", package.name):
            sys.exit(f"no release: {package} is not of version {version}")
    (folder / "SHA256SUMS").write_text("".join(
        f"{hashlib.sha256(package.read_bytes()).hexdigest()}  {package.name}\n" for package in packages))
    print(f"{folder}: the site and {', '.join(package.name for package in packages)}")


def main():
    version, *paths = sys.argv[1:]
    changes, *others = (pathlib.Path(path).resolve() for path in paths)
    check_changes(version, changes)
    if others:
        make_release(version, changes, *others)


if __name__ == "__main__":
    main()
