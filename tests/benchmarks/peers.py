"""Which peers there are; each is optional, and one that cannot be imported is a line of the table and not a failure."""

import ctypes
import importlib
import importlib.metadata
import importlib.util
import sys
import warnings
from pathlib import Path
from types import ModuleType, SimpleNamespace


def peer(name: str) -> ModuleType | None:
    """Return the module of a peer, or None after a line that says why there is none."""
    try:
        if name == "openseespy.opensees":
            _bring_blas()
        if name == "pyrotd":
            _stand_in_for_setuptools()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # a peer's own deprecations are not ours to mend
            return importlib.import_module(name)
    except (ImportError, OSError, RuntimeError) as problem:
        reason = str(problem).partition("\n")[0]
        print(f"{name}: not installed ({reason})")
        return None


def _bring_blas() -> None:
    # The wheel carries the BLAS that its LAPACK needs, but LAPACK does not know where: it finds one already loaded.
    spec = importlib.util.find_spec("openseespylinux")
    for folder in (spec.submodule_search_locations or ()) if spec else ():
        blas = Path(folder) / "lib" / "libblas.so.3"
        if blas.exists():
            ctypes.CDLL(str(blas), mode=ctypes.RTLD_GLOBAL)


def _stand_in_for_setuptools() -> None:
    # pyrotd asks pkg_resources for its own version; setuptools no longer has that module.
    if importlib.util.find_spec("pkg_resources") is None:
        stand_in = ModuleType("pkg_resources")
        stand_in.get_distribution = (  # type: ignore[attr-defined]
            lambda name: SimpleNamespace(version=importlib.metadata.version(name))
        )
        sys.modules["pkg_resources"] = stand_in
