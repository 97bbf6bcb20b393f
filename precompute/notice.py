"""Things a user should know that are no mistake: one line each, on the logger `modalfmu`.

The library never prints: the command line shows these lines on stderr; a script sees them by
`logging.basicConfig(level="INFO")`.
"""

import logging

LOGGER_NAME = "modalfmu"


def notice(text: str) -> None:
    """Say one line that needs no action."""
    logging.getLogger(LOGGER_NAME).info(text)


def warning(text: str) -> None:
    """Say one line about something that probably needs action."""
    logging.getLogger(LOGGER_NAME).warning(text)
