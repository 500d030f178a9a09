#!/usr/bin/env python3
"""Simulates public robots' files for a tenth of a second, or applies a rubber layer to a finger of each.

    python3 tests/robots/survey.py build/release/bin/softfinger FOLDER [--apply] [--fetch] [--only WORD] [-j N]

The files are those of public_robots.txt beside this program; none of them is part of the project. FOLDER has
a folder for each repository, named as that is; --fetch clones those that are missing. A line per file: simulated,
with the number of bodies, joints and contacts; refused, with the reason; or failed. It is no test: it needs the
network and takes an hour.

--apply chooses the finger as a reader of the file would: the first part that can touch others, in the order of
FINGER_WORDS by its name, then of its depth in the chain of bodies, the deepest first. Nothing but the name is typed.
Where the answer is refused, or not usable, and names a --pad to type, that is typed, twice at most. A file that then
takes none of the next MORE_PARTS either keeps what the first one said.
"""

import argparse
import concurrent.futures
import json
import pathlib
import re
import subprocess
import sys
import xml.etree.ElementTree

HERE = pathlib.Path(__file__).resolve().parent
DURATION_s = 0.1
LONGEST_s = 600

# Parts of names, likeliest first. A robot without fingers presses with its feet or wheels.
FINGER_WORDS = ("tip", "distal", "pad", "finger", "thumb", "jaw", "gripper", "hand", "foot", "toe", "wheel")
MORE_PARTS = 4
LAYER = ["--layer", "2,300,0.49", "--friction", "0.8", "--load", "2"]


def robots():
    """Pairs of address and path of the list."""
    for line in (HERE / "public_robots.txt").read_text().splitlines():
        words = line.split("#")[0].split()
        if words:
            yield words[0], words[1]


def clone(address, folder):
    command = ["git", "clone", "--quiet", "--depth", "1", address, str(folder)]
    subprocess.run(command, check=True, timeout=3600)


def simulate(program, file):
    """What happened, in a word and a sentence."""
    command = [program, "simulate", str(file), "--json", "--set", f"simulation.duration_s={DURATION_s}"]
    try:
        run = subprocess.run(command, capture_output=True, text=True, timeout=LONGEST_s)
    except subprocess.TimeoutExpired:
        return "slow", f"not done after {LONGEST_s} s"
    last = (run.stderr.strip().splitlines() or [""])[-1]
    if run.returncode == 2:
        return "refused", last
    if run.returncode != 0:
        return "failed", f"status {run.returncode}: {last}"
    result = json.loads(run.stdout)
    remarks = len(run.stderr.strip().splitlines())
    return "simulated", (f"{len(result['bodies'])} bodies, up to {result['most_contacts']} contacts, "
                         f"{result['steps_per_s']:.0f} steps/s, {remarks} remarks")


def root_of(file):
    return xml.etree.ElementTree.fromstring(file.read_bytes().rstrip(b"\0"))


def elements(file):
    """Pairs of depth and element of an XML file and of what it includes, in their order."""
    open_elements = [(0, root_of(file))]
    while open_elements:
        depth, element = open_elements.pop()
        yield depth, element
        included = file.parent / element.get("file", "") if element.tag == "include" else None
        children = [root_of(included)] if included and included.is_file() else element
        open_elements.extend((depth + 1, child) for child in reversed(children))


def candidates(file):
    """Names of parts that may be a finger, likeliest first."""
    depths = {}
    if file.suffix == ".urdf":
        all_elements = [element for _, element in elements(file)]
        parents = {joint.find("child").get("link"): joint.find("parent").get("link")
                   for joint in all_elements if joint.tag == "joint" and joint.find("child") is not None}
        for link in all_elements:
            if link.tag != "link" or link.find("collision") is None:
                continue
            depth, above = 0, link.get("name")
            while above in parents and depth < len(parents):
                depth, above = depth + 1, parents[above]
            depths[link.get("name")] = depth
    else:
        for depth, element in elements(file):
            for geom in element.findall("geom") if element.tag == "body" else []:
                depths.setdefault(geom.get("name") or element.get("name"), depth)
        depths.pop(None, None)
    ranks = {name: next((i for i, word in enumerate(FINGER_WORDS) if word in name.lower()), len(FINGER_WORDS))
             for name in depths}
    return sorted(depths, key=lambda name: (ranks[name], -depths[name]))


def apply(program, file):
    """What happened, in a word and a sentence."""
    engine = "gazebo" if file.suffix == ".urdf" else "mujoco"
    try:
        names = candidates(file)
    except xml.etree.ElementTree.ParseError as error:
        return "refused", f"no XML: {error}"
    outcomes = []
    for name in names:
        outcome = apply_to(program, file, engine, name)
        if outcome[0] in ("applied", "with --pad"):
            return outcome if not outcomes else ("other part", outcome[1])
        if "a geom that touches others" not in outcome[1]:
            outcomes.append(outcome)
        if len(outcomes) > MORE_PARTS:
            break
    return (outcomes or [("refused", "no part with a name that touches others")])[0]


def apply_to(program, file, engine, name):
    """What happened to a part, in a word and a sentence."""
    pad = []
    for _ in range(3):
        command = [program, "apply", str(file), "--finger", name, *pad, *LAYER, "--to", engine, "--json"]
        run = subprocess.run(command, capture_output=True, text=True, timeout=LONGEST_s)
        said = " ".join([name, *pad])
        if run.returncode == 0:
            finger = json.loads(run.stdout)["fingers"][0]
            words = f"{finger['shape']}, {finger['contact']}, torque {1e3 * finger['max_torque_Nm']:.3g} mNm"
            return "applied" if not pad else "with --pad", f"{said}: {words}"
        word = {1: "not usable", 2: "refused"}.get(run.returncode, "failed")
        sentence = json.loads(run.stdout)["reason"] if word == "not usable" else run.stderr.strip().splitlines()[-1]
        proposed = re.search(r"--pad (" + re.escape(name) + r":[-+.,xyz\d]*[xyz\d])", sentence)
        if not proposed:
            break
        pad = ["--pad", proposed[1]]
    return word, f"{said}: {sentence}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--apply", action="store_true", help="applies instead of simulating")
    parser.add_argument("--fetch", action="store_true", help="clones repositories that are not there")
    parser.add_argument("--only", default="", help="files whose path has this word")
    parser.add_argument("-j", type=int, default=1, help="files at once")
    typed = parser.parse_args()
    chosen = [(address, path) for address, path in robots() if typed.only in path]
    files = []
    for address, path in chosen:
        folder = typed.folder / address.rsplit("/", 1)[-1]
        if typed.fetch and not folder.exists():
            clone(address, folder)
        files.append(folder / path)
    counts = {}
    with concurrent.futures.ThreadPoolExecutor(typed.j) as pool:
        outcomes = pool.map(lambda file: (apply if typed.apply else simulate)(typed.program, file), files)
        for (_, path), (word, sentence) in zip(chosen, outcomes):
            print(f"{word:<10} {path}: {sentence}", flush=True)
            counts[word] = counts.get(word, 0) + 1
    print(", ".join(f"{count} {word}" for word, count in sorted(counts.items())), f"of {len(chosen)} robots' files")
    return 0


if __name__ == "__main__":
    sys.exit(main())
