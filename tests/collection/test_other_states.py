"""Sizes of a thing in another state, and what is no fraction."""

from pathlib import Path

import pytest

from pipeline.collection.reading import read_items
from tests.museum import load_mapping


@pytest.mark.parametrize(
    ("text", "sizes"),
    [
        ("H 320 x W 240 (open 460) x D 42 cm", (3.2, 2.4, 0.42)),
        ("H 320 x W 240 (460 open) x D 42 cm", (3.2, 2.4, 0.42)),
        ("320 x 240 (460 with wings open) x 42 cm", (3.2, 2.4, 0.42)),
        ("H 320 x W 240 (aperto 460) x D 42 cm", (3.2, 2.4, 0.42)),
        # From 2.4 to 4.6 m: which it is now nobody says, and no more than that is lost.
        ("H 320 x W 240/460 x D 42 cm", (3.2, None, 0.42)),
        ("H 12 1/2 x W 10 3/64 x D 4 in.", (0.3175, 0.255191, 0.1016)),
    ],
)
def test_sizes_in_another_state(tmp_path: Path, text: str, sizes: tuple[float | None, ...]) -> None:
    (tmp_path / "mapping.toml").write_text(
        '[source]\nformat = "csv"\nencoding = "utf-8"\ndelimiter = ","\n[museum]\nname = "M"\n'
        '[columns.object_number]\ncolumn = "No"\n[columns.gallery]\ncolumn = "Gallery"\n'
        '[dimensions]\ncolumns = ["Size"]\n'
    )
    (tmp_path / "objects.csv").write_text(f'No,Gallery,Size\n1,G,"{text}"\n')
    (item,) = read_items(tmp_path / "objects.csv", load_mapping(tmp_path / "mapping.toml")).items
    for found, size in zip((item.height_m, item.width_m, item.depth_m), sizes, strict=True):
        assert found is size is None or found == pytest.approx(size, rel=1e-5)
