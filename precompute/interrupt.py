"""Ctrl-C between the steps of an FMU, not inside of one."""

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def deferred_interrupt() -> Iterator[Callable[[], None]]:
    """Hold Ctrl-C back; the callable that is given raises KeyboardInterrupt if there was one.

    Inside an FMU whose code is Python the exception would be taken for a fault of the FMU.
    """
    pressed = threading.Event()

    def check() -> None:
        if pressed.is_set():
            raise KeyboardInterrupt

    if threading.current_thread() is not threading.main_thread():
        yield check  # signals go to the main thread
        return
    before = signal.signal(signal.SIGINT, lambda number, frame: pressed.set())
    try:
        yield check
    finally:
        signal.signal(signal.SIGINT, before)
