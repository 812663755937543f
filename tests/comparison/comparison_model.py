"""A scripted model for the optimizers loop and adalflow."""

from compared import GOOD
from openai_server import prompt_of

from vaso.skill_file import load_skill

LABELLING = load_skill("drive", version="initial").labelling_code
CLUMSY = "while True:\n    forward()\n"


def adalflow(text):
    return (
        "<response><reasoning>-</reasoning><method>rewrite</method>"
        f"<proposed_variable>{text}</proposed_variable></response>"
    )


class Model:
    """Answers what loop and adalflow ask; its first replies to loop are wrong."""

    def __init__(self, wrong=0):
        self.wrong = wrong

    def __call__(self, request):
        prompt = prompt_of(request)
        if "new_text" in prompt:
            self.wrong -= 1
            text = CLUMSY if self.wrong >= 0 else GOOD
            return f"[[ ## new_text ## ]]\n```python\n{text}```\n\n[[ ## completed ## ]]"
        if "<proposed_variable>" not in prompt:
            return "The loop ends; it must go on."
        return adalflow(LABELLING if "<NAME> labelling_code" in prompt else GOOD)
