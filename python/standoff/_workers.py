# SPDX-License-Identifier: Apache-2.0
"""Threads that work ahead for a thread that takes the results, and that never keep Python from ending."""

from __future__ import annotations

import atexit
import os
import sys
import threading
from collections import deque
from collections.abc import Callable
from typing import Any, Generic, TypeVar, cast

Result = TypeVar("Result")

_IDLE = 0.1  # seconds without work after which a thread ends; starting one takes a ten-thousandth


class _Starts:
    """Lets threads start until Python ends. CPython up to 3.12 crashes where a thread begins after that: it gets what
    the interpreter keeps of it, which is gone. A daemon thread that asks for results may want a thread at any time."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._ended = False

    def start(self, thread: threading.Thread) -> bool:
        """Returns when the thread has begun; False if it cannot."""
        with self._lock:
            if self._ended:
                return False
            try:
                thread.start()
            except RuntimeError:
                return False
            return True

    def end(self) -> None:
        """Waits for a thread that is about to begin."""
        with self._lock:
            self._ended = True

    def forget(self) -> None:
        """After a fork: the thread that held the lock is not there."""
        self._lock = threading.Lock()


_starts = _Starts()
atexit.register(_starts.end)
os.register_at_fork(after_in_child=_starts.forget)


class Stopped(BaseException):
    """Nobody waits for the result of a task any more."""


class Task(Generic[Result]):
    """A call of the work: what it is called with, and what came of it."""

    __slots__ = ("arguments", "done", "error", "result")

    def __init__(self, arguments: tuple[Any, ...]) -> None:
        self.arguments = arguments
        self.done = False
        self.result: Result | None = None
        self.error: BaseException | None = None


class Workers(Generic[Result]):
    """Calls work(check, *arguments) in up to `most` threads. Work may call check() now and then: it raises Stopped.

    A ThreadPoolExecutor refuses tasks as soon as the main thread ends, also those of threads that Python waits for. In
    a daemon thread the error and its traceback meet an interpreter that is going away, and abort the process. And
    Python does not end before such a pool has worked off all its tasks.

    Here no call ever fails because Python ends. The threads are not daemons: Python waits for them. But they stop at
    once when nobody can ask for results any more, and wherever no thread can work (Python ends, or the system has no
    more threads), the thread that asks for a result does the work.
    """

    def __init__(self, most: int, work: Callable[..., Result]) -> None:
        self._most = most
        self._work = work
        lock = threading.RLock()  # the garbage collector may close a generator wherever this is held
        self._handed_in = threading.Condition(lock)
        self._worked_off = threading.Condition(lock)
        self._tasks: deque[Task[Result]] = deque()  # those that nobody has begun
        self._threads: set[threading.Thread] = set()
        self._idle = 0
        self._closed = False
        self._asking = threading.current_thread()

    def submit(self, *arguments: Any) -> Task[Result]:
        """Hands in a call of the work."""
        task: Task[Result] = Task(arguments)
        with self._handed_in:
            self._asking = threading.current_thread()
            self._tasks.append(task)
            if len(self._tasks) <= self._idle:
                self._handed_in.notify()
            elif len(self._threads) < self._most and not self._stopped():
                self._start_thread()
        return task

    def result(self, task: Task[Result]) -> Result:
        """The result of the task, when it is done; raises its error if it has one."""
        if (error := self.error(task)) is not None:
            try:
                raise error
            finally:
                del error  # whose traceback holds this frame
        return cast("Result", task.result)

    def error(self, task: Task[Result]) -> BaseException | None:
        """The error of the task, when it is done."""
        with self._worked_off:
            self._asking = threading.current_thread()
            while not task.done and self._threads:
                self._worked_off.wait()
            if not task.done:
                self._tasks.remove(task)
        if not task.done:
            self._do(task, lambda: None)
        return task.error

    def close(self) -> None:
        """Stops the work, and waits until it has stopped."""
        if sys.is_finalizing():
            return  # what threads are left stand still, maybe with the lock
        with self._handed_in:
            self._closed = True
            self._handed_in.notify_all()
            threads = list(self._threads)
        for thread in threads:
            # Not alive: Ctrl-C came before it was started. This one: the garbage collector closes a generator here.
            if thread.is_alive() and thread is not threading.current_thread():
                thread.join()

    def _stopped(self) -> bool:
        """Whether nobody can ask for results any more: closed, or Python ends and does not wait for who asked last."""
        if self._closed:
            return True
        return not threading.main_thread().is_alive() and (self._asking.daemon or not self._asking.is_alive())

    def _check(self) -> None:
        if self._stopped():
            raise Stopped

    def _start_thread(self) -> None:
        thread = threading.Thread(target=self._run, name="standoff", daemon=False)
        self._threads.add(thread)
        if not _starts.start(thread):
            self._threads.discard(thread)

    def _run(self) -> None:
        while (task := self._next()) is not None:
            try:
                self._do(task, self._check)
            except Stopped:
                with self._handed_in:
                    self._tasks.appendleft(task)

    def _next(self) -> Task[Result] | None:
        """The next task of a thread; None if it is to end."""
        with self._handed_in:
            self._idle += 1
            in_time = True
            while in_time and not self._tasks and not self._stopped():
                in_time = self._handed_in.wait(_IDLE)
            self._idle -= 1
            if self._tasks and not self._stopped():
                return self._tasks.popleft()
            self._threads.discard(threading.current_thread())
            self._worked_off.notify_all()
            return None

    def _do(self, task: Task[Result], check: Callable[[], None]) -> None:
        result, error = None, None
        try:
            result = self._work(check, *task.arguments)
        except Stopped:
            raise
        except BaseException as caught:
            error = caught
        with self._worked_off:
            task.result, task.error, task.done = result, error, True
            self._worked_off.notify_all()
        del task, error  # whose traceback holds this frame
