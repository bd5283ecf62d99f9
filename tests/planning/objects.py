"""Objects to act on, made up: in galleries and cases, some of them on furniture that has to be fastened first."""

from random import Random

from pipeline.mitigate.saying import ANCHORED
from pipeline.planning.errands import Advised

MEASURES = ("wax", "putty", "ties", "clips", "clamps", "fasten", "horizontal_isolator", "anchor", "close_hooks")


def advised(
    number: str, measure: str, loss: float, left: float = 0.0, *, gallery: str = "East", case: str = "",
    anchored: bool = False, sentence: str = "Do it.", title: str = "Vase",
    check: bool = False,
) -> Advised:  # fmt: skip
    """An object that something is advised for."""
    words = f"{ANCHORED} {sentence}" if anchored else sentence
    return Advised(
        number, title, gallery, case, measure, measure.title(), words, loss, left, f"east.html#{number}", check
    )


def collection(size: int, seed: int, galleries: int = 2, removed: float = 0.0) -> list[Advised]:
    """Objects at random, the same for the same seed."""
    random = Random(seed)
    found = []
    for index in range(size):
        measure = "remove" if random.random() < removed else random.choice(MEASURES)
        loss = random.randint(52, 512) / 512.0 * random.choice((1.0, 2.0, 3.0, 10.0))
        found.append(
            advised(
                f"{index:05}",
                measure,
                loss,
                loss * random.choice((0.0, 0.0, 0.05, 0.2)),
                gallery=f"Room {random.randrange(galleries)}",
                case=random.choice(("", "", "A", "B")),
                anchored=measure not in ("anchor", "remove") and random.random() < 0.25,
            )
        )
    return found
