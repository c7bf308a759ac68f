# SPDX-License-Identifier: GPL-2.0-only
"""Words of a scene that belong to this feature."""

SWITCHES = {"gravity": "a gravity vector that is not zero"}
