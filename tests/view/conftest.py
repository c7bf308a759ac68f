# SPDX-License-Identifier: GPL-2.0-only
"""One browser for all tests of the page. Without Chromium they are skipped, or fail where the environment says
MDANIM_BROWSER=required."""

import os

import pytest
from browser import Browser, missing


@pytest.fixture(scope="session")
def browser():
    """One browser for all tests."""
    if why := missing():
        assert os.environ.get("MDANIM_BROWSER") != "required", why
        pytest.skip(why)
    opened = Browser(1000, 640)
    yield opened
    opened.close()


@pytest.fixture
def quiet(browser):
    """No error in the console, no breach of the page's policy."""
    yield
    assert not [message for message in browser.messages() if "404" not in message]
