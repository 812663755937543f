"""A plan process to be killed or stalled: drives ahead over ROS until it cannot any more."""

import json
import sys

from vaso import load_skill
from vaso.execution import execute
from vaso.modules.robots import JackalROS

PLAN = """
while True:
    if people_observed():
        stop()
    else:
        forward()
"""

if __name__ == "__main__":
    robot = JackalROS(python=sys.argv[1], **json.loads(sys.argv[2]))
    print(execute(load_skill("drive"), PLAN, robot).ending.model_dump_json())
