"""Checks every file that belongs to the project (git's list): size, line ends, white space, leftovers, links in Markdown.

    check_files.py ROOT
"""

import pathlib
import re
import subprocess
import sys

LARGEST = 2 * 1024 * 1024
CODE = {".cpp", ".hpp", ".cu", ".py", ".sh", ".cmake", ".mjs", ".js", ".ts"}
LEFTOVER = re.compile(r"\b(TODO" r"|FIXME|XXX)\b|^(<<<<<<<|>>>>>>>) ")

LINK = re.compile(r"\]\((?!https?:|#)([^)#\s]+)")


def broken_links(root, path, text):
    for target in LINK.findall(text):
        if not (root / path).parent.joinpath(target).exists():
            yield f"{path}: a link to {target}, which does not exist"


def offences_of_text(path, text):
    if "\r" in text:
        yield f"{path}: carriage returns; lines end in LF"
    if text and not text.endswith("\n"):
        yield f"{path}: the last line has no end"
    is_code = path.suffix in CODE
    for number, line in enumerate(text.split("\n"), 1):
        if is_code and "\t" in line:
            yield f"{path}:{number}: a tab"
        if is_code and line != line.rstrip():
            yield f"{path}:{number}: white space at the end"
        if LEFTOVER.search(line) and path.name != "check_files.py":
            yield f"{path}:{number}: a leftover: {line.strip()[:60]}"


def check(root):
    # Continuous integration often works on a checkout that belongs to another user, which git refuses unless told.
    git = ["git", "-c", f"safe.directory={root}", "-C", root]
    listed = subprocess.run([*git, "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
                            capture_output=True, check=True).stdout.decode()
    for name in filter(None, listed.split("\0")):
        file = root / name
        if not file.is_file():
            continue
        size = file.stat().st_size
        if size > LARGEST:
            yield f"{name}: {size} bytes; the limit is {LARGEST}: large data do not belong into the repository"
            continue
        if name.startswith("tests/fuzz/corpus/"):  # bytes as a parser may get them
            continue
        data = file.read_bytes()
        if b"\0" in data:
            continue
        try:
            text = data.decode()
        except UnicodeDecodeError:
            yield f"{name}: neither UTF-8 text nor binary"
            continue
        yield from offences_of_text(pathlib.Path(name), text)
        if file.suffix == ".md":
            yield from broken_links(root, name, text)


if __name__ == "__main__":
    found = list(check(pathlib.Path(sys.argv[1]).resolve()))
    for line in found:
        print(line)
    sys.exit(1 if found else 0)
