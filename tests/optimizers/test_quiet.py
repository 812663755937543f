import logging
import sys
import threading

from vaso.optimizers.quiet import quiet


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


def test_restores_everything_after_an_error(capsys):
    log, before = logging.getLogger("noisy"), sys.stdout
    try:
        with quiet("noisy"):
            raise ValueError
    except ValueError:
        pass
    assert sys.stdout is before and log.propagate and log.handlers == []
