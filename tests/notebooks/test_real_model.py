"""With the one line changed, the notebooks work with a model behind a real server."""

import importlib.util
import json
import re
import sys
from collections import Counter
from pathlib import Path

import nbformat
import pytest

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "tests"))

from openai_server import OpenAIServer, prompt_of  # noqa: E402

SWITCH = re.compile(r'^lm = .*?#.*(lm = "openai/[\w.-]+")', re.M)
STEPS = [
    {"skill": "find-object", "task": "find the bottle"},
    {"skill": "bypass-object", "task": "come back around the chairs"},
]


@pytest.fixture(scope="module")
def runner():
    spec = importlib.util.spec_from_file_location("notebooks", ROOT / "scripts" / "notebooks.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class Model:
    """The edit model behind a server; it also knows how to route, and how to use one tool."""

    def __init__(self):
        from vaso.modules import EditModel

        self.lm, self.asked, self.turns = EditModel(1), Counter(), 0

    def __call__(self, request):
        from dspy.lm15 import Message, Request

        prompt = prompt_of(request)
        self.asked[prompt] += 1
        if "`steps`" in prompt:
            return f"[[ ## steps ## ]]\n{json.dumps(STEPS)}\n\n[[ ## completed ## ]]"
        if "next_tool_name" in prompt:
            self.turns += 1
            name = "drive" if self.turns == 1 else "finish"
            args = json.dumps({"task": "Move forward 2 meters."} if name == "drive" else {})
            fields = {"next_thought": "go", "next_tool_name": name, "next_tool_args": args}
            return "\n\n".join(f"[[ ## {k} ## ]]\n{v}" for k, v in fields.items())
        said = [m for m in request["messages"] if m["role"] != "system"]
        system = prompt_of({"messages": [m for m in request["messages"] if m not in said]})
        messages = tuple(Message.user(prompt_of({"messages": [m]})) for m in said)
        asked = Request(model=self.lm.model, system=system or None, messages=messages)
        return self.lm(asked, rollout_id=self.asked[prompt]).message.text


@pytest.mark.slow
@pytest.mark.timeout(600)
@pytest.mark.parametrize("name", ["01", "02", "03", "04", "05"])
def test_with_the_one_line_changed(runner, monkeypatch, name):
    path = next(runner.FOLDER.glob(f"{name}_*.ipynb"))
    notebook = nbformat.read(path, as_version=4)
    changed = 0
    for cell in (c for c in notebook.cells if c.cell_type == "code"):
        cell.source, count = SWITCH.subn(r"\1", cell.source)
        changed += count
    assert changed == 1
    kept = runner._environment
    with OpenAIServer(default=Model()) as server:
        keys = {"OPENAI_API_KEY": "none", "OPENAI_API_BASE": server.url}
        monkeypatch.setattr(runner, "_environment", lambda home: kept(home) | keys)
        executed, problem = runner.execute(notebook, timeout=400)
    assert problem == ""
    assert server.requests
    assert not [o for c in executed.cells for o in c.get("outputs", []) if "ename" in o]
