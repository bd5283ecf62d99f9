"""Dimension texts as museums of the world write them, each with the extents that a reader takes from it.

The texts are in the forms of the named museums' public catalogues and of registers of their countries; truth is what
the text says, read by a person, in the units of the text; inches are 2.54 cm and hundredweights 112 pounds, exact.
"""

import pytest

from pipeline.collection.dimensions import choose, parse

FIELDS = ("height", "width", "depth", "diameter", "base_width", "mass")
"""A base of one diameter is as deep as it is wide."""

WRITTEN = [
    # A part without its frame is no frame; what is in brackets behind a number is of that number.
    ("Gesamt: Höhe: 27 cm; Breite: 37 cm; Tiefe: 6 cm\nTeil (ohne Rahmen): Höhe: 22 cm; Breite: 31 cm",
     "27 37 6 - - -"),
    ("Length: 2,351 mm (net 2,329 mm); Width: 939 mm (net 927 mm); Height: 898 mm (net 297 mm)",
     "89.8 93.9 235.1 - - -"),
    ("Net dimensions exclude lid. Length: 2,351 mm (net 2,329 mm); Height: 898 mm (net 297 mm)", "89.8 235.1 - - - -"),
    # What stands behind a number says of which part it is.
    ("Height: 79 cm, Width: 77 cm, Depth: 70 cm, Height: 42 cm seat", "79 77 70 - - -"),
    ("Height: 242 cm, Width: 111.5 cm maximum, Depth: 62 cm feet", "242 111.5 62 - - -"),
    ("Alto 90, ancho 45, fondo 40 cm; altura asiento 44 cm", "90 45 40 - - -"),
    # With its base or lid, behind the height without it.
    ("H: 30 cm (sans socle), 36 cm (avec socle)", "36 - - - - -"),
    ("H. 45 cm (Figur), 60 cm (mit Sockel)", "60 - - - - -"),
    ("H. 30 cm, 36 cm with base", "36 - - - - -"),
    ("H 12 cm (4 3/4 in.), 15 cm (5 7/8 in.) with stand", "15 - - - - -"),
    ("H. 62 cm on socle", "62 - - - - -"),
    ("62 cm (H) on socle", "62 - - - - -"),
    # Labels of the whole and of the seat, as Colonial Williamsburg writes them.
    ('OH: 96 1/2"; OW: 22"; OD: 10 3/4"', "245.11 55.88 27.305 - - -"),
    ('OH: 38 3/4"; OW: 22 1/2"; SD: 17"; SH: 16 3/4"', "98.425 57.15 - - - -"),
    # Diameters of mouth, body and bottom.
    ("h. max 78 diam. bocca 45 diam. fondo 30 cm", "78 - - - 30 -"),
    ("H=24,5 cm; Dg=12 cm; Db=8 cm", "24.5 - - - 8 -"),
    ("Cao: 45cm; ĐK miệng: 12cm; ĐK đáy: 10cm", "45 - - - 10 -"),
    ("Diamètre de l'ouverture : 12 cm ; diamètre de la panse : 24 cm ; hauteur : 30 cm", "30 - - 24 - -"),
    ("H: 39.8 × Diam. (mouth): 19 × Diam. (foot): 13.7 × Diam. (body): 28 cm", "39.8 - - 28 13.7 -"),
    ("Φ 30 cm, h 61 cm", "61 - - 30 - -"),
    ("girth 94 cm, H 45 cm", "45 - - 29.921 - -"),
    # A blank behind the decimal mark; a point of thousands; old abbreviations.
    ("height: 19. 5cm width: 13. 7cm", "19.5 13.7 - - - -"),
    ("19, 5 x 13 cm", "19.5 13 - - - -"),
    ("13 x 19, 5 x 4 cm", "13 19.5 4 - - -"),
    ("Plate 3, 5 x 7 cm", "5 7 - - - -"),
    ("1.250 mm x 600 mm x 450 mm", "125 60 45 - - -"),
    ("Haut. 35 cent.; larg. 20 cent.", "35 20 - - - -"),
    ("H. 180 cm; weight: 3 cwt 2 qr 14 lb", "180 - - - - 177.808"),
    # Legends without joins, and units behind legends.
    ("87 x 54 x 57 cm (hwd)", "87 54 57 - - -"),
    ("87 x 54 x 57 cm (wdh)", "57 87 54 - - -"),
    ("LWH: 87 x 54 x 57 cm", "57 54 87 - - -"),
    ("HBT 87 x 54 x 57 cm", "87 54 57 - - -"),
    ("34 1/2 x 21 x 18 (HxWxD) (inches)", "87.63 53.34 45.72 - - -"),
    ("34 1/2 x 21 x 18 HxWxD inches", "87.63 53.34 45.72 - - -"),
    ("34 x 21 x 18 H x W x D in cm", "34 21 18 - - -"),
    ("dimensioni: 45 x 30 x 20 (a x l x p) cm", "45 30 20 - - -"),
    # Read before, and to stay so.
    ("Object: H: 38.9 × W: 28.6 × D: 26 cm, Weight: 5.4 kg (15 5/16 × 11 1/4 × 10 1/4 in., 12 lb.)",
     "38.9 28.6 26 - - 5.4"),
    ("Height: 36.8 cm (14 1/2 in.) Mount (Steel pin in wooden base): 5.1 x 10.2 x 10.2 cm (2 x 4 x 4 in.)",
     "36.8 - - - 10.2 -"),
    ("Overall: 520mm (width), 800mm (height), 200mm (depth)", "80 52 20 - - -"),
    ("150.0 cm (H)83.0 cm (W)72.0 cm (D)", "150 83 72 - - -"),
    ("82.0 x 49.5 x 47.0 cm (whole object); 72.4 cm (height)", "82 49.5 47 - - -"),
    ("17,5x12,3х5 см", "17.5 12.3 5 - - -"),
    ("hoogte 35 cm × breedte 20,5 cm × diepte 10 cm × gewicht 2300 gr", "35 20.5 10 - - 2.3"),
    ("通高24.5、口径12、底径8厘米", "24.5 - - 12 8 -"),
    ("overall (closed): 45 x 30 x 20 cm; overall (open): 45 x 60 x 20 cm", "45 60 20 - - -"),
    ("each panel: 170 x 60 cm; overall: 170 x 360 cm", "170 360 - - - -"),
    ("54 (L) x 32 (l) x 44 (h) cm", "44 32 54 - - -"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "expected"), WRITTEN, ids=[text for text, _ in WRITTEN])
def test_extents(text: str, expected: str) -> None:
    chosen = choose(parse(text))
    found = [getattr(chosen, field) for field in FIELDS]
    wanted = [None if one == "-" else float(one) for one in expected.split()]
    wanted = [one / (1.0 if field == "mass" or one is None else 100.0) if one is not None else None
              for field, one in zip(FIELDS, wanted, strict=True)]  # fmt: skip
    # Texts give up to five digits.
    assert [one and one.value for one in found] == [one and pytest.approx(one, rel=1e-4) for one in wanted]


def test_a_lone_number_of_micrometres_is_doubted() -> None:
    dimensions = parse("Diameter: 9.525 mm")
    assert choose(dimensions).diameter is not None
    assert [note.kind for note in dimensions.notes] == ["ambiguous"]
