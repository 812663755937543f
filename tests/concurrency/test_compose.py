"""Several robots at the same time: what is checked, what is shown, and what is refused."""

import json

import pytest
from rich.console import Console
from robots import MOVE, MUTEX, ON_GREEN, ON_RED, ZONE, skill, toggle

import vaso
from vaso.errors import FormulaError, SkillError
from vaso.plan.explore import Budget
from vaso.plan.transition_system import Edge, Sensor, State, TransitionSystem
from vaso.verdict import Verdict

LEFT, RIGHT = (skill(), ON_GREEN), (skill(), ON_RED)
PAIR = {"left": LEFT, "right": RIGHT}


def text_of(renderable, width=100):
    console = Console(width=width, color_system=None)
    with console.capture() as capture:
        console.print(renderable)
    return capture.get()


# ------------------------------------------------------------------------- sensors and modes


def test_a_shared_light_keeps_the_zone_exclusive():
    result = vaso.compose(PAIR, [MUTEX], share=["light_green"])
    assert result
    assert result.specs[0].vacuous is None


def test_lights_of_their_own_do_not():
    result = vaso.compose(PAIR, [MUTEX])
    assert result.verdict is Verdict.FAIL
    example = result.specs[0].counterexample
    assert example.decided_at == 1
    assert [d.api for d in example.doing[1]] == ["enter()", "enter()"]
    assert [d.line for d in example.doing[1]] == [3, 3]


def test_both_on_the_same_colour_collide_although_they_share_the_light():
    result = vaso.compose({"left": LEFT, "right": LEFT}, [MUTEX], share=["light_green"])
    assert result.verdict is Verdict.FAIL


@pytest.mark.parametrize("mode", ["interleaving", "asynchronous"])
def test_a_light_that_changes_while_one_waits_does_not_protect(mode):
    result = vaso.compose(PAIR, [MUTEX], share=["light_green"], mode=mode)
    example = result.specs[0].counterexample
    assert result.verdict is Verdict.FAIL
    assert not example.timed
    assert all("turn" in step.sensors for step in example.steps)


def test_what_interleaving_misses_when_two_look_before_either_enters():
    """Each looks whether the other is inside. One at a time that works; together it does not."""
    polite = "while True:\n    if light_green():\n        stop()\n    else:\n        enter()\n"
    members = {"left": (skill(), polite), "right": (skill(), polite)}
    links = {"left.light_green": "right.in_zone", "right.light_green": "left.in_zone"}
    verdicts = {
        mode: vaso.compose(members, [MUTEX], links=links, mode=mode).verdict
        for mode in ("interleaving", "synchronous", "asynchronous")
    }
    assert verdicts == {
        "interleaving": Verdict.PASS,
        "synchronous": Verdict.FAIL,
        "asynchronous": Verdict.FAIL,
    }


def test_sensors_can_be_shared_under_different_names():
    seeing = skill(code=ZONE.replace("light_green", "go_ahead"))
    members = {"left": LEFT, "right": (seeing, ON_RED.replace("light_green", "go_ahead"))}
    share = {"traffic_light": ["left.light_green", "right.go_ahead"]}
    assert vaso.compose(members, [MUTEX], share=share)
    failing = vaso.compose(members, ["G left.in_zone"], share=share)
    assert "traffic_light" in failing.specs[0].counterexample.steps[0].sensors


def test_a_raw_sensor_can_be_shared():
    assert vaso.compose(PAIR, [MUTEX], share=["yolo_listener('light')"])


def test_a_linked_sensor_shows_what_the_other_does():
    waiting = "while True:\n    if light_green():\n        stop()\n    else:\n        enter()\n"
    members = {"left": (skill(), "enter()\nenter()\nleave()\n"), "right": (skill(), waiting)}
    rule = "G(left.in_zone -> X right.stop)"
    assert not vaso.compose(members, [rule])
    assert vaso.compose(members, [rule], links={"right.light_green": "left.in_zone"})


# ------------------------------------------------------------------------------ fairness


def test_liveness_needs_fairness_and_says_so():
    rule = "F left.in_zone"
    members = {"left": (skill(), "enter()\n"), "right": RIGHT}
    fair = vaso.compose(members, [rule], mode="interleaving")
    assert fair
    assert fair.specs[0].assumptions == ("G F left.moves",)


def test_without_fairness_a_starved_member_is_shown():
    members = {"left": (skill(), "enter()\n"), "right": RIGHT}
    result = vaso.compose(members, ["F left.in_zone"], mode="interleaving", fair=False)
    example = result.specs[0].counterexample
    assert result.verdict is Verdict.FAIL
    assert {step.sensors["turn"] for step in example.steps[example.loop_start :]} == {"right"}


def test_safety_needs_no_fairness():
    result = vaso.compose(PAIR, ["G !(left.in_zone & left.stop)"], mode="interleaving")
    assert result
    assert result.specs[0].assumptions == ()


# ------------------------------------------------------------------------------- own rules


OWN = skill(rules=["G(people_observed -> X stop)", "G F stop"], code=MOVE, name="walk")
OBEYS = (
    "while True:\n    if people_observed():\n        stop()\n    else:\n        forward()\n        \
stop()\n"
)
CAREFUL = "while True:\n    stop()\n"


@pytest.mark.parametrize("mode", ["synchronous", "interleaving", "asynchronous"])
def test_own_rules_count_the_steps_of_their_member(mode):
    result = vaso.compose({"a": (OWN, CAREFUL), "b": LEFT}, mode=mode)
    assert [s.role for s in result.specs] == ["a", "a"]
    assert result
    liveness = result.specs[1]
    assert liveness.assumptions == (() if mode == "synchronous" else ("G F a.moves",))


def test_own_rules_of_a_starved_member_fail_where_they_ask_for_something():
    result = vaso.compose({"a": (OWN, CAREFUL), "b": LEFT}, mode="interleaving", fair=False)
    assert [s.verdict for s in result.specs] == [Verdict.FAIL, Verdict.FAIL]


def test_own_rules_have_the_verdicts_that_they_have_alone():
    alone = vaso.verify(OWN, OBEYS)
    result = vaso.compose({"a": (OWN, OBEYS), "b": LEFT}, mode="asynchronous")
    assert [s.verdict for s in result.specs] == [s.verdict for s in alone.specs]


def test_own_rules_can_be_left_out():
    assert [s.role for s in vaso.compose({"a": (OWN, OBEYS)}, ["F a.stop"], own=False).specs] == [
        "joint"
    ]


def test_sharing_a_sensor_with_a_linked_one_can_make_an_own_rule_hold():
    rules = ["G(obstacle_observed -> X stop)"]
    blind = "while True:\n    stop()\n    forward()\n"
    member = (skill("blind", MOVE, rules), blind)
    assert not vaso.compose({"a": member})
    signal = TransitionSystem(
        tuple(State(f"s{i}", labels={"on": i == 0}) for i in range(2)),
        ((Edge({}, 1),), (Edge({}, 0),)),
        dt=0.1,
    )
    assert vaso.compose({"a": member, "b": signal}, links={"a.obstacle_observed": "b.on"})


# -------------------------------------------------------------------------------- assumptions


def test_assumptions_of_a_member_are_used_and_named():
    trusting = skill("trusting", MOVE, ["F forward"], ["G F !people_observed"])
    plan = "while people_observed():\n    stop()\nforward()\n"
    result = vaso.compose({"a": (trusting, plan), "b": LEFT})
    assert result
    assert result.specs[0].assumptions == ("G F !a.people_observed",)
    late = vaso.compose({"a": (trusting, plan), "b": LEFT}, ["F(a.forward | b.moves)"],
                        mode="interleaving")  # fmt: skip
    assert late


# --------------------------------------------------------------------------- control periods


def test_a_slower_member_steps_less_often():
    members = {"fast": toggle(dt=0.1), "slow": toggle(dt=0.3)}
    result = vaso.compose(members, ["G(slow.n < 0.5 & X slow.n > 0.5 -> slow.moves)", "F slow.on"])
    assert result
    assert result.dt == pytest.approx(0.1)
    failing = vaso.compose(members, ["G !slow.on"]).specs[0].counterexample
    assert failing.decided_at == 3
    assert failing.dt == pytest.approx(0.1)


def test_own_rules_of_a_slower_member_are_not_about_the_faster_clock():
    px4 = vaso.load_skill("fly-in-square-shape-traj")
    result = vaso.compose({"jackal": (skill("m", MOVE), "stop()\n"), "px4": px4})
    alone = vaso.verify(px4, px4.plan_template)
    assert [s.verdict for s in result.specs] == [s.verdict for s in alone.specs]


def test_periods_that_never_meet_are_refused():
    with pytest.raises(SkillError, match="do not fit"):
        vaso.compose({"a": toggle(dt=0.1), "b": toggle(dt=0.10007)}, ["F a.on"])
    assert vaso.compose({"a": toggle(dt=0.1), "b": toggle(dt=0.10007)}, ["F a.on"],
                        mode="interleaving")  # fmt: skip


# ---------------------------------------------------------------------------------- bounds


def cut_system(depth):
    """A system that is explored for some steps only."""
    states = [State(f"s{i}", labels={"on": False}) for i in range(depth)]
    states.append(State("?", labels={"on": False}, cut=True))
    edges = [(Edge({}, i + 1),) for i in range(depth)]
    return TransitionSystem(tuple(states), (*edges, (Edge({}, depth),)))


@pytest.mark.parametrize("rule", ["G !(a.on & b.on)", "G !a.on", "F(a.on & b.on)", "G F b.on"])
def test_a_cut_member_cuts_the_product(rule):
    result = vaso.compose({"a": cut_system(3), "b": toggle()}, [rule])
    spec = result.specs[0]
    if "a" not in rule:
        assert spec.verdict is Verdict.PASS
        return
    assert spec.verdict is Verdict.UNKNOWN
    assert "explored up to step 2" in spec.reason
    assert result.problem.kind == "unknown"


def test_a_violation_before_the_cut_counts():
    result = vaso.compose({"a": cut_system(3), "b": toggle()}, ["G !(b.on & !a.on)"])
    assert result.verdict is Verdict.FAIL


@pytest.mark.parametrize(
    "rule", ["G !(a.n > 12.5 & b.n > 20.5 & a.n < b.n - 9)", "G F(a.on & b.on)"]
)
def test_a_bound_on_joint_states_is_never_a_pass(rule):
    members = {"a": toggle(7), "b": toggle(11)}
    bounded = vaso.compose(members, [rule], joint_budget=Budget(states=20, seconds=20))
    assert bounded.specs[0].verdict is Verdict.UNKNOWN
    assert "20 joint states" in bounded.specs[0].reason
    assert vaso.compose(members, [rule])


def test_time_is_a_bound_too():
    result = vaso.compose(PAIR, [MUTEX, "G F left.stop"], share=["light_green"], timeout=0.0)
    assert {s.verdict for s in result.specs} == {Verdict.UNKNOWN}


# ------------------------------------------------------------------------------- exclusions


def test_exclusions_are_rules():
    result = vaso.compose(PAIR, exclude=["in_zone", ["left.stop", "right.stop"]])
    assert [s.role for s in result.specs] == ["exclusion", "exclusion"]
    assert [s.verdict for s in result.specs] == [Verdict.FAIL, Verdict.FAIL]
    assert vaso.compose(PAIR, exclude=["in_zone"], share=["light_green"])


def test_a_group_of_three_is_exclusive_in_pairs():
    members = {name: toggle(3) for name in "abc"}
    result = vaso.compose(members, exclude=["on"])
    assert result.specs[0].formula.count("!") == 3


# -------------------------------------------------------------------------------- vacuity


def test_an_exclusion_that_is_never_put_to_the_test_says_so():
    idle = (skill(), "stop()\n")
    result = vaso.compose({"left": idle, "right": RIGHT}, [MUTEX])
    assert result
    assert result.specs[0].vacuous == "it never happens that left.in_zone"


# ---------------------------------------------------------------------------------- errors


@pytest.mark.parametrize(
    ("rule", "message"),
    [
        ("G !(in_zone)", "could be left.in_zone or right.in_zone"),
        ("G middle.in_zone", "there is no member 'middle'"),
        ("G left.in_zoo", "there is no 'left.in_zoo'"),
        ("G in_zoo", "no member has the proposition 'in_zoo'"),
        ("G (", "never closed"),
    ],
)
def test_rules_that_cannot_be_read(rule, message):
    with pytest.raises(FormulaError) as found:
        vaso.compose(PAIR, [rule])
    assert message in str(found.value)


@pytest.mark.parametrize(
    ("members", "message"),
    [
        ([], "nothing to compose"),
        (["drive", "drive"], "two members are called 'drive'"),
        ({"G": LEFT}, "cannot be the name"),
        ({"a.b": LEFT}, "cannot be the name"),
        ([3], "int is not a member"),
        ({"a": {"plan": "x"}}, "'skill' is missing"),
        ({"a": {"skill": "drive", "plans": "x"}}, "'plans' is not known"),
        ([toggle()], "needs a name"),
        ("no-such-skill", "no-such-skill"),
    ],
)
def test_members_that_are_none(members, message):
    with pytest.raises(SkillError) as found:
        vaso.compose(members, ["F x"])
    assert message in str(found.value)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"mode": "parallel"}, "no mode 'parallel'"),
        ({"share": ["in_zone"]}, "is not what one sensor says"),
        ({"share": ["cat_observed"]}, "no member has it"),
        ({"share": {"x": ["left.light_green"]}}, "only left has it"),
        ({"share": {"x": ["light_green", "right.light_green"]}}, "names no member"),
        ({"share": {"x": ["left.cats", "right.light_green"]}}, "does not observe 'cats'"),
        ({"share": {"turn": ["left.light_green", "right.light_green"]}}, "cannot be called"),
        ({"links": {"left.light_green": "right.people_observed"}}, "cannot show"),
        ({"links": {"left.light_green": "right.speed"}}, "cannot show"),
        ({"links": {"left.in_zone": "right.in_zone"}}, "is not what one sensor says"),
        (
            {"share": ["light_green"], "links": {"left.light_green": "right.in_zone"}},
            "shared or linked twice",
        ),
        ({"exclude": [["left.stop"]]}, "nothing excludes"),
    ],
)
def test_options_that_do_not_fit(options, message):
    with pytest.raises(SkillError) as found:
        vaso.compose(PAIR, [MUTEX], **options)
    assert message in str(found.value)


def test_a_plan_that_is_no_program_makes_everything_unsupported():
    result = vaso.compose({"left": LEFT, "right": (skill(), "fly()\n")}, [MUTEX])
    assert result.verdict is Verdict.UNSUPPORTED
    assert result.problem.kind == "input"
    assert "right" in result.problem.message


def test_a_system_that_can_get_stuck_is_refused():
    stuck = TransitionSystem((State("s", labels={"on": False}),), ((),))
    with pytest.raises(SkillError, match="not total"):
        vaso.compose({"a": stuck, "b": toggle()}, ["G !(a.on & b.on)"])


def test_no_rule_is_no_pass():
    assert vaso.compose(PAIR).verdict is not Verdict.PASS


def test_short_names_where_there_is_no_doubt():
    members = {"left": LEFT, "mover": (skill("m", MOVE), "forward()\n")}
    assert vaso.compose(members, ["F in_zone"]).specs[0].formula == "F left.in_zone"
    shared = vaso.compose(PAIR, ["G(light_green -> X left.in_zone | left.in_zone)"],
                          share=["light_green"])  # fmt: skip
    assert "left.light_green" in shared.specs[0].formula


# ------------------------------------------------------------------------------------ output


def test_the_table_shows_every_plan():
    result = vaso.compose(PAIR, [MUTEX])
    shown = text_of(result)
    for part in ("left does", "right does", "3: enter()", "violated here", "plan of left",
                 "plan of right", "left and right are in the zone"):  # fmt: skip
        assert part in shown


def test_the_table_fits_a_narrow_terminal():
    shown = text_of(vaso.compose(PAIR, [MUTEX], mode="asynchronous"), width=80)
    assert max(map(len, shown.splitlines())) <= 80
    assert "(3: enter())" not in shown.splitlines()[0]


def test_json_says_what_each_member_does():
    data = json.loads(json.dumps(vaso.compose(PAIR, [MUTEX]).to_json()))
    step = data["specs"][0]["counterexample"]["steps"][1]
    assert {n: m["line"] for n, m in step["members"].items()} == {"left": 3, "right": 3}
    assert step["labels"]["left.in_zone"] is True
    assert [m["name"] for m in data["members"]] == ["left", "right"]
    assert data["mode"] == "synchronous"


def test_html_is_one_page():
    from vaso.report.composition_html import composition_html

    result = vaso.compose(PAIR, [MUTEX])
    page = composition_html(result)
    assert "left does" in page and "3: enter()" in page
    assert "left does" in result._repr_html_()
    assert "left does" in result.specs[0].counterexample._repr_html_()


def test_the_gradient_names_the_plan_that_moved_in_last():
    """Left is inside from step 1 on; right comes later, in its line 2."""
    members = {"left": (skill(), "enter()\n"), "right": (skill(), "stop()\nenter()\n")}
    result = vaso.compose(members, [MUTEX])
    gradient = vaso.textual_gradient(result)
    assert "Plan of right: Line 2 executes enter() in step 2" in gradient.blame
    assert "Plan of left" not in gradient.blame
    assert f"violates {MUTEX}" in str(gradient)
    assert "right does" in gradient.trace


def test_the_gradient_of_a_pass():
    result = vaso.compose(PAIR, [MUTEX], share=["light_green"])
    assert str(vaso.textual_gradient(result)) == "pass all specifications"


def test_a_sensor_in_a_rule_is_nobodys_plan():
    system = TransitionSystem(
        (State("s", labels={"on": True}),), ((Edge({}, 0),),), (Sensor("light"),)
    )
    result = vaso.compose({"a": system, "b": toggle()}, ["G(a.on & b.on)"])
    assert "Plan of b" in vaso.textual_gradient(result).blame
