"""The pages in a real browser: from the file system, without network, small and large, day and night."""

import re
from itertools import product
from pathlib import Path

import pytest
from html_check import check
from report_samples import optimization_result

import vaso
from vaso.optimizers import optimize
from vaso.report.cells import verification_cell
from vaso.report.html import optimization_html, skill_html, verification_html
from vaso.skill_file import load_skill

SIZES = [400, 1400]
SCHEMES = ["light", "dark"]


@pytest.fixture(scope="module")
def pages(tmp_path_factory) -> dict[str, Path]:
    """Pages of real runs, one that ends verified and one that does not, and of what went wrong."""
    square = load_skill("fly-in-square-shape-traj", version="initial")
    drive = load_skill("drive", version="initial")
    texts = {
        "square": optimization_html(optimize(square, ["Fly in a square."], optimizer="repair")),
        "steps": optimization_html(optimization_result(verified=False)),
        "drive": verification_html(vaso.verify(drive, drive.plan_template)),
        "skill": skill_html(drive),
    }
    folder = tmp_path_factory.mktemp("pages")
    for name, text in texts.items():
        (folder / f"{name}.html").write_text(text, encoding="utf-8")
    return {name: folder / f"{name}.html" for name in texts}


@pytest.mark.parametrize("name", ["square", "steps", "drive", "skill"])
def test_everything_can_be_read(pages, open_page, name):
    opened = open_page(pages[name])
    for width, scheme in product(SIZES, SCHEMES):
        opened.look_like(width, scheme)
        assert opened.flaws() == {}, (width, scheme)
    opened.unfold()
    for width, scheme in product(SIZES, SCHEMES):
        opened.look_like(width, scheme)
        assert opened.flaws() == {}, (width, scheme, "unfolded")
    assert opened.messages == []
    assert opened.requests == []


@pytest.mark.parametrize("width", SIZES)
def test_the_report_of_a_run_shows_all_of_it(pages, open_page, width):
    opened = open_page(pages["square"], width)
    for part in (".vaso-plot", ".chips", "table.timeline", "svg.graph", ".listing", ".tiles"):
        assert opened.is_shown(part), part


@pytest.mark.parametrize("scheme", SCHEMES)
def test_light_and_dark_differ(pages, open_page, scheme):
    page = open_page(pages["drive"], 400, scheme).page
    colour = page.evaluate("getComputedStyle(document.querySelector('.vaso')).backgroundColor")
    assert is_dark(colour) == (scheme == "dark")


def test_on_paper_everything_is_unfolded_and_light(pages, open_page):
    opened = open_page(pages["square"], 720, "dark")
    assert not opened.is_shown(".attempt")
    opened.page.emulate_media(media="print", color_scheme="dark")
    assert opened.is_shown(".attempt")
    assert set(opened.flaws()) <= {"small text"}  # what is small on a screen is not on paper
    assert len(opened.page.pdf()) > 10_000


HOST = """<!DOCTYPE html><style>
  body { background: %(back)s; color: %(ink)s } h1, code, pre, td { color: %(ink)s; background: %(back)s }
  .host code, .host pre, .host td { white-space: pre-wrap; background: red; color: red }
</style><body data-jp-theme-light="%(light)s"><h1 id=host>A heading</h1><p>A text</p>
<div class=host>%(cell)s</div>"""


@pytest.mark.parametrize("dark", [False, True])
def test_a_cell_follows_the_notebook_and_neither_spoils_the_other(tmp_path, open_page, dark):
    drive = load_skill("drive", version="initial")
    cell = verification_cell(vaso.verify(drive, drive.plan_template))
    assert "<html" not in cell and "<script" not in cell
    check(cell)
    back, ink = ("rgb(17, 17, 17)", "rgb(238, 238, 238)")[:: 1 if dark else -1]
    file = tmp_path / "notebook.html"
    light = str(not dark).lower()
    file.write_text(HOST % {"back": back, "ink": ink, "light": light, "cell": cell}, "utf-8")
    opened = open_page(file, 900, "light" if dark else "dark")  # the system says the opposite
    assert opened.flaws() == {}
    look = "e => [getComputedStyle(e).color, getComputedStyle(e).backgroundColor]"
    page = opened.page
    assert page.eval_on_selector("#host", look) == [ink, back]
    for part in ("code", "pre", "td"):
        assert "rgb(255, 0, 0)" not in page.eval_on_selector(f".vaso {part}", look)
    assert is_dark(page.eval_on_selector(".vaso", look)[1]) == dark


def is_dark(colour: str) -> bool:
    return sum(map(int, re.findall(r"\d+", colour)[:3])) < 3 * 128
