"""Reports from the galleries as people write them: words in the languages of the pages, CSV files and workbooks."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from babel.messages.pofile import read_po
from openpyxl import Workbook

from pipeline.errors import InputError
from pipeline.event.found import STATES, FoundObject, read_found, state_said
from pipeline.resources import resource

KNOWN = {"1", "2", "3", "1913.20"}


@pytest.mark.parametrize("code", ["it", "es", "el", "ja"])
def test_the_words_of_the_sheets_are_taken_back(code: str) -> None:
    """A sheet prints the words of its catalogue; whoever types them must be understood."""
    with (resource("templates", "catalogues") / code / "LC_MESSAGES" / "kouros.po").open("rb") as stream:
        catalogue = read_po(stream)
    for state in STATES:
        word = str(catalogue[state].string)
        assert word
        assert state_said(word) == (state, None)
        assert state_said(word.upper()) == (state, None)


@pytest.mark.parametrize(
    ("words", "state", "metres"),
    [
        ("moved 2 cm", "moved", 0.02), ("Moved about 2 cm", "moved", 0.02), ("moved by 3/8 in", "moved", 0.009525),
        ("spostata di 3 mm", "moved", 0.003), ("desplazado 2,5 cm", "moved", 0.025), ("CAÍDO", "fallen", None),
        ("μετακινήθηκε κατά 2 εκ.", "moved", 0.02), ("2cm移動", "moved", 0.02), ("ＭＯＶＥＤ　２ｃｍ", "moved", 0.02),
        ("移動 2センチ", "moved", 0.02), ("in piedi.", "standing", None), ("落下・転倒", "fallen", None),
    ],
)  # fmt: skip
def test_a_state_in_words(words: str, state: str, metres: float | None) -> None:
    found, moved = state_said(words)
    assert found == state
    assert moved == (None if metres is None else pytest.approx(metres))


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("asleep", "is not known; use one of standing"), ("moved 2", "has no unit: write it such as 2 cm"),
        ("moved 2-3 cm", "is a range"), ("moved 2 kg", "is no length"), ("moved 999 m", "is more than 100 m"),
        ("fallen 2 m", "a distance goes with moved"), ("not fallen", "is not known"), ("", "is not known"),
    ],
)  # fmt: skip
def test_words_that_cannot_be_are_refused(words: str, message: str) -> None:
    with pytest.raises(InputError, match=re.escape(message)):
        state_said(words)


def test_a_table_is_read_in_any_of_its_forms(tmp_path: Path) -> None:
    file = tmp_path / "found.csv"
    for text in (
        "object,state\n1,Fallen\n2,moved 2 cm\n1,standing\n3,\n",
        "\ufeffOggetto;Trovato\r\n1;in piedi\r\n2;spostato di 2 cm\r\n",
        "資料\t結果\n1\t自立\n2\t2cm移動\n",
        "object_number,title,reported,moved\n1,A vase,standing,\n2,,moved,20 mm\n",
    ):
        file.write_text(text, encoding="utf-8")
        assert read_found(file, KNOWN) == {
            "1": FoundObject("standing"), "2": FoundObject("moved", pytest.approx(0.02))
        }, text  # fmt: skip


def test_a_workbook_is_read_and_numbers_stay_texts(tmp_path: Path) -> None:
    book = Workbook()
    sheet = book.active
    assert sheet is not None
    for row in (["object", "state", "note", "who"], [1913.2, "broken", "handle", "A. Smith"], [2, None, None, None]):
        sheet.append(row)
    sheet["A2"].number_format = "0.00"
    file = tmp_path / "found.xlsx"
    book.save(file)
    assert read_found(file, KNOWN) == {"1913.20": FoundObject("broken", None, "handle", "A. Smith")}
    sheet["B3"] = "=A2"
    book.save(file)
    with pytest.raises(InputError, match=r"row 3: .*formula"):
        read_found(file, KNOWN)


def test_rows_are_refused_by_number_and_nothing_of_the_file_counts(tmp_path: Path) -> None:
    file = tmp_path / "found.csv"
    for text, message in (
        ("object,state\n9,fallen\n", "row 2: object '9' is not on display"),
        ("object,state\n1,fallen\n2,asleep\n", "row 3: state 'asleep' is not known; use one of standing"),
        ("object,state\n" + "1,asleep\n" * 9, "and 4 more rows"),
        ("number;state\n1;fallen\n", "row 1: give the columns object and state"),
        ("object,state,found\n1,fallen,moved\n", "two columns hold the state"),
        ("object,state\n1,fallen,2\n", "row 2: 3 cells, the header has 2"),
        ("object,state,moved\n1,,2 cm\n", "row 2: a distance without a state"),
        ("object,state,moved\n1,fallen,2 cm\n", "row 2: a distance goes with moved"),
        ("object,state,note\n1,fallen," + "x" * 2001 + "\n", "row 2: note has more than 2000 characters"),
        ("", "give the columns object and state"),
    ):
        file.write_text(text, encoding="utf-8")
        with pytest.raises(InputError, match=re.escape(message)):
            read_found(file, KNOWN)
    file.write_bytes(b"object,state\n1,ca\xeddo\n")
    with pytest.raises(InputError, match=r"row 2: "):
        read_found(file, KNOWN)
    file.write_bytes(b"PK\x03\x04 no zip")
    with pytest.raises(InputError, match="cannot be read"):
        read_found(file, KNOWN)
