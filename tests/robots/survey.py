#!/usr/bin/env python3
"""Simulates public robots' files for a tenth of a second, and says what happens to each.

    python3 tests/robots/survey.py build/release/bin/softfinger FOLDER [--fetch] [--only WORD] [-j N]

The files are those of public_robots.txt beside this program; none of them is part of the project. FOLDER has
a folder for each repository, named as that is; --fetch clones those that are missing. A line per file: simulated,
with the number of bodies, joints and contacts; refused, with the reason; or failed. It is no test: it needs the
network and takes an hour.
"""

import argparse
import concurrent.futures
import json
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
DURATION_s = 0.1
LONGEST_s = 600


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


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("folder", type=pathlib.Path)
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
        outcomes = pool.map(lambda file: simulate(typed.program, file), files)
        for (_, path), (word, sentence) in zip(chosen, outcomes):
            print(f"{word:<10} {path}: {sentence}", flush=True)
            counts[word] = counts.get(word, 0) + 1
    print(", ".join(f"{count} {word}" for word, count in sorted(counts.items())), f"of {len(chosen)} robots' files")
    return 0


if __name__ == "__main__":
    sys.exit(main())
