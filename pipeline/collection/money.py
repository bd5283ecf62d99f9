"""Amounts of money as museums write them: $45,000.00, 45.000,00 €, CHF 12'500.-."""

import re
from collections.abc import Sequence

_MARK = r"(?P<{}>(?:[A-Z]{{1,3}}\s?)?[$€£¥₺₽₩₪]|[A-Z][A-Za-z]{{1,3}}\.?|円|元|원|Kč|zł)?"
_AMOUNT = re.compile(
    rf"{_MARK.format('before')}\s*"
    rf"(?P<whole>\d{{1,3}}(?:(?P<by>[.,'’ \u00a0\u202f])\d{{3}}(?:(?P=by)\d{{3}}){{0,4}})?|\d{{1,15}})"
    rf"(?:(?!(?P=by))[.,](?P<part>\d{{1,2}}|[-–]{{1,2}}))?\s*{_MARK.format('behind')}"
)
_GROUPS = re.compile(r"\D")
_LONGEST = 40


def amount(text: str) -> tuple[str, str] | None:
    """Return an amount as a plain number, and the mark of its money, "" where it has none.

    Three digits behind a mark are thousands, one or two are a part: money has no thousandths.

    Parameters
    ----------
    text : str
        "$45,000.00".

    Returns
    -------
    (str, str) or None
        ("45000.00", "$"); None for what is no amount, or has a mark at each end.
    """
    text = text.strip()
    found = _AMOUNT.fullmatch(text) if len(text) <= _LONGEST else None
    if found is None or (found["before"] and found["behind"]):
        return None
    part = found["part"] or ""
    number = _GROUPS.sub("", found["whole"]) + (f".{part}" if part.isdecimal() else "")
    return number, (found["before"] or found["behind"] or "").strip(" .")


def no_money(texts: Sequence[str]) -> str:
    """Return why a column holds no amounts of one money; "" where it does, or is empty."""
    found = [one for text in texts if (one := amount(text)) is not None]
    marks = sorted({mark for _, mark in found if mark})
    if len(found) < 0.5 * len(texts):
        return "most of its cells are no amounts"
    return f"it is in several moneys, {', '.join(marks[:5])}" if len(marks) > 1 else ""
