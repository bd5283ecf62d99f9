"""Lists of museums of nature, of musical instruments and of technology: specimens, cases and spots, thousands."""

from __future__ import annotations

from pathlib import Path

import pytest

from pipeline.analysis.classify import classify
from pipeline.analysis.told import as_displayed
from pipeline.collection.mapping import load_mapping
from pipeline.collection.places import beside_case
from pipeline.collection.reading import read_items
from pipeline.night.importing import Proposed, proposed
from pipeline.records import Furniture, Item, Support
from pipeline.tables.held_rows import told_by

NATURE = """Catalog #,Specimen,Preparation,Hall,Exhibit unit,Height (in),Length (in),Width (in),Wt (lb),Notes
V-12,Allosaurus fragilis,mounted cast,Dinosaur Hall,Open platform A,108,300,60,"1,450",bolted to platform
M-433,American bison,full taxidermy mount,Plains Hall,Diorama 4,72,110,36,620,
B-2211,Great horned owl,taxidermy mount on perch,Bird Gallery,"Case 7, shelf 2",22,14,12,4,
MN-331,Amethyst geode,mineral,Minerals,Open plinth 3,58,34,28,"1,900",stands on steel cradle
P-90,"Ammonite, polished slab",fossil,Deep Time,on wall,40,40,2,140,hung with cleats
M-2001,Blue whale model,fibreglass,Ocean Hall,suspended from ceiling,120,1020,150,"8,000",
M-2050,Elk head with antlers,taxidermy shoulder mount,Plains Hall,wall,60,44,40,175,
B-9,Ostrich egg,egg,Bird Gallery,"Case 7, shelf 1",6,5,5,3,on ring stand
"""
INSTRUMENTS = """N. inv.;Strumento;Materiali;Sala;Vetrina / posizione;H cm;L cm;P cm
1;Clavicembalo;cipresso, abete;Sala 2;pedana;92;238;88
2;Violino;acero, abete;Sala 1;vetrina 3, appeso;59;21;10
3;Violoncello;acero, abete;Sala 1;vetrina 4, su supporto;122;44;28
4;Pianoforte a coda;palissandro;Sala 4;a pavimento;101;255;148
5;Corno naturale;ottone;Sala 3;vetrina 6, ripiano 2;22;38;26
6;Timpano;rame, pelle;Sala 5;su treppiede;85;66;66
"""


def listed(folder: Path, text: str) -> tuple[Proposed, dict[str, Item]]:
    file = folder / "list.csv"
    file.write_text(text, encoding="utf-8")
    read = proposed(str(file))
    return read, {item.object_number: item for item in read.reading.items}


def test_specimens_with_remarks_on_how_they_are_held(tmp_path: Path) -> None:
    read, items = listed(tmp_path, NATURE)
    assert not read.guess.left  # every column is read
    assert items["V-12"].title == "Allosaurus fragilis"
    assert items["B-9"].title == "Ostrich egg"
    # Pounds to kilograms: 1,450 x 0.45359237, exactly.
    assert items["V-12"].mass_kg == pytest.approx(657.7089365, rel=1e-12)
    assert items["M-433"].mass_kg == pytest.approx(281.2272694, rel=1e-12)
    assert any("thousands are parted by ','" in doubt for doubt in read.guess.doubts)
    held = {number: classify(item).support for number, item in items.items()}
    assert held == {
        "V-12": Support.FASTENED,
        "M-433": Support.FREESTANDING,
        "B-2211": Support.FREESTANDING,
        "MN-331": Support.FREESTANDING,
        "P-90": Support.HUNG,
        "M-2001": Support.SUSPENDED,
        "M-2050": Support.HUNG,
        "B-9": Support.FREESTANDING,
    }


def test_a_column_of_cases_that_names_spots_too(tmp_path: Path) -> None:
    _, items = listed(tmp_path, INSTRUMENTS)
    assert {number: item.case for number, item in items.items()} == {
        "1": "",
        "2": "vetrina 3",
        "3": "vetrina 4",
        "4": "",
        "5": "vetrina 6",
        "6": "",
    }
    shown = {number: as_displayed(item) for number, item in items.items()}
    assert shown["1"].furniture is shown["4"].furniture is Furniture.FLOOR
    assert shown["2"].support is Support.HUNG
    assert shown["3"].support is Support.FREESTANDING


def test_a_mapped_column_of_cases_says_how_things_are_held(tmp_path: Path) -> None:
    file = tmp_path / "list.csv"
    file.write_text('no,room,case\n1,A,pedestal 4\n2,A,on platform\n3,A,"case 3, bolted"\n4,A,Vitrine 5\n', "utf-8")
    (tmp_path / "m.toml").write_text(
        '[source]\nformat = "csv"\nencoding = "utf-8"\ndelimiter = ","\n[museum]\nname = "M"\n'
        '[columns.object_number]\ncolumn = "no"\n[columns.gallery]\ncolumn = "room"\n'
        '[columns.case]\ncolumn = "case"\n',
        "utf-8",
    )
    shown = [as_displayed(item) for item in read_items(file, load_mapping(tmp_path / "m.toml")).items]
    assert [item.case for item in shown] == ["pedestal 4", "", "case 3, bolted", "Vitrine 5"]
    assert [item.support for item in shown] == [None, Support.FREESTANDING, Support.FASTENED, None]
    assert beside_case("case 3, bolted") == "bolted"
    assert beside_case("Vitrine 5") == ""


def weights(folder: Path, delimiter: str, head: str, *cells: str) -> tuple[list[float | None], Proposed]:
    rows = (delimiter.join((f"A.{n}", f"Thing {n}", "Gallery 1", f'"{cell}"')) for n, cell in enumerate(cells, 1))
    read, items = listed(folder, "\n".join((delimiter.join(("Inv. no.", "Object", "Gallery", head)), *rows)) + "\n")
    return [item.mass_kg for item in items.values()], read


@pytest.mark.parametrize("mark", [",", "."])
@pytest.mark.parametrize("delimiter", [",", ";"])
def test_thousands_beside_hundreds(tmp_path: Path, delimiter: str, mark: str) -> None:
    found, _ = weights(tmp_path, delimiter, "Weight (kg)", "410", "780", f"1{mark}350", "32")
    assert found == [410.0, 780.0, 1350.0, 32.0]


def test_three_decimals_are_no_thousands(tmp_path: Path) -> None:
    # Scales that show grams: nothing else in the column comes near a hundred.
    found, _ = weights(tmp_path, ";", "Weight (kg)", "1,350", "12,400", "3,125", "8")
    assert found == [1.35, 12.4, 3.125, 8.0]


@pytest.mark.parametrize("blank", [" ", "\u00a0", "\u202f", "'", "\u2019"])
def test_thousands_parted_by_blanks_and_apostrophes(tmp_path: Path, blank: str) -> None:
    found, read = weights(tmp_path, ";", "Gewicht (kg)", "410", f"1{blank}350", "32", "7", "12")
    assert found == [410.0, 1350.0, 32.0, 7.0, 12.0]
    assert not read.reading.rejected


@pytest.mark.parametrize(
    ("words", "support"),
    [
        *((word, Support.HUNG) for word in ("appese", "colgados", "accrochées", "pendurada", "κρεμασμένη", "obješena")),
        *((word, Support.HUNG) for word in ("agățată", "aufgehängt", "asılı", "penjada", "окачена", "повешена")),
        *((word, Support.SUSPENDED) for word in ("podwieszona", "zavěšené", "підвішений", "upphängt", "suspendată")),
        *(
            (word, Support.FASTENED)
            for word in ("fissate", "atornillados", "vissée", "fixadas", "στερεωμένη", "ukotveno")
        ),
        *(
            (word, Support.FASTENED)
            for word in ("przymocowana", "прикреплена", "закріплено", "učvršćen", "fastskruvat")
        ),
        *((word, Support.FASTENED) for word in ("kiinnitetty", "rögzítve", "sabitlenmiş", "ancorată", "ネジ止め")),
    ],
)
def test_participles_in_every_gender_and_number(words: str, support: Support) -> None:
    assert told_by(words).support is support
    assert told_by(f"{words} 2").support is support
