"""A folder of small files, one for each key, that several processes may use at the same time.

A file is written under another name and renamed, so a reader sees all of it or none. Every file
carries a checksum: what is damaged counts as missing, and is written again. When the folder has
grown beyond its size, the files that nobody has read for longest go.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import time
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

__all__ = ["Memo", "MemoInfo", "default_memo", "without_memo"]

MAX_BYTES = 500_000_000
LARGEST_ENTRY = 256_000_000
"""Bytes of one entry after decompression; a larger one is not read."""

_MAGIC = b"vaso memo 1 "
_SUFFIX, _PARTIAL = ".memo", ".part"
_LOOK_AFTER = 50  # writes until the size of the folder is looked at again
_KEEP = 0.8  # share of the size that is kept when the folder is too large
_STALE = 3600.0  # seconds after which a partial file is what a killed process has left


@dataclass(frozen=True, slots=True)
class MemoInfo:
    """What is in a memo.

    Attributes:
        folder: Where it is.
        entries: Number of files.
        bytes: Their size.
        max_bytes: The size that it is kept below.
    """

    folder: Path
    entries: int
    bytes: int
    max_bytes: int


class Memo:
    """JSON values by key, on disk. Nothing here raises because of the disk.

    Args:
        folder: Where the files are; made with the first write, for this user only.
        max_bytes: Size that the folder is kept below, at the latest after some more writes.
    """

    def __init__(self, folder: Path | str, max_bytes: int = MAX_BYTES) -> None:
        self.folder = Path(folder)
        self.max_bytes = max_bytes
        self._writes = 0

    def get(self, key: str) -> Any:
        """The value of a key; None where there is none, or none that can be read."""
        path = self._path(key)
        try:
            value = _unpacked(path.read_bytes(), key)
        except (OSError, ValueError, zlib.error, MemoryError, RecursionError):
            return None
        with contextlib.suppress(OSError):
            os.utime(path)
        return value

    def put(self, key: str, value: Any) -> bool:
        """Keep a value; False where the disk does not take it, or it is no JSON."""
        path = self._path(key)
        part = path.with_name(f"{path.stem}-{os.getpid()}-{os.urandom(4).hex()}{_PARTIAL}")
        try:
            self.folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            path.parent.mkdir(exist_ok=True)
            part.write_bytes(_packed(value, key))
            part.replace(path)
        except (OSError, TypeError, ValueError):
            with contextlib.suppress(OSError):
                part.unlink(missing_ok=True)
            return False
        if self._writes % _LOOK_AFTER == 0:
            self._shrink()
        self._writes += 1
        return True

    def info(self) -> MemoInfo:
        """How much there is."""
        sizes = [size for _, size, path in self._files() if path.endswith(_SUFFIX)]
        return MemoInfo(self.folder, len(sizes), sum(sizes), self.max_bytes)

    def clear(self) -> int:
        """Remove every entry, and say how many there were."""
        removed = 0
        for _, _, path in list(self._files()):
            with contextlib.suppress(OSError):
                os.unlink(path)
                removed += path.endswith(_SUFFIX)
        with contextlib.suppress(OSError):
            for shard in self.folder.iterdir():
                with contextlib.suppress(OSError):  # not empty: somebody writes there
                    shard.rmdir()
        return removed

    def _path(self, key: str) -> Path:
        return self.folder / key[:2] / f"{key}{_SUFFIX}"

    def _files(self) -> Iterator[tuple[float, int, str]]:
        """Time of last use, size and path of every file of the memo; nothing else is touched."""
        with contextlib.suppress(OSError):
            for shard in os.scandir(self.folder):
                with contextlib.suppress(OSError):
                    for entry in os.scandir(shard.path):
                        if entry.name.endswith((_SUFFIX, _PARTIAL)):
                            found = entry.stat()
                            yield found.st_mtime, found.st_size, entry.path

    def _shrink(self) -> None:
        now, kept, size = time.time(), [], 0
        for used, bytes_, path in self._files():
            if path.endswith(_SUFFIX):
                kept.append((used, bytes_, path))
                size += bytes_
            elif now - used > _STALE:
                with contextlib.suppress(OSError):
                    os.unlink(path)
        if size <= self.max_bytes:
            return
        for _, bytes_, path in sorted(kept):
            with contextlib.suppress(OSError):
                os.unlink(path)
                size -= bytes_
            if size <= _KEEP * self.max_bytes:
                return


_measuring = 0


@contextlib.contextmanager
def without_memo() -> Iterator[None]:
    """Have this process keep and recall no verdicts for a while, so that times can be compared."""
    global _measuring
    _measuring += 1
    try:
        yield
    finally:
        _measuring -= 1


def default_memo() -> Memo | None:
    """The memo of this user: ``~/.cache/vaso/verdicts``.

    ``XDG_CACHE_HOME`` moves it with other caches, ``VASO_CACHE`` names another folder, and
    ``VASO_CACHE=off`` turns it off. ``VASO_CACHE_MB`` bounds its size.
    """
    chosen = os.environ.get("VASO_CACHE", "").strip()
    if _measuring or chosen.lower() in ("off", "0", "no", "none", "false"):
        return None
    if chosen:
        return Memo(Path(chosen).expanduser(), _max_bytes())
    base = Path(os.environ.get("XDG_CACHE_HOME") or "")
    try:
        folder = base if base.is_absolute() else Path.home() / ".cache"
    except RuntimeError:  # there is no home folder
        return None
    return Memo(folder / "vaso" / "verdicts", _max_bytes())


def _max_bytes() -> int:
    try:
        return max(0, int(float(os.environ["VASO_CACHE_MB"]) * 1e6))
    except (KeyError, ValueError, OverflowError):
        return MAX_BYTES


def _packed(value: Any, key: str) -> bytes:
    text = json.dumps([key, value], ensure_ascii=False, separators=(",", ":"))
    body = zlib.compress(text.encode("utf-8", "surrogatepass"), 1)
    return _MAGIC + hashlib.blake2b(body, digest_size=16).hexdigest().encode() + b"\n" + body


def _unpacked(data: bytes, key: str) -> Any:
    head, _, body = data.partition(b"\n")
    if head != _MAGIC + hashlib.blake2b(body, digest_size=16).hexdigest().encode():
        raise ValueError("damaged")
    unpacker = zlib.decompressobj()
    text = unpacker.decompress(body, LARGEST_ENTRY)
    if unpacker.unconsumed_tail:
        raise ValueError("too large")
    found, value = json.loads(text.decode("utf-8", "surrogatepass"))
    if found != key:
        raise ValueError("the entry of another key")
    return value
