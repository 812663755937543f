"""Random small models with their explicit graph, random formulas, and an oracle for both."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise, product

from hypothesis import strategies as st

from vaso.ltl import Binary, Formula, Proposition, Unary, holds
from vaso.verifiers.engine import SMVTrace

LIGHT = """MODULE main
VAR go : boolean; n : 0..2;
ASSIGN init(n) := 0;
  next(n) := case go : (n + 1) mod 3; TRUE : n; esac;
"""

# NuSMV needs seconds to walk back through it, and shows a trace of 2,000 states.
LONG = """MODULE main
VAR n : 0..1999;
ASSIGN init(n) := 0;
  next(n) := case n < 1999 : n + 1; TRUE : n; esac;
"""

# Models that prove nothing or everything, and a word of the reason that an engine gives.
UNSOUND = [
    ("", "parsing"),
    ("MODULE main\nVAR x : boolean", "syntax error"),
    ("MODULE other", '"main" undefined'),
    ("MODULE main\nVAR x : boolean; INIT FALSE;", "no fair run"),
    ("MODULE main\nVAR x : boolean; INVAR FALSE;", "no fair run"),
    ("MODULE main\nVAR x : boolean; TRANS FALSE;", "no fair run"),
    ("MODULE main\nVAR x : boolean; JUSTICE x & !x;", "no fair run"),
    ("MODULE main\nVAR x : boolean; COMPASSION (TRUE, x & !x);", "no fair run"),
    ("MODULE main\nVAR x : boolean; TRANS x;", "without a successor"),
    ("MODULE main\nVAR x : 0..1; ASSIGN init(x) := 0; next(x) := x + 1;", "cannot assign"),
    ("MODULE main\nVAR x : 0..1; ASSIGN next(x) := 1 / x;", "Division by zero"),
    ("MODULE main\nVAR x : boolean; ASSIGN next(x) := y;", '"y" undefined'),
    ("MODULE main\nVAR x : boolean; x : boolean;", "multiple declaration"),
]

BAD_SPECS = [
    *("", "q", "G (n <= ", "n = 1 / 0", "G n", "AG go", "go) | (TRUE", "go; quit", "go -- x"),
    *('"', 'go"\nquit', "go LTLSPEC go"),
]

# Multiplication has no small BDD, in any order of the variables.
HARD = "MODULE main\nVAR p : boolean; a : unsigned word[18]; b : unsigned word[18];\n"
HARD_SPEC = "!(F (a * b = 0ud18_131071 & b * a = 0ud18_131071 & a > b))"

Node = tuple[int, bool]  # value of s, value of the free input i


@dataclass(frozen=True)
class Graph:
    """A total transition system over ``s`` and a free boolean ``i``, with labels p and q."""

    initial: tuple[int, ...]
    edges: tuple[tuple[tuple[int, ...], tuple[int, ...]], ...]  # s -> successors for i = 0 and 1
    p: tuple[bool, ...]
    q: tuple[bool, ...]

    @property
    def model(self) -> str:
        """The graph in NuSMV's language."""
        cases = "".join(
            f"    s = {s} & {'i' if i else '!i'} : {{{', '.join(map(str, successors))}}};\n"
            for s, both in enumerate(self.edges)
            for i, successors in enumerate(both)
        )
        return (
            f"MODULE main\nVAR s : 0..{len(self.edges) - 1}; i : boolean;\n"
            f"DEFINE p := {_among('s', self.p)}; q := {_among('s', self.q)} xor i;\n"
            f"INIT s in {{{', '.join(map(str, self.initial))}}};\n"
            f"ASSIGN next(s) := case\n{cases}  esac;\n"
        )

    def label(self, node: Node) -> dict[str, bool]:
        s, i = node
        return {"p": self.p[s], "q": self.q[s] != i, "i": i}

    def next(self, node: Node) -> list[Node]:
        s, i = node
        return [(t, j) for t in set(self.edges[s][i]) for j in (False, True)]

    def path(self, trace: SMVTrace) -> list[Node]:
        return [(int(step.values["s"]), step.values["i"] == "TRUE") for step in trace.steps]

    def is_violated_by(self, formula: Formula, trace: SMVTrace) -> bool:
        """Whether a trace is a run of this graph that violates the formula."""
        path = self.path(trace)
        closed = [*path, path[trace.loop_start]]
        real = path[0][0] in self.initial and all(b in self.next(a) for a, b in pairwise(closed))
        return real and not holds(formula, [self.label(n) for n in path], trace.loop_start)

    def lassos(self, length: int) -> Iterator[tuple[list[Node], int]]:
        """Every lasso of at most so many states."""
        paths: list[list[Node]] = [
            [(s, i)] for s, i in product(sorted(set(self.initial)), (False, True))
        ]
        while paths:
            path = paths.pop()
            after = self.next(path[-1])
            yield from ((path, start) for start, node in enumerate(path) if node in after)
            if len(path) < length:
                paths.extend([*path, node] for node in after)


def _among(name: str, members: tuple[bool, ...]) -> str:
    chosen = [str(k) for k, member in enumerate(members) if member]
    return f"({name} in {{{', '.join(chosen)}}})" if chosen else "FALSE"


@st.composite
def graphs(draw: st.DrawFn) -> Graph:
    size = draw(st.integers(1, 3))
    some = st.lists(st.integers(0, size - 1), min_size=1, max_size=2).map(tuple)
    labels = st.tuples(*[st.booleans()] * size)
    edges = draw(st.tuples(*[st.tuples(some, some)] * size))
    return Graph(draw(some), edges, draw(labels), draw(labels))


_PROPOSITIONS = st.sampled_from([Proposition("p"), Proposition("q"), Proposition("i")])

formulas: st.SearchStrategy[Formula] = st.recursive(
    _PROPOSITIONS,
    lambda inner: st.one_of(
        st.builds(Unary, st.sampled_from("!XGFGFYOHZ"), inner),
        st.builds(Binary, st.sampled_from(["&", "|", "->", "U", "V", "S", "<->"]), inner, inner),
    ),
    max_leaves=5,
)
