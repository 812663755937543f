"""A plan process of its own, to be killed: it climbs, then flies east for ever."""

from __future__ import annotations

import sys
import time

from vaso.errors import RobotError
from vaso.modules.robots import PX4Mavlink
from vaso.platforms import get_platform

command = get_platform("px4").commands[0]
px4 = PX4Mavlink(sys.argv[1], flight_log=sys.argv[2])
try:
    px4.connect()
    px4.start()
    for step in range(1000):
        px4.act(command.issue(((0.0, 0.0, -0.5) if step < 2 else (0.0, 0.5, 0.0),), {}))
        px4.wait()
        if step == 2:
            print("moving", px4.driver_pid, flush=True)
            if "stall" in sys.argv:
                time.sleep(60)
except RobotError as error:
    print("ended:", error, flush=True)
except KeyboardInterrupt:
    print("interrupted", flush=True)
px4.stop()
print("stopped", px4.health().details, flush=True)
px4.close()
