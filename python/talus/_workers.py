"""Work in processes of their own. They are started afresh: a copy of a process with threads, as fork makes it, can hang in
the library, and the start of multiprocessing would run the caller's script again."""

from __future__ import annotations

import os
import pickle
import queue
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor, wait
from pathlib import Path
from typing import Any, Callable, Sequence

from ._library import TalusError


class _Worker:
    """A process that answers one call after another."""

    def __init__(self) -> None:
        here = str(Path(__file__).resolve().parents[1])
        places = [here, *filter(None, [os.environ.get("PYTHONPATH")])]
        # A session of its own: Ctrl-C in a terminal reaches the caller alone, who ends the workers.
        self.process = subprocess.Popen(
            [sys.executable, "-c", "from talus._workers import serve; serve()"], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(places)}, start_new_session=True,
        )  # fmt: skip

    def __call__(self, work: Callable[[Any], Any], job: Any) -> Any:
        assert self.process.stdin is not None and self.process.stdout is not None
        try:
            pickle.dump((work, job), self.process.stdin)
            self.process.stdin.flush()
            answer, error = pickle.load(self.process.stdout)
        except (OSError, EOFError, pickle.UnpicklingError):
            raise TalusError(f"a process of the study ended with code {self.process.wait()}; is there enough memory?") from None
        if error is not None:
            raise error
        return answer

    def end(self) -> None:
        self.process.kill()
        self.process.wait()
        for pipe in (self.process.stdin, self.process.stdout):
            if pipe is not None:
                try:
                    pipe.close()
                except OSError:
                    pass  # what was not sent is not wanted any more


def work_in_processes(work: Callable[[Any], Any], jobs: Sequence[Any], processes: int) -> list[Any]:
    """`work` of every job, in their order, in so many processes at once. Ends them all where one fails, and on Ctrl-C."""
    workers = [_Worker() for _ in range(min(processes, len(jobs)))]
    free: queue.SimpleQueue[_Worker] = queue.SimpleQueue()
    for worker in workers:
        free.put(worker)

    def one(job: Any) -> Any:
        worker = free.get()
        try:
            return worker(work, job)
        finally:
            free.put(worker)

    threads = ThreadPoolExecutor(max(1, len(workers)), "talus study")
    try:
        calls = [threads.submit(one, job) for job in jobs]
        # In short waits: a signal that comes just before a thread begins to wait does not wake it.
        while any(not call.done() for call in calls) and not any(call.done() and call.exception() for call in calls):
            wait(calls, 0.1, "FIRST_EXCEPTION")
        for call in calls:
            if call.done():
                call.result()
        return [call.result() for call in calls]
    finally:
        threads.shutdown(wait=False, cancel_futures=True)
        for worker in workers:
            worker.end()


def serve() -> None:
    """What such a process does."""
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what is printed does not come between the answers
    while True:
        try:
            work, job = pickle.load(sys.stdin.buffer)
        except EOFError:
            return  # whoever asked is gone
        answer, error = None, None
        try:
            answer = work(job)
        except Exception as failure:  # told to whoever asked
            error = failure
        try:
            pickle.dump((answer, error), answers)
            answers.flush()
        except BrokenPipeError:
            os._exit(1)  # whoever asked is gone

