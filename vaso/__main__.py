"""``python -m vaso``: the command line."""

from vaso.cli import main

main()
