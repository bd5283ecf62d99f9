"""The package `pipeline` under the name of the distribution: `import kouros` gives the very same modules and classes.

In a wheel this folder lies beside `pipeline`; an editable install has the folder above it on the path.
"""

import sys
from collections.abc import Sequence
from importlib import import_module
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from importlib.util import find_spec
from types import CodeType, ModuleType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pipeline import *  # noqa: F403 - what it hands on, for those who check types
else:
    _OURS, _THEIRS = "kouros", "pipeline"

    class _Alias(MetaPathFinder, Loader):
        """Finds `kouros.motions` and the like: the module `pipeline.motions` itself, and no second copy of it."""

        def find_spec(self, fullname: str, *_: Sequence[str] | ModuleType | None) -> ModuleSpec | None:
            ours, _, rest = fullname.partition(".")
            if ours != _OURS or not rest:
                return None
            true = find_spec(f"{_THEIRS}.{rest}")
            return true and ModuleSpec(
                fullname, self, origin=true.origin, is_package=true.submodule_search_locations is not None
            )

        def create_module(self, spec: ModuleSpec) -> ModuleType:
            module = import_module(_THEIRS + spec.name.removeprefix(_OURS))
            spec.loader_state = module.__spec__
            return module

        def exec_module(self, module: ModuleType) -> None:
            # Python has just said that the module is ours.
            module.__spec__ = module.__spec__.loader_state

        def get_code(self, fullname: str) -> CodeType | None:
            """Return what `python -m kouros` runs."""
            true = find_spec(_THEIRS + fullname.removeprefix(_OURS))
            return true.loader.get_code(true.name)

    sys.meta_path.insert(0, _Alias())
    sys.modules[__name__] = import_module(_THEIRS)
