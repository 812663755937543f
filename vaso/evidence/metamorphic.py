"""Metamorphic tests: changes of a plan that must not change what it does.

There is no need to know the right verdict: the plan before and after such a change must have the
same one. The check is stronger, since the automata must do the same in every state.
"""

from __future__ import annotations

import ast
import builtins
import re
import textwrap
from collections.abc import Callable, Iterator
from random import Random

from vaso.errors import VasoError
from vaso.evidence.equivalence import same_behaviour
from vaso.plan.explore import Budget, compile_plan
from vaso.plan.transition_system import TransitionSystem
from vaso.skill import Skill

Relation = Callable[[str], str | None]
"""From a plan to one that does the same; None where it does not apply."""


def violated_relations(
    plan: str,
    skill: Skill,
    system: TransitionSystem,
    random: Random,
    *,
    most: int | None = None,
    budget: Budget | None = None,
) -> Iterator[str]:
    """Change a plan in ways that must not matter, and compare the automata.

    Args:
        plan: The plan.
        skill: Supplies the labelling code.
        system: The plan's automaton, explored to the end.
        random: Chooses the relations to try.
        most: At most so many; all by default.
        budget: Bounds of the exploration. A changed plan that exceeds them is not compared.

    Returns:
        What is wrong: the relation's name, and how the plans differ.
    """
    applicable = [(n, c) for n, r in RELATIONS.items() if (c := r(plan)) is not None and c != plan]
    chosen = applicable if most is None else random.sample(applicable, min(most, len(applicable)))
    for name, changed in chosen:
        try:
            other = compile_plan(changed, skill, budget=budget)
        except VasoError as error:
            yield f"{name}: {error}"
            continue
        if other.cut is None and not same_behaviour(system, other):
            yield f"{name}: the changed plan behaves differently\n{changed}"


# --- text --------------------------------------------------------------------------------------


def _comments(plan: str) -> str | None:
    if '"""' in plan or "'''" in plan or "\\\n" in plan:
        return None
    return "# a remark\n\n" + "\n".join(f"{line}  # {i}" for i, line in enumerate(plan.split("\n")))


def _windows_lines(plan: str) -> str:
    return plan.replace("\n", "\r\n")


def _tabs(plan: str) -> str | None:
    lines = [re.match(r" *", line) for line in plan.split("\n")]
    widths = [len(m[0]) for m in lines if m]
    if '"""' in plan or any(w % 4 for w in widths):
        return None
    return "\n".join(
        "\t" * (w // 4) + line[w:] for w, line in zip(widths, plan.split("\n"), strict=True)
    )


def _reprinted(plan: str) -> str:
    return ast.unparse(ast.parse(plan))


# --- statements --------------------------------------------------------------------------------


def _transformed(change: Callable[[ast.AST], ast.AST | list[ast.stmt] | None]) -> Relation:
    """A relation that rewrites every node for which ``change`` returns something."""

    class Rewriter(ast.NodeTransformer):
        changed = False

        def visit(self, node: ast.AST) -> ast.AST | list[ast.stmt]:
            self.generic_visit(node)
            new = change(node)
            self.changed = self.changed or new is not None
            return node if new is None else new

    def apply(plan: str) -> str | None:
        rewriter = Rewriter()
        tree = rewriter.visit(ast.parse(plan))
        assert isinstance(tree, ast.AST)
        return ast.unparse(ast.fix_missing_locations(tree)) if rewriter.changed else None

    return apply


def _parsed(text: str) -> list[ast.stmt]:
    return ast.parse(text).body


def _prints(node: ast.AST) -> list[ast.stmt] | None:
    if isinstance(node, ast.Expr) and isinstance(node.value, ast.Call):
        return [*_parsed("print('now', f'{1 + 1:>4}')"), node]
    return None


def _dead_branches(node: ast.AST) -> list[ast.stmt] | None:
    if isinstance(node, ast.Expr) and isinstance(node.value, ast.Call):
        return [ast.If(ast.Constant(False), _parsed(ast.unparse(node)), []), node]
    return None


def _wrapped_in_if(node: ast.AST) -> ast.stmt | None:
    if isinstance(node, ast.Expr) and isinstance(node.value, ast.Call):
        return ast.If(ast.Constant(True), [node], [])
    return None


def _wrapped_in_try(node: ast.AST) -> ast.stmt | None:
    if isinstance(node, (ast.Expr, ast.Assign)):
        return ast.Try([node], [], [], [ast.Pass()])
    return None


def _other_truth(node: ast.AST) -> ast.AST | None:
    if isinstance(node, ast.While) and isinstance(node.test, ast.Constant) and node.test.value:
        node.test = ast.Constant(1 if node.test.value is True else True)
        return node
    return None


def _swapped_branches(node: ast.AST) -> ast.AST | None:
    if not isinstance(node, ast.If) or not node.orelse:
        return None
    negated = ast.UnaryOp(ast.Not(), node.test)
    return ast.If(negated, node.orelse, node.body)


def _split_sleeps(node: ast.AST) -> list[ast.stmt] | None:
    if not isinstance(node, ast.Expr) or not isinstance(node.value, ast.Call):
        return None
    function, given = node.value.func, node.value.args
    if ast.unparse(function) != "time.sleep" or not isinstance(given[0], ast.Constant):
        return None
    seconds = float(str(given[0].value))
    periods = -(-round(seconds * 1000) // 100)  # of 0.1 s
    return _parsed("time.sleep(0.1)\n" * periods or "pass")


def _unrolled(node: ast.AST) -> list[ast.stmt] | None:
    """The first turn of a loop before the loop."""
    if not isinstance(node, ast.While) or node.orelse or _leaves(node.body):
        return None
    if any(isinstance(n, (ast.NamedExpr, ast.Call)) for n in ast.walk(node.test)):
        return None  # the test is evaluated once more, so it must have no effect
    first = [ast.parse(ast.unparse(s)).body[0] for s in node.body]
    return [ast.If(node.test, first, []), node]


def _leaves(body: list[ast.stmt]) -> bool:
    """True for a body with a ``break`` or ``continue`` (of whatever loop)."""
    return any(isinstance(n, (ast.Break, ast.Continue)) for s in body for n in ast.walk(s))


def _as_while(node: ast.AST) -> list[ast.stmt] | None:
    """``for i in range(n)`` as a while loop."""
    if not isinstance(node, ast.For) or node.orelse or not isinstance(node.target, ast.Name):
        return None
    if not re.fullmatch(r"range\(\d+\)", ast.unparse(node.iter)):
        return None
    counter = f"turn_of_{node.target.id}"
    head = _parsed(f"{counter} = 0\nwhile {counter} < {ast.unparse(node.iter)[6:-1]}:\n    pass")
    loop = head[1]
    assert isinstance(loop, ast.While)
    loop.body = [*_parsed(f"{node.target.id} = {counter}\n{counter} = {counter} + 1"), *node.body]
    return head


def _spelled_out(node: ast.AST) -> ast.stmt | None:
    """``x += 1`` as ``x = x + 1``."""
    if not isinstance(node, ast.AugAssign) or not isinstance(node.target, ast.Name):
        return None
    if not isinstance(node.value, ast.Constant):
        return None  # lists are changed in place
    value = ast.BinOp(ast.Name(node.target.id, ast.Load()), node.op, node.value)
    return ast.Assign([node.target], value)


# --- whole plans -------------------------------------------------------------------------------


def _in_a_function(plan: str) -> str | None:
    tree = ast.parse(plan)
    scoped = (ast.Global, ast.Nonlocal, ast.ClassDef, ast.ImportFrom)
    if any(isinstance(n, scoped) for n in ast.walk(tree)) or _sets_constant(tree):
        return None
    if '"""' in plan or not _acts_at_top(tree):
        return None
    return f'def main():\n    """Do it."""\n{textwrap.indent(plan, "    ")}\n\nmain()\n'


def _sets_constant(tree: ast.Module) -> bool:
    """True for a plan that sets something of the labelling code, or a trajectory."""
    names = {n.id for n in ast.walk(tree) if isinstance(n, ast.Name)}
    return bool(names & {"TARGET", "MAX_SPEED", "CURRENT_SPEED", "vel_traj"})


def _acts_at_top(tree: ast.Module) -> bool:
    return not all(isinstance(n, (ast.FunctionDef, ast.Import)) for n in tree.body)


def _renamed(plan: str) -> str | None:
    """Every variable and function of the plan's own under another name."""
    tree = ast.parse(plan)
    if any(isinstance(n, ast.Global) for n in ast.walk(tree)) or _sets_constant(tree):
        return None
    own = {n.id for n in ast.walk(tree) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
    own |= {n.name for n in ast.walk(tree) if isinstance(n, ast.FunctionDef)} - _methods(tree)
    own -= {a.arg for n in ast.walk(tree) for a in _arguments(n)} | set(dir(builtins))
    for node in ast.walk(tree):
        if isinstance(node, ast.Name) and node.id in own:
            node.id = f"{node.id}_q"
        elif isinstance(node, ast.FunctionDef) and node.name in own:
            node.name = f"{node.name}_q"
        elif isinstance(node, ast.Nonlocal):
            node.names = [f"{n}_q" if n in own else n for n in node.names]
        elif isinstance(node, ast.MatchAs | ast.ExceptHandler) and node.name in own:
            node.name = f"{node.name}_q"
    return ast.unparse(tree)


def _methods(tree: ast.AST) -> set[str]:
    classes = [n for n in ast.walk(tree) if isinstance(n, ast.ClassDef)]
    inside = [s for c in classes for s in ast.walk(c)]
    return {s.name for s in inside if isinstance(s, ast.FunctionDef)} | {
        n.id for n in inside if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)
    }


def _arguments(node: ast.AST) -> list[ast.arg]:
    if not isinstance(node, (ast.FunctionDef, ast.Lambda)):
        return []
    return [a for a in ast.walk(node.args) if isinstance(a, ast.arg)]


def _unread_variable(plan: str) -> str:
    return f"never_read = {{'a': [1, 2.5, None]}}\n{plan}"


RELATIONS: dict[str, Relation] = {
    "comments and blank lines": _comments,
    "lines that end in CR LF": _windows_lines,
    "tabs": _tabs,
    "reprinted by Python": _reprinted,
    "prints": _transformed(_prints),
    "branches that are never taken": _transformed(_dead_branches),
    "statements in `if True`": _transformed(_wrapped_in_if),
    "statements in `try … finally: pass`": _transformed(_wrapped_in_try),
    "`while 1` for `while True`": _transformed(_other_truth),
    "`if not` with branches swapped": _transformed(_swapped_branches),
    "sleeps of one period each": _transformed(_split_sleeps),
    "loops with the first turn before them": _transformed(_unrolled),
    "`while` for `for … in range`": _transformed(_as_while),
    "`x = x + 1` for `x += 1`": _transformed(_spelled_out),
    "all of it in a function": _in_a_function,
    "other names": _renamed,
    "a variable that nothing reads": _unread_variable,
}
"""Changes that must not matter, by name."""
