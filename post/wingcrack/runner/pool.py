"""Tasks side by side on this machine, as processes that threads wait for."""

from __future__ import annotations

import signal
import subprocess
import threading
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor, as_completed
from typing import Generic, TypeVar

from wingcrack.runner.task import Outcome, Task, run_task

Name = TypeVar("Name")


class Pool(Generic[Name]):
    """Runs so many at a time; whatever ends the call ends what is running, too."""

    def __init__(self, parallel: int) -> None:
        self._parallel = parallel
        self._children: set[subprocess.Popen[bytes]] = set()
        self._lock = threading.Lock()
        self._stopped = False

    def run_all(
        self,
        names: Iterable[Name],
        run: Callable[[Name], Outcome],
        progress: Callable[[Name, Outcome], None],
    ) -> dict[Name, Outcome]:
        """Outcome by name; `progress` is called with each as it ends.

        `run` must be able to work in a thread; it runs its task by `run_task` of this pool.
        """
        outcomes: dict[Name, Outcome] = {}
        with ThreadPoolExecutor(self._parallel) as threads:
            waiting = {threads.submit(run, name): name for name in names}
            try:
                for done in as_completed(waiting):
                    name = waiting[done]
                    outcomes[name] = done.result()
                    progress(name, done.result())
            except BaseException:
                threads.shutdown(wait=False, cancel_futures=True)
                self._stop()
                raise
        return outcomes

    def run_task(self, task: Task) -> Outcome:
        """Run a task so that it ends with the pool."""
        return run_task(task, self._start, self._forget)

    def _start(self, start: Callable[[], subprocess.Popen[bytes]]) -> subprocess.Popen[bytes]:
        with self._lock:
            if self._stopped:
                raise KeyboardInterrupt
            child = start()
            self._children.add(child)
        return child

    def _forget(self, child: subprocess.Popen[bytes]) -> None:
        with self._lock:
            self._children.discard(child)

    def _stop(self) -> None:
        with self._lock:
            self._stopped = True
            for child in self._children:
                child.send_signal(signal.SIGTERM)
