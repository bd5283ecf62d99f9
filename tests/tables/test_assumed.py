"""The museum's own rows of what is assumed: they take the place of Kouros's, and say whose they are."""

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pipeline.analysis.classify import classify
from pipeline.analysis.context import Context
from pipeline.analysis.furniture import filter_of
from pipeline.analysis.rule_table import RuleTable, with_own
from pipeline.execute import Threads
from pipeline.mitigate import measure_catalogue
from pipeline.mitigate.measures.surfaces import Surface
from pipeline.mitigate.proposals import Deficiency
from pipeline.mitigate.trials import TrialRunner
from pipeline.models import MODELS
from pipeline.records import Furniture, Mount, Numerics, Origin, Scene
from pipeline.tables import TableError, table
from pipeline.tables.assumed import assumed, assumed_with, span
from tests.museum import PAINTING, VASE

KEYS = {
    "classes": {"class": "vessel"},
    "materials": {"material": "porcelain"},
    "friction": {"object_material": "Marble", "surface_material": "Formica"},
    "damping": {"wall_surface": "Paint", "back_surface": "Wood"},
    "furniture": {"furniture": "showcase"},
}
"""The row of each table that the museum of these tests has an own one of."""

SHAKES = ("frequency", "frequency_low", "frequency_high", "damping", "damping_low", "damping_high")
"""The columns of furniture.csv that are empty of what moves as its floor does."""

VALUE = {"friction": ("value", "low", "high"), "damping": ("value", "low", "high")}


def own(folder: Path, name: str, **cells: str) -> dict[str, Path]:
    """Write a museum's file of one row, which is Kouros's but for some cells; "-" takes a column out."""
    row = next(dict(row) for row in table(name) if KEYS[name].items() <= row.items())
    row = {column: cell for column, cell in (row | cells).items() if cell != "-"}
    file = folder / f"our-{name}.csv"
    with file.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.DictWriter(stream, list(row))
        writer.writeheader()
        writer.writerow(row)
    return {name: file}


def rules(files: dict[str, Path]) -> RuleTable:
    return with_own(None, assumed_with(files, [model.name for model in MODELS]))


def ends(scene: Scene, name: str) -> list[float]:
    found = scene.parameters[name]
    assert found.origin is Origin.ASSUMED
    return [found.low, found.value, found.high]


def test_an_own_class_is_what_is_assumed_and_the_museum_is_named(tmp_path: Path) -> None:
    cells = {
        "title": "Vessel on our stands",
        "cg_low": "0.2",
        "cg_ratio": "0.25",
        "cg_high": "0.3",
        "clearance": "0.12",
    }
    files = own(tmp_path, "classes", **cells, source="measured, M. Rossi 2026")
    scene, before = classify(VASE, rules(files)), classify(VASE)
    assert ends(scene, "cg_height") == pytest.approx([0.2 * 0.4, 0.25 * 0.4, 0.3 * 0.4])
    assert ends(scene, "clearance") == [0.05, 0.12, 0.30]
    for name in ("cg_height", "half_width", "clearance"):
        found = scene.parameters[name]
        assert found.source == "the museum's our-classes.csv, vessel (measured, M. Rossi 2026)"
        assert found.note.endswith("assumed for: vessel on our stands (the museum's our-classes.csv)")
        assert found.note in scene.assumptions
    assert "our-classes.csv" in scene.assumptions[0]
    assert before.parameters["cg_height"].source == "classes.csv, vessel (judgement)"
    # Nothing else is another: not what the row says as before, not what other classes assume.
    assert ends(scene, "half_width") == ends(before, "half_width")
    assert classify(PAINTING, rules(files)) == classify(PAINTING)


def test_an_own_class_says_how_it_is_held_and_what_is_run(tmp_path: Path) -> None:
    changed = {"support": "fastened", "models": "stress|flexible_stress", "why": "is clamped on our mounts"}
    scene = classify(VASE, rules(own(tmp_path, "classes", **changed)))
    assert (scene.support, scene.models) == ("fastened", ("stress", "flexible_stress"))
    scene = classify(VASE, rules(own(tmp_path, "classes", models="none", why="is built into our walls")))
    assert scene.models == ()
    assert scene.missing == ("no generic model applies: it is built into our walls",)
    # Whatever the museum says is held by mounts is taken as one of which nobody knows how it grips.
    scene = classify(VASE, rules(own(tmp_path, "classes", models="held", why="is held by our mounts")))
    assert scene.mount is Mount.UNKNOWN
    assert scene.missing == ()


def test_an_own_material_is_named(tmp_path: Path) -> None:
    numbers = {"density": "2000", "density_low": "1900", "density_high": "2100", "tensile": "4e6", "tensile_low": "3e6"}
    files = own(tmp_path, "materials", **numbers, words="porcelain|our paste", source="our laboratory")
    scene, before = classify(VASE, rules(files)), classify(VASE)
    ratio = [new / old for new, old in zip(ends(scene, "mass"), ends(before, "mass"), strict=True)]
    assert ratio == pytest.approx([1900 / 2300, 2000 / 2400, 2100 / 2500])
    assert ends(scene, "allowable_stress") == [3e6, 4e6, 60e6]
    assert scene.parameters["mass"].source == "the museum's our-materials.csv, porcelain"
    assert scene.parameters["allowable_stress"].source == "the museum's our-materials.csv, porcelain (our laboratory)"
    assert "porcelain (the museum's our-materials.csv)" in scene.parameters["allowable_stress"].note
    assert ends(classify(replace(VASE, medium="our paste"), rules(files)), "mass") == ends(scene, "mass")


def test_an_own_friction_counts_for_its_pair_and_in_the_span_of_what_is_not_known(tmp_path: Path) -> None:
    files = own(tmp_path, "friction", value="0.30", low="0.25", high="0.45", source="tilt tests 2026")
    values = rules(files).values
    (pair,) = values.friction_of("marble", "formica")
    assert (pair.low, pair.value, pair.high) == (0.25, 0.30, 0.45)
    # On anything: from glass, 0.12, to sawn stone on concrete, 0.90.
    marble = span(values.friction_of("Marble"))
    assert (marble.low, marble.high) == (0.12, 0.90)
    stone = classify(replace(VASE, medium="marble", furniture=Furniture.SHOWCASE), rules(files)).parameters[
        "friction_static"
    ]
    theirs = "the museum's our-friction.csv"
    assert f"{theirs} (tilt tests 2026)" in stone.source
    assert theirs in stone.note
    assert stone.note.endswith("for Marble on anything in a showcase; not measured")
    metal = replace(VASE, medium="bronze")
    assert classify(metal, rules(files)) == classify(metal)


def test_an_own_damping_counts_for_its_pair(tmp_path: Path) -> None:
    files = own(tmp_path, "damping", value="0.04", low="0.03", high="0.05", source="our wall")
    wood = classify(replace(PAINTING, wall_surface="paint", back_surface="wood"), rules(files))
    assert ends(wood, "damping") == [0.03, 0.04, 0.05]
    assert wood.parameters["damping"].source == "the museum's our-damping.csv (our wall)"
    unknown = classify(PAINTING, rules(files)).parameters["damping"]
    assert (unknown.low, unknown.value, unknown.high) == (0.03, 0.03, 0.13)
    assert "wood on paint, the least of the museum's our-damping.csv and Table 4" in unknown.note


def test_an_own_showcase_is_as_stiff_as_the_museum_measured_it(tmp_path: Path) -> None:
    """Cases that were measured: the scene has the museum's numbers, and names its file."""
    cells = {"frequency": "8", "frequency_low": "7.5", "frequency_high": "8.5", "source": "hammer test 2026"}
    scene = classify(replace(VASE, furniture=Furniture.SHOWCASE), rules(own(tmp_path, "furniture", **cells)))
    assert ends(scene, "furniture_frequency") == [7.5, 8.0, 8.5]
    assert scene.parameters["furniture_frequency"].source == "the museum's our-furniture.csv (hammer test 2026)"
    assert "of 8 Hz (7.5 to 8.5), or stiff, the museum's our-furniture.csv" in scene.assumptions[-3]
    filtered = filter_of(scene)
    assert filtered is not None
    assert filtered.frequency == (7.5, 8.0, 8.5)
    assert filtered.damping == (0.03, 0.05, 0.1)


def test_a_surface_is_proposed_with_the_museums_own_friction(tmp_path: Path) -> None:
    """Marble on Formica is 0.18 in Table 3: the museum that measured 0.28 is advised with that, and Kouros's is not.

    Terrazzo holds it at 0.15; what handbooks and judgement say of other surfaces is too wide to advise by.
    """
    values = rules(own(tmp_path, "friction", value="0.30", low="0.28", high="0.33", source="tilt tests 2026")).values
    scene = classify(replace(VASE, base_material="Marble", friction=0.14))
    (row,) = (one for one in measure_catalogue(values=values).measures if isinstance(one, Surface))
    offered = []
    for have in (assumed(), values):
        runner = TrialRunner((), (), Context(Threads(1)), Numerics(), values=have)
        proposal = row.propose(Deficiency(0, scene, (), ()), runner)
        offered.append([float(candidate.numbers["friction"][0]) for candidate in proposal.candidates])
    assert offered == [[0.15, 0.18], [0.15, 0.28]]
    assert measure_catalogue(values=values).values is values


@pytest.mark.parametrize(
    ("name", "cells", "message"),
    [
        ("classes", {"class": "vesel"}, r"line 2: Kouros's classes.csv has no row 'vesel' .*; write one of vessel"),
        ("classes", {"support": "standing"}, r"line 2, class 'vessel': column 'support': .*, not 'standing'"),
        ("classes", {"support": "isolated"}, r"column 'support': is 'isolated', which measures make of an object"),
        ("classes", {"round": "maybe"}, r"column 'round': .* not 'maybe'"),
        ("classes", {"cg_low": "0.5"}, r"column 'cg_high': cg_low <= cg_ratio <= cg_high does not hold \(0.5 0.45"),
        ("classes", {"cg_ratio": "1.2"}, r"column 'cg_ratio': is a share: it must be above 0 and at most 1, not 1.2"),
        ("classes", {"base_ratio": ""}, r"column 'base_high': base_ratio, base_low and base_high go together"),
        ("classes", {"section": ""}, r"column 'section_high': a critical section and its size go together"),
        ("classes", {"section": "waist"}, r"column 'section': .* not 'waist'"),
        ("classes", {"clearance": "wide"}, r"column 'clearance': .* valid number.* not 'wide'"),
        ("classes", {"clearance_high": "inf"}, r"column 'clearance_high': .* finite number"),
        ("classes", {"models": "rocking|flying"}, r"column 'models': there is no model 'flying'; use .*rocking"),
        ("classes", {"models": "none|rocking"}, r"column 'models': none and held stand alone"),
        ("classes", {"models": ""}, r"column 'models': is empty; name models parted by \|"),
        ("classes", {"source": " "}, r"column 'source': is empty; every row needs it"),
        ("classes", {"title": "-"}, r"column 'title': there is no such column"),
        ("classes", {"colour": "red"}, r"column 'colour': no column is called so; correct its name, or remove it"),
        ("materials", {"material": "paper clay"}, r"line 2: Kouros's materials.csv has no row 'paper clay'"),
        ("materials", {"density": "-5"}, r"column 'density': .* greater than 0, not '-5'"),
        ("materials", {"tensile_high": "1e6"}, r"column 'tensile_high': tensile_low <= tensile <= tensile_high"),
        ("materials", {"friction_as": "Felt"}, r"material 'porcelain': column 'friction_as': .* has no 'Felt'"),
        ("materials", {"words": "porcelain|oak"}, r"material 'porcelain': .* 'oak' is a word of 'wood' too"),
        ("friction", {"surface_material": "Silk"}, r"line 2: Kouros's friction.csv has no row 'marble on silk'"),
        ("friction", {"low": "-0.1"}, r"line 2, object_material 'Marble': column 'low': must be 0 or more, not -0.1"),
        ("friction", {"value": "0,2"}, r"column 'value': .*valid number.*, not '0,2'"),
        ("damping", {"back_surface": "Cork"}, r"has no row 'paint on cork'"),
        ("damping", {"value": "2", "high": "5"}, r"column 'high': is a ratio of critical damping: .* below 1"),
        ("furniture", {"furniture": "crate"}, r"line 2, furniture 'crate': column 'furniture': .*'floor', 'showcase'"),
        ("furniture", {"frequency": "0"}, r"column 'frequency': must be from 0.1 to 50 Hz, not 0"),
        ("furniture", {"frequency": "2"}, r"column 'frequency_high': frequency_low <= frequency <= frequency_high"),
        ("furniture", {"frequency": ""}, r"column 'frequency_high': frequency, frequency_low and frequency_high go"),
        ("furniture", {"damping_low": "1.5"}, r"column 'damping_low': is a share of the critical damping: .* not 1.5"),
        ("furniture", {"damping": "", "damping_low": "", "damping_high": ""}, r"what shakes has a frequency and a dam"),
        ("furniture", {"level_error": "7"}, r"column 'level_error': .* less than or equal to 5, not '7'"),
        ("furniture", {"half_width": "0"}, r"column 'half_width': must be above 0 and at most 10 m, not 0"),
        ("furniture", {"half_width": "0.7"}, r"column 'half_width_high': half_width_low <= half_width <= half_width_h"),
        ("furniture", {"cg_height": ""}, r"column 'cg_height_high': cg_height, cg_height_low and cg_height_high go"),
        ("furniture", {"friction_high": "3"}, r"column 'friction_high': is a coefficient of friction: .* not 3"),
        ("furniture", {"shelf_height": "-"}, r"column 'shelf_height': what is not fastened .*: fill shelf_height too"),
        ("furniture", {"anchorage": "maybe"}, r"column 'anchorage': .*'anchored' or 'unanchored', not 'maybe'"),
        ("furniture", {"furniture": "floor"} | dict.fromkeys(SHAKES, ""), r"'shelf_height': what moves as the"),
        ("furniture", {"title": ""}, r"column 'title': is empty; every row needs it"),
    ],
)  # fmt: skip
def test_a_mistake_in_an_own_table_is_named(name: str, cells: dict[str, str], message: str, tmp_path: Path) -> None:
    """The file, the line, the row, the column, and what to do."""
    with pytest.raises(TableError, match=rf"our-{name}\.csv.*{message}"):
        rules(own(tmp_path, name, **cells))


def test_a_row_that_is_there_twice_and_a_table_without_rows(tmp_path: Path) -> None:
    files = own(tmp_path, "friction")
    text = files["friction"].read_text(encoding="utf-8")
    files["friction"].write_text(text + text.splitlines()[1].replace("Marble", "MARBLE") + "\n", encoding="utf-8")
    with pytest.raises(TableError, match=r"our-friction.csv, line 3: 'marble on formica' is there twice; keep one row"):
        rules(files)
    files["friction"].write_text(text.splitlines()[0] + "\n", encoding="utf-8")
    with pytest.raises(TableError, match=r"our-friction.csv: has no rows; write the header"):
        rules(files)


def test_kouros_own_tables_are_the_files(tmp_path: Path) -> None:
    """Cell by cell: what the models make of a row is what the file says."""
    for row, one in zip(table("classes"), assumed().classes.values(), strict=True):
        assert (row["class"], row["title"], row["support"]) == (one.name, one.title, one.support)
        assert (row["round"] == "yes", tuple(row["models"].split("|"))) == (one.round, one.models)
        for kind, found in (("cg", one.cg), ("base", one.base), ("section", one.critical)):
            told = [row[f"{kind}_low"], row[f"{kind}_ratio"], row[f"{kind}_high"]]
            assert [""] * 3 if found is None else np.array(told, float).tolist() == [found.low, found.value, found.high]
    for row, stuff in zip(table("materials"), assumed().materials.values(), strict=True):
        assert row["words"] == "|".join(stuff.words)
        assert (float(row["density"]), float(row["tensile"])) == (stuff.density, stuff.tensile)
    assert [float(row["value"]) for row in table("friction")] == [row.value for row in assumed().friction]
    assert [float(row["value"]) for row in table("damping")] == [row.value for row in assumed().damping]


@pytest.mark.parametrize(
    ("words", "material"),
    [
        # As museums of these countries write: the translations are those of the AAT.
        ("coton (dentelle, tissé)", "paper"), ("soie, taffetas", "paper"), ("Seide, Baumwolle", "paper"),
        ("cuero y lana", "paper"), ("tessuto di seta", "paper"), ("zijde en wol", "paper"), ("μετάξι", "paper"),
        ("argent (appliqué)", "silver"), ("Silber, vergoldet", "silver"), ("argento dorato", "silver"),
        ("plata repujada", "silver"), ("zilver", "silver"), ("Zinn", "pewter"), ("plomb", "pewter"),
        ("terre cuite", "terracotta"), ("Terrakotta", "terracotta"), ("barro cocido", "terracotta"),
        ("lut ars", "terracotta"), ("πηλός", "terracotta"), ("aardewerk", "terracotta"),
        ("faïence stannifère", "glazed earthenware"), ("Porzellan", "porcelain"), ("porțelan", "porcelain"),
        ("verre soufflé", "glass"), ("vetro", "glass"), ("vidrio", "glass"), ("sticlă", "glass"),
        ("laiton", "bronze"), ("alliage cuivreux, papier", "bronze"), ("Messing", "bronze"), ("alamă", "bronze"),
        # What is painted or written with lies on what a thing is made of.
        ("Ink and gold on paper, wood", "paper"), ("ink, colors, and gold on silk", "paper"),
        ("ink on gold paper", "paper"), ("gold on a marble base", "gold"), ("gold, wood", "gold"),
        ("oro e tempera su legno", "wood"),
        ("fer forgé", "iron"), ("hierro", "iron"), ("Schmiedeeisen; Eisen", "iron"), ("oro", "gold"),
        ("marbre blanc", "marble"), ("mármore", "marble"), ("μάρμαρο", "marble"), ("Kalkstein", "stone"),
        ("bois, chêne", "wood"), ("Lindenholz, gefasst", "wood"), ("legno dorato", "wood"), ("madera", "wood"),
        ("ivoire", "ivory"), ("Elfenbein", "ivory"), ("mother of pearl", "ivory"), ("résine", "plastic"),
        ("plâtre", "plaster"), ("Gips", "plaster"),
        # Chinese, Japanese and Korean part no words; the first material that a text names is the thing's.
        ("木造、彩色", "wood"), ("木心乾漆", "wood"), ("銅造鍍金", "bronze"), ("紙本墨画", "paper"),
        ("絹本着色", "paper"), ("磁器、染付", "porcelain"), ("鉄地金銀象嵌", "iron"), ("大理石", "marble"),
        ("石造", "stone"), ("铜", "bronze"),
        ("청동", "bronze"), ("백자", "porcelain"), ("drewno polichromowane", "wood"), ("brąz, złocony", "bronze"),
        ("szkło", "glass"), ("фарфор, роспись", "porcelain"), ("холст, масло", "paper"), ("чугун", "iron"),
        ("ahşap, boya", "wood"), ("pişmiş toprak", "terracotta"), ("mramor", "marble"), ("üveg", "glass"),
        ("træ", "wood"), ("gjutjärn", "iron"), ("sølv", "silver"),
        # English words that are another language's word for a material are not read as that.
        ("acrylic with 1 or 2 motors", "plastic"), ("wood or bone", "wood"),
    ],
)  # fmt: skip
def test_a_material_is_known_by_its_name_in_the_languages_that_classes_are_known_by(words: str, material: str) -> None:
    found = assumed().material_in(words)
    assert found is not None
    assert found.name == material


def test_no_word_names_two_materials() -> None:
    words = [word.lower() for one in assumed().materials.values() for word in one.words]
    assert len(words) == len(set(words))


@pytest.mark.parametrize(
    ("text", "material"),
    [("石", "stone"), ("木、漆", "wood"), ("銅", "bronze"), ("铜", "bronze"), ("陶", "terracotta"), ("석", "stone"),
     ("鉄", "iron"), ("銅鎏金", "bronze"), ("金襴", None), ("土佐", None)],
)  # fmt: skip
def test_materials_of_one_sign_are_all_there_is(text: str, material: str | None) -> None:
    found = assumed().material_in(text)
    assert (found and found.name) == material
