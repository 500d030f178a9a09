#!/usr/bin/env python3
"""Runs the program on random command lines and case files, and looks for what must never happen.

usage: command_line.py PROGRAM [RUNS [SEED]]        (default: 1000 runs, seed 1; prints a line per finding)

A run may end with status 0, 1, 2 or 3. It may not crash or hang. With status 2 it says one line on standard error.
With --json standard output is one JSON object without NaN and infinity, and has a schema. Exit status 1 on findings.
"""
import json
import os
import random
import resource
import subprocess
import sys
import tempfile

CASE = """{head}[geometry]
{geometry}
[layer]
thickness_mm = {thickness}
youngs_modulus_kPa = {modulus}
poisson_ratio = {poisson}
[contact]
load_N = {load}
friction_coefficient = {friction}
"""
ODD = ["0", "-1", "nan", "inf", "-inf", "1e400", "1e-400", "1e308", "1e-308", '""', '"a"', "[]", "[1]", "{}", "true", "0x10", "1_000",
       "9007199254740993", "{ value = 1 }", "{ value = 300, factor = 2 }", "{ value = 300, std = 20 }", "{ value = nan, std = 1 }",
       "{ value = 1, factor = 1 }", "{ value = 1, std = -1 }", "{ value = 1, factor = 2, std = 1 }", "{ value = { value = 1, std = 1 }, std = 1 }"]
ODD_WORDS = ["", "contact.load_N", "=", "a.b=1", "herz", "nan", "inf", "-inf", "0", "-1", "1e400", "1e-400", "1,2", "1,,2", ",", "0x1p3", "1e", "1 ", " 1", "1.5.2", "1_000", "\u0661",
             "a,b", "max_torque", "a,b,area", "torque", "\xff", "a" * 5000]


def choose(generator, usual, odd):
    return generator.choice(odd if generator.random() < generator.odd else usual)


def doubted(generator, value):
    kind = generator.random()
    if generator.odd == 0:
        return "%g" % value
    if kind < 0.15:
        return "{ value = %g, factor = %g }" % (value, choose(generator, [1.1, 2, 10, 1000], [1001]))
    if kind < 0.3:
        return "{ value = %g, std = %g }" % (value, value * choose(generator, [1e-3, 0.1, 0.45], [0.6, 5]))
    return "%g" % value


def number(generator, low, high):
    if generator.random() < generator.odd:
        return generator.choice(ODD)
    return doubted(generator, low * (high / low) ** generator.random())


def geometry(generator, mesh):
    kind = generator.random()
    if kind < 0.3:
        return "relative_radii_mm = [%s, %s]" % (number(generator, 1, 100), number(generator, 1, 100))
    finger = "radii_mm = [%s, %s]" % (number(generator, 2, 50), choose(generator, [number(generator, 2, 50)], ["inf"]))
    bodies = ["radii_mm = [%s, %s]" % (number(generator, 2, 50), generator.choice(["inf", number(generator, 2, 50)])),
              "sphere_radius_mm = %s" % number(generator, 2, 50), "radii_mm = [inf, inf]"]
    if kind < 0.45:
        unit = choose(generator, ["", ', unit = "mm"'], [', unit = "m"', ', unit = "inch"'])
        place = choose(generator, ['along = "-y"', "near_mm = [%s, %s, %s]" % tuple(number(generator, 1, 20) for _ in "xyz")],
                       ["point_mm = [0, -7, 0], normal = [0, -1, 0]", "near_mm = [0, -7]", ""])
        return 'finger = { mesh = "%s"%s, %s }\nobject = { %s }' % (mesh, unit, place, generator.choice(bodies))
    return "finger = { %s }\nobject = { %s }\nangle_deg = %s" % (choose(generator, [finger], bodies), generator.choice(bodies), number(generator, 1, 90))


def case(generator, mesh):
    text = CASE.format(head=choose(generator, ["", 'id = "fuzz"\n', 'question = "?"\n'], ['id = ""\n', "id = 3\n"]),
                       geometry=geometry(generator, mesh), thickness=number(generator, 0.3, 5), modulus=number(generator, 30, 3000),
                       poisson=choose(generator, ["0.49", "0.3", "0.5", number(generator, 0.01, 0.5)], ["0.6"]),
                       load=generator.choice([number(generator, 0.05, 20), "[%s, %s]" % (number(generator, 0.1, 1), number(generator, 1, 20))]),
                       friction=number(generator, 0.05, 3))
    if generator.random() < generator.odd:  # a broken file
        at = generator.randrange(len(text))
        text = text[:at] + generator.choice(["\0", "[", "]", "{", "}", "=", "\n", "\x80", '"', "#", "nan"]) + text[at + generator.randrange(3):]
    return text


def word(generator, usual):
    return generator.choice(ODD_WORDS) if generator.random() < generator.odd else generator.choice(usual)


def arguments(generator, file):
    command = generator.choice(["predict", "predict", "predict", "export", "export", "select"])
    words = [command, file]
    if generator.random() < generator.odd:
        words.remove(file)
    options = {"--tolerance": ["0.05", "0.1", "1"], "--quantities": ["a", "a,b", "max_torque", "indentation,peak_pressure"],
               "--set": ["contact.load_N=2", "layer.thickness_mm=3", "layer.poisson_ratio={value=0.4,std=0.02}"],
               "--load": ["1", "2.5"], "--friction": ["0.5"], "--thickness-mm": ["2"], "--model": ["hertz", "fingertip_layer"]}
    if command == "export":
        words += ["--to", choose(generator, ["mujoco", "MuJoCo", "bullet", "drake", "gazebo"], ["mujocco"])]
        options.update({"--load-range": ["0.5,5"], "--fit": ["range", "nominal"]})
    if command == "predict":
        options.update({"--limit-surface": ["3", "9"], "--torque-rule": ["paper", "exact"]})
    if command == "select":
        words += ["--tolerance", word(generator, ["0.05"])]
        options.pop("--tolerance")
        options.pop("--model")
        options.update({"--models": ["hertz,winkler", "fem", "all"], "--budget-us": ["5", "1e9"]})
    for name in generator.sample(sorted(options), generator.randrange(4)):
        words += [name, word(generator, options[name])]
    flags = {"predict": ["--explain", "--json", "--quiet"], "export": ["--force", "--json", "--quiet"], "select": ["--json", "--quiet"]}
    return words + [flag for flag in flags[command] if generator.random() < 0.5]


def a_minute_of_processor():
    """Of its own time, so that a busy machine makes no finding; then the run ends by SIGXCPU, a status below 0."""
    resource.setrlimit(resource.RLIMIT_CPU, (60, 61))


def refuse_constant(name):
    raise ValueError(name)


def finding_of(words, run):
    if run.returncode not in (0, 1, 2, 3):
        return "status %d" % run.returncode
    errors = [line for line in run.stderr.splitlines() if line.startswith(b"softfinger: error")]
    if run.returncode == 2 and len(errors) != 1:
        return "%d lines of errors" % len(errors)
    if run.returncode == 3:
        return "the numerics: " + run.stderr.decode(errors="replace").strip()[:200]
    if "--json" in words and run.returncode in (0, 1) and run.stdout:
        try:
            if json.loads(run.stdout, parse_constant=refuse_constant).get("schema") != 2:
                return "no schema"
        except ValueError as error:
            return "JSON: %s" % error
    elif run.returncode == 0 and any(part in run.stdout.replace(b",", b" ").split() for part in (b"nan", b"inf", b"-nan")):
        return "not a number"
    return None


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    program = os.path.abspath(sys.argv[1])
    runs = int(sys.argv[2]) if len(sys.argv) > 2 else 1000
    seed = int(sys.argv[3]) if len(sys.argv) > 3 else 1
    generator = random.Random(seed)
    findings, statuses = 0, {}
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, "case.toml")
        for i in range(runs):
            generator.odd = generator.choice([0, 0.01, 0.03, 0.12])  # share of odd values: few refusals hide what comes after them
            text = case(generator, "shadow_like_pad")
            with open(file, "w", encoding="latin-1") as written:
                written.write(text)
            words = arguments(generator, file)
            try:
                run = subprocess.run([program, *[w.replace("\0", "") for w in words]], capture_output=True, timeout=1800, cwd=folder,
                                     preexec_fn=a_minute_of_processor)
                finding = finding_of(words, run)
                statuses[run.returncode] = statuses.get(run.returncode, 0) + 1
            except subprocess.TimeoutExpired:
                finding = "hangs"
            if finding:
                findings += 1
                print("run %d: %s\n  %s\n%s" % (i, finding, " ".join(words), text))
    print("%d runs, seed %d, by status %s: %d findings" % (runs, seed, dict(sorted(statuses.items())), findings))
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
