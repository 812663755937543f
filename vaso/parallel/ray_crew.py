"""Workers as actors of Ray: on this machine, or on the machines of a cluster."""

from __future__ import annotations

import contextlib
import importlib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from vaso.errors import MissingDependencyError, VerifierError
from vaso.parallel.crew import Event, Lost, Reply
from vaso.parallel.job import greeting, perform_packed
from vaso.parallel.processes import usable_cores

__all__ = ["RayCrew"]


@dataclass(eq=False, slots=True)
class RayWorker:
    """An actor, and the answer that it is working on."""

    actor: Any
    answer: Any


class _Verifier:
    """The actor: VASO must be installed where it runs."""

    def greet(self) -> bytes:
        return greeting()

    def verify(self, job: bytes) -> bytes:
        return perform_packed(job)


class RayCrew:
    """Actors with one core each. Ray is started on this machine where the program has not done so.

    To use a cluster, call ``ray.init(address=...)`` first; its machines need VASO as well.

    Args:
        workers: How many; by default one for each core of the cluster.

    Raises:
        MissingDependencyError: Ray is not installed.
    """

    def __init__(self, workers: int | None = None) -> None:
        try:
            self._ray: Any = importlib.import_module("ray")
        except ImportError as error:
            raise MissingDependencyError("ray", "ray") from error
        self._alive: set[RayWorker] = set()
        self._actor: Any = None
        self._is_ours = False
        self._wanted = workers
        self.workers = workers or usable_cores()

    def start(self) -> RayWorker:
        """Start an actor.

        Raises:
            VerifierError: Ray does not start.
        """
        if self._actor is None:
            self._join()
        actor = self._actor.remote()
        worker = RayWorker(actor, actor.greet.remote())
        self._alive.add(worker)
        return worker

    def _join(self) -> None:
        ray = self._ray
        if not ray.is_initialized():
            self._is_ours = True
            self._init()
        cores = max(1, int(ray.cluster_resources().get("CPU", 1)))
        self.workers = min(self._wanted or cores, cores)
        self._actor = ray.remote(num_cpus=1, max_restarts=0, max_task_retries=0)(_Verifier)

    def _init(self) -> None:
        quiet = {"include_dashboard": False, "log_to_driver": False, "logging_level": "ERROR"}
        try:
            self._ray.init(num_cpus=self.workers, **quiet)
        except Exception as error:
            raise VerifierError(
                f"Ray does not start: {error}", hint="executor='processes' needs no Ray"
            ) from error

    def send(self, worker: RayWorker, job: bytes) -> None:
        """Give a job to an actor."""
        worker.answer = worker.actor.verify.remote(job)

    def wait(self, workers: Sequence[RayWorker], timeout: float) -> list[tuple[RayWorker, Event]]:
        """Answers of actors, and those that are gone."""
        places = {worker.answer: worker for worker in workers}
        ready, _ = self._ray.wait(list(places), num_returns=1, timeout=timeout)
        return [(places[answer], self._event(answer)) for answer in ready]

    def _event(self, answer: Any) -> Event:
        try:
            return Reply(self._ray.get(answer))
        except self._ray.exceptions.RayError as error:
            return Lost(_told(error))

    def kill(self, worker: RayWorker) -> None:
        """End an actor."""
        self._alive.discard(worker)
        with contextlib.suppress(Exception):  # it is gone already
            self._ray.kill(worker.actor, no_restart=True)

    def close(self) -> None:
        """End every actor, and Ray where this crew has started it."""
        for worker in list(self._alive):
            self.kill(worker)
        if self._is_ours:
            self._ray.shutdown()


def _told(error: Exception) -> str:
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    return f"{type(error).__name__}: {lines[0] if lines else 'no reason'}"
