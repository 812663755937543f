"""Optimizers of skill texts behind one protocol."""
