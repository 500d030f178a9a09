"""The numbers behind the pictures of these pages: writes them, or compares a file of them with today's.

    docs/picture_data.py --build build/release --write docs/pictures.csv
    docs/picture_data.py --build build/release --compare docs/pictures.csv

One row per number: picture, load, model, quantity, value (SI units; errors and bounds relative). The picture
compare_page has the numbers of silicone_pad.
"""

import argparse
import csv
import json
import os
import pathlib
import subprocess
import sys
import tempfile

# Half of the last digit that a picture shows: most show three digits, of errors and bounds two.
SHOWN_OF_VALUES = 0.5e-2
SHOWN_OF_ERRORS = 0.5e-1
# A picture shows errors in per cent, with two decimals at most.
SMALLEST_ERROR = 1e-4

CASE = "silicone_pad_2mm"
MESH_CASE, MESH = "pad_on_plane", "shadow_like_pad.stl"
SWEEP, SCENE, MEASUREMENTS = "thickness_and_load", "pinch", "inked_fingertip.csv"
TOLERANCE = "0.05"


def run(build, *words):
    environment = dict(os.environ, NO_COLOR="1")
    return subprocess.run([str(build / "bin" / "softfinger"), *words], check=True, text=True,
                          env=environment, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL).stdout


def silicone_pad(build, folder):
    """Of the report: contact, pressure and torque of each model, and its errors."""
    run(build, "compare", CASE, "--output", str(folder / "report"))
    with open(folder / "report" / "results.csv", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            for quantity in ("a_m", "b_m", "area_m2", "peak_pressure_Pa", "max_torque_Nm",
                             "relative_error_max_torque"):
                if row[quantity]:
                    yield "silicone_pad", row["load_N"], row["model"], quantity, float(row[quantity])


def select_page(build):
    """Of the choice: the stated error of each model."""
    answer = json.loads(run(build, "select", CASE, "--tolerance", TOLERANCE, "--json"))
    for choice in answer["choices"]:
        for entry in choice["candidates"]:
            for quantity, value in (entry["error_bound"] or {}).items():
                if value is not None:
                    yield "select_page", str(choice["load_N"]), entry["model"], f"relative_{quantity}", value


def sweep_page(build, folder):
    """Of the sweep: what its first lines say of the leading model."""
    run(build, "sweep", SWEEP, "--output", str(folder / "sweep"))
    with open(folder / "sweep" / "results.csv", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["fingertip_layer_usable"] == "yes"]
    torques = [float(row["fingertip_layer_max_torque_Nm"]) for row in rows]
    yield "sweep_page", "", "fingertip_layer", "usable_rows", float(len(rows))
    yield "sweep_page", "", "fingertip_layer", "least_max_torque_Nm", min(torques)
    yield "sweep_page", "", "fingertip_layer", "largest_max_torque_Nm", max(torques)


def recommended(picture, answer):
    """Of a prediction: the recommended model's contact and torque, and their bounds."""
    for result in answer["results"]:
        if not result.get("recommended"):
            continue
        for quantity in ("a_m", "b_m", "max_torque_Nm", "eccentricity_m"):
            yield picture, f"{result['load_N']:g}", result["model"], quantity, result[quantity]
        for quantity in ("area", "max_torque"):
            yield picture, f"{result['load_N']:g}", result["model"], f"relative_{quantity}", result["error_bound"][quantity]


def predictions(build):
    """Of the pages of predict and explore."""
    yield from recommended("predict_page", json.loads(run(build, "predict", MESH_CASE, "--json")))
    answer = json.loads(run(build, "predict", CASE, "--set", "contact.load_N=2", "--json"))
    yield from recommended("explore_page", answer)


def motion_page(build):
    """Of the motion: when the grasp slips."""
    answer = json.loads(run(build, "simulate", SCENE, "--json"))
    yield "motion_page", "", "", "until_s", answer["hold"]["until_s"]


def calibrate_page(build):
    """Of the calibration: what was found, and its intervals."""
    answer = json.loads(run(build, "calibrate", MEASUREMENTS, CASE, "--json"))
    for name, found in answer["parameters"].items():
        for quantity, value in zip(("value", "low", "high"), (found["value"], *(found["interval95"] or ()))):
            if value is not None:
                yield "calibrate_page", "", name, quantity, value


def mesh_page(build):
    """Of the mesh: what the best pad gives."""
    best = json.loads(run(build, "mesh", MESH, "--json"))["pads"][0]
    for quantity, name in (("a_m", "a_m"), ("b_m", "b_m"), ("max_torque_Nm", "max_torque_Nm"),
                           ("error_bound", "relative_error_bound")):
        yield "mesh_page", "", best["name"], name, best[quantity]


def numbers(build):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        rows = [*silicone_pad(build, folder), *select_page(build), *sweep_page(build, folder), *predictions(build),
                *motion_page(build), *calibrate_page(build), *mesh_page(build)]
    return {row[:4]: row[4] for row in rows}


def differences(said, today):
    for key in sorted(said.keys() | today.keys()):
        if key not in said or key not in today:
            yield f"{', '.join(key)}: {'no longer there' if key in said else 'new'}"
            continue
        is_error = key[3].startswith("relative")
        allowed = (SHOWN_OF_ERRORS if is_error else SHOWN_OF_VALUES) * abs(today[key])
        if is_error:
            allowed = max(allowed, SMALLEST_ERROR)
        if abs(said[key] - today[key]) > allowed:
            yield f"{', '.join(key)}: the picture has {said[key]:g}, today it is {today[key]:g}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--build", type=pathlib.Path, required=True)
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--write", type=pathlib.Path)
    what.add_argument("--compare", type=pathlib.Path)
    arguments = parser.parse_args()
    today = numbers(arguments.build)
    header = ["picture", "load_N", "model", "quantity", "value"]
    if arguments.write:
        with open(arguments.write, "w", encoding="utf-8", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(header)
            writer.writerows([*key, f"{value:.6g}"] for key, value in today.items())
        return
    with open(arguments.compare, encoding="utf-8") as file:
        said = {tuple(row[name] for name in header[:4]): float(row["value"]) for row in csv.DictReader(file)}
    found = list(differences(said, today))
    if found:
        sys.exit("\n".join([*found, "The pictures are stale: run docs/pictures.sh"]))
    print(f"{len(today)} numbers behind the pictures are those of today")


if __name__ == "__main__":
    main()
