"""Execute the notebooks, and check or refresh the outputs that are committed with them.

    .venv/bin/python scripts/notebooks.py                run all; fail on an error or a stale output
    .venv/bin/python scripts/notebooks.py 01 05          some of them
    .venv/bin/python scripts/notebooks.py --update       write the new outputs back

Every notebook runs in a fresh kernel of this Python (no installed kernel is needed), in an empty
folder, with an empty home, without API keys and without a way to the network.
"""

from __future__ import annotations

import argparse
import copy
import difflib
import json
import os
import re
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).resolve().parent.parent / "notebooks"
METADATA = {
    "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
    "language_info": {"name": "python"},
}
VARIES = "varies"
"""Tag of a cell whose output is different in every run, such as a measured time."""

SECRET = re.compile(r"_API_KEY$|_TOKEN$|^VASO_|^OPENAI_|^ANTHROPIC_|^HF_")
NOWHERE = "http://127.0.0.1:9"
"""A proxy that refuses every connection."""

DURATION = re.compile(r"\b\d+(?:\.\d+)?(?:e-\d+)? ?(?:ms|s|seconds)\b")
COMPARED = ("text/plain", "text/html", "image/svg+xml", "text/markdown")
STYLES = re.compile(r"<style>.*?</style>", re.S)
TAGS = re.compile(r"<[^>]*>")
COLOURS = re.compile(r"\x1b\[[0-9;]*m")
DIFF_LINES = 30


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the notebooks that are named; 0 if all is well."""
    options = _options(arguments)
    paths = [p for p in sorted(FOLDER.glob("*.ipynb")) if _is_chosen(p, options.names)]
    if not paths:
        print(f"no notebook in {FOLDER} is called {' or '.join(options.names)}", file=sys.stderr)
        return 2
    failures = 0
    for path in paths:
        started = time.monotonic()
        problem = process(path, update=options.update, timeout=options.timeout)
        seconds = time.monotonic() - started
        failures += bool(problem)
        print(f"{path.name:32} {seconds:6.1f} s  {'FAILED' if problem else 'ok'}", flush=True)
        if problem:
            print("    " + problem.replace("\n", "\n    "), flush=True)
    return 1 if failures else 0


def _options(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("names", nargs="*", help="beginnings of notebook names; all if none")
    parser.add_argument("--update", action="store_true", help="write the outputs back")
    parser.add_argument("--timeout", type=int, default=300, help="seconds for one cell")
    return parser.parse_args(arguments)


def _is_chosen(path: Path, names: Sequence[str]) -> bool:
    return not names or any(path.name.startswith(Path(name).name) for name in names)


def process(path: Path, *, update: bool = False, timeout: int = 300) -> str:
    """Execute a notebook; check its outputs, or refresh them.

    Args:
        path: The notebook.
        update: Write the outputs back instead of comparing them.
        timeout: Seconds for one cell.

    Returns:
        What is wrong with it; empty if nothing is.
    """
    import nbformat

    committed = nbformat.read(path, as_version=4)
    executed, problem = execute(committed, timeout=timeout)
    if problem:
        return problem
    if not update:
        return "\n".join(differences(committed, executed))
    keep_equal_outputs(committed, executed)
    path.write_text(text_of(executed), encoding="utf-8")
    return ""


def execute(notebook: Any, *, timeout: int = 300) -> tuple[Any, str]:
    """Run all cells in a fresh kernel.

    Args:
        notebook: The notebook; it is not changed.
        timeout: Seconds for one cell.

    Returns:
        A normalised copy with the new outputs, and what went wrong.
    """
    from nbclient import NotebookClient
    from nbclient.exceptions import CellExecutionError, CellTimeoutError, DeadKernelError

    fresh = copy.deepcopy(notebook)
    for cell in fresh.cells:
        if cell.cell_type == "code":
            cell.outputs, cell.execution_count = [], None
    with tempfile.TemporaryDirectory(prefix="vaso-notebook-") as folder:
        home, work = Path(folder, "home"), Path(folder, "work")
        home.mkdir()
        work.mkdir()
        environment = _environment(home)
        os.environ["JUPYTER_RUNTIME_DIR"] = environment["JUPYTER_RUNTIME_DIR"]
        client = NotebookClient(fresh, km=_kernel(home), timeout=timeout)
        log = home / "kernel.log"
        try:
            with log.open("w", encoding="utf-8") as file:
                client.execute(env=environment, cwd=str(work), stdout=file, stderr=file)
        except (CellExecutionError, CellTimeoutError) as error:
            return fresh, COLOURS.sub("", str(error))
        except DeadKernelError as error:
            return fresh, f"{error}\n{log.read_text(encoding='utf-8', errors='replace')[-2000:]}"
    normalise(fresh)
    return fresh, "\n".join(complaints(fresh))


def _kernel(home: Path) -> Any:
    """A manager for kernels of this very Python."""
    from jupyter_client.kernelspec import KernelSpecManager
    from jupyter_client.manager import AsyncKernelManager

    spec = home / "kernels" / "python3"
    spec.mkdir(parents=True)
    argv = [sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"]
    content = {"argv": argv, "display_name": "Python 3", "language": "python"}
    (spec / "kernel.json").write_text(json.dumps(content), encoding="utf-8")
    specs = KernelSpecManager(kernel_dirs=[str(spec.parent)], ensure_native_kernel=False)
    return AsyncKernelManager(
        kernel_name="python3",
        kernel_spec_manager=specs,
        transport="ipc",
        ip=str(home / "ipc"),
    )


def _environment(home: Path) -> dict[str, str]:
    """The caller's environment without its keys, its home and its network."""
    kept = {name: value for name, value in os.environ.items() if not SECRET.search(name)}
    folders = {
        name: str(home / name.lower())
        for name in ("IPYTHONDIR", "JUPYTER_RUNTIME_DIR", "JUPYTER_CONFIG_DIR", "MPLCONFIGDIR")
    }
    for folder in folders.values():
        Path(folder).mkdir()
    proxies = dict.fromkeys(("http_proxy", "https_proxy", "HTTP_PROXY", "HTTPS_PROXY"), NOWHERE)
    fixed = {
        "HOME": str(home),
        "XDG_CACHE_HOME": str(home / "cache"),
        "no_proxy": "localhost,127.0.0.1",
        "COLUMNS": "100",
        "PYTHONHASHSEED": "0",
        "TZ": "UTC",
    }
    return {**kept, **folders, **proxies, **fixed}


# -- the form in which notebooks are committed -----------------------------------------------------


def normalise(notebook: Any) -> None:
    """Drop what differs from run to run or from machine to machine without meaning anything."""
    import nbformat

    notebook.metadata = nbformat.from_dict(METADATA)
    notebook.nbformat, notebook.nbformat_minor = 4, 5
    for number, cell in enumerate(notebook.cells, start=1):
        cell.id = f"cell-{number:02}"
        tags = cell.metadata.get("tags")
        cell.metadata = nbformat.from_dict({"tags": tags} if tags else {})
        if cell.cell_type == "code":
            cell.outputs = list(_merged(cell.outputs))


def _merged(outputs: list[Any]) -> Iterator[Any]:
    """Printed text in one piece, however the kernel happened to cut it."""
    pending: Any = None
    for output in outputs:
        if "metadata" in output:
            output.metadata = {}
        if output.output_type != "stream":
            yield from [pending] if pending else []
            pending = None
            yield output
        elif pending is not None and pending.name == output.name:
            pending.text += output.text
        else:
            yield from [pending] if pending else []
            pending = output
    yield from [pending] if pending else []


def text_of(notebook: Any) -> str:
    """The notebook as it is written to its file."""
    import nbformat

    return nbformat.writes(notebook, indent=1, ensure_ascii=False, sort_keys=True) + "\n"


def complaints(notebook: Any) -> Iterator[str]:
    """What nobody wants to read in a notebook."""
    for number, cell in enumerate(notebook.cells, start=1):
        for output in cell.get("outputs", []):
            if output.get("name") == "stderr":
                yield f"cell {number} writes to stderr:\n{output.text}"


# -- comparing -------------------------------------------------------------------------------------


def differences(committed: Any, executed: Any) -> Iterator[str]:
    """The cells whose output is not what was committed.

    Args:
        committed: The notebook as it is in its file.
        executed: The same one, executed.
    """
    pairs = zip(committed.cells, executed.cells, strict=True)
    for number, (old, new) in enumerate(pairs, start=1):
        if not _is_equal(old, new):
            lines = difflib.unified_diff(
                _shown(old), _shown(new), "committed", "now", lineterm="", n=1
            )
            yield f"cell {number}: the committed output is not what the code gives now"
            yield "\n".join(line[:200] for line in list(lines)[:DIFF_LINES])
            yield "to refresh it: .venv/bin/python scripts/notebooks.py --update"


def _is_equal(old: Any, new: Any, *, to_the_pixel: bool = False) -> bool:
    if VARIES in new.metadata.get("tags", []):
        return bool(old.get("outputs")) == bool(new.get("outputs"))
    return _shown(old, to_the_pixel) == _shown(new, to_the_pixel)


def _shown(cell: Any, to_the_pixel: bool = False) -> list[str]:
    """The outputs of a cell as lines of text, with durations left out.

    Of pages and drawings it is what they say; how they look counts only ``to_the_pixel``.
    """
    lines: list[str] = []
    for output in cell.get("outputs", []):
        if output.output_type == "stream":
            lines += [f"[{output.name}]", *_lines(output.text)]
            continue
        data = output.get("data", {})
        lines += [f"[{', '.join(sorted(data))}]"]
        for kind in (k for k in COMPARED if k in data):
            drawn = kind in ("text/html", "image/svg+xml") and not to_the_pixel
            lines += _lines(_words(data[kind]) if drawn else data[kind])
    return lines


def _words(markup: str) -> str:
    return "\n".join(TAGS.sub("\n", STYLES.sub("", markup)).split())


def _lines(text: str) -> list[str]:
    return DURATION.sub("… s", text).splitlines()


def keep_equal_outputs(committed: Any, executed: Any) -> None:
    """Leave outputs that say the same as they are, so that a diff shows what has changed."""
    for old, new in zip(committed.cells, executed.cells, strict=True):
        if new.cell_type == "code" and _is_equal(old, new, to_the_pixel=True):
            new.outputs = old.get("outputs", [])


if __name__ == "__main__":
    sys.exit(main())
