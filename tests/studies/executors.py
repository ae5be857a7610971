"""A small case, and an executor that computes at once, in this process."""

from concurrent.futures import Executor, Future

from small_cases import changed

BALL = """
kind = "ball-on-beam"
duration = "0.02 s"
laws = ["hertz", "linear"]
[surface]
spectrum = "iso3095"
"""
ROUGH = changed("ball-on-beam", laws=["table", "areal", "linear-filtered"], start="0.5 m", settling="5 ms")


class Here(Executor):
    """Counts its tasks, and loses those that `lost` says."""

    def __init__(self, lost=lambda count: False):
        self.count, self.lost = 0, lost

    def submit(self, task, /, *arguments, **keywords):
        self.count += 1
        future = Future()
        if self.lost(self.count):
            future.set_exception(BrokenPipeError("worker lost"))
        else:
            future.set_result(task(*arguments, **keywords))
        return future
