"""The order of the tests."""

import pytest


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """The libraries for other platforms first: minutes of compiler and wine, beside which the rest runs."""
    items.sort(key=lambda item: item.path.name != "test_platforms.py")
