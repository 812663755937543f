"""Apply unified diffs, strictly: every line must be where the diff says (no ``patch`` needed)."""

from __future__ import annotations

import re
from pathlib import Path

_FILES = re.compile(r"^--- (\S+).*\n\+\+\+ (\S+).*\n", re.M)
_HUNK = re.compile(r"@@ -(\d+)(?:,(\d+))? \+\d+(?:,(\d+))? @@")


class PatchError(Exception):
    """A diff that does not fit the files."""


def apply(diff: str, root: Path, strip: int = 0) -> None:
    """Apply a diff to the files below a folder.

    Args:
        diff: Unified diff of one or more files.
        root: The folder.
        strip: Leading path components to ignore, as in ``patch -pN``.
    """
    heads = list(_FILES.finditer(diff))
    ends = [*(head.start() for head in heads[1:]), len(diff)]
    for head, end in zip(heads, ends, strict=False):
        body = diff[head.end() : end]
        names = [name.split("/", strip)[-1] for name in head.groups()]
        name = next((n for n in names if (root / n).exists()), names[1])
        path = root / name
        old = path.read_bytes().decode("latin-1") if path.exists() else ""
        new = _apply_hunks(old.splitlines(keepends=True), body.splitlines(keepends=True), name)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes("".join(new).encode("latin-1"))


def _apply_hunks(old: list[str], body: list[str], name: str) -> list[str]:
    new: list[str] = []
    done = 0  # lines of the old file that are dealt with
    i = 0
    while i < len(body):
        hunk = _HUNK.match(body[i])
        i += 1
        if not hunk:
            continue  # text between the hunks
        start, removed, added = (int(n) if n is not None else 1 for n in hunk.groups())
        first = start - 1 if removed else start
        new += old[done:first]
        done = first
        while removed or added:
            sign, line = body[i][0], body[i][1:]
            i += 1
            if sign in " -":
                if done >= len(old) or old[done].rstrip("\r\n") != line.rstrip("\r\n"):
                    raise PatchError(f"{name}, line {done + 1}: expected {line!r}")
                removed -= 1
            if sign == " ":
                new.append(old[done])
            elif sign == "+":
                new.append(line)
            done += sign in " -"
            added -= sign in " +"
    return new + old[done:]
