# SPDX-License-Identifier: GPL-2.0-only
"""A feature that only tests know, with all that a feature may have: held parts shake, tethers join objects, and forces depend on
what was before. Its fix is tests/lab/plugin/fix_mdanim_test_rig.cpp."""
