"""The worker process of :class:`~vaso.verifiers.pynusmv_engine.PyNuSMVEngine`.

Run as ``python -P _pynusmv_worker.py REQUEST_FD RESPONSE_FD``; imports nothing of VASO. NuSMV keeps
global state, leaks memory, may abort, and cannot be interrupted. So this process loads it once and
keeps a forked child ready that answers the requests: a crash or a kill costs one child. Between two
models the child ends and starts NuSMV's session (0.6 ms, where a fork costs 4 ms). It is replaced
after an error, a trace or an invalid model, after so many models, and when it has grown, so nothing
accumulates. Requests and messages are JSON, one per line.

A request has ``model``, ``specs`` (pairs of number and text), ``traces``, ``deadline`` (seconds for
all), ``slice`` (seconds without a message, once the model is loaded) and ``memory_mb``. Messages:

* ``{"loaded": seconds}``, or ``{"invalid": reason}``: no formula can be decided on this model;
* ``{"spec": number, "holds": bool, "seconds": s}`` then, where asked for, ``{"trace": number,
  "names": [...], "rows": [[...]], "loop": i}`` or ``{"no_trace": number, "reason": text}``;
* ``{"error": reason}``: the formula in progress is bad; NuSMV is not used any further after that;
* ``{"end": "done" | "timeout" | "crash", "detail": text}``: always the last one.
"""

from __future__ import annotations

import contextlib
import ctypes
import gc
import json
import os
import re
import resource
import select
import signal
import sys
import time
from typing import Any, NoReturn

REORDER = "set dynamic_reorder 1"
MANY_VARIABLES = 8  # with fewer, looking for a better order costs more than it saves
STDERR_TAIL = 20_000
PR_SET_PDEATHSIG = 1
PAGE = os.sysconf("SC_PAGE_SIZE")
MODELS = 200  # models that a child sees before it is replaced
GROWTH = 256 << 20  # bytes that it may grow by
READY_SECONDS = 2.0  # for a child to end one session and start the next
READY, DONE = b"ready\n", b"done\n"  # from child to parent; every other line is a message


def main() -> None:
    """Serve requests until the client closes the pipe."""
    requests, responses = int(sys.argv[1]), int(sys.argv[2])
    null = os.open(os.devnull, os.O_RDWR)
    os.dup2(null, 0)
    os.dup2(null, 1)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the client's business
    try:
        nusmv = NuSMV()
    except Exception as error:
        send(responses, {"fatal": f"{type(error).__name__}: {error}"})
        return
    gc.collect()
    gc.freeze()
    gc.disable()
    server = Server(nusmv, requests, responses)
    send(responses, {"ready": os.getpid()})
    for line in LineReader(requests):
        server.serve(line)


def send(fd: int, message: dict[str, Any]) -> None:
    """Write one message, all of it."""
    write_all(fd, json.dumps(message).encode() + b"\n")


def write_all(fd: int, data: bytes) -> None:
    """Write all of the bytes to a pipe."""
    view = memoryview(data)
    while view:
        view = view[os.write(fd, view) :]


class LineReader:
    """Lines from a file descriptor, until its end."""

    def __init__(self, fd: int) -> None:
        self.fd = fd
        self.rest = b""

    def __iter__(self) -> LineReader:
        return self

    def __next__(self) -> bytes:
        while b"\n" not in self.rest:
            chunk = os.read(self.fd, 1 << 16)
            if not chunk:
                raise StopIteration
            self.rest += chunk
        line, self.rest = self.rest.split(b"\n", 1)
        return line


# --- the parent: a child that is ready ---------------------------------------------------------


class Child:
    """A forked NuSMV that answers one request after the other."""

    def __init__(self, nusmv: NuSMV, foreign: tuple[int, ...]) -> None:
        self.log = os.memfd_create("nusmv-stderr")
        incoming, self.requests = os.pipe()
        self.source, sink = os.pipe()
        self.models = 0
        self.unread = b""
        self.status: int | None = None
        self.pid = os.fork()
        if self.pid == 0:
            die_with_parent()
            for fd in (self.requests, self.source, *foreign):
                os.close(fd)
            run_child(nusmv, incoming, sink, self.log)
        os.close(incoming)
        os.close(sink)
        self.size = resident(self.pid)

    def is_worn(self) -> bool:
        """True when it has seen so many models, or grown so much, that a new one is better."""
        self.models += 1
        return self.models >= MODELS or resident(self.pid) - self.size > GROWTH

    def is_ready(self) -> bool:
        """True when it waits for a request, as it says after its start and after each model."""
        deadline = time.monotonic() + READY_SECONDS
        poll = select.poll()
        poll.register(self.source, select.POLLIN)
        while READY not in self.unread:
            if not poll.poll(max(0.0, deadline - time.monotonic()) * 1000):
                return False
            chunk = os.read(self.source, 1 << 16)
            if not chunk:
                return False
            self.unread += chunk
        self.unread = b""
        return not poll.poll(0)  # a hang-up: it has died since

    def end(self) -> None:
        """Have it gone."""
        if self.status is None:
            os.kill(self.pid, signal.SIGKILL)
            self.reap()

    def reap(self) -> tuple[int, str]:
        """The wait status of a child that has closed its pipe, and its complaint."""
        self.status = os.waitpid(self.pid, 0)[1]
        said = complaint(self.log)
        for fd in (self.requests, self.source, self.log):
            os.close(fd)
        return self.status, said


class Server:
    """Answers requests, each within its time, with a child that is kept ready."""

    def __init__(self, nusmv: NuSMV, requests: int, responses: int) -> None:
        self.nusmv, self.requests, self.responses = nusmv, requests, responses
        self.child = self.fork()

    def fork(self) -> Child:
        """A new child."""
        return Child(self.nusmv, (self.requests, self.responses))

    def serve(self, line: bytes) -> None:
        """Answer a request."""
        if not self.child.is_ready():
            self.child.end()
            self.child = self.fork()
            self.child.is_ready()
        child, request = self.child, json.loads(line)
        try:
            write_all(child.requests, line + b"\n")
        except BrokenPipeError:
            end = "lost"
        else:
            end = relay(request, child, self.requests, self.responses)
        if end == "done" and not child.is_worn():
            send(self.responses, {"end": "done", "detail": ""})
            return
        send(self.responses, self.farewell(child, end))
        self.child = self.fork()

    def farewell(self, child: Child, end: str) -> dict[str, str]:
        """The last message about a request, where the child is gone or has to go."""
        if end != "lost":
            child.end()
            return {"end": end, "detail": ""}
        status, said = child.reap()
        if status == 0:
            return {"end": "done", "detail": ""}
        return {"end": "crash", "detail": f"{describe_exit(status)}; {said}".rstrip("; ")}


def resident(pid: int) -> int:
    """Resident memory of a process in bytes; 0 where the system does not tell."""
    try:
        with open(f"/proc/{pid}/statm", "rb") as file:
            return int(file.read().split()[1]) * PAGE
    except (OSError, IndexError, ValueError):
        return 0


def die_with_parent() -> None:
    """Have the kernel kill this process when its parent is gone (Linux only)."""
    with contextlib.suppress(OSError, AttributeError):
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)


def relay(request: dict[str, Any], child: Child, requests: int, responses: int) -> str:
    """Pass the child's complete lines on, until it is done or lost, or its time is over.

    Returns:
        ``done``, ``timeout``, or ``lost`` for a child that has closed its pipe.
    """
    deadline = time.monotonic() + request["deadline"]
    limit = deadline
    poll = select.poll()
    poll.register(child.source, select.POLLIN)
    poll.register(requests, 0)  # only a hang-up
    rest = b""
    while True:
        wait = limit - time.monotonic()
        events = poll.poll(wait * 1000) if wait > 0 else []
        if not events:
            return "timeout"
        if any(fd == requests for fd, _ in events):
            child.end()
            sys.exit(0)
        chunk = os.read(child.source, 1 << 16)
        if not chunk:
            return "lost"
        lines, newline, rest = (rest + chunk).rpartition(b"\n")
        if newline:
            lines, done, after = (lines + newline).partition(DONE)
            write_all(responses, lines)
            if done:
                child.unread = after + rest
                return "done"
            limit = min(deadline, time.monotonic() + request["slice"])


def describe_exit(status: int) -> str:
    """How a child ended, in words."""
    if os.WIFSIGNALED(status):
        return f"NuSMV was stopped by {signal.Signals(os.WTERMSIG(status)).name}"
    return "NuSMV gave up, probably for lack of memory"


_NOISE = re.compile(
    r"^(\W*$|aborting|an error occured during|\*{4}|in definition of \S+ at line)", re.I
)
_FILE = re.compile(r"(TYPE ERROR )?file \S+?: ")


def complaint(log: int) -> str:
    """The last line that NuSMV wrote on stderr, without the noise."""
    size = os.fstat(log).st_size
    text = os.pread(log, STDERR_TAIL, max(0, size - STDERR_TAIL)).decode(errors="replace")
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    useful = [line for line in lines if not _NOISE.match(line)] or lines
    return _FILE.sub("", useful[-1]) if useful else ""


# --- the child: one model after the other ------------------------------------------------------


def run_child(nusmv: NuSMV, incoming: int, sink: int, log: int) -> NoReturn:
    """Answer requests until one leaves NuSMV in a doubtful state; leave without any clean-up."""
    code = 1
    try:
        os.dup2(log, 2)
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        write_all(sink, READY)
        for line in LineReader(incoming):
            if not answer_safely(nusmv, json.loads(line), sink, log):
                break
            write_all(sink, DONE)
            nusmv.restart()
            write_all(sink, READY)
        code = 0
    except BrokenPipeError:
        code = 0
    finally:
        os._exit(code)


def answer_safely(nusmv: NuSMV, request: dict[str, Any], sink: int, log: int) -> bool:
    """Answer one request within its memory; True when NuSMV can go on to another model."""
    os.ftruncate(log, 0)
    os.lseek(log, 0, os.SEEK_SET)
    _, hard = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (request["memory_mb"] << 20, hard))
    try:
        return answer(nusmv, request, sink)
    except MemoryError:
        os._exit(1)  # not even enough to say so
    except Exception as error:
        text = complaint(log) or " ".join(str(error).split()) or type(error).__name__
        send(sink, {"error": text})
        return False


def answer(nusmv: NuSMV, request: dict[str, Any], sink: int) -> bool:
    """Load the model, judge it, decide the formulas; True when nothing out of the way happened."""
    started = time.perf_counter()
    nusmv.load(request["model"])
    invalid = nusmv.defect()
    if invalid:
        send(sink, {"invalid": invalid})
        return False
    send(sink, {"loaded": time.perf_counter() - started})
    ordinary = True
    for number, spec in request["specs"]:
        started = time.perf_counter()
        check = nusmv.check(spec)
        seconds = time.perf_counter() - started
        send(sink, {"spec": number, "holds": check.holds, "seconds": seconds})
        if request["traces"] and not check.holds:
            ordinary = False
            if check.has_compassion():
                send(sink, {"no_trace": number, "reason": "no trace for a model with COMPASSION"})
            else:
                send(sink, {"trace": number, **check.lasso()})
        check.close()
    return ordinary


class Modules:
    """The modules of PyNuSMV that are needed, imported once, before any fork."""

    def __init__(self) -> None:
        from pynusmv import fsm, glob, init, parser, prop, trace
        from pynusmv_lower_interface.nusmv.cmd import cmd as low_cmd
        from pynusmv_lower_interface.nusmv.compile.symb_table import symb_table as low_symbols
        from pynusmv_lower_interface.nusmv.dd import dd as low_dd
        from pynusmv_lower_interface.nusmv.enc.bdd import bdd as low_enc
        from pynusmv_lower_interface.nusmv.fsm.bdd import bdd as low_fsm
        from pynusmv_lower_interface.nusmv.fsm.sexp import sexp as low_sexp
        from pynusmv_lower_interface.nusmv.ltl import ltl as low_ltl
        from pynusmv_lower_interface.nusmv.mc import mc as low_mc
        from pynusmv_lower_interface.nusmv.node import node as low_node
        from pynusmv_lower_interface.nusmv.prop import prop as low_prop
        from pynusmv_lower_interface.nusmv.trace import trace as low_trace

        self.fsm, self.glob, self.init, self.parser = fsm, glob, init, parser
        self.prop, self.trace = prop, trace
        self.low_cmd, self.low_symbols, self.low_dd = low_cmd, low_symbols, low_dd
        self.low_enc, self.low_fsm, self.low_sexp = low_enc, low_fsm, low_sexp
        self.low_ltl, self.low_mc, self.low_node = low_ltl, low_mc, low_node
        self.low_prop, self.low_trace = low_prop, low_trace


class NuSMV:
    """PyNuSMV, as far as LTL on BDDs needs it."""

    def __init__(self) -> None:
        self.py = Modules()
        self.start()

    def start(self) -> None:
        """Begin a session of NuSMV."""
        self.py.init.init_nusmv(collecting=False)

    def restart(self) -> None:
        """Forget the model and everything about it."""
        self.py.init.deinit_nusmv()
        self.start()

    def load(self, model: str) -> None:
        """Read and compile a model."""
        if len(re.findall(r"^ *\w+ : (?:boolean|\d+\.\.)", model, re.MULTILINE)) > MANY_VARIABLES:
            self.py.low_cmd.Cmd_SecureCommandExecute(REORDER)
        fd = os.memfd_create("model")
        write_all(fd, model.encode())
        try:
            self.py.glob.load_from_file(f"/proc/self/fd/{fd}")
            self.py.glob.compute_model(keep_single_enum=True)
        finally:
            os.close(fd)

    def check(self, spec: str) -> LTLCheck:
        """Decide one formula."""
        return LTLCheck(self.py, self.py.prop.Spec(self.py.parser.parse_ltl_spec(spec)))

    def defect(self) -> str:
        """Why every formula would hold on the loaded model, or an empty string."""
        always_false = self.check("G FALSE")
        empty = always_false.holds
        always_false.close()
        if empty:
            return (
                "the model has no fair run (no initial state, a deadlock, or fairness that cannot "
                "be met), so every formula would hold"
            )
        fsm = self.py.glob.prop_database().master.bddFsm
        if self.py.low_fsm.BddFsm_is_deadlock_free(fsm._ptr):
            return ""
        state = fsm.pick_one_state(fsm.reachable_states & fsm.deadlock_states)
        values = ", ".join(f"{name} = {value}" for name, value in state.get_str_values().items())
        return f"the model has a reachable state without a successor: {values}"


class LTLCheck:
    """One formula, decided on the product of the loaded model and the formula's tableau."""

    def __init__(self, py: Modules, spec: Any) -> None:
        self.py = py
        self._property = py.low_prop.Prop_create_partial(spec._ptr, py.low_prop.Prop_Ltl)
        self._struct = py.low_ltl.Ltl_StructCheckLtlSpec_create(self._property)
        py.low_ltl.Ltl_StructCheckLtlSpec_build(self._struct)
        py.low_ltl.Ltl_StructCheckLtlSpec_check(self._struct)
        status = py.low_prop.Prop_get_status(self._property)
        if status not in (py.low_prop.Prop_True, py.low_prop.Prop_False):
            raise RuntimeError("NuSMV gave no verdict")
        self.holds = bool(status == py.low_prop.Prop_True)

    def close(self) -> None:
        """Remove the tableau from the model again."""
        self.py.low_ltl.Ltl_StructCheckLtlSpec_destroy(self._struct)
        self.py.low_prop.Prop_destroy(self._property)

    def has_compassion(self) -> bool:
        """Whether the model has strong fairness, for which NuSMV's witness search does not end."""
        fsm = self.py.low_fsm
        found = fsm.compassionList2fairnessList(fsm.BddFsm_get_compassion(self._struct.fsm))
        return not fsm.FairnessList_is_empty(found)

    def lasso(self) -> dict[str, Any]:
        """A violating run of the model.

        NuSMV hides the tableau's variables from its traces and then marks every state that *looks*
        like the last one as a loop. Here the loop is found on the states of the product, before
        they are stripped: the first one that equals the last one.
        """
        cells = self._path()
        states = [int(self._bdd(cell)) for cell in cells[::2]]
        loop = states.index(states[-1])
        if loop == len(states) - 1:
            raise RuntimeError("NuSMV's counterexample does not close its loop")
        names, rows = self._values(cells)
        return {"names": names, "rows": rows[:-1], "loop": loop}

    def _bdd(self, cell: Any) -> Any:
        return self.py.low_node.node2bdd(self.py.low_node.car(cell))

    def _path(self) -> list[Any]:
        """List cells of the product's path: state, input, state, input, ..., state."""
        node, struct = self.py.low_node, self._struct
        start = self.py.low_enc.BddEnc_pick_one_state(struct.bdd_enc, struct.s0)
        path = node.cons(node.bdd2node(self.py.low_dd.bdd_dup(start)), None)
        path = self.py.low_mc.explain(struct.fsm, struct.bdd_enc, path, struct.spec_formula, None)
        cell, cells = node.reverse(path), []
        while cell is not None:
            cells.append(cell)
            cell = node.cdr(cell)
        return cells

    def _values(self, cells: list[Any]) -> tuple[list[str], list[list[str]]]:
        """Names of the state variables, and their values in every state of a path."""
        py, struct, trace = self.py, self._struct, self.py.low_trace
        self._strip_tableau(cells)
        database = py.low_prop.PropPkg_get_prop_database()
        master = py.low_prop.PropDb_master_get_scalar_sexp_fsm(database)
        variables = py.low_sexp.SexpFsm_get_vars_list(master)
        # volatile: it shares the symbol table, and does not outlive this call
        kind = trace.TRACE_TYPE_CNTEXAMPLE
        pointer = trace.Trace_create(struct.symb_table, "", kind, variables, True)
        py.low_mc.Mc_fill_trace_from_bdd_state_input_list(struct.bdd_enc, pointer, cells[0])
        symbols = [(str(s), s._ptr) for s in py.trace.Trace(pointer).state_frozen_vars]
        rows = []
        for number in range(1, len(cells) // 2 + 2):
            step = trace.Trace_ith_iter(pointer, number)
            values = (trace.Trace_step_get_value(pointer, step, symbol) for _, symbol in symbols)
            rows.append([py.low_node.sprint_node(value) for value in values])
        return [name for name, _ in symbols], rows

    def _strip_tableau(self, cells: list[Any]) -> None:
        py, struct = self.py, self._struct
        manager = py.low_enc.BddEnc_get_dd_manager(struct.bdd_enc)
        every = py.low_symbols.VFT_ALL
        tableau = py.low_enc.BddEnc_get_layer_vars_cube(struct.bdd_enc, struct.tableau_layer, every)
        for cell in cells:
            visible = py.low_dd.bdd_forsome(manager, self._bdd(cell), tableau)
            py.low_node.setcar(cell, py.low_node.bdd2node(visible))


if __name__ == "__main__":
    main()
