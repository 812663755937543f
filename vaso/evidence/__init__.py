"""Independent evidence that verdicts are right: CPython, other engines, changed plans, mutants."""
