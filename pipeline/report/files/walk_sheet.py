"""The sheet to walk a gallery with as PDF: one line an object, with room for what was measured, by whom and when.

A letter that the fonts lack is a box, and the sheet says so.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from io import BytesIO
from itertools import groupby
from threading import Lock

from pipeline.report.files.sheet_fonts import BOLD, LACKING, SANS, draw_text, ready, shown_letters, width_of
from pipeline.report.language import Language, _, moment, ngettext
from pipeline.report.pages.compose import PageHead
from pipeline.report.pages.walking import WalkRow, WalkView
from pipeline.report.text import BREAKS, count, plain, short

PAPERS = {"A4": (595.28, 841.89), "Letter": (612.0, 792.0)}
"""Sizes of paper, in points."""

_DRAWING = Lock()
"""Fonts of reportlab are for one document at a time."""

_MARGIN, _SIZE, _LEADING, _PAD = 28.0, 7.5, 8.4, 2.4
_LEAST = 13.2
"""Height of a line in points, 4.7 mm: what people write numbers in on squared paper."""
_PICTURE = 34.0
"""Side of the square of a picture in points, 12 mm."""
_LINES = 40
"""Lines of a cell at most: a third of a page is left where the number of an object has no end."""
_MOST = 700
"""Characters of a text at most, more than an object number can have."""
_ROW = 120
"""Characters of a line at most: no column holds as many."""
_REST = 12
"""Lines at most of the numbers of objects that need nothing."""
_FOOT = 12.0
_GREY = 0.42


@dataclass(frozen=True, slots=True)
class _Column:
    """A column of the sheet: its heading, its width in points, and how many lines it may have."""

    title: str
    width: float
    lines: int


@dataclass(frozen=True, slots=True)
class _Line:
    """A row of the sheet ready to be drawn: the lines of each text, and its height in points.

    band  : the heading of a part, which stands in place of a row
    text  : lines across the whole sheet, which stand in place of a row
    photo : the file of a picture, "" for none
    """

    cells: tuple[tuple[str, ...], ...]
    height: float
    ask: tuple[str, ...] = ()
    band: str = ""
    photo: str = ""
    text: tuple[str, ...] = ()


def sheet_file(page: str) -> str:
    """Return the file of the sheet beside the page of a gallery."""
    return f"{page.removesuffix('.html')}-sheet.pdf"


def sheet_pdf(
    view: WalkView,
    head: PageHead,
    language: Language,
    paper: str = "A4",
    images: Mapping[str, bytes] | None = None,
) -> bytes:
    """Return the sheet as PDF; the same results give the same bytes.

    Parameters
    ----------
    view : WalkView
        What is on it; with nothing to do it says so.
    head : PageHead
        Where the results come from.
    language : Language
        Of the pages, which is being spoken.
    paper : {"A4", "Letter"}
        Its size.
    images : mapping of str to bytes, optional
        Pictures of its objects as JPEG, by the files that its rows name; without any there is no column for them.

    Returns
    -------
    bytes
        Of the file.

    Raises
    ------
    ReportError
        Where the fonts are not there.
    """
    with _DRAWING:
        return _Sheet(view, head, language, PAPERS[paper], images or {}).drawn()


class _Sheet:
    """One sheet that is being drawn."""

    def __init__(
        self,
        view: WalkView,
        head: PageHead,
        language: Language,
        size: tuple[float, float],
        images: Mapping[str, bytes],
    ) -> None:
        from reportlab.pdfgen.canvas import Canvas

        ready()
        self._view, self._head, self._size = view, head, size
        self._lacks = False
        self._images = {row.photo: images[row.photo] for row in (*view.act, *view.measure) if row.photo in images}
        self._stream = BytesIO()
        # Invariant: neither the hour at which it is drawn nor chance is in the file.
        self._pdf = Canvas(self._stream, pagesize=size, pageCompression=1, invariant=1, lang=language.code)
        self._width = size[0] - 2.0 * _MARGIN
        self._columns = self._of_width()
        # A number alone is no name on a sheet of paper.
        named = " ".join((_("Gallery"), view.gallery)) if view.gallery.isdigit() else plain(view.gallery)
        self._name = self._fit(named) if view.gallery else _("No gallery recorded")
        if view.page.of > 1:
            part = _("part %(number)s of %(of)s") % {"number": view.page.number, "of": view.page.of}
            self._name = f"{self._name}, {part}"

    def _of_width(self) -> tuple[_Column, ...]:
        # Where something has a picture, the tick box has it beside.
        rows = (*self._view.act, *self._view.measure)
        fixed = [
            _Column("", 16.0 + (_PICTURE + _PAD if self._images else 0.0), 0),
            _Column(_("Object"), 78.0, _LINES),
            _Column("", 0.0, 3),
            _Column(_("What to do"), self._held((row.what for row in rows), 88.0, 112.0), 3),
            _Column(_("Set to"), self._held((row.numbers for row in rows), 90.0, 138.0), 4),
            _Column(_("Measured"), 58.0, 2),
            _Column(_("Initials"), 36.0, 0),
            _Column(_("Date"), 38.0, 0),
        ]
        fixed[2] = _Column(_("Title"), self._width - sum(one.width for one in fixed), 2)
        return tuple(fixed)

    def _held(self, texts: Iterable[str], least: float, most: float) -> float:
        """Return the width of a column in which most texts take one line, as far as there is room."""
        wide = sorted(width_of(self._fit(plain(text)[:_MOST]), SANS, _SIZE) for text in texts if text)
        asked = wide[(19 * (len(wide) - 1)) // 20] + 2.0 * _PAD + 0.5 if wide else least
        return min(max(asked, least), most)

    def drawn(self) -> bytes:
        top = self._head_lines()
        room = self._size[1] - 2.0 * _MARGIN - _FOOT - 14.0
        # What the fonts lack is known once all is laid out: the note about it has its place in any case.
        pages = _paged(self._lines(), room - 11.0 * len(top) - 24.0, room)
        # Not within an f-string: what is taken out for translators is not looked for there.
        kind = _("sheet to walk with")
        self._pdf.setTitle(f"{plain(self._view.gallery) or _('No gallery recorded')}: {kind}")
        self._pdf.setAuthor(plain(self._head.museum))
        self._pdf.setCreator("Kouros")
        for at, lines in enumerate(pages, 1):
            self._page(lines, at, len(pages), top if at == 1 else ())
            self._pdf.showPage()
        self._pdf.save()
        return self._stream.getvalue()

    # -----------------------------------------------------------------------------------------------------------------
    # Laying out

    def _head_lines(self) -> tuple[str, ...]:
        act, measure = len(self._view.act), len(self._view.measure)
        if not act and not measure:
            told = _(
                "Nothing to do here: no object is to be acted on, and no measurement would change what is decided."
            )
        else:
            told = "; ".join(
                phrase % {"count": count(number)}
                for phrase, number in (
                    (ngettext("%(count)s object to act on", "%(count)s objects to act on", act), act),
                    (ngettext("%(count)s object to measure", "%(count)s objects to measure", measure), measure),
                )
                if number
            )
            told += ". " + _("Tick what is done; write down what was measured, and who did it when.")
        return self._wrapped(told, SANS, self._width, 2)

    def _lines(self) -> list[_Line]:
        out = []
        for title, rows in (
            (_("To act on"), self._view.act),
            (_("To measure: it may change what is decided"), self._view.measure),
        ):
            if rows:
                out += [_Line((), 14.0, band=title), *map(self._line, rows)]
        for phrase, numbers in (
            (_("Cannot be assessed yet: %(numbers)s."), self._view.unknown),
            (_("Nothing to do now for: %(numbers)s."), self._view.left),
        ):
            if numbers:
                text = phrase % {"numbers": ", ".join(numbers)}
                lines = self._wrapped(text, SANS, self._width - 2.0 * _PAD, _REST, _REST * _ROW * 2)
                out.append(_Line((), len(lines) * _LEADING + 2.0 * _PAD, text=lines))
        return out

    def _line(self, row: WalkRow) -> _Line:
        texts = ("", row.number, row.title, row.what, row.numbers)
        cells = [
            self._wrapped(text, BOLD if at == 1 else SANS, column.width - 2.0 * _PAD, column.lines)
            for at, (text, column) in enumerate(zip(texts, self._columns, strict=False))
        ]
        ask = self._wrapped(row.ask, SANS, self._columns[5].width - 2.0 * _PAD, 2)
        # What is to be measured stands above the room for the number.
        high = max(*map(len, cells), len(ask) + 1 if ask else 0)
        photo = row.photo if row.photo in self._images else ""
        least = _PICTURE + 2.0 * _PAD if photo else _LEAST
        return _Line(tuple(cells), max(least, high * _LEADING + 2.0 * _PAD), ask, photo=photo)

    def _fit(self, text: str) -> str:
        """Return a text with a box for each letter that the fonts lack."""
        shown = shown_letters(text)
        self._lacks |= LACKING in shown and LACKING not in text
        return shown

    def _wrapped(self, text: str, font: str, width: float, most: int, letters: int = _MOST) -> tuple[str, ...]:
        """Cut a text into lines of a width in points, an ellipsis where there are more than so many."""

        def fits(piece: str) -> bool:
            return width_of(piece, font, _SIZE) <= width

        whole = self._fit(plain(text)[:letters]).strip()
        if fits(whole):
            return (whole,) if whole else ()
        lines, line = [], ""
        for word in BREAKS.split(whole):
            joined = f"{line} {word}" if line else word
            if fits(joined):
                line = joined
                continue
            lines += [line] if line else []
            line = word
            while not fits(line):
                # A word that is wider than its column is cut where it is full.
                at = next(at for at in range(min(len(line), _ROW), 0, -1) if at == 1 or fits(line[:at]))
                lines, line = [*lines, line[:at]], line[at:]
                if len(lines) > most:
                    break
        lines += [line] if line else []
        if len(lines) > most:
            last = lines[most - 1]
            while last and not fits(f"{last}…"):
                last = last[:-1]
            lines = [*lines[: most - 1], f"{last}…"]
        return tuple(lines)

    # -----------------------------------------------------------------------------------------------------------------
    # Drawing

    def _page(self, lines: Sequence[_Line], at: int, of: int, told: Sequence[str]) -> None:
        pdf, left = self._pdf, _MARGIN
        y = self._size[1] - _MARGIN
        if at == 1:
            y -= 12.0
            self._text(left, y, self._cut(self._name, BOLD, 13.0, self._width), BOLD, 13.0)
            y -= 3.0
            for line in told:
                y -= 11.0
                self._text(left, y, line, SANS, 8.0)
            y -= 9.0
        if lines:
            y = self._headings(y)
        pdf.setLineWidth(0.4)
        for row in lines:
            self._row(row, y)
            y -= row.height
        self._foot(at, of)

    def _headings(self, y: float) -> float:
        x = _MARGIN
        for column in self._columns:
            self._text(x + _PAD, y - 9.0, self._cut(column.title, SANS, 6.5, column.width - _PAD), SANS, 6.5, _GREY)
            x += column.width
        self._pdf.setLineWidth(0.9)
        self._pdf.line(_MARGIN, y - 13.0, _MARGIN + self._width, y - 13.0)
        return y - 13.0

    def _row(self, line: _Line, y: float) -> None:
        pdf, bottom = self._pdf, y - line.height
        if line.band:
            pdf.setFillGray(0.92)
            pdf.rect(_MARGIN, bottom, self._width, line.height, stroke=0, fill=1)
            self._text(_MARGIN + _PAD, bottom + 4.2, line.band, BOLD, _SIZE)
            return
        if line.text:
            for at, text in enumerate(line.text):
                self._text(_MARGIN + _PAD, y - _PAD - 7.0 - at * _LEADING, text, SANS, _SIZE)
            return
        pdf.rect(_MARGIN + _PAD, y - _PAD - 8.6, 9.0, 9.0)
        if line.photo:
            self._picture(line.photo, _MARGIN + 16.0, y - _PAD)
        x = _MARGIN
        for at, column in enumerate(self._columns):
            if at < len(line.cells):
                for row, text in enumerate(line.cells[at]):
                    font = BOLD if at == 1 else SANS
                    self._text(x + _PAD, y - _PAD - 7.0 - row * _LEADING, text, font, _SIZE)
            else:
                pdf.setStrokeGray(0.75)
                pdf.line(x, y, x, bottom)
            if at == len(line.cells):
                for row, text in enumerate(line.ask):
                    self._text(x + _PAD, y - _PAD - 5.0 - row * 7.0, text, SANS, 5.5, _GREY)
            x += column.width
        pdf.line(_MARGIN, bottom, _MARGIN + self._width, bottom)
        pdf.setStrokeGray(0.0)

    def _picture(self, file: str, left: float, top: float) -> None:
        """Draw a picture within its square, from the left and the top."""
        from reportlab.lib.utils import ImageReader

        picture = ImageReader(BytesIO(self._images[file]))
        wide, high = picture.getSize()
        scale = _PICTURE / max(wide, high)
        self._pdf.drawImage(picture, left, top - scale * high, scale * wide, scale * high)

    def _foot(self, at: int, of: int) -> None:
        y = _MARGIN
        right = _("page %(number)s of %(of)s") % {"number": at, "of": of}
        # The day alone: a gallery that did not change is of an hour that no other page tells.
        date = moment(self._head.finished[:10])
        middle = _("results of %(date)s") % {"date": date} if date else ""
        if self._view.decided > self._head.finished[:10]:
            # What people decided since is on the sheet too: it is not all of that day.
            middle = _("results of %(date)s, decisions until %(day)s") % {
                "date": date,
                "day": moment(self._view.decided),
            }
        name = self._cut(self._name, SANS, 7.0, 0.45 * self._width)
        self._text(_MARGIN, y, name, SANS, 7.0, _GREY)
        draw_text(self._pdf, (self._size[0] / 2.0 + 0.1 * self._width, y), plain(middle), SANS, 7.0, share=0.5)
        draw_text(self._pdf, (_MARGIN + self._width, y), right, SANS, 7.0, share=1.0)
        if self._lacks:
            told = _("%(box)s stands for letters that the fonts of this sheet lack; the page in the report has them.")
            self._text(_MARGIN, y + 10.0, told % {"box": LACKING}, SANS, 6.5, _GREY)

    def _cut(self, text: str, font: str, size: float, width: float) -> str:
        shown = short(text, 120)
        while len(shown) > 1 and width_of(shown, font, size) > width:
            shown = shown[:-2].rstrip("… ") + "…"
        return shown

    def _text(self, x: float, y: float, text: str, font: str, size: float, grey: float = 0.0) -> None:
        self._pdf.setFillGray(grey)
        draw_text(self._pdf, (x, y), text, font, size)


def _paged(lines: Iterable[_Line], first: float, room: float) -> list[list[_Line]]:
    """Cut the rows into pages, one at least: none is cut, and no heading of a part stands alone at the end.

    Parameters
    ----------
    lines : iterable of _Line
        All of them.
    first, room : float
        Height of the rows of the first page and of each other one, in points.
    """
    pages: list[list[_Line]] = [[]]
    left = first
    for heading, members in groupby(_kept_together(lines), key=lambda pair: pair[0]):
        del heading
        block = [line for _number, line in members]
        high = sum(line.height for line in block)
        if high > left and (pages[-1] or left < room):
            pages.append([])
            left = room
        pages[-1] += block
        left -= high
    return pages


def _kept_together(lines: Iterable[_Line]) -> Iterable[tuple[int, _Line]]:
    """Number rows: the heading of a part has the number of its first row."""
    at = 0
    for line in lines:
        yield at, line
        at += not line.band
