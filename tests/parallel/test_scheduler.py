"""The scheduler, with a crew that has no processes: what can happen to a worker."""

from collections import deque

import pytest
from batches import FAULTY, GOOD

from vaso import verify_many
from vaso.errors import VerifierError
from vaso.parallel import Lost, Reply
from vaso.parallel.job import greeting, perform_packed


class Acted:
    """Workers that do what a script says: greet, answer, are lost, or say nothing."""

    def __init__(self, *scripts, workers=1):
        self.workers = workers
        self.scripts = deque(deque(script) for script in scripts)
        self.jobs, self.killed, self.started = {}, [], 0

    def start(self):
        self.started += 1
        return self.scripts.popleft() if self.scripts else deque(["greet"] + ["answer"] * 9)

    def send(self, worker, job):
        self.jobs[id(worker)] = job

    def wait(self, workers, timeout):
        events = []
        for worker in workers:
            act = worker[0]
            if act == "hang":
                continue
            worker.popleft()
            if act == "greet":
                events.append((worker, Reply(greeting())))
            elif act == "answer":
                events.append((worker, Reply(perform_packed(self.jobs[id(worker)]))))
            else:
                events.append((worker, Lost("it was acted")))
        return events

    def kill(self, worker):
        self.killed.append(worker)

    def close(self):
        pass


def verdicts(crew, plans, drive, **options):
    found = verify_many(plans, drive, executor=crew, memo=False, **options).collect()
    return [str(r.verdict) for r in found], [r.problem and r.problem.message for r in found]


def test_a_worker_that_is_lost_at_work_is_replaced_and_its_plan_tried_again(drive):
    crew = Acted(["greet", "lose"])
    assert verdicts(crew, [GOOD, FAULTY], drive)[0] == ["pass", "fail"]
    assert (crew.started, len(crew.killed)) == (2, 1)


def test_a_plan_that_loses_two_workers_is_given_up(drive):
    crew = Acted(["greet", "lose"], ["greet", "lose"])
    found, said = verdicts(crew, [GOOD, FAULTY], drive)
    assert found == ["unknown", "fail"]
    assert said[0] == "two workers were lost over this plan; the last time, it was acted"


def test_a_worker_that_is_lost_at_the_start_is_replaced(drive):
    crew = Acted(["lose"], ["lose"], ["greet", "lose"], ["lose"])
    assert verdicts(crew, [GOOD], drive)[0] == ["pass"]


def test_workers_that_never_start_end_the_batch(drive):
    crew = Acted(*([["lose"]] * 3))
    with pytest.raises(VerifierError, match="does not start: it was acted"):
        verdicts(crew, [GOOD], drive)


def test_a_plan_that_takes_too_long_is_not_tried_again(drive):
    crew = Acted(["greet", "hang"])
    found, said = verdicts(crew, [GOOD, FAULTY], drive, timeout=0.5)
    assert found == ["unknown", "fail"] and "time-out" in said[0]
    assert (crew.started, len(crew.killed)) == (2, 1)
