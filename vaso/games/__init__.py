"""GR(1) games as binary decision diagrams, in a process of their own.

A game that is too large can then be ended from outside. The process serves :mod:`vaso.synthesis`,
speaks JSON, and imports nothing else of the package, so that it starts at once.
"""
