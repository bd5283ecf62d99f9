"""What a worker compiles on a first night, while the process that started it compiles what its charts need."""

from pipeline.analysis.model_runs import prepare
from pipeline.kernels import is_kept
from pipeline.models.standing import STANDING
from pipeline.motions.synthesis import sine

_KERNEL = "standing.standing_batch"
"""Takes longest to compile, and all that stands needs it: two workers that meet it at once compile it both."""


def to_compile() -> bool:
    """Return whether there is something that a worker may as well compile at once."""
    return not is_kept(_KERNEL)


def compile_ahead(_shared: None, _task: None) -> None:
    """Compile it, by running it once on next to nothing."""
    STANDING.run(sine(1.0, 2.0, 1.0).excitation(0.0), prepare(STANDING, STANDING.trials.sample), 1, False)
