"""What fits of several files share."""

import pytest
from support.closed_form_solver import registered


@pytest.fixture(scope="module")
def closed_form():
    """The runs of a fit are closed forms."""
    with registered() as name:
        yield name
