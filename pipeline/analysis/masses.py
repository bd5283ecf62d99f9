"""Mass of an object that nobody weighed: how much of its outline its material fills.

What is made of metal is sheet, cast hollow, or of rods, and what is made of papier-mâché or fibreglass is a shell: it
fills far less than the same thing of wood or clay.  What makes it lighter makes its critical section thinner too, so
that one must not be counted without the other.
"""

import re
from math import pi

from pipeline.records import Estimate, Item, Origin, Support
from pipeline.records import phrases as say
from pipeline.records.phrase import Clause
from pipeline.tables import Range
from pipeline.tables.assumed import UNKNOWN
from pipeline.tables.assumed_rows import Material, ObjectClass
from pipeline.tables.body_rows import SCREEN, BodyRow
from pipeline.tables.fill_rows import fill_of
from pipeline.tables.usual_material_rows import usual_material

_FRAMED = (5.0, 15.0, 40.0)
"""Mass of a square metre of a framed work [kg/m2], by judgement: low, best, high."""

_SUSPENDED = (0.5, 8.0, 60.0)
"""The same of what hangs from above, over its outline: from a mobile of sheet and wire to a chandelier of crystal."""

_CHANDELIER = (8.0, 30.0, 90.0)
"""The same of what is called a chandelier: of brass with 25 kg to the m2, of glass and bronze with 60 and more."""

_CLOTH = (0.3, 1.5, 5.0)
"""The same of cloth on a wall whose thickness nobody recorded: from a silk banner over a tapestry to a pile carpet."""

_PILE = (1.5, 3.5, 6.0)
"""The same of a carpet: from a kilim to a deep pile."""

_SCREEN = (2.0, 5.0, 15.0)
"""The same of a folding screen that stands: paper or silk over a lattice of wood, to leather and lacquered boards."""

_CALLED = re.compile(
    r"chandelier|kronleuchter|lüster\b|\blustre|lampadari|\blumier|\baraña|candelabro de techo|πολυέλαιο|люстра"
    r"|паникадил|\bavize|żyrandol|kroonluchter|ljuskrona|シャンデリア|枝形吊灯",
    re.IGNORECASE,
)
"""What is called one."""

_SHAFT = Range(0.7, 0.3, 0.95, "judgement: a shaft is of one piece, and its outline is its own where nothing spreads")
"""Share of its outline that a pole of wood fills."""

_SLIM = 15.0
"""Length over the larger of the two other sizes from which a thing of wood is a pole: judgement."""

_LARGE = 1.0
"""Outline [m3] from which what hangs from above is no solid body: nobody hangs tonnes over a room (judgement)."""

_CORED = {"lamp": 2.0}
"""Class -> mass at most of it with a solid shaft, as a multiple of its own.

What fills little of the outline of a lamp is air under its shade and round its shaft; of the shaft itself a core is
missing at most, as in candlesticks that were cast (judgement).
"""

_CARPET = re.compile(
    r"\b(?:carpets?|rugs?|teppich|tapis|tappet[oi]|alfombras?|tapetes?|covor|covoare|karpet|tapijt|halı|dywan|koberec"
    r"|χαλί|ковёр|ковер)\b|絨毯|段通|地毯",
    re.IGNORECASE,
)
"""What names one."""

_SCROLL = re.compile(
    r"\b(?:hanging scrolls?|kakemono|kakejiku|thangka|tangka|banner|flag|pennant|Hängerolle|Rollbild|Thangka|Fahne|"
    r"rouleau suspendu|bannière|drapeau|rotolo|stendardo|bandiera|rollo colgante|estandarte|bandera)\b|"
    r"掛軸|掛幅|立轴|족자",
    re.IGNORECASE,
)
"""What hangs without a frame, though its class has one."""

CLOTH, FRAMED = "paper", "framed"
"""The material of cloth and leather, and the class of what a frame holds."""


def mass_of(
    item: Item,
    row: ObjectClass,
    material: Material,
    support: Support,
    shape: BodyRow | None = None,
    *,
    thick: bool = True,
) -> Estimate | None:
    """Return the mass of an object [kg]: as recorded, else by what fills its outline, else by its area where it hangs.

    Parameters
    ----------
    item : Item
        Its record.
    row : ObjectClass
        Its class.
    material : Material
        What it is made of.
    support : Support
        How it is held.
    shape : BodyRow or None
        What is known of its shape besides its class: how much of its outline it fills goes before its material, and a
        folding screen is as thin as what hangs.
    thick : bool
        Whether its depth is recorded: of cloth on a wall an assumed one says nothing.

    Returns
    -------
    Estimate or None
        None where its sizes or its class do not say it.
    """
    if item.mass_kg is not None:
        return Estimate.measured(item.mass_kg, "kg")
    shaped = shape is not None and shape.fill is not None
    box, own = _outline(item, row), None if shaped else _shell_fill(item, row, material)
    screen = shape is not None and shape.body == SCREEN
    fill = own or row.filled
    if fill is not None and not (shaped or row.own) and _pole(item, material):
        fill = own = _SHAFT
    # A slab of stone weighs many times as much as a picture of its size; of what nobody knows what it is made, either.
    by_volume = fill is not None and item.depth_m is not None and material.name != UNKNOWN
    words = f"{item.object_name} {item.title}"
    spread = support is Support.HUNG or (row.support is Support.HUNG and support is Support.FREESTANDING)
    cloth = spread and unframed(item, row.name, material, thick=thick)
    face = _of_face(words, support, screen=screen, cloth=cloth)
    by_face = screen or cloth or not by_volume or (not shaped and _airy(box, fill, material, item, support))
    if face is not None and item.height_m and item.width_m and by_face:
        per_area, face_phrase = face
        area, (low, best, high) = item.height_m * item.width_m, per_area
        note = face_phrase(mass=per_area)
        return Estimate.assumed(best * area, low * area, high * area, "kg", note, "judgement")
    if fill is None or box is None:
        return None
    density = material.density_range
    phrase = say.MASS_OF_SHELL if own else say.MASS_OF_CLASS if row.aside else say.MASS
    usual = usual_material(row.name, words, item.height_m) if material.name == UNKNOWN and item.height_m else None
    if usual is not None and not (row.own or shaped):
        material, density, phrase = usual.of, usual.density, say.MASS_OF_USUAL
        fill = _shell_fill(item, row, material) or fill
    note = phrase(material=material.told, density=density.value, fill=fill.value, aside=row.aside.strip(" ()"))
    low, high = box * fill.low * density.low, box * fill.high * density.high
    return Estimate.assumed(box * fill.value * density.value, low, high, "kg", note, density.source)


def _of_face(
    words: str, support: Support, *, screen: bool, cloth: bool
) -> tuple[tuple[float, float, float], Clause] | None:
    """Return what a square metre of a face weighs, and how that is said; None of what is no face."""
    if screen:
        return _SCREEN, say.MASS_OF_SCREEN
    if cloth:
        return _PILE if _CARPET.search(words) else _CLOTH, say.MASS_OF_CLOTH
    if support is Support.HUNG:
        return _FRAMED, say.MASS_OF_FRAMED
    if support is Support.SUSPENDED:
        return _CHANDELIER if _CALLED.search(words) else _SUSPENDED, say.MASS_OF_SUSPENDED
    return None


def unframed(item: Item, object_class: str, material: Material, *, thick: bool = False) -> bool:
    """Say whether what hangs is bare cloth or paper: a scroll, a banner, a tapestry.

    Parameters
    ----------
    item : Item
        Its record.
    object_class : str
        Row of classes.csv.
    material : Material
        What it is made of.
    thick : bool, optional
        Whether its depth is recorded, as of what is stretched or mounted.

    Returns
    -------
    bool
    """
    bare = object_class != FRAMED and not thick
    return material.name == CLOTH and (bare or _SCROLL.search(f"{item.object_name} {item.title}") is not None)


def _pole(item: Item, material: Material) -> bool:
    """Say whether a thing of wood is so long for its thickness that it is a shaft: a pike, an oar, a staff."""
    sizes = sorted(size for size in (item.height_m, item.width_m, item.depth_m) if size)
    return material.name == "wood" and len(sizes) == 3 and sizes[2] >= _SLIM * sizes[1]


def _airy(box: float | None, fill: Range | None, material: Material, item: Item, support: Support) -> bool:
    """Say whether a large thing that hangs from above would weigh more by its outline than its face lets it."""
    if support is not Support.SUSPENDED or box is None or fill is None or box < _LARGE:
        return False
    most = _SUSPENDED[2] * (item.height_m or 0.0) * (item.width_m or 0.0)
    return box * fill.value * material.density_range.value > most


def solid_mass(item: Item, row: ObjectClass, material: Material, own: Estimate | None = None) -> Estimate | None:
    """Return the mass below which a thing of sheet or a shell is hollow, and its critical section with it [kg].

    Parameters
    ----------
    item, row, material : Item, ObjectClass, Material
        As of `mass_of`.
    own : Estimate or None
        Its mass.

    Returns
    -------
    Estimate or None
        None where its section is recorded, or nothing says that it may be hollow.
    """
    box, filled = _outline(item, row), row.filled
    if item.section_width_m is not None or box is None or filled is None or _shell_fill(item, row, material) is None:
        return None
    mass = box * filled.value * material.density_range.value
    if row.name in _CORED and own is not None:
        mass = min(mass, _CORED[row.name] * own.value)
    return Estimate(mass, "kg", Origin.ASSUMED, mass, mass, say.SOLID(mass=mass), "judgement")


def _outline(item: Item, row: ObjectClass) -> float | None:
    """Return the volume [m3] that a thing takes up; None where its sizes do not say it."""
    across, along = item.width_m or item.depth_m, item.depth_m or item.width_m
    if not (item.height_m and across and along):
        return None
    return item.height_m * across * along * (0.25 * pi if row.round else 1.0)


def _shell_fill(item: Item, row: ObjectClass, material: Material) -> Range | None:
    """Return how much of its outline fills.csv says that it fills; a museum's own row of the class goes before."""
    return None if row.own else fill_of(row.name, material.name, item.height_m or 0.0)
