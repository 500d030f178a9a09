"""Runs the Python sample of README.md and compares what it prints with the text below it."""

import contextlib
import io
import re
import sys

readme = open(sys.argv[1], encoding="utf-8").read()
sample, said = re.search(r"```python\n(.*?)```\n.*?```text\n(.*?)```", readme, re.DOTALL).groups()
printed = io.StringIO()
with contextlib.redirect_stdout(printed):
    exec(compile(sample, "the sample of README.md", "exec"), {})
if printed.getvalue() != said:
    sys.exit(f"The sample of README.md prints\n{printed.getvalue()}not\n{said}")
