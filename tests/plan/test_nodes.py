"""The nodes of a tree, walked once."""

import ast
import gc
import weakref

from vaso.plan.nodes import nodes

TEXT = "def f(x):\n    return [x, 1]\nwhile f(2):\n    print('a')\n"


def test_the_same_nodes_in_the_same_order_each_time():
    tree = ast.parse(TEXT)
    for _ in range(2):
        assert list(nodes(tree)) == list(ast.walk(tree))
    assert list(nodes(tree.body[0])) == list(ast.walk(tree.body[0]))


def test_trees_are_let_go():
    tree = ast.parse(TEXT)
    assert sum(1 for _ in nodes(tree)) > 10
    known = weakref.ref(tree)
    del tree
    gc.collect()
    assert known() is None
