"""A place that names a room and what a thing stands in there, "Gallery 1, case 3", and where the one ends."""

import re
from functools import cache, lru_cache
from typing import NamedTuple

from pipeline.collection.display_words import says_shown
from pipeline.records import Furniture, Support
from pipeline.tables.held_rows import CASES, hangs_above, in_no_case, stands_or_hangs, told_by, words_for
from pipeline.tables.place_rows import place_words
from pipeline.tables.rows import UNPARTED, any_of

_SEPARATOR = re.compile(r"\s*(?:[,;>|，、；➜→➔›»▸]|(?<!\bw)(?:(?<!\b[A-Za-z\d])/|/(?![A-Za-z]\b)))\s*|:\s+|\s+[-–—]\s+")
LONGEST = 300
"""Characters beyond which a text names no place that could be parted."""

_ENCLOSED = re.compile(r"(.*\S)\s*\(([^()]+)\)\s*")
_SIGN = r"(?:(?!\d+\s?(?:mm|cm|m|in|ft)\b)[a-z]{0,3}\d[\w.-]{0,5}|[a-z]|[ivx]{1,4}|(?-i:[A-Z]{2}))"
"""What tells one case from the next: 3, 12b, A, IV, FS, MW4."""

_SIDE = rf"(?:{'|'.join(place_words('surface'))})"
_SIDE_OF = re.compile(
    r"(\w(?:[\w'.]| (?!(?:on|the|of|by|to|near|against|an|am|der|die|das|auf|au|du|sur|la|le|al|alla|sulla|del|della|en"
    r"|el|na|no|de|aan|op|north|south|east|west|left|right|back|end)\b))*)"
    rf" ({_SIDE})",
    re.IGNORECASE,
)
"""The floor, wall or ceiling of a room, where a thing lies or hangs: "Library floor", and no storey, "Second floor"."""
_NOTHING_BEHIND = re.compile(r"\s*[,;/>|]\s*[-–—.]*\s*$")
"""What stands for a case that a place has not: "Gartensaal / –"."""
_OF_WALLS = re.compile(
    r"(?:Wand|wall|mur|muro|parete|pared|parede|muur|ściana|stěna|стена|τοίχος|duvar|vägg|væg|seinä|perete|zid)\s+"
    r"(?:[nsewo]|nord|süd|ost|west|sud|est|ouest|ovest|norte|sur|este|oeste|noord|zuid|oost|\d{1,2}|[a-d]"
    r"|[^\W\d_]{1,5}\.(?:[\s-]?[^\W\d_]{1,5}\.)?)"
    r"|(?:panel|panneau|pannello|painel|paneel|Stellwand|display screen|baffle|partition)\s+(?:[a-z]|\d{1,3}[a-z]?)"
    r"|(?:north|south|east|west|left|right|back|end|[nsew])\.? wall|(?:Nord|Süd|Ost|West|Stirn|Längs|Rück)wand",
    re.IGNORECASE,
)
"""One of a room's walls, where a table stands and a picture hangs: no part of the room's name."""
_CODES = re.compile(
    r"([A-Z]{1,3}\d{1,3})[.\-_/](?:(?P<case>(?:C|CASE|V|VIT|SC)\d{1,3}(?:[.\-_/][A-Z]{1,3}\d{1,3}){0,2})"
    r"|(?P<spot>(?:P|PL|W|WL|F|FL)\d{1,3}))"
    r"|(?P<room>[A-Z]{1,3}\d{1,3}[a-z]?)/(?:(?P<dc>dc\d{1,3}[a-z]?)|(?P<od>od\d{0,3}))"
)
"""A place by its signs: the room, and a case with a shelf in it or a spot, G12.C03.S2 and G12.P01; display cases and
open display as the British Museum writes them, G12/dc3 and G24/od."""
_CODE = re.compile(r"[A-Z]{1,4}[ .-]?\d{1,4}")
"""A case by its sign alone, ahead of a shelf in it: CG-12."""
_BESIDE = re.compile(
    rf"{_SEPARATOR.pattern}|\s*\+\s*|\s+(?:with|and|mit|und|avec|et|con|com|met|med|z)\s+", re.IGNORECASE
)
"""What parts a case from what else is told in a text on how a thing is displayed: "plinth 3 + acrylic bonnet"."""
_UPON = re.compile(
    r"\s*(?:on|in|with|auf|mit|im|sur|avec|dans|su|con|sobre|en|em|com|op|met|på|med|na|ze?|s|se|σε|με|на|в|с)\s+\D+$",
    re.IGNORECASE,
)
"""Behind a case what a thing is on or with there, and no second case: "on perspex mount"."""
_SIDED = re.compile(
    r"\b(?:left|right|first|second|third|north|south|east|west|upper|lower|link|recht|nord|süd|ost|west|gauche|droit|sud|est"
    r"|ouest|sinistr|destr|ovest|izquierd|derech|norte|oeste|esquerd|direit|lew|praw|лев|прав|αριστερ|δεξι)",
    re.IGNORECASE,
)
"""Words that tell one of several pedestals of a room from the others."""
_EASTERN = "\u3040-\u30ff\u3400-\u9fff\uac00-\ud7af"
"""Signs of Chinese, Japanese and Korean."""
_OF_ROOM_SIGNS = "室厅廳館馆堂殿院楼樓层層階층실관홀庫库一二三四五六七八九十"
"""Those of them that end the name of a room or a storey, or count it."""
_SIGN_BEHIND = re.compile(rf"\d\s+{_CODE.pattern}[a-z]?$")
_SIGNED_CASE = re.compile(r"\s*[A-Z]{1,4}[ .-]?\d{1,4}[a-z]?\s*\(([^()]+)\)")
"""A case by its sign, and what kind of case it is: "CC2 (centre case)"."""
_CUT_ELSEWISE = frozenset({"pal", "par", "sal", "gal", "mag", "col", "dep"})
"""What is short for other words in places: a palace, a storey, a hall, a gallery, a store."""

_NONE = ("FS", "EXP", "WN", "WE", "WS", "WW")
"""Free-standing, exposed and the four walls, in the column for cases of the Victoria and Albert Museum."""
_OF_ROOMS = (Furniture.FLOOR, Furniture.WALL, Furniture.RAIL)
_NO_CASE = (
    rf"(?!case (?:{'|'.join(_NONE)})\b|(?:hors|sans|outside(?: of)?|not in|ohne|außerhalb(?: der)?|fuori|senza|fuera de"
    r"|sin|fora d[ae]|sem|buiten(?: de)?|zonder|utanför|uden|poza|bez|mimo|вне|без|εκτός)\b)"
)
"""No case is behind these words: "hors vitrine", as the Louvre says it."""

_MIDDLE = frozenset(map(str.casefold, place_words("middle")))
SIDES_OF_ROOMS = _MIDDLE.union(map(str.casefold, place_words("side")))
"""Sides of a room, and its middle."""

ROOM = re.compile(
    r"(?<!\w)(?:room|rm\.?|gallery|hall|court|atrium|lobby|foyer|wing|pavilion|\w*saal|\w*raum|galerie|\w*kabinett|halle|salle"
    r"|salon|sala|salone|galleria|galería|galeria|αιθ\.|zaal|\w*sal(?:en)?|\w*rummet|\w*rommet|\w*hallen|galleriet|terem|αίθουσα|salonu|зал|зала|сала|dvorana|soba|salė|zāle"
    r"|ruang|gedung|phòng|nhà|salla|დარბაზი|սրահ|ցուցասրահ|ห้อง\S*|القاعة|قاعة|غرفة|تالار|אולם|חדר|\w*展示室[a-z\d]{0,3})(?!\w)",
    re.IGNORECASE,
)
"""A room that is named without a number or a mark behind it: "Fossil room Case 2"."""
_OF_HOUSES = re.compile(
    r"(?:[\w'\u2019.-]+\s+){0,2}(?:kitchen|bedroom|library|ballroom|parlou?r|nursery|barn"
    r"|(?:dining|drawing|dressing|breakfast|morning) room|stable|cellar|attic"
    r"|chapel|sacristy|nave|choir|staircase|corridor|courtyard|garden|küche|\w*stube|\w*kammer|scheune|(?<!\s)stall|keller|diele|flur"
    r"|\w*zimmer|\w*kapelle|sakristei|langhaus|chor|treppenhaus|\w*hof|garten|dachboden|tenne|cuisine|chambre|grange"
    r"|étable|grenier|bibliothèque|chapelle|sacristie|chœur|escalier|couloir|jardin|cucina|stalla|fienile|cantina"
    r"|soffitta|salotto|biblioteca|cappella|sacrestia|navata|presbiterio|cortile|giardino|cocina|dormitorio|granero"
    r"|establo|bodega|comedor|capilla|sacristía|escalera|pasillo|patio|jardín|cozinha|quarto|celeiro|adega|capela"
    r"|sacristia|escada|pátio|jardim|keuken|slaapkamer|schuur|kelder|zolder|kapel|kuchnia|izba|stodoła|stajnia|piwnica"
    r"|kaplica|kuchyně|světnice|stodola|chlév|kaple|konyha|istálló|κουζίνα|παρεκκλήσι|αυλή|κήπος|κελάρι|mutfak|ahır"
    r"|kiler|avlu|bahçe|stuga|köket|kjøkken|låve|tupa)(?:\s+(?:\d\w*|[a-z]|[ivx]+))?\s*",
    re.IGNORECASE,
)
"""A room of a house, a farm or a church, which is the whole that is said: "Blue bedroom", and no garden bench."""


def names_room(text: str) -> bool:
    """Say whether a text names a room by what it is: with a word for rooms of museums, or as one of a house."""
    return ROOM.search(text) is not None or _OF_HOUSES.fullmatch(text) is not None


_NUMBERED_ROOM = re.compile(
    rf"(.*?(?:{ROOM.pattern}\s?(?:no\.?|nr\.?|#|№)?\s?{_SIGN}|\S[室厅廳館실관홀]))\s+(\S.*)", re.IGNORECASE
)
"""One with its number and more words behind: "Gallery 3 on plinth"."""


_NAMED_ROOM = re.compile(r"((?:[A-Z\u00c0-\u00de][\w'\u2019-]+\s+){2})([a-z].*)", re.DOTALL)
"""Two words with capitals ahead of one without: "Mana Whenua plinth 2", but no "Large plinth 2"."""


_SHOWN_AT = re.compile(
    r"\s*([^:(]{2,40}?)(?: (?:at|in|im|bei|à|en|a))?\s*(?::\s*([^\s:].*?)|\(\s*([^()]+?)\s*\))\s*", re.DOTALL
)
"""That something is on display, and where: "Currently on view at: Gallery 109", "On display (G12/dc3)"."""


def located(text: str) -> str:
    """Return a place without the words ahead of it, or behind it, that say that what is there is on display.

    Parameters
    ----------
    text : str
        As the museum writes it: "On display: Hall of Musical Instruments".
    """
    if len(text) > LONGEST:
        return text
    ahead, _, last = text.rpartition(" - ")
    if ahead.strip() and says_shown(last):
        return ahead.strip()  # "Greece Gallery - On Display"
    found = _SHOWN_AT.fullmatch(text)
    return found[2] or found[3] if found and says_shown(found[1]) else text


_CASE_FIRST = re.compile(
    rf"(\w{{3,20}})\s+((?!(?:gallery|hall|room|court|atrium|lobby|wing|pavilion)\b){ROOM.pattern}(?:\s+\w{{1,4}})?)",
    re.IGNORECASE,
)
"""What a thing stands in or hangs on ahead of its room: "Vitrine Hörsaal", but "Vitrine Gallery" is a room."""


class NamedPlace(NamedTuple):
    """What a place names: a room, a case, plinth or shelf in it, how a thing is held there; "" for what it does not."""

    room: str
    case: str = ""
    displayed: str = ""


# A museum has far fewer places than things.
@lru_cache(maxsize=4096)
def parted(text: str) -> NamedPlace:
    """Return what a place names.

    Parameters
    ----------
    text : str
        As the museum writes it: "Gallery 1, case 3", "Atrium, suspended from the ceiling", "Hall (hung)". One
        that names a case and no room, "Vitrine 3", is both.
    """
    if len(text) > LONGEST:
        return NamedPlace(text)
    text = located(text)
    coded = _CODES.fullmatch(text)
    if coded:
        case, spot = coded["case"] or coded["dc"] or "", coded["spot"] or coded["od"] or ""
        return NamedPlace(coded[1] or coded["room"], case, spot)
    enclosed = _ENCLOSED.fullmatch(text)
    # "Rm 4 CC2 (centre case)": what kind of case the one of that sign is.
    signed = enclosed and _SIGN_BEHIND.search(enclosed[1]) and _is_case(enclosed[2])
    if enclosed and not signed and _tells(enclosed[2]):
        outer = parted(enclosed[1])
        return outer._replace(displayed=", ".join(filter(None, (outer.displayed, enclosed[2]))))
    if enclosed and _patterns("." in text)[1].match(enclosed[2]):
        return NamedPlace(enclosed[1], enclosed[2])
    ahead = _CASE_FIRST.fullmatch(text)
    if ahead and re.fullmatch(_SIDE, ahead[1], re.IGNORECASE):
        return NamedPlace(ahead[2], displayed=ahead[1])
    if ahead and _patterns("." in text)[0].fullmatch(ahead[1]):
        return NamedPlace(ahead[2], ahead[1])
    lies = _SIDE_OF.fullmatch(text)
    walled = _NUMBERED_ROOM.fullmatch(text)
    if lies and names_room(lies[1]) and not (walled and _is_spot(walled[2])):
        return NamedPlace(lies[1], displayed=lies[2])
    text = _NOTHING_BEHIND.sub("", text)
    ends = [found.span() for found in _separators(UNPARTED.search(text) is not None, "." in text).finditer(text)]
    spans = list(zip((0, *(end for _, end in ends)), (*(start for start, _ in ends), len(text)), strict=True))
    if len(spans) > 1 and says_shown(text[: spans[0][1]]):
        # "On view - Room 1, case 3": that it is on view is no part of the room's name.
        return parted(text[spans[1][0] :])
    whole, numbered, inside = _patterns("." in text)
    room = _room_apart(text, spans[0])
    spans = room + spans[1:]
    pieces = [text[start:end] for start, end in spans]
    if len(pieces) > 1 and _bare_plinth(pieces[0]):
        return NamedPlace(text[spans[1][0] :], displayed=pieces[0])
    # Of plinths without a number a room has several: what stands on one has it to itself.
    cases = [_is_case(piece) and not _bare_plinth(piece) for piece in pieces]
    if any(cases):
        first = cases.index(True)
        if first:
            # "Case 3, on a cushion": how a thing is held there is no part of its case, which others share.
            further = range(first + 1, len(pieces))
            held = next((at for at in further if not cases[at] and (_holds(pieces[at]) or _UPON.match(pieces[at]))), 0)
            case = text[spans[first][0] : spans[held - 1][1] if held else len(text)]
            return NamedPlace(text[: spans[first - 1][1]], case, text[spans[held][0] :] if held else "")
        if not all(cases):
            # "Case 3, Gallery 1": the other way round.
            other = cases.index(False)
            return NamedPlace(text[spans[other][0] :], text[: spans[other - 1][1]])
        behind = _NUMBERED_ROOM.fullmatch(text) if len(spans) == 1 else None
        if behind and whole.match(behind[2]):
            return NamedPlace(behind[1], behind[2])
        found = inside.search(text) if len(spans) == 1 else None
        if found and ROOM.search(text[: found.start()]):
            return NamedPlace(text[: found.start()].rstrip(), text[found.start() :])
        named = _NAMED_ROOM.fullmatch(text) if len(spans) == 1 else None
        if named and numbered.match(named[2]):
            return NamedPlace(named[1].rstrip(), named[2])
        return NamedPlace(text, text if len(spans) > 1 or numbered.match(text) else "")
    held = next(
        (at for at, one in enumerate(pieces) if at and (_tells(one) or _OF_WALLS.fullmatch(one) or at < len(room))), 0
    )
    if held:
        return NamedPlace(text[: spans[held - 1][1]], displayed=text[spans[held][0] :])
    behind = _NUMBERED_ROOM.fullmatch(text)
    if behind and _tells(behind[2]):
        return (
            NamedPlace(behind[1], behind[2]) if whole.match(behind[2]) else NamedPlace(behind[1], displayed=behind[2])
        )
    found = inside.search(text)
    room_alone = text[: found.start()].rstrip() if found else ""
    if room_alone:
        return NamedPlace(room_alone, text[len(room_alone) :].strip())
    # "Suspended above the stairs": a place in the air is no room's name alone.
    return NamedPlace(text, displayed=text if hangs_above(text) else "")


def _is_spot(piece: str) -> bool:
    """Whether a piece of a place tells where in a room a thing is: one of its walls, a panel, or its middle."""
    # "Gallery 5 North" may be a room beside "Gallery 5 South".
    return _OF_WALLS.fullmatch(piece) is not None or piece.strip().casefold() in _MIDDLE


def _room_apart(text: str, first: tuple[int, int]) -> list[tuple[int, int]]:
    """Return the first piece of a place, in two where a room with its number is followed by a case or a spot in it."""
    behind = _NUMBERED_ROOM.fullmatch(text, *first)
    if behind is None or not (_is_case(behind[2]) or _holds(behind[2]) or _is_spot(behind[2])):
        return [first]
    return [behind.span(1), behind.span(2)]


def _is_case(piece: str) -> bool:
    """Whether a piece of a place is a case, a pedestal or a shelf: "CC2 (centre case)", "case F upper shelf"."""
    whole = _patterns("." in piece)[0]
    signed, shelved = _SIGNED_CASE.match(piece), _shelved("." in piece).match(piece)
    return (
        whole.match(piece) is not None
        or (piece.endswith(")") and whole.match(piece.partition("(")[0]) is not None)
        or (signed is not None and whole.match(signed[1]) is not None)
        or (shelved is not None and whole.match(shelved[1]) is not None)
    )


@cache
def _shelved(points: bool) -> re.Pattern[str]:
    """Return what finds a case with its number, and then what is a shelf in it."""
    return re.compile(rf"\s*(?:[^\W\d_]+[\s-]+){{0,2}}{_counted(points)}\s+(\S.*)", re.IGNORECASE)


def _holds(piece: str) -> bool:
    """Whether a piece of a place tells how a thing is held there, or that it is on the floor."""
    told = told_by(piece)
    return stands_or_hangs(piece) or told.mount is not None or told.hanging is not None


def spot_of(case: str, furniture: object = None) -> str:
    """Return how a thing is held by a field for cases that names none; "" where it names one.

    Parameters
    ----------
    case : str
        As the museum writes it: "wall", "floor"; free-standing (FS), exposed (EXP) and walls (WN to WW) as the
        Victoria and Albert Museum does.
    furniture : object, optional
        What else of the record says that it stands on or hangs from: of W05, that it is a wall.
    """
    if furniture in _OF_ROOMS and _CODE.fullmatch(case.strip()):
        return case
    if case.strip() in _NONE:
        return f"case {case.strip()}"
    whole = _patterns("." in case)[0]
    if _bare_plinth(case) or in_no_case(case):
        return case
    within = not case.strip() or any(map(whole.match, _SEPARATOR.split(case[:LONGEST])))
    told = told_by(case)
    open_ = told.furniture in _OF_ROOMS or told.support in (Support.HUNG, Support.SUSPENDED)
    return case if open_ and not within else ""


@lru_cache(maxsize=4096)
def case_in(text: str) -> str:
    """Return the case, plinth or shelf that a text on how a thing is displayed names by its number; else "".

    Parameters
    ----------
    text : str
        As the museum writes it: "showcase 4", "Vitrine 12, on a cushion".
    """
    numbered = _patterns("." in text)[1]
    pieces = [piece.strip() for piece in _BESIDE.split(text[:LONGEST])]
    at = next((at for at, piece in enumerate(pieces) if numbered.match(piece)), None)
    if at is None:
        return ""
    shelf = told_by(pieces[at]).furniture is Furniture.SHELF
    return pieces[at - 1] if at and shelf and _CODE.fullmatch(pieces[at - 1]) else pieces[at]


@lru_cache(maxsize=4096)
def beside_case(text: str) -> str:
    """Return what a text on a case says beside its name: of "case 4, hung" that it hangs; "" for nothing.

    Parameters
    ----------
    text : str
        As the museum writes it.
    """
    pieces = _SEPARATOR.split(text[:LONGEST])
    return ", ".join(piece for piece in pieces if not _patterns("." in piece)[0].match(piece))


def _tells(piece: str) -> bool:
    if piece.casefold() == "loft":
        return False  # a room below an English roof; in Danish, where it is a ceiling, things hang "i loftet"
    told = told_by(piece)
    # "The Plinth Room" is one.
    return told.support is not None or (told.furniture is not None and ROOM.search(piece) is None)


@cache
def _separators(signs: bool, points: bool) -> re.Pattern[str]:
    """Return what parts the pieces of a place; where it has Chinese, Japanese or Korean signs, a blank too."""
    # "Gallery 12 Case 3 shelf 2": behind a number a case or a shelf begins a piece of its own.
    behind = rf"(?:(?<=\d)|(?<=\d[a-z]))\s+(?={_counted(points)}(?!\w))"
    spaced = rf"|(?<=\S)[\s\u3000]+(?=\S*[{_EASTERN}])" if signs else ""
    return re.compile(rf"{_SEPARATOR.pattern}|{behind}{spaced}", re.IGNORECASE)


@cache
def _words() -> tuple[str, ...]:
    """Return the words for cases, pedestals and shelves."""
    kinds = (Furniture.SHOWCASE, Furniture.PEDESTAL, Furniture.SHELF)
    return tuple(word for kind in kinds for word in words_for(kind) if "*" not in word)


@lru_cache(maxsize=4096)
def _bare_plinth(text: str) -> bool:
    """Whether a text is of a pedestal, and tells it from no other: "Sockel", "on stone plinth", not "left plinth"."""
    whole, numbered, _ = _patterns("." in text)
    text = text.partition("(")[0] if text.endswith(")") else text  # "on stone plinth (90 cm)"
    if whole.match(text) is None or numbered.match(text) is not None or _SIDED.search(text) is not None:
        return False
    return told_by(text).furniture is Furniture.PEDESTAL


def _cut_short() -> str:
    """Return what finds a word for a case, a pedestal or a shelf that a point cuts short: "vetr.", "gabl."."""
    stems = {word[:long] for word in (*_words(), *CASES) if word.isalpha() for long in range(3, len(word))}
    return rf"(?<!\w)(?:{'|'.join(sorted(filter(_parts_words, stems), key=len, reverse=True))})\."


def _parts_words(stem: str) -> bool:
    return UNPARTED.match(stem) is None and stem.casefold() not in _CUT_ELSEWISE


@cache
def _counted(points: bool) -> str:
    """Return what finds a case, a pedestal or a shelf with its number; where there are points, words cut short too."""
    numbered = f"(?:{any_of([*_words(), *CASES]).pattern}{f'|{_cut_short()}' if points else ''})"
    # 3号柜, 第2ケース: the number comes first.
    signs = any_of([*filter(UNPARTED.match, [*_words(), *CASES]), "柜", "櫃"]).pattern
    ahead = rf"[第제]?[\d一二三四五六七八九十]{{1,4}}\s?[号號番번]?\s?(?:{signs})"
    # "3. vitrin", "2. polc": the number comes first, as an ordinal.
    ordinal = rf"(?<!\w)\d{{1,3}}\.\s*{numbered}(?!\w)"
    return rf"(?:{_NO_CASE}{numbered}\.?\s*(?:no\.?|nr\.?|n[.°º]|#|№)?\s*{_SIGN}|{ahead}|{ordinal})"


@cache
def _patterns(points: bool) -> tuple[re.Pattern[str], re.Pattern[str], re.Pattern[str]]:
    """Return what is wholly a case, what is so with its number, and where one with a number begins."""
    word, counted = f"(?:{any_of(_words()).pattern})", _counted(points)
    # 独立ケース1: no blank parts a case from the words ahead of it.
    before = rf"\s*(?:[^\W\d_]+[\s-]+){{0,2}}(?:(?![{_OF_ROOM_SIGNS}])[{_EASTERN}]){{0,4}}?"
    return (
        re.compile(rf"{_NO_CASE}{before}(?:{counted}|{word}|case)\s*$", re.IGNORECASE),
        re.compile(rf"{_NO_CASE}{before}{counted}\s*$", re.IGNORECASE),
        re.compile(rf"{counted}(?!\w).*$", re.IGNORECASE | re.DOTALL),
    )
