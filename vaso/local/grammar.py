"""Grammars of what a language model may write for a skill: plans and local rules.

A plan grammar holds the skill's own calls, the settings and functions of its plan template, and
little else. Every text that follows it is a plan that compiles: names are defined, calls have the
arguments they need, values have the kinds that they are used as, blocks are indented and end.
"""

from __future__ import annotations

from vaso.local import gbnf
from vaso.local.program import write_program
from vaso.local.scope import BASICS
from vaso.local.setpoints import write_setpoints
from vaso.local.template import read_template
from vaso.local.vocabulary import vocabulary
from vaso.ltl import propositions, variables
from vaso.platforms import get_platform
from vaso.skill import Skill

RULES = 4


def plan_grammar(skill: Skill) -> str:
    """The grammar of a skill's plans, in GBNF.

    Args:
        skill: Its labelling code gives the calls; its plan template the settings and functions. A
            template that cannot be understood gives none.

    Raises:
        LabellingError: The labelling code is not Python.
        PlatformError: There is no such platform.
    """
    words = vocabulary(skill)
    template = read_template(skill.plan_template, words)
    rules = gbnf.Rules()
    if not write_setpoints(rules, words, template, get_platform(skill.platform)):
        write_program(rules, words, template)
    return str(rules)


def rule_grammar(skill: Skill) -> str:
    """The grammar of a skill's local rules, in GBNF: one formula of temporal logic a line.

    The formulas are of the shapes that people write: always and never, in the end, whenever this
    then that in the next step, at some time, or for ever. The skill's present rules are among them.

    Args:
        skill: Its propositions may be used.
    """
    formulas = [r.formula for r in (*skill.rules, *skill.assumptions)]
    standard = get_platform(skill.platform).propositions
    flags = {n for f in formulas for n in propositions(f)}
    flags |= {p.name for p in standard if p.kind == "action"}
    numbers = {n for f in formulas for n in variables(f)}
    rules = gbnf.Rules()
    rules.add("number", BASICS["number"])
    rules.add("relation", '" < " | " <= " | " > " | " >= " | " == "')
    literals = [gbnf.seq(gbnf.maybe(gbnf.text("!")), gbnf.texts(sorted(flags)))] if flags else []
    literals += [gbnf.seq(gbnf.texts(sorted(numbers)), "relation", "number")] if numbers else []
    rules.add("fact", gbnf.alt(literals or ['"TRUE"']))
    rules.add("facts", '"(" fact ((" & " fact){1,2} | (" | " fact){1,2}) ")" | fact')
    rules.add("later", '("X " | "F " | "G " | "X G " | "X F ")? facts')
    shapes = [
        '"G(" facts " -> " later ")"',
        '"F(" facts ") -> F(" facts ")"',
        '("G" | "F" | "G F") "(" facts ")"',
        '"F(" facts " & F(" facts "))"',
    ]
    own = sorted({r.text for r in skill.local_rules if "\n" not in r.text})
    rules.add("rule", gbnf.alt([*shapes, *map(gbnf.text, own)]))
    more = gbnf.repeat(gbnf.seq(gbnf.text("\n"), "rule"), 0, max(RULES, len(own)) - 1)
    rules.add("root", gbnf.seq("rule", more))
    return str(rules)
