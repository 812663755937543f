"""The committed notebooks are whole, clean and executed; the runner finds what is wrong with one.

That all of them still give their committed outputs is `make notebooks`, which runs them all.
"""

import ast
import importlib.util
import re
from pathlib import Path

import nbformat
import pytest
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook, new_output

ROOT = Path(__file__).parents[2]
FOLDER = ROOT / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))
QUICKEST = FOLDER / "01_quickstart.ipynb"

MACHINE = re.compile(r"/root|/home/|/Users/|/tmp/|/work/|[A-Z]:\\\\|site-packages|0x[0-9a-f]{8,}")
SWITCH = re.compile(r'^lm = .*#.*lm = "openai/[\w.-]+"', re.M)
LINK = re.compile(r"\]\(([^)#]+)\)")
PICTURES = {"image/svg+xml", "image/png"}


@pytest.fixture(scope="module")
def runner():
    spec = importlib.util.spec_from_file_location("notebooks", ROOT / "scripts" / "notebooks.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(params=NOTEBOOKS, ids=lambda path: path.stem)
def notebook(request):
    return nbformat.read(request.param, as_version=4)


def code(notebook):
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


def outputs(notebook):
    return [output for cell in code(notebook) for output in cell.outputs]


def test_all_six_are_there():
    assert [p.stem[:2] for p in NOTEBOOKS] == ["01", "02", "03", "04", "05", "06"]


def test_valid(notebook):
    nbformat.validate(notebook)
    assert notebook.cells[0].cell_type == "markdown"
    assert notebook.cells[0].source.startswith("# ")


def test_executed_in_order_and_without_errors(notebook):
    counts = [cell.execution_count for cell in code(notebook)]
    assert counts == list(range(1, len(counts) + 1))
    assert not [o for o in outputs(notebook) if o.output_type == "error"]
    assert not [o for o in outputs(notebook) if o.get("name") == "stderr"]


def test_pictures_are_committed(notebook):
    shown = [set(o.get("data", {})) & PICTURES for o in outputs(notebook)]
    assert any(shown)


def test_written_for_any_machine(runner, notebook):
    assert notebook.metadata == runner.METADATA
    for output in outputs(notebook):
        output.get("data", {}).pop("image/png", None)  # its letters mean nothing
    assert not MACHINE.search(nbformat.writes(notebook))


def test_one_line_switches_to_a_real_model(notebook):
    cells = [cell.source for cell in code(notebook) if SWITCH.search(cell.source)]
    assert len(cells) == 1
    switched = SWITCH.sub('lm = "openai/gpt-4o-mini"', cells[0])
    assert ast.parse(switched)
    used = [c for c in code(notebook) if re.search(r"\blm\b", c.source) and c.source != cells[0]]
    assert used, "the model is named and then not used"


def test_cells_are_short(notebook):
    long = [c.source for c in code(notebook) if len(c.source.splitlines()) > 20]
    assert all(source.startswith("%%writefile") for source in long)


def test_links_lead_somewhere(notebook):
    texts = [cell.source for cell in notebook.cells if cell.cell_type == "markdown"]
    for target in (t for text in texts for t in LINK.findall(text)):
        assert target.startswith("https://") or (FOLDER / target).is_file(), target


# -- the runner ------------------------------------------------------------------------------------


def one_cell(source, printed, *, stream="stdout", tags=()):
    cell = new_code_cell(source, metadata={"tags": list(tags)} if tags else {})
    cell.outputs = [new_output("stream", name=stream, text=printed)] if printed else []
    return new_notebook(cells=[new_markdown_cell("# Title"), cell])


@pytest.fixture
def write(tmp_path):
    def written(source, printed=""):
        path = tmp_path / "one.ipynb"
        nbformat.write(one_cell(source, printed), path)
        return path

    return written


SHIELDED = """
import os
from pathlib import Path

print(os.environ.get("OPENAI_API_KEY"), os.environ.get("VASO_LM"))
print(list(Path.cwd().iterdir()), Path.home() == Path(os.environ["HOME"]))
Path("left_behind.txt").touch()
"""


def test_the_quickest_notebook_gives_what_is_committed(runner):
    assert runner.process(QUICKEST) == ""


def test_a_kernel_without_keys_in_an_empty_folder(runner, write, monkeypatch):
    monkeypatch.setenv("OPENAI_API_KEY", "secret")
    monkeypatch.setenv("VASO_LM", "openai/x")
    before = set(ROOT.iterdir())
    path = write(SHIELDED)
    assert "+None None" in runner.process(path)
    assert runner.process(path, update=True) == ""
    assert code(nbformat.read(path, as_version=4))[0].outputs[0].text == "None None\n[] True\n"
    assert set(ROOT.iterdir()) == before


def test_an_error_and_noise(runner, write):
    problem = runner.process(write("1 / 0"))
    assert "ZeroDivisionError" in problem
    noisy = one_cell("", "careful\n", stream="stderr")
    assert "careful" in "".join(runner.complaints(noisy))
    assert not list(runner.complaints(one_cell("", "fine\n")))


@pytest.mark.slow
def test_a_cell_that_never_ends(runner, write):
    assert "timed out" in runner.process(write("while True: pass"), timeout=2).lower()


def differ(runner, old, new, **options):
    return "\n".join(runner.differences(one_cell("", old), one_cell("", new, **options)))


def test_a_stale_output(runner):
    found = differ(runner, "1\n", "2\n")
    assert "cell 2" in found and "-1" in found and "+2" in found
    assert differ(runner, "1\n", "1\n") == ""


def test_times_do_not_make_an_output_stale(runner):
    assert differ(runner, "done in 71 ms", "done in 3.2 s") == ""
    assert differ(runner, "done in 71 m", "done in 3.2 m") != ""


def test_a_cell_that_varies(runner):
    assert differ(runner, "0.5", "0.7") != ""
    assert differ(runner, "0.5", "0.7", tags=[runner.VARIES]) == ""
    assert differ(runner, "", "0.7", tags=[runner.VARIES]) != ""


def drawn(text, x):
    cell = new_code_cell("")
    svg = f'<svg><style>a</style><text x="{x}">{text}</text></svg>'
    cell.outputs = [new_output("display_data", data={"image/svg+xml": svg})]
    return new_notebook(cells=[new_markdown_cell("# Title"), cell])


def test_a_drawing_is_stale_when_it_says_something_else(runner):
    old = drawn("stop()", 1)
    assert not list(runner.differences(old, drawn("stop()", 2)))
    assert list(runner.differences(old, drawn("forward()", 1)))
    moved = drawn("stop()", 2)
    runner.keep_equal_outputs(old, moved)
    assert 'x="2"' in moved.cells[1].outputs[0].data["image/svg+xml"]


def test_an_update_leaves_what_says_the_same(runner):
    old, new = one_cell("", "done in 71 ms"), one_cell("", "done in 3.2 s")
    runner.keep_equal_outputs(old, new)
    assert new.cells[1].outputs[0].text == "done in 71 ms"
    newer = one_cell("", "not done in 3.2 s")
    runner.keep_equal_outputs(old, newer)
    assert newer.cells[1].outputs[0].text == "not done in 3.2 s"


def test_normal_form(runner):
    notebook = one_cell("", "a")
    notebook.cells[1].outputs.append(new_output("stream", name="stdout", text="b"))
    notebook.cells[1].metadata["execution"] = {"iopub.status.busy": "2026-01-01"}
    notebook.metadata["kernelspec"] = {"name": "mine", "display_name": "Mine"}
    runner.normalise(notebook)
    nbformat.validate(notebook)
    assert notebook.metadata == runner.METADATA and notebook.cells[1].metadata == {}
    assert [o.text for o in notebook.cells[1].outputs] == ["ab"]


def test_names_and_exit_codes(runner, monkeypatch, capsys):
    problems = {QUICKEST.name: ""}
    monkeypatch.setattr(runner, "process", lambda path, **_: problems.get(path.name, "broken"))
    assert runner.main(["01"]) == 0 and runner.main(["notebooks/01_quickstart.ipynb"]) == 0
    assert runner.main(["99"]) == 2
    assert runner.main([]) == 1
    shown = capsys.readouterr().out
    assert "FAILED" in shown and "broken" in shown
