"""A driver for the tests of the link: it answers, fails on request, and writes down how it ends."""

from __future__ import annotations

import sys
import time
from pathlib import Path

from vaso.modules.robots.link import LinkClosed, connect_back

channel, settings = connect_back()
if settings.get("dies"):
    sys.exit("no such robot")
channel.send("hello")
hung = False
try:
    while True:
        messages = channel.receive(0.05)
        if not hung:
            channel.send("state", silence=channel.silence)
        for message in messages:
            if message["kind"] == "echo":
                channel.send("event", text="echoed")
                channel.answer(message, value=message["value"])
            elif message["kind"] == "refuse":
                channel.refuse(message, "no", hint="ask nicely", name=message.get("name", ""))
            elif message["kind"] == "hang":
                hung = True
            elif message["kind"] == "flood":
                for _ in range(message["lines"]):
                    channel.send("state", text="x" * 1000)
        if channel.silence > settings.get("silence_s", 1.0):
            Path(settings["epitaph"]).write_text("silence")
            sys.exit(3)
except LinkClosed:
    time.sleep(0.1)
    Path(settings["epitaph"]).write_text("closed")
