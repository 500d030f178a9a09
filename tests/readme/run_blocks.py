"""Runs every fenced block of a page, in order, as a reader would who types them in one shell.

The page is read in a copy of the checkout (links, but for its top folder), which lies in a folder of
its own that is removed at the end, and which is also the reader's home. What a block does follows
from its language:

  sh       runs in bash; folder and exported variables stay as they are for the next block
  python   runs
  text     is what the last block that ran prints, line by line; a line `...` stands for any lines,
           and a line that ends with ` ...` for all lines that begin like it
  others   are files: `<!-- file: NAME -->` stands above the block, and a later block uses NAME,
           or its folder (`~/grip/grip.cc`)

A block that a test cannot run has `<!-- not run: REASON -->` above it. All else fails.
"""

import argparse
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time

BLOCK = re.compile(r"(?:<!-- (?P<mark>file|not run): (?P<said>[^>]+?) -->\n+)?"
                   r"^```(?P<language>\w*)\n(?P<text>.*?)^```$", re.DOTALL | re.MULTILINE)


class Failure(Exception):
    """What a page says and what happens are not the same."""


def link_checkout(source, build, folder):
    """`folder` looks like the checkout, with the build in build/release; nothing but links is in it."""
    folder.mkdir()
    for entry in source.iterdir():
        if entry.name not in ("build", ".git"):
            (folder / entry.name).symlink_to(entry)
    (folder / "build").mkdir()
    (folder / "build" / "release").symlink_to(build)


class Reader:
    """Types the blocks of a page."""

    def __init__(self, checkout, environment):
        self.folder = checkout
        self.environment = environment
        self.printed = None
        self.unused_files = []

    def run(self, command, name):
        result = subprocess.run(command, cwd=self.folder, env=self.environment, text=True,
                                stdin=subprocess.DEVNULL, capture_output=True, check=False)
        if result.returncode != 0:
            raise Failure(f"{name} ends with {result.returncode}\n{result.stdout}\n{result.stderr}")
        self.printed = result.stdout
        return result.stdout

    def use(self, text):
        self.unused_files = [name for name in self.unused_files
                             if name not in text and (name.rpartition("/")[0] or name) not in text]

    def sh(self, text):
        self.use(text)
        after = "\nprintf '\\0%s\\0' \"$PWD\"; env -0"
        printed = self.run(["bash", "-e", "-o", "pipefail", "-c", text + after], "the block")
        self.printed, self.folder, variables = printed.split("\0", 2)
        self.environment = dict(line.split("=", 1) for line in variables.split("\0") if line)

    def python(self, text):
        self.use(text)
        self.run([sys.executable, "-c", text], "the block")

    def file(self, name, text):
        home = name.startswith("~/")
        target = (pathlib.Path(self.environment["HOME"]) / name[2:]) if home else pathlib.Path(self.folder) / name
        if ".." in name or name.startswith("/") or target.is_symlink():
            raise Failure(f"{name} is a file of the checkout, or of nobody's")
        target.parent.mkdir(exist_ok=True)
        target.write_text(text, encoding="utf-8")
        self.unused_files.append(name)

    def compare(self, text):
        """Each line of `text` follows the one before it, unless `...` stands between them."""
        if self.printed is None:
            raise Failure("no block ran that could have printed this")
        printed = [line.rstrip() for line in self.printed.splitlines()]

        def differs(line, said):
            if said.endswith(" ..."):
                return not line.startswith(said[:-len(" ...")])
            return line != said.rstrip()

        at, elided = 0, False
        for line in text.splitlines():
            if line == "...":
                elided = True
                continue
            found = at
            while elided and found < len(printed) and differs(printed[found], line):
                found += 1
            if found >= len(printed) or differs(printed[found], line):
                raise Failure(f"the page says\n{text}\nand the block prints\n{self.printed}\n"
                              f"The first line that differs: {line}")
            at, elided = found + 1, False
        if not elided and at < len(printed):
            raise Failure(f"the block prints more than the page says: {printed[at]}")


def run_page(page, reader, only):
    """How many blocks ran, and how many are marked; `only` those of one language and what they print."""
    text = page.read_text(encoding="utf-8")
    blocks = list(BLOCK.finditer(text))
    if 2 * len(blocks) != len(re.findall(r"^```", text, re.MULTILINE)):
        raise Failure(f"{page.name}: a block is not closed, or its first line is not understood")
    executed, marked, skipped = 0, 0, False
    for block in blocks:
        mark, said, language, content = block.group("mark", "said", "language", "text")
        skipped = only and language != only and (skipped or language != "text")
        if skipped:
            continue
        where = f"{page.name}:{text.count(chr(10), 0, block.start('language')) + 1}"
        begin = time.monotonic()
        try:
            if mark == "not run":
                marked += 1
                print(f"  {where}: not run: {said}")
                continue
            if mark == "file":
                reader.file(said, content)
            elif language == "sh":
                reader.sh(content)
            elif language == "python":
                reader.python(content)
            elif language == "text":
                reader.compare(content)
            else:
                raise Failure(f"a block of language '{language}' is no file; say <!-- file: NAME --> "
                              "or <!-- not run: REASON --> above it")
        except Failure as failure:
            raise Failure(f"{where}: {failure}\nThe block is\n{content}") from failure
        executed += 1
        print(f"  {where}: {language}, {time.monotonic() - begin:.1f} s")
    if reader.unused_files:
        raise Failure(f"{page.name}: no block uses {', '.join(reader.unused_files)}")
    return executed, marked


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--source", type=pathlib.Path, required=True)
    parser.add_argument("--build", type=pathlib.Path, required=True)
    parser.add_argument("--finite-elements", help="program in place of softfinger-fem")
    parser.add_argument("--only", help="the blocks of this language, and what they print")
    parser.add_argument("page", type=pathlib.Path)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        checkout = pathlib.Path(folder) / "softfinger-checkout"
        link_checkout(arguments.source.resolve(), arguments.build.resolve(), checkout)
        environment = dict(os.environ, HOME=folder, PWD=str(checkout), NO_COLOR="1")
        environment["PYTHONPATH"] = str(arguments.build.resolve() / "python")
        if arguments.finite_elements:
            environment["SOFTFINGER_FEM_PROGRAM"] = arguments.finite_elements
        try:
            reader = Reader(str(checkout), environment)
            executed, marked = run_page(arguments.page, reader, arguments.only)
        except Failure as failure:
            sys.exit(str(failure))
    print(f"{arguments.page.name}: {executed} of {executed} blocks executed, {marked} marked as not run")


if __name__ == "__main__":
    main()
