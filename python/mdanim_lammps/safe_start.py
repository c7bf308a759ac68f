# SPDX-License-Identifier: GPL-2.0-only
"""The file with which every child process begins (children.py): ``python safe_start.py MODULE ARGUMENTS`` calls ``MODULE.main``.

With ``-m`` or ``-c`` Python would take modules from the current folder, where a stranger's ``numpy.py`` may lie beside a scene.
"""

import atexit
import gc
import sys


def is_safe() -> bool:
    """Whether Python was told to put no folder of a script first on the path (``-P``, ``-I``, PYTHONSAFEPATH)."""
    return bool(sys.flags.isolated or getattr(sys.flags, "safe_path", False))


def few_collections() -> None:
    """Look for garbage a tenth as often, and not when the process ends.

    Nearly all that a short command makes are modules, which stay: this is a tenth of the time of ``mdanim-lammps picture``, and
    of the start of a process that draws.
    """
    gc.set_threshold(10_000)
    atexit.register(gc.freeze)


if __name__ == "__main__":
    if not is_safe():
        del sys.path[0]  # the folder of this file, whose modules are not those of Python
    few_collections()
    from importlib import import_module
    from importlib.util import module_from_spec, spec_from_file_location

    # The package of the parent, wherever the parent has it from.
    spec = spec_from_file_location("mdanim_lammps", __file__.removesuffix("safe_start.py") + "__init__.py")
    assert spec and spec.loader, "this file lies in the package"
    sys.modules["mdanim_lammps"] = package = module_from_spec(spec)
    spec.loader.exec_module(package)
    sys.argv[:2] = sys.argv[1:2]
    import_module("mdanim_lammps.errors").for_a_shell()  # what a child says is spelled by its parent
    import_module(sys.argv[0]).main()
