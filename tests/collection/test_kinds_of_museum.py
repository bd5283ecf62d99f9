"""Lists of museums of nature, of musical instruments and of technology: specimens, cases and spots, thousands."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from pipeline.analysis.classify import classify
from pipeline.analysis.told import as_displayed
from pipeline.collection.guessing.short_heads import short_heads
from pipeline.collection.mapping import load_mapping
from pipeline.collection.places import beside_case, case_in
from pipeline.collection.reading import read_items
from pipeline.models.rigid_body import FALLS_IN
from pipeline.night.importing import Proposed, proposed
from pipeline.records import Furniture, Hanging, Item, Support
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
PUPPETS = """Inv. č.;Předmět;Materiál;Místnost;Umístění;v. cm;š. cm;hl. cm
1;Marioneta;dřevo, textil;Sál 1;vitrína 2, zavěšená na vlasci;68;22;15
2;Loutkové divadlo;dřevo, lepenka;Sál 1;na stole;120;140;70
3;Kulisa les;plátno, lať;Sál 2;opřená o stěnu;250;300;3
4;Skříň s rekvizitami;dub;Sál 3;u zdi, kotveno;198;110;55
5;Busta;bronz;Vstup;na soklu, přišroubovaná;48;35;30
"""
SHIPS = """Nº Inv;Designação;Sala / Local;Suporte expositivo;Comp. (m);Larg. (m);Alt. (m);Peso
1;Galeota real;Pavilhão;berço de madeira;29,5;3,9;4,2;12 t
2;Modelo de caravela;Sala 1;vitrine sobre mesa;1,10;0,42;0,95;14 kg
3;Figura de proa;Sala 2;fixada à parede com ferragens;0,70;0,80;2,10;180 kg
4;Astrolábio náutico;Sala 1;vitrine 4;;0,18;0,19;2,4 kg
5;Âncora;Exterior;no chão;3,20;2,10;0,50;1,8 t
6;Lanterna de popa;Sala 2;suspensa do teto por corrente;0,60;0,60;1,40;45 kg
"""
COSTUME = """ID,Garment,Fabric,Exhibition area,Display method,Overall H,Max W,Max D
1,Court mantua,"silk, silver thread","Europe, Bay 3",on custom mannequin,5 ft 9 in,6 ft 1 in,2 ft
2,Evening gown,silk satin,"Fashion gallery, island 2",bust form on pole stand,65 in,30 in,26 in
3,Waistcoat,silk,"Fashion gallery, drawer 14",flat in drawer,24 in,20 in,
4,Samurai armour,"iron, silk","Japan, Case 5",seated on armour box,52 in,24 in,22 in
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


def test_heads_that_are_labels_of_sizes(tmp_path: Path) -> None:
    _, items = listed(tmp_path, PUPPETS)
    assert [(one.height_m, one.width_m, one.depth_m) for one in items.values()][:3] == [
        (0.68, 0.22, 0.15),
        (1.2, 1.4, 0.7),
        (2.5, 3.0, 0.03),
    ]
    assert [classify(one).support for one in items.values()][2:] == [
        Support.FREESTANDING,
        Support.FASTENED,
        Support.FASTENED,
    ]


@pytest.mark.parametrize(
    ("heads", "fields"),
    [
        (["v. cm", "š. cm", "hl. cm"], ["height_m", "width_m", "depth_m"]),
        (["wys.", "szer.", "gł."], ["height_m", "width_m", "depth_m"]),
        (["В", "Ш", "Г"], ["height_m", "width_m", "depth_m"]),
        (["Overall H", "Max W", "Max D"], ["height_m", "width_m", "depth_m"]),
        (["En", "Boy"], ["width_m", "height_m"]),
        (["C", "N", "R"], [None, None, None]),
    ],
)
def test_what_short_heads_mean_beside_each_other(heads: list[str], fields: list[str | None]) -> None:
    found = short_heads(dict(enumerate(heads)), set())
    assert [found[at].field if at in found else None for at in range(len(heads))] == fields


def test_a_support_that_is_shown_on_is_no_material_and_tonnes_are_weights(tmp_path: Path) -> None:
    _, items = listed(tmp_path, SHIPS)
    assert {one.medium for one in items.values()} == {""}
    assert [one.mass_kg for one in items.values()] == [12000.0, 14.0, 180.0, 2.4, 1800.0, 45.0]
    assert items["1"].depth_m == 29.5
    assert items["4"].case == "vitrine 4"
    assert as_displayed(items["3"]).hanging is Hanging.FIXED


def test_an_exhibition_area_is_no_title(tmp_path: Path) -> None:
    _, items = listed(tmp_path, COSTUME)
    assert [one.gallery for one in items.values()] == [
        "Europe, Bay 3",
        "Fashion gallery, island 2",
        "Fashion gallery, drawer 14",
        "Japan",
    ]
    assert items["4"].case == "Case 5"
    # 5 ft 9 in and 6 ft 1 in, by the inch of 25.4 mm.
    assert (items["1"].height_m, items["1"].width_m) == pytest.approx((69 * 0.0254, 73 * 0.0254), rel=1e-12)


@pytest.mark.parametrize(
    "words",
    [
        *("nicht verschraubt", "não fixada", "pas fixée", "no bolts", "to be bolted", "never bolted", "niet verankerd"),
        *("地面，无固定", "没有固定", "固定していない", "고정되어 있지 않음", "sabitlenmemiş", "sabitlenmiş değil"),
        *("rögzítetlen", "nije pričvršćen", "není ukotven", "не закреплена", "δεν είναι στερεωμένη", "לא מקובע"),
    ],
)
def test_what_is_not_made_fast_stands_free(words: str) -> None:
    assert told_by(words).support is Support.FREESTANDING


def stands(name: str, words: str, height: float, width: float, depth: float) -> Support:
    item = replace(listed_item(), object_name=name, displayed=words, height_m=height, width_m=width, depth_m=depth)
    return classify(item).support


def listed_item() -> Item:
    return Item(object_number="1", gallery="Hall", title="", on_display=True)


def test_what_is_fixed_to_a_wall_stands_there_or_hangs() -> None:
    assert stands("Longcase clock", "fixed to wall", 1.92, 0.42, 0.3) is Support.FASTENED
    assert stands("Wardrobe", "an der Wand verschraubt", 2.1, 1.2, 0.6) is Support.FASTENED
    assert stands("Name plate", "screwed to wall", 0.3, 0.6, 0.04) is Support.HUNG


def test_what_is_deep_and_hangs_of_no_wall_hangs_from_above() -> None:
    assert stands("Campana", "appesa al castello", 0.64, 0.7, 0.7) is Support.SUSPENDED
    assert stands("Bicycle", "colgada", 1.0, 1.65, 0.45) is Support.SUSPENDED
    assert stands("Bicycle", "colgada en la pared", 1.0, 1.65, 0.45) is Support.HUNG
    assert stands("Propeller", "duvara asılı", 0.15, 0.25, 2.4) is Support.HUNG


def test_a_case_by_its_sign_ahead_of_a_shelf() -> None:
    assert case_in("CG-12 / glass shelf B") == "CG-12"
    assert case_in("armoire 3, étagère 2") == "armoire 3"
    assert case_in("玻璃柜4，托架上") == "玻璃柜4"


def test_rocking_alone_harms_no_taxidermy() -> None:
    bison = replace(listed_item(), object_name="taxidermy mount", height_m=1.83, width_m=0.91, depth_m=2.79)
    bust = replace(listed_item(), object_name="bust", medium="marble", height_m=0.6, width_m=0.4, depth_m=0.3)
    assert FALLS_IN in classify(bison).parameters
    assert FALLS_IN not in classify(bust).parameters
