"""Where sensors stood, by the words of their headers: on a deck, in the free field, in a borehole.

The truth is the header as it was written, and what stands on the ground of a museum.
"""

from __future__ import annotations

from pathlib import Path

import obspy
import pytest

from pipeline.motions import MotionError
from pipeline.motions.formats import header_facts
from pipeline.motions.gathering import gather
from pipeline.motions.proposing import Answers, propose
from tests.motions.formats import specimens as hand


def bridge(folder: Path, *channels: tuple[int, int, str, str]) -> list[Path]:
    """Files of a bridge: the recorder's number, the station's, direction and place, as CSMIP writes them."""
    made = []
    for own, number, direction, place in channels:
        named = f"Chan {own:2d}: {direction}      (Sta Chn: {number:2d})     Location: {place}"
        text = hand.csmip(2, (direction,)).replace(f"Chan  1: {direction}\r\n".encode(), f"{named}\r\n".encode())
        made.append(folder / f"chan{number:03d}.v2")
        made[-1].write_bytes(text)
    return made


def cosmos(place: str, folder: Path, name: str = "a.v1c") -> Path:
    (folder / name).write_bytes(hand.cosmos().replace(b"Location:Ground", f"Location:{place}".encode()))
    return folder / name


@pytest.mark.parametrize(
    ("line", "place", "depth"),
    [
        ("Sta Chan  39:Up      (Rcrdr Chan  ?) Location:DH array 10.7m", "DH array 10.7m", 10.7),
        ("Chan  4: 360 Deg  (Sta Chn:  4)  Location: Downhole 100 ft", "Downhole 100 ft", 30.48),
        ("Chan  6:  Up      (Sta Chn: 11)     Location: Deck Level near Abut 1  ", "Deck Level near Abut 1", None),
        ("Chan  6:  Up  Location: Deck 4 m from Abut 1", "Deck 4 m from Abut 1", None),
        ("Sta Chan   1  90    HNE           Location:   00", None, None),
        ("Sta Chan  1: 360 deg (Rcrdr Chan  1)", None, None),
    ],
)
def test_words_of_a_header(line, place, depth):
    found = header_facts.sensor(line)
    assert (found.get("sensor_place"), found.get("sensor_depth")) == (place, pytest.approx(depth))


def test_channels_of_two_recorders_have_the_station_s_numbers(tmp_path):
    """Each recorder of a bridge counts its own channels from one; both have a sixth that points up."""
    files = bridge(tmp_path, (6, 11, " Up", "Deck"), (6, 19, " Up", "Base of Bent 3"))
    assert [obspy.read(str(file))[0].id for file in files] == [".00001.11.HNZ", ".00001.19.HNZ"]


def test_three_of_the_free_field_are_taken_and_the_bridge_is_left(tmp_path):
    deck = [(6, 11, " Up", "Deck Level near Abut 1"), (7, 12, " 90 Deg", "Deck Level near Abut 1")]
    ground = [(1, 1, " 90 Deg", "Free Field"), (2, 2, " Up", "Free Field"), (3, 3, "360 Deg", "Free Field")]
    made, left = propose(gather(bridge(tmp_path, *deck, *ground)), Answers())
    assert not left
    (proposal,) = made
    assert sorted(proposal.record.files) == ["chan001.v2", "chan002.v2", "chan003.v2"]
    assert any("free field" in told and ".00001.11.HNZ" in told for told in proposal.told)


def test_where_each_stood_is_told_where_somebody_has_to_choose(tmp_path):
    every = [(n, n, way, f"{n}th floor") for n, way in enumerate((" Up", " 90 Deg", "360 Deg", " 90 Deg"), start=1)]
    ((proposal,), _) = propose(gather(bridge(tmp_path, *every)), Answers())
    assert proposal.record is None
    assert ".00001.02.HNE (90.0, 2th floor)" in proposal.questions[0].text


def test_the_ground_and_the_deck_are_no_record(tmp_path):
    from pipeline.motions.reading import read_record

    places = ((1, 1, " 90 Deg", "Free Field"), (11, 11, " Up", "Deck"), (3, 3, "360 Deg", "Free Field"))
    ((proposal,), _) = propose(gather(bridge(tmp_path, *places)), Answers())
    with pytest.raises(MotionError, match=r"sensor's place 'Free Field' and 'Deck'"):
        read_record(tmp_path, proposal.record)


def test_a_borehole_is_told_by_the_header_alone(tmp_path):
    made, left = propose(gather([cosmos("DH array 10.7m", tmp_path)]), Answers())
    assert not made
    assert "in a borehole, and a museum stands on the surface" in left[0].reason
    ((proposal,), _) = propose(gather([cosmos("DH array 0.0m", tmp_path, "b.v1c")]), Answers())
    assert any("DH array 0.0m" in told for told in proposal.told)
