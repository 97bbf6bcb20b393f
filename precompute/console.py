"""What the command line shows: results on stdout; notices, errors and progress on stderr."""

import logging
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager

from rich.console import Console, RenderableType
from rich.progress import BarColumn, Progress, SpinnerColumn, TaskID, TextColumn, TimeElapsedColumn

from .notice import LOGGER_NAME

PATIENCE = 1.0  # s; a stage that is over sooner is not worth a line
PIPE_WIDTH = 200  # columns where no terminal has a say


def show(*renderables: RenderableType) -> None:
    """Tables and text on stdout; plain text where that is no terminal."""
    terminal = sys.stdout.isatty()
    console = Console(
        file=sys.stdout, width=None if terminal else PIPE_WIDTH, highlight=False, markup=False, emoji=False
    )
    # Captured, then written here: rich leaves the program by itself where a pipe is closed.
    with console.capture() as text:
        for renderable in renderables:
            console.print(renderable)
    sys.stdout.writelines(f"{line.rstrip()}\n" for line in text.get().splitlines())


def complain(text: str) -> None:
    """One line on stderr about what went wrong."""
    print(f"error: {' '.join(text.split())}", file=sys.stderr)


class _Lines(logging.Handler):
    """Each record is one line on stderr, wherever that leads at the time; what was said is not said again."""

    def __init__(self) -> None:
        super().__init__()
        self._said: set[str] = set()

    def emit(self, record: logging.LogRecord) -> None:
        word = "warning" if record.levelno >= logging.WARNING else "note"
        line = f"{word}: {' '.join(record.getMessage().split())}"
        if line not in self._said:
            self._said.add(line)
            print(line, file=sys.stderr)


@contextmanager
def notices() -> Iterator[None]:
    """Show the notices and warnings of the library on stderr."""
    logger, handler = logging.getLogger(LOGGER_NAME), _Lines()
    before = logger.level, logger.propagate
    logger.addHandler(handler)
    logger.setLevel(logging.INFO)
    logger.propagate = False
    try:
        yield
    finally:
        logger.removeHandler(handler)
        logger.setLevel(before[0])
        logger.propagate = before[1]


class _SlowStages(Progress):
    """Lines for those stages only that last longer than PATIENCE."""

    def get_renderables(self) -> Iterable[RenderableType]:
        yield self.make_tasks_table([task for task in self.tasks if (task.elapsed or 0.0) > PATIENCE])


@contextmanager
def progress() -> Iterator[Callable[[str, float | None], None]]:
    """A callable to tell the stage and the fraction of it that is done; shown where stderr is a terminal.

    What follows a colon in a stage's name is a detail of it: "solving: 40 of 60" is no new stage.
    """
    if not sys.stderr.isatty():
        yield lambda stage, fraction: None
        return
    columns = (SpinnerColumn(), TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    console = Console(stderr=True, highlight=False, emoji=False)
    with _SlowStages(*columns, console=console) as lines:
        tasks: dict[str, TaskID] = {}

        def tell(stage: str, fraction: float | None) -> None:
            name = stage.partition(":")[0]
            if name not in tasks:
                _finish(lines)
                tasks[name] = lines.add_task(stage, total=None)
            total = None if fraction is None else 1.0
            lines.update(tasks[name], description=stage, total=total, completed=fraction or 0.0)

        yield tell
        _finish(lines)


def _finish(lines: Progress) -> None:
    for task in lines.tasks:
        lines.update(task.id, total=1.0, completed=1.0)
