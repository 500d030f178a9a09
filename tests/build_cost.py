#!/usr/bin/env python3
"""What compiling costs: seconds of the processor and memory of each source.

usage: build_cost.py measure COMPILER ARGUMENTS..    as CMAKE_CXX_COMPILER_LAUNCHER (tests/run.sh sets it): runs the
                                                     compiler and adds a line to compile_costs.tsv in the build folder
       build_cost.py report FOLDER..                 prints the ten dearest sources of each build folder, and totals

Of a source that was compiled several times the last time counts. What a compiler cache had costs next to nothing.
"""
import os
import resource
import subprocess
import sys

LOG = "compile_costs.tsv"


def measure(command):
    status = subprocess.call(command)
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    if status == 0 and "-c" in command and "-o" in command:
        output = command[command.index("-o") + 1]
        with open(LOG, "a") as log:
            log.write("%s\t%.2f\t%.0f\n" % (output, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024))
    return status if status >= 0 else 128 - status


def report(folder):
    costs = {}
    with open(os.path.join(folder, LOG)) as log:
        for line in log:
            source, seconds, megabytes = line.rstrip("\n").split("\t")
            costs[source] = (float(seconds), float(megabytes))
    if not costs:
        return
    print("%s: %d sources, %.0f s of the processor, %.0f MB in the largest compiler process" % (
        folder, len(costs), sum(cost[0] for cost in costs.values()), max(cost[1] for cost in costs.values())))
    for source, (seconds, megabytes) in sorted(costs.items(), key=lambda item: -item[1][0])[:10]:
        print("  %6.1f s %6.0f MB  %s" % (seconds, megabytes, source.replace("CMakeFiles/", "").replace(".dir/", "/")))


def main():
    if len(sys.argv) > 2 and sys.argv[1] == "measure":
        return measure(sys.argv[2:])
    if len(sys.argv) < 3 or sys.argv[1] != "report":
        sys.exit(__doc__)
    for folder in sys.argv[2:]:
        if os.path.exists(os.path.join(folder, LOG)):
            report(folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())
