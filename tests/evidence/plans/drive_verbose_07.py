# skill: drive
# expected: pass
# because: keyword defaults, formatted prints
"""Navigate ahead with progress messages."""


def report(step: int, total: int, *, unit: str = "steps") -> None:
    """Print progress."""
    percent = 100.0 * step / total
    print(f"{step}/{total} {unit} ({percent:.1f}%)")


def navigate(total: int = 40) -> None:
    """Navigate ahead."""
    step = 0
    while step < total:
        if people_observed():
            stop()
            continue
        if obstacle_observed():
            stop()
            continue
        forward()
        step += 1
        report(step, total)
    stop()


navigate()
