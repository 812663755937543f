"""What random plans are made of: Python as language models write it, one feature at a time.

Every variable stays bounded, and nothing depends on hash order or identity, so that a plan has few
states and CPython behaves the same in every run.
"""

from __future__ import annotations

from dataclasses import dataclass

HEAD = """n, x, seen, done, mode = 0, 0.0, False, False, 'go'
log, memory = [], {}
legs = [(2, 'left'), (1, 'right')]"""
"""The variables of every plan."""

ACTIONS = (
    "forward()", "backward()", "stop()", "turn_left()", "turn_right()",
    "set_velocity(0.2, 0.1)", "set_velocity(linear=0.0, angular=-0.5)",
    "velocity_publisher(linear=0.3)", "velocity_publisher(0.0, 0.0)",
    "forward() if n % 2 == 0 else stop()",
    "stop() if people_observed() else forward()",
)  # fmt: skip

SENSES = (
    "people_observed()", "obstacle_observed()", "target_observed()", "yolo_listener('door')",
    "yolo_listener(object_name='door')",
)  # fmt: skip

TESTS = (
    "people_observed() and not obstacle_observed()", "people_observed() or obstacle_observed()",
    "not people_observed()", "any([people_observed(), target_observed()])",
    "all(not w for w in (people_observed(), seen))", "n < 2", "0 < n <= 2", "seen", "not done",
    "mode == 'go'", "mode in ('turn', 'wait')", "len(log) % 2 == 0", "log and log[-1]",
    "memory.get('last', False)", "'last' in memory and memory['last']", "x < 0.25",
    "math.isclose(x, 0.3)", "(k := n + 1) > 2", "sum(log) > 1", "isinstance(n, int)",
    "f'{n}' == '1'", "mode.startswith('t')", "max(log, default=0) == 1", "True", "n",
)  # fmt: skip

STATEMENTS = (
    "n += 1", "n = (n + 1) % 3", "n = min(n + 1, 3)", "n = 0", "n -= n > 0",
    "x = x + 0.1 if x < 0.4 else 0.0", "x = (x + 0.1) % 0.5", "x = 0.3",
    "x = round(x + 0.15, 1) % 0.5",
    "seen = people_observed()", "seen = seen or obstacle_observed()", "seen, done = done, seen",
    "done = n > 1 or target_observed()", "done = not done", "mode = 'turn'", "mode = 'wait'",
    "mode = {'go': 'turn', 'turn': 'wait'}.get(mode, 'go')", "log.append(n)", "log = log[-2:]",
    "log = [v for v in log if v != 1]", "log = sorted(log, reverse=True)[:2]", "log.clear()",
    "memory['last'] = people_observed()", "memory = {**memory, 'n': n}",
    "memory.update(last=False)", "memory.pop('last', None)", "time.sleep(0.1)",
    "time.sleep(0.25)", "time.sleep(0)", "print('n is', n)", "print(f'{n=} {x:.1f} {mode!r:>6}')",
    "pass", "'a line of text'", "first, *rest = [n, 1, 2]", "(a, b), c = (n, 1), 2",
    "n = a if (a := n) < 3 else 0", "n: int = 0",
    "log += [int(people_observed())]", "n = len({1, 2, n})", "n = int('2')",
    "seen = bool(n) and not seen", "x = max(0.0, x - 0.1)",
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Feature:
    """Definitions, and what they allow a plan to say.

    Attributes:
        name: For messages.
        definition: Statements of the module.
        statements: What may be written where it is defined.
        tests: Conditions.
    """

    name: str
    definition: str
    statements: tuple[str, ...] = ()
    tests: tuple[str, ...] = ()


FEATURES = (
    Feature(
        "closure",
        """def make_counter(limit=3):
    total = 0
    def count():
        nonlocal total
        total = min(total + 1, limit)
        return total
    return count
count = make_counter()
other = make_counter(limit=1)""",
        ("count()", "n = other()", "log = [count()]"),
        ("count() > 2", "other() == count()"),
    ),
    Feature(
        "defaults",
        """def act(times=1, *, quiet=False, word='go'):
    for i in range(times):
        if people_observed():
            stop()
            return word
        if not quiet:
            forward()
    return None""",
        ("act()", "act(2)", "seen = act(quiet=True) is None", "act(1, word='stay')"),
        ("act(times=0) is None",),
    ),
    Feature(
        "star arguments",
        """def repeat(action, *args, **options):
    for _ in range(options.get('times', 1)):
        action(*args)""",
        ("repeat(forward)", "repeat(stop, times=2)", "repeat(set_velocity, 0.1, 0.2)"),
    ),
    Feature(
        "class",
        """class Robot:
    LIMIT = 2
    def __init__(self, n=0):
        self.n = n
        self.path = []
    def go(self):
        if self.n % 2:
            turn_right()
        else:
            forward()
    def tick(self):
        self.n = (self.n + 1) % 3
        return self
    def busy(self):
        return self.n > 0 and not people_observed()
robot = Robot()""",
        ("robot.go()", "robot.tick()", "robot.tick().go()", "robot.n = 0", "Robot(1).go()",
         "robot.path = [robot.n]"),
        ("robot.busy()", "robot.n < Robot.LIMIT", "robot.path == [1]"),
    ),
    Feature(
        "global",
        """seen_before = 0
def note():
    global seen_before
    if people_observed():
        seen_before = min(seen_before + 1, 2)
    return seen_before""",
        ("note()", "n = note()"),
        ("note() > 1", "seen_before == 1"),
    ),
    Feature(
        "dispatch",
        """ACTIONS = {'go': forward, 'turn': turn_left, 'wait': stop}
steps = [forward, stop, lambda: turn_right()]""",
        ("ACTIONS[mode]()", "ACTIONS.get(mode, stop)()", "steps[n % 3]()", "steps[-1]()"),
    ),
    Feature(
        "recursion",
        """def march(k):
    if k == 0 or people_observed():
        return k
    forward()
    return march(k - 1)""",
        ("march(2)", "n = march(3)"),
        ("march(1) == 0",),
    ),
    Feature(
        "decorator",
        """def careful(function):
    def inner(*args):
        if obstacle_observed():
            stop()
            return False
        function(*args)
        return True
    return inner
@careful
def ahead():
    forward()""",
        ("ahead()", "seen = ahead()", "careful(turn_left)()"),
        ("ahead()",),
    ),
    Feature(
        "waypoints",
        """waypoints = [{'turn': 'left', 'steps': 1}, {'turn': 'right', 'steps': 2}]
def visit(point):
    for _ in range(point['steps']):
        forward()
    turn_left() if point['turn'] == 'left' else turn_right()""",
        ("visit(waypoints[n % 2])", "visit({'turn': 'left', 'steps': 0})"),
        ("waypoints[n % 2]['turn'] == 'left'",),
    ),
    Feature(
        "errors",
        """def risky(k):
    try:
        return 1 / (k - 1)
    except ZeroDivisionError as error:
        stop()
        return str(error) == 'division by zero'
    finally:
        memory['n'] = min(k, 2)""",
        ("risky(n)", "risky(1)", "assert n < 5, 'too many'"),
        ("risky(2) == 1",),
    ),
    Feature(
        "matching",
        """def by_mode(m):
    match m:
        case 'go':
            forward()
        case 'turn' | 'wait' if people_observed():
            stop()
        case _:
            turn_left()""",
        ("by_mode(mode)", "by_mode('wait')"),
    ),
    Feature(
        "state machine",
        """from enum import Enum
class State(Enum):
    DRIVE = 1
    HALT = 2
machine = {'state': State.DRIVE}
def advance(s):
    if s == State.DRIVE:
        forward()
        return State.HALT if people_observed() else State.DRIVE
    stop()
    return State.DRIVE""",
        ("machine['state'] = advance(machine['state'])", "advance(State.HALT)"),
        ("machine['state'] is State.DRIVE", "machine['state'] != State.HALT",
         "machine['state'].name == 'HALT'",),
    ),
    Feature(
        "own exception",
        """class Blocked(Exception):
    pass
def step():
    if obstacle_observed():
        raise Blocked('in the way')
    forward()
def careful_step():
    try:
        step()
    except Blocked:
        stop()
        return False
    return True""",
        ("careful_step()", "seen = careful_step()"),
        ("careful_step()",),
    ),
    Feature(
        "dataclass",
        """from dataclasses import dataclass
@dataclass
class Leg:
    steps: int
    left: bool = True""",
        ("leg = Leg(2)", "leg = Leg(n, left=False); n = leg.steps"),
        ("Leg(1).left", "Leg(steps=n).steps == 1", "Leg(n) == Leg(1)"),
    ),
    Feature(
        "clock",
        """start = time.time()
def elapsed():
    return time.time() - start
def late(limit=0.35):
    return time.monotonic() - start > limit""",
        ("x = min(int(elapsed() * 4), 2) / 4", "now = time.time()"),
        ("elapsed() < 0.35", "time.time() - start < 0.4", "late()", "late(limit=0.2)"),
    ),
)  # fmt: skip
