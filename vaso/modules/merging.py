"""One contract for several skills, so that their plans can run, and be verified, as one plan.

Skills of one robot mostly share their labelling code. Where two define the same name alike, it is
one definition; where they differ, both are kept under different names, provided that no rule speaks
of it: a rule must mean the same in every part of the plan.
"""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from vaso.errors import SkillError
from vaso.ltl import propositions, variables
from vaso.modules.symbolic import instantiate
from vaso.plan.labelling import Labelling
from vaso.plan.model import Plan
from vaso.plan.source import parse_python, prepare
from vaso.platforms import Platform, get_platform
from vaso.skill import Rule, Skill


@dataclass(frozen=True)
class Merged:
    """A skill that stands for several.

    Attributes:
        skill: All global rules and assumptions, and the merged labelling code. Local rules are left
            out: each speaks of its own skill's part.
        renamed: For each part, what functions and constants of its labelling code are called now,
            where that changed.
    """

    skill: Skill
    renamed: tuple[dict[str, str], ...]


def merge(parts: Sequence[tuple[Skill, Plan]]) -> Merged:
    """Merge the contracts of skills.

    Args:
        parts: Each skill with its plan, whose settings (``TARGET = "chair"``) become part of its
            labelling code.

    Raises:
        SkillError: The skills are for different robots, or do not agree on what a rule speaks of.
        LabellingError: Labelling code that cannot be read.
        PlanError: A plan that cannot be read.
    """
    first = parts[0][0]
    robot = get_platform(first.platform)
    for skill, _ in parts:
        if (other := get_platform(skill.platform).name) != robot.name:
            raise SkillError(
                f"'{first.name}' is for the robot {robot.name}, '{skill.name}' for {other}",
                expected="skills of one robot in one plan",
            )
    codes = [_Code.of(skill, plan, robot) for skill, plan in parts]
    merged = first.model_copy(
        update={
            "name": "+".join(dict.fromkeys(skill.name for skill, _ in parts)),
            "description": " ".join(dict.fromkeys(s.description for s, _ in parts)),
            "global_rules": _union(skill.global_rules for skill, _ in parts),
            "local_rules": (),
            "assumptions": _union(skill.assumptions for skill, _ in parts),
            "plan_template": "",
            "source": None,
            "labelling_line": 1,
        }
    )
    different = _different(codes)
    _require_agreement(different, merged, [skill for skill, _ in parts], codes)
    text, renamed = _text(codes, different)
    return Merged(merged.model_copy(update={"labelling_code": text}), renamed)


def robot_functions(robot: Platform) -> set[str]:
    """The low-level commands and sensors of a robot."""
    return {c.name for c in robot.commands} | {s.name for s in robot.sensors}


def _union(groups: Iterable[tuple[Rule, ...]]) -> tuple[Rule, ...]:
    """Rules of all groups; those that say the same are one."""
    found: dict[str, Rule] = {}
    for rule in (rule for group in groups for rule in group):
        found.setdefault(str(rule.formula), rule)
    return tuple(found.values())


# -- definitions -------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Code:
    """The labelling code of one part.

    Attributes:
        text: Its text, with the settings of the part's plan.
        statements: Its top-level statements.
        known: What each name is defined as, in a form that can be compared.
    """

    text: str
    statements: tuple[ast.stmt, ...]
    known: dict[str, str]

    @classmethod
    def of(cls, skill: Skill, plan: Plan, robot: Platform) -> _Code:
        name = skill.source or f"{skill.name}: labelling code"
        code = Labelling(skill.labelling_code, robot, name=name)
        program = prepare(
            plan.source,
            name=plan.name,
            known={*code.functions, *robot_functions(robot)},
            constants=code.constants,
            settings=code.settings,
            acting=code.acting | {c.name for c in robot.commands},
            trajectory=robot.trajectory is not None,
        )
        text = instantiate(skill.labelling_code, dict(program.rebinds))
        body = tuple(s for s in parse_python(text, name).body if not _is_remark(s))
        known: dict[str, str] = {}
        for statement in body:
            if not _defined(statement):
                raise SkillError(
                    f"the labelling code of '{skill.name}' does something when it is loaded",
                    line=statement.lineno,
                    expected="functions and constants only, where several skills make one plan",
                )
            for defined in _defined(statement):
                known[defined] = known.get(defined, "") + _meaning(statement)
        return cls(text, body, known)

    def variant(self, names: set[str]) -> tuple[tuple[str, str], ...]:
        """How this code defines some names."""
        return tuple(sorted((n, m) for n, m in self.known.items() if n in names))

    def users(self, names: set[str]) -> set[str]:
        """What is defined with the help of some names."""
        return {n for s in self.statements if names & set(_used(s)) for n in _defined(s)}


def _defined(statement: ast.stmt) -> list[str]:
    """The names that a top-level statement defines."""
    if isinstance(statement, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
        return [statement.name]
    if isinstance(statement, (ast.Import, ast.ImportFrom)):
        return [(a.asname or a.name).split(".")[0] for a in statement.names]
    stored = (n for n in ast.walk(statement) if isinstance(n, ast.Name))
    return [n.id for n in stored if isinstance(n.ctx, ast.Store)]


def _is_remark(statement: ast.stmt) -> bool:
    text = isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant)
    return text or isinstance(statement, ast.Pass)


def _used(statement: ast.stmt) -> Iterator[str]:
    """Every name in a statement but the one that it defines."""
    for node in ast.walk(statement):
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load):
            yield node.id
        elif isinstance(node, ast.Global):
            yield from node.names


def _meaning(statement: ast.stmt) -> str:
    """A statement without what does not matter: its place, docstrings, 0 or 0.0."""
    copy = ast.parse(ast.unparse(statement))
    for node in ast.walk(copy):
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)) and ast.get_docstring(node):
            node.body = node.body[1:] or [ast.Pass()]
        elif isinstance(node, ast.Constant) and type(node.value) is int:
            node.value = float(node.value)
    return ast.dump(copy)


def _different(codes: Sequence[_Code]) -> set[str]:
    """Names that mean something else in some part, by themselves or through what they use."""
    names = {name for code in codes for name in code.known}
    found = {n for n in names if len({c.known[n] for c in codes if n in c.known}) > 1}
    while more := {n for code in codes for n in code.users(found)} - found:
        found |= more
    return found


def _require_agreement(
    different: set[str], merged: Skill, skills: Sequence[Skill], codes: Sequence[_Code]
) -> None:
    """Rules must mean the same in every part."""
    rules = (*merged.global_rules, *merged.assumptions)
    spoken = {n for r in rules for n in (*propositions(r.formula), *variables(r.formula))}
    for name in sorted(different & spoken):
        owners = [s.name for s, c in zip(skills, codes, strict=True) if name in c.known]
        raise SkillError(
            f"the skills {' and '.join(dict.fromkeys(owners))} do not define '{name}' alike, "
            "and a rule speaks of it",
            expected="the same labelling code for everything that the global rules mention",
        )


# -- the merged text ---------------------------------------------------------------------------


def _text(codes: Sequence[_Code], different: set[str]) -> tuple[str, tuple[dict[str, str], ...]]:
    """The merged labelling code, and for each part what is renamed in it.

    The first part that defines a name keeps it; parts that define all of this alike share it.
    """
    pieces = [codes[0].text.strip("\n")]
    there: set[str] = set(codes[0].known)
    taken = {name for code in codes for name in code.known}
    variants: dict[tuple[tuple[str, str], ...], dict[str, str]] = {codes[0].variant(different): {}}
    for number, code in enumerate(codes[1:], start=2):
        variant = code.variant(different)
        fresh = variant not in variants
        if fresh:
            clash = [name for name, _ in variant if name in there]
            variants[variant] = {n: _free(f"{n}_{number}", taken) for n in clash}
        names = variants[variant]
        for statement in code.statements:
            defined = set(_defined(statement))
            if defined - different - there or (fresh and defined & different):
                pieces.append(_renamed(statement, code.text, names))
        there |= set(code.known)
    return "\n\n".join(pieces) + "\n", tuple(variants[c.variant(different)] for c in codes)


def _free(name: str, taken: set[str]) -> str:
    while name in taken:
        name += "_"
    taken.add(name)
    return name


def _renamed(statement: ast.stmt, text: str, names: dict[str, str]) -> str:
    """A statement's text, with other names in it."""
    if not names or not names.keys() & {*_defined(statement), *_used(statement)}:
        return ast.get_source_segment(text, statement) or ast.unparse(statement)
    local = {a.arg for a in ast.walk(statement) if isinstance(a, ast.arg)}
    if clash := sorted(local & names.keys()):
        raise SkillError(
            f"the labelling code cannot be merged: '{clash[0]}' is the name of a parameter and of "
            "something that two skills define differently",
            hint="rename the parameter",
        )
    return ast.unparse(_Rename(names).visit(statement))


class _Rename(ast.NodeTransformer):
    """Gives names of the module other names."""

    def __init__(self, names: dict[str, str]) -> None:
        self.names = names

    def visit_Name(self, node: ast.Name) -> ast.Name:
        return ast.copy_location(ast.Name(self.names.get(node.id, node.id), node.ctx), node)

    def visit_Global(self, node: ast.Global) -> ast.Global:
        return ast.copy_location(ast.Global([self.names.get(n, n) for n in node.names]), node)

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        node.name = self.names.get(node.name, node.name)
        return self.generic_visit(node)
