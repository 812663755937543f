"""What objects show in a notebook and in a terminal; one skill, so that they fit together."""

import io
import re
import subprocess
import sys

import pytest
from html_check import check
from report_samples import optimization_result
from rich.console import Console

import vaso
from vaso.gradient.model import Edit, Level, TextualGradient
from vaso.skill_file import load_skill

INFEASIBLE = "G(!obstacle_observed | people_observed -> X forward)"


@pytest.fixture(scope="module")
def shown():
    """Each kind of object with words that it must show."""
    skill = load_skill("drive", version="initial")
    result = vaso.verify(skill, skill.plan_template)
    edit = Edit(parameter="plan_template", description="line 1", before="go()", after="stop()")
    optimized = optimization_result()
    return {
        "skill": (skill, ["drive", "whenever people are observed", "while True:"]),
        "verification": (result, ["3 of 4 rules hold", "people"]),
        "counterexample": (result.failures[0].counterexample, ["stop()", "goes on for ever"]),
        "system": (result.system, ["forward()", "line 5"]),
        "feasibility": (vaso.check(skill), ["✓ FEASIBLE", "drive"]),
        "conflict": (
            vaso.check(skill.with_parameters({"local_rule": INFEASIBLE})),
            ["✗ INFEASIBLE", "The local rule conflicts with"],
        ),
        "gradient": (vaso.textual_gradient(result, skill=skill), ["violates F(", "line 6"]),
        "repair": (
            TextualGradient(
                level=Level.REPAIR, score=0.5, passed=False, verdict="bad", repair=edit
            ),
            ["bad", "verified repair", "line 1", "go()", "stop()"],
        ),
        "step": (optimized.steps[1], ["accepted", "line 3: replace break by stop()", "stop()"]),
        "in vain": (optimized.steps[0], ["line 3: nothing", "safety would fall", "F (!people"]),
        "optimization": (optimized, ["VERIFIED", "replace break by stop()"]),
    }


KINDS = [
    "skill", "verification", "counterexample", "system", "feasibility", "conflict", "gradient",
    "repair", "step", "in vain", "optimization",
]  # fmt: skip


@pytest.mark.parametrize("kind", KINDS)
def test_in_a_notebook(shown, kind):
    thing, words = shown[kind]
    html = thing._repr_html_()
    found = check(html)
    text = " ".join(found.text.split("}")[-1].split())  # after the styles
    assert not [w for w in words if w not in text]
    assert not {"html", "head", "body", "script", "link", "meta"} & set(found.tags)
    assert html.startswith("<style>") and '<div class="vaso vaso-cell">' in html


@pytest.mark.parametrize("kind", KINDS)
def test_in_a_terminal(shown, kind):
    thing, words = shown[kind]
    console = Console(file=io.StringIO(), width=100)
    console.print(thing)
    printed = console.file.getvalue()
    assert "\x1b" not in printed
    text = " ".join(re.sub(r"│", " ", printed).split())
    assert not [w for w in words if w not in text]


def test_a_passing_gradient():
    gradient = TextualGradient(level=Level.BLAME, score=1.0, passed=True, verdict="")
    assert "pass all specifications" in check(gradient._repr_html_()).text


def test_nothing_that_shows_things_is_imported_before_it_is_needed():
    code = (
        "import sys, vaso; vaso.load_skill, vaso.verify, vaso.check, vaso.Skill;"
        "vaso.load_skill('drive');"
        "print(*[m for m in sys.modules if m.startswith(('vaso.report', 'rich', 'dspy'))])"
    )
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.split() == []
