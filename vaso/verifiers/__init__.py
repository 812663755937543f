"""Verifiers: model checkers and the direct lasso evaluator behind one protocol."""
