"""Makes the Debian packages of a finished build, installs them into an empty root and tries each there.

usage: debian_packages.py BUILD CONSUMER FOLDER [COMPILER]

Nothing is compiled but the consumer, a project outside the tree. What the packages depend on is taken
from this machine; that it is what they say is checked by apt, which only simulates.
"""

import json
import os
import pathlib
import re
import shutil
import statistics
import subprocess
import sys
import time

PACKAGES = ("softfinger", "softfinger-fem", "libsoftfinger-dev", "python3-softfinger")
# Where the libraries that read robots' files were there when the build was configured.
OPTIONAL_PACKAGES = ("softfinger-robot",)
LARGEST_PYTHON_PACKAGE_BYTES = 3_000_000
LARGEST_PAGE_BYTES = 3_000_000
# What finite elements need, and numbers for many processes.
HEAVY = re.compile(r"deal\.?ii|gmsh|cholmod|blas|lapack|mpi|trilinos|petsc|vtk|assimp", re.IGNORECASE)

ROBOT = """<mujoco model="arm"><worldbody><body name="link" pos="0 0 1"><joint axis="0 1 0"/>
<geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.02" mass="1"/></body></worldbody></mujoco>
"""

SAMPLE = """
import softfinger
print(softfinger.__file__)
contact = softfinger.predict(
    normal_force_N=2, youngs_modulus_Pa=3e5, poisson_ratio=0.45, thickness_m=2e-3,
    radius_major_m=20e-3, radius_minor_m=5e-3, friction_coefficient=0.8)
assert contact.has_answer
(computed,) = softfinger.fem("hertz_circle", level=1)
print(computed.a_m)
"""


def run(*command, check=True, **options):
    """The finished command. Fails as the command does, and then shows it."""
    done = subprocess.run(
        [str(word) for word in command], text=True, capture_output=True, check=False, **options
    )
    if check and done.returncode != 0:
        sys.exit(
            f"{' '.join(map(str, command))} ends with {done.returncode}:\n{done.stdout}{done.stderr}"
        )
    return done


def make_packages(build, folder):
    """Files of the packages by name."""
    run("cpack", "--config", build / "CPackConfig.cmake", "-G", "DEB", "-B", folder)
    debs = {deb.name.split("_")[0]: deb for deb in folder.glob("*.deb")}
    assert set(debs) - set(OPTIONAL_PACKAGES) == set(PACKAGES), sorted(debs)
    for name, deb in debs.items():
        print(f"{deb.name}: {deb.stat().st_size} bytes")
    return debs


def check_dependencies(debs):
    depends = {n: run("dpkg-deb", "--field", deb, "Depends").stdout for n, deb in debs.items()}
    version = run("dpkg-deb", "--field", debs["softfinger"], "Version").stdout.strip()
    for name in ("softfinger", "libsoftfinger-dev", "python3-softfinger"):
        assert not HEAVY.search(depends[name]), f"{name} is not lean: {depends[name]}"
    for name, needed in (
        ("softfinger", ("libpng", "libfcl", "libstdc++6", "libc6")),
        ("softfinger-fem", (f"softfinger (= {version})", "libdeal.ii", "libgmsh", "libcholmod")),
        ("libsoftfinger-dev", ("libeigen3-dev",)),
        ("python3-softfinger", ("python3-numpy", "libstdc++6")),
        ("softfinger-robot", (f"softfinger (= {version})", "libstdc++6")),
    ):
        for one in needed if name in depends else ():
            assert one in depends[name], f"{name} does not depend on {one}: {depends[name]}"
    size = debs["python3-softfinger"].stat().st_size
    assert size <= LARGEST_PYTHON_PACKAGE_BYTES, size


def check_that_apt_agrees(debs):
    """That the packages named as dependencies exist, as far as this machine knows packages at all."""
    if shutil.which("apt-get") is None:
        print("no apt-get: dependencies are not resolved")
        return
    done = run(
        "apt-get", "install", "--simulate", *(deb.resolve() for deb in debs.values()), check=False
    )
    if done.returncode == 0:
        configured = re.findall(r"^Conf (\S+)", done.stdout, re.MULTILINE)
        assert set(debs) <= set(configured), done.stdout
        print(f"apt would install them, with {len(configured) - len(debs)} other packages")
    else:
        # Without lists of packages, or where a library stands in for Debian's own.
        print("apt does not resolve the dependencies here:", done.stdout.strip().splitlines()[-1:])


class Root:
    """A folder that packages are installed into: by dpkg itself, or as a user by unpacking."""

    def __init__(self, folder):
        self.folder = folder
        state = folder / "var" / "lib" / "dpkg"
        state.mkdir(parents=True)
        (state / "status").touch()
        self.as_root = os.geteuid() == 0
        # What is built, or chosen by variables, is not what is tried.
        self.environment = {
            "PATH": f"{folder / 'usr' / 'bin'}:/usr/bin:/bin",
            "HOME": str(folder),
            "OMP_NUM_THREADS": "1",
            "PYTHONDONTWRITEBYTECODE": "1",
            "PYTHONPATH": str(folder / "usr" / "lib" / "python3" / "dist-packages"),
        }

    def install(self, *debs):
        if self.as_root:
            path = {**os.environ, "PATH": os.environ["PATH"] + ":/usr/sbin:/sbin"}
            # Their libraries are those of this machine. dpkg refuses files of two packages.
            run("dpkg", f"--root={self.folder}", "--force-depends", "--install", *debs, env=path)
        else:
            for deb in debs:
                run("dpkg-deb", "--extract", deb, self.folder)

    def remove(self, *names):
        if self.as_root:
            path = {**os.environ, "PATH": os.environ["PATH"] + ":/usr/sbin:/sbin"}
            run("dpkg", f"--root={self.folder}", "--force-depends", "--purge", *names, env=path)

    def run(self, *command, check=True):
        return run(*command, check=check, env=self.environment, cwd=self.folder)


def check_program(root):
    program = root.folder / "usr" / "bin" / "softfinger"
    document = json.loads(root.run(program, "predict", "seed_thumb", "--json").stdout)
    assert document["results"], document
    for arguments in (["--version"], ["predict", "seed_thumb"]):
        times_s = []
        for _ in range(7):
            start = time.perf_counter()
            root.run(program, *arguments)
            times_s.append(time.perf_counter() - start)
        median_ms = 1e3 * statistics.median(times_s)
        print(f"softfinger {' '.join(arguments)}: {median_ms:.1f} ms, the median of 7 runs")
    loaded = run("ldd", program).stdout
    assert "not found" not in loaded and not HEAVY.search(loaded), loaded
    for file in (
        "share/man/man1/softfinger.1",
        "share/bash-completion/completions/softfinger",
        "share/fish/vendor_completions.d/softfinger.fish",
        "share/zsh/vendor-completions/_softfinger",
        "share/softfinger/meshes/shadow_like_pad.stl",
    ):
        assert (root.folder / "usr" / file).is_file(), file
    # The page of `explore`, as far as the build has it, is in the program.
    there = {f["name"]: f["there"] for f in json.loads(root.run(program, "doctor", "--json").stdout)["findings"]}
    explored = root.run(program, "explore", "--output", "explore.html", check=False)
    assert explored.returncode == (0 if there["page of explore"] else 2), explored.stderr
    if there["page of explore"]:
        size = (root.folder / "explore.html").stat().st_size
        print(f"softfinger explore: {size} bytes")
        assert 500_000 < size < LARGEST_PAGE_BYTES, size
    # Not this machine's own finite elements either.
    refused = root.run(program, "fem", "hertz_circle", "--level", "1", check=False)
    assert refused.returncode == 2 and "package softfinger-fem" in refused.stderr, refused.stderr


def check_finite_elements(root):
    program = root.folder / "usr" / "bin" / "softfinger"
    told = root.run(program, "fem", "hertz_circle", "--level", "1", "--json").stdout
    (result,) = json.loads(told)["results"]
    assert result["a_m"] > 0, result
    return result["a_m"]


def check_robots(root, deb):
    """A robot's file, without and with the package that reads it."""
    program = root.folder / "usr" / "bin" / "softfinger"
    (root.folder / "arm.xml").write_text(ROBOT, encoding="utf-8")
    refused = root.run(program, "simulate", "arm.xml", "--json", check=False)
    assert refused.returncode == 2 and "softfinger-robot" in refused.stderr, refused.stderr
    if deb is None:
        return
    root.install(deb)
    told = root.run(program, "simulate", "arm.xml", "--json", check=False)
    if "libmujoco" in run("dpkg-deb", "--field", deb, "Depends").stdout:
        assert told.returncode == 0 and json.loads(told.stdout)["lcp_failures"] == 0, told.stderr
    else:
        assert told.returncode == 2 and told.stderr, told.stdout


def check_consumer(root, consumer, folder, compiler):
    options = ["-D", f"CMAKE_PREFIX_PATH={root.folder / 'usr'}", "-D", "CMAKE_BUILD_TYPE=Release"]
    if compiler:
        options += ["-D", f"CMAKE_CXX_COMPILER={compiler}"]
    run("cmake", "-S", consumer, "-B", folder, *options)
    cache = (folder / "CMakeCache.txt").read_text(encoding="utf-8")
    assert f"softfinger_DIR:PATH={root.folder}" in cache, "another softfinger was found"
    run("cmake", "--build", folder)
    print("the consumer says:", run(folder / "consumer").stdout.strip())


def check_python(root, a_m):
    file, computed = root.run(sys.executable, "-c", SAMPLE).stdout.splitlines()
    assert file.startswith(str(root.folder)), file
    # The same program with the same case: the same number.
    assert float(computed) == a_m, (computed, a_m)


def check_copyrights(root, packages):
    for package in packages:
        text = root.folder / "usr" / "share" / "doc" / package / "copyright"
        assert "Redistribution" in text.read_text(encoding="utf-8"), package


def main():
    build, consumer, folder = (pathlib.Path(argument).resolve() for argument in sys.argv[1:4])
    compiler = sys.argv[4] if len(sys.argv) > 4 else None
    shutil.rmtree(folder, ignore_errors=True)
    debs = make_packages(build, folder / "packages")
    check_dependencies(debs)
    check_that_apt_agrees(debs)
    root = Root(folder / "root")
    root.install(debs["softfinger"])
    check_program(root)
    root.install(debs["softfinger-fem"])
    a_m = check_finite_elements(root)
    root.install(debs["libsoftfinger-dev"])
    check_consumer(root, consumer, folder / "consumer", compiler)
    root.install(debs["python3-softfinger"])
    check_python(root, a_m)
    check_robots(root, debs.get("softfinger-robot"))
    check_copyrights(root, debs)
    root.remove(*debs)
    left = [f for f in (root.folder / "usr").rglob("*") if root.as_root and f.is_file()]
    assert not left, left


if __name__ == "__main__":
    main()
