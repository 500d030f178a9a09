"""Numbers that the pages and the program's help state in passing, against what the program prints.

A claim is a place in a page, the numbers in its sentence, and what a command gives for them. A sentence that
no longer stands where it stood fails as a number that differs does.
"""

import argparse
import csv
import json
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile
from fractions import Fraction


class Program:
    """softfinger, and what the claims ask of it more than once."""

    def __init__(self, path):
        self.path = path
        self.exports = None

    def text(self, *words):
        """What it prints. An answer that is not usable is an answer, too."""
        done = subprocess.run([self.path, *words], text=True, capture_output=True, check=False,
                              env={**os.environ, "NO_COLOR": "1"})
        if done.returncode not in (0, 1):
            sys.exit(f"softfinger {' '.join(words)} ends with {done.returncode}:\n{done.stderr}")
        return done.stdout

    def answer(self, *words):
        return json.loads(self.text(*words, "--json"))

    def exported(self):
        """Every built-in curved case for MuJoCo, which keeps e_n constant (a flat pad's is); printed also where not usable."""
        if self.exports is None:
            names = re.findall(r"^ *([a-z0-9_]+) ", self.text("list", "cases"), re.MULTILINE)
            assert len(names) >= 20, names
            # A line contact is not exported.
            made = [self.answer("export", name, "--to", "mujoco", "--force") for name in names if name != "roller"]
            self.exports = [one for one in made if "load_exponent" in one]
        return self.exports


def growth_of_eccentricity(program):
    """The least and the largest exponent of e_n over the load."""
    exponents = [made["load_exponent"] for made in program.exported()]
    return min(exponents), max(exponents)


def error_of_constant(program):
    """Of the torque in per cent: least and largest too large at P/3, least and largest too small at 3P."""
    lower, upper = [], []
    for made in program.exported():
        for point in made["loads"]:
            factor = point["load_N"] / made["load_N"]
            if abs(factor * 3 - 1) < 0.01:
                lower.append(100 * point["relative_error"])
            if abs(factor / 3 - 1) < 0.01:
                upper.append(-100 * point["relative_error"])
    assert lower and upper, program.exported()[0]["loads"]
    return min(lower), max(lower), min(upper), max(upper)


def turn_of_presliding(program, source):
    """How far `lift_box` turns with `presliding`: least and largest angle in degrees once it hangs, from 1 s on,
    and the least and largest share of the limit in per cent."""
    rule = 'bodies = ["object", "*"]'
    scene = (source / "comparisons" / "scenes" / "lift_box.toml").read_text(encoding="utf-8")
    assert rule in scene, scene
    with tempfile.TemporaryDirectory() as folder:
        changed = pathlib.Path(folder) / "lift_box.toml"
        changed.write_text(scene.replace(rule, rule + "\npresliding = true"), encoding="utf-8")
        program.text("simulate", str(changed), "--output", folder, "--vtu-every", "0")
        rows = {name: list(csv.DictReader(open(pathlib.Path(folder) / name, encoding="utf-8")))
                for name in ("trajectory.csv", "contacts.csv")}
    degrees = [math.degrees(2 * math.acos(min(1.0, abs(float(row["quaternion_w"])))))
               for row in rows["trajectory.csv"] if row["body"] == "object" and float(row["time_s"]) >= 1]
    shares = [100 * float(row["utilisation"]) for row in rows["contacts.csv"]
              if float(row["time_s"]) >= 1 and "tip" in row["body_a"] + row["body_b"]]
    return min(degrees), max(degrees), min(shares), max(shares)


def bound_of_sampled_gap(program):
    answers = program.answer("predict", "pad_on_plane", "--gap", "sampled")["results"]
    (sampled,) = [answer for answer in answers if answer.get("gap") == "sampled"][:1]
    return sampled["error_bound"]


class Claims:
    """Counts what does not hold."""

    def __init__(self, source, program):
        self.source, self.program, self.failures = source, program, 0

    def place(self, name):
        """A page, or what a command prints of itself; lines are joined."""
        text = (self.program.text(*name[1:]) if name[0] == "softfinger"
                else (self.source / name[0]).read_text(encoding="utf-8"))
        return re.sub(r"\s*\n(?:///|#)?\s*", " ", text)

    def check(self, name, sentence, values, tolerance):
        """`sentence` is a pattern with a group for each number."""
        where = " ".join(name)
        found = re.search(sentence, self.place(name))
        if not found:
            self.fail(where, f"says nothing like {sentence}")
            return
        for said, value in zip(found.groups(), values):
            if not abs(float(Fraction(said)) - value) <= tolerance:
                self.fail(where, f"says {said} in \"{found.group()}\", and it is {value:.4g}")
        if len(found.groups()) != len(values):
            self.fail(where, f"has {len(found.groups())} numbers, not {len(values)}")

    def fail(self, where, what):
        print(f"{where} {what}")
        self.failures += 1


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--source", type=pathlib.Path, required=True)
    parser.add_argument("--program", required=True)
    arguments = parser.parse_args()
    program = Program(arguments.program)
    claims = Claims(arguments.source, program)

    growth = growth_of_eccentricity(program)
    print("e_n goes with P^{:.3f} to P^{:.3f}".format(*growth))
    exponents = r"P\^\(([0-9/]+)\) to P\^\(([0-9/]+)\)"
    # Fractions that are easy to remember; 1/3 is the exponent of a half-space.
    claims.check(["docs/mujoco_in_five_minutes.md"], "grows about as " + exponents, growth, 0.03)
    claims.check(["softfinger", "export", "--help"], "by about " + exponents, growth, 0.03)
    claims.check(["comparisons/exporting/mujoco/softfinger_mujoco.h"], "with about " + exponents, growth, 0.03)

    error = error_of_constant(program)
    print("a constant e_n is {:.1f} to {:.1f} % too large at P/3, {:.1f} to {:.1f} % too small at 3P".format(*error))
    claims.check(["docs/mujoco_in_five_minutes.md"], r"(\d+) to (\d+) % too large at P/3 and (\d+) to (\d+) % too small at 3P", error, 1)

    turn = turn_of_presliding(program, arguments.source)
    print("lift_box turns by {:.1f} to {:.1f} degrees at {:.0f} to {:.0f} % of the limit".format(*turn))
    claims.check(["docs/files.md"],
                 r"by (\d+) to (\d+) degrees, as it swings, at (\d+) to (\d+) % of the limit", turn, 1)

    bound = bound_of_sampled_gap(program)
    print(f"error bound of a sampled gap: {bound}")
    for name in (["README.md"], ["softfinger", "predict", "--help"]):
        if "no error is known" not in claims.place(name):
            claims.fail(" ".join(name), "does not say that of a sampled gap no error is known")
    if bound is not None:
        claims.fail("predict --gap sampled", f"has an error bound: {bound}")

    sys.exit(f"{claims.failures} claims do not hold" if claims.failures else 0)


if __name__ == "__main__":
    main()
