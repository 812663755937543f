"""Small optimizers and tasks for comparisons."""

from dataclasses import dataclass, field

from vaso.optimizers import Proposal
from vaso.skill_file import load_skill

DRIVE = load_skill("drive", version="initial")
GOOD = DRIVE.plan_template.replace("break", "stop()")
USELESS = "while True:\n    stop()\n"
TASKS = ["Drive straight for 3 meters and stop."]


@dataclass
class GivesUp:
    """Has nothing to propose."""

    name: str = "gives-up"
    needs_lm: bool = False
    deterministic: bool = True

    def propose(self, state):
        yield Proposal({"plan_template": USELESS}, "stops for ever")


@dataclass
class Scripted:
    """Proposes texts in order, one a step; ``boom`` is a crash, ``interrupt`` the user's Ctrl-C."""

    script: list[str]
    name: str = "scripted"
    needs_lm: bool = False
    deterministic: bool = False
    used: int = field(default=0, compare=False)

    def propose(self, state):
        text = self.script[min(self.used, len(self.script) - 1)]
        self.used += 1
        if text == "boom":
            raise RuntimeError("the optimizer broke")
        if text == "interrupt":
            raise KeyboardInterrupt
        yield Proposal({"plan_template": text}, f"the text number {self.used}")
