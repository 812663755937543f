import logging
import sys
import threading
import time

from tqdm import tqdm

from vaso.optimizers.quiet import aloud, quiet


def test_swallows_prints_and_logs_of_this_thread(capsys, caplog):
    log = logging.getLogger("noisy.part")
    with quiet("noisy"):
        print("hidden")
        log.error("hidden too")
        sys.stdout.flush()
    print("shown")
    assert capsys.readouterr() == ("shown\n", "")
    assert caplog.records == []


def test_other_threads_go_on_printing(capsys):
    with quiet("noisy"):
        thread = threading.Thread(target=lambda: print("progress"))
        thread.start()
        thread.join()
        assert sys.stdout.isatty() is False and sys.stdout.encoding
    assert capsys.readouterr().out == "progress\n"


def test_a_progress_bar_that_its_monitor_redraws(capsys, monkeypatch):
    """tqdm redraws a bar that stands still, from a thread of its own."""
    monkeypatch.setattr(tqdm, "monitor_interval", 0.01)
    monkeypatch.setattr(tqdm, "monitor", None)
    with quiet("noisy"), tqdm(total=9, maxinterval=0.01, mininterval=0) as bar:
        bar.update(5)
        bar.miniters = 100  # the monitor resets this when it redraws
        end = time.monotonic() + 10
        while bar.miniters == 100 and time.monotonic() < end:
            time.sleep(0.01)
        time.sleep(0.05)
        tqdm.monitor.exit()
    assert bar.miniters == 1
    assert capsys.readouterr() == ("", "")


def test_restores_everything_after_an_error(capsys):
    log, before = logging.getLogger("noisy"), sys.stdout
    try:
        with quiet("noisy"):
            raise ValueError
    except ValueError:
        pass
    assert sys.stdout is before and log.propagate and log.handlers == []


def test_progress_bars_on_stderr(capsys):
    with quiet("noisy"):
        print("hidden", file=sys.stderr)
    print("shown", file=sys.stderr)
    assert capsys.readouterr() == ("", "shown\n")


def test_what_is_not_the_frameworks_may_be_printed(capsys):
    with quiet("noisy"), quiet("noisy"):
        print("hidden")
        with aloud():
            print("shown")
        print("hidden")
    assert capsys.readouterr().out == "shown\n"


def test_two_threads_may_overlap(capsys):
    """The one that began first ends first."""
    before, first, second = sys.stdout, threading.Event(), threading.Event()

    def late():
        first.wait()
        with quiet("noisy"):
            second.set()
            done.wait()
            print("hidden")

    done, thread = threading.Event(), threading.Thread(target=late)
    thread.start()
    with quiet("noisy"):
        first.set()
        second.wait()
    print("shown")
    assert logging.getLogger("noisy").propagate is False
    done.set()
    thread.join()
    assert sys.stdout is before and logging.getLogger("noisy").propagate
    assert capsys.readouterr().out == "shown\n"
