# skill: drive
# expected: pass
# because: a timer class
import time

class Timer:
    def __init__(self):
        self.start = time.time()
        self.paused = 0.0
        self.since = 0.0

    def pause(self):
        self.since = time.time()

    def resume(self):
        self.paused += time.time() - self.since

    def elapsed(self):
        return time.time() - self.start - self.paused

timer = Timer()
while timer.elapsed() < 0.7:
    if people_observed() or obstacle_observed():
        timer.pause()
        while people_observed() or obstacle_observed():
            stop()
        timer.resume()
    else:
        forward()
stop()
