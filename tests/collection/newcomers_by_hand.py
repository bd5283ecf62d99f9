"""Exports of museums whose lists were kept by hand or by a program for small museums: sections, merged rooms, feet.

Made by hand as those of `newcomers`, with what a person would read from each.
"""

from __future__ import annotations

import csv
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import openpyxl

from .newcomers import Newcomer, Thing, _things


def feet_and_inches(folder: Path) -> Newcomer:
    """A table of PastPerfect: its own names, feet beside inches, 0 for what nobody measured, places now and usual.

    Sizes are such that they are whole quarters of an inch.
    """
    quarters = [
        Thing(
            number=f"{1962 + at % 40}.{at % 9 + 1:03d}.{at + 1:03d}",
            name=name,
            title=f"{name} no. {at}",
            medium=medium,
            place="Storage; Shelf B2" if at % 7 == 3 else ("Parlor", "Exhibit Hall; Case 1")[at % 2],
            shown=at % 7 != 3,
            height=2.54 * (4.25 + 1.75 * at),
            width=2.54 * (3.5 + 0.5 * at),
            depth=None if at % 3 == 0 else 2.54 * (2.25 + 0.25 * at),
            mass=None if at % 4 else 0.45359237 * (3.5 + at),
        )
        for at in range(40)
        for name, medium in [(("Painting", "Canvas, Oil"), ("Chair, Side", "Oak"), ("Crock", "Stoneware"))[at % 3]]
    ]
    path = folder / "OBJECTS.csv"
    with path.open("w", encoding="cp1252", newline="") as stream:
        writer = csv.writer(stream)
        writer.writerow(
            [
                *("OBJECTID", "ACCESSNO", "OBJNAME", "TITLE", "MATERIAL", "HOMELOC", "TEMPLOC", "STATUS", "HEIGHTFT"),
                *("HEIGHTIN", "WIDTHFT", "WIDTHIN", "DEPTHFT", "DEPTHIN", "DIAMETERFT", "DIAMETERIN", "WEIGHTLB"),
                "WEIGHTOZ",
            ]
        )
        for at, one in enumerate(quarters):
            sizes: list[object] = []
            for size in (one.height, one.width, one.depth, None):
                inches = round((size or 0.0) / 2.54 * 4) / 4
                sizes += [int(inches // 12), f"{inches % 12:.3f}"]
            ounces = 0.0 if one.mass is None else 16 * one.mass / 0.45359237
            moved = not one.shown and at % 2 == 0
            writer.writerow(
                [
                    *(one.number, one.number.rpartition(".")[0], one.name, one.title, one.medium),
                    *("Parlor" if moved else one.place, one.place if moved else ""),
                    *("On Exhibit" if one.shown else "In Storage", *sizes, int(ounces // 16), f"{ounces % 16:.2f}"),
                ]
            )
    return Newcomer(str(path), tuple(quarters))


def by_hand(folder: Path) -> Newcomer:
    """A workbook made by hand: a head of two rows, headings between the rows, rooms merged beside them, a sum below.

    Sizes are written as numbers, as fractions and with inch marks, in turn.
    """
    fractions = {0.0: "", 0.25: " 1/4", 0.5: " 1/2", 0.75: " 3/4"}
    things = tuple(
        Thing(
            number=f"{1971 + at}.{at + 1}",
            name=("Rocking chair", "Copper kettle", "Grandfather clock", "Sampler")[at // 6 % 4],
            title="",
            medium=("oak", "copper", "mahogany", "linen")[at // 6 % 4],
            place=("Parlour", "Attic store")[at // 3 % 2],
            shown=at // 3 % 2 == 0,
            height=None if at == 5 else 2.54 * (10.25 + at),
            width=2.54 * (8.5 + 0.25 * at),
            depth=None if at // 6 % 4 == 3 else 2.54 * (5.75 + 0.5 * at),
        )
        for at in range(24)
    )
    book = openpyxl.Workbook()
    sheet = book.worksheets[0]
    sheet.append(["HARBOUR TOWN HERITAGE SOCIETY"])
    sheet.append([])
    sheet.append(["Acc. #", "What it is", "Made of", "Where", "Displayed?", "Size (inches)", None, None, "Notes"])
    sheet.append([None, None, None, None, "Y/N", "H", "W", "D", None])
    sheet.merge_cells("F3:H3")
    for at, one in enumerate(things):
        if at % 6 == 0:
            sheet.append([])
            sheet.append([("FURNITURE", "KITCHEN", "CLOCKS", "NEEDLEWORK")[at // 6]])
        cells: list[object] = []
        for size in (one.height, one.width, one.depth):
            inches = None if size is None else round(size / 2.54 * 4) / 4
            fraction = "" if inches is None else f"{int(inches)}{fractions[inches % 1]}"
            cells.append("?" if inches is None else (inches, fraction, f'{fraction}"')[at % 3])
        place = one.place if at % 3 == 0 else None
        sheet.append([one.number, one.name, one.medium, place, "Y" if one.shown else "N", *cells, None])
        if at % 3 == 2:
            sheet.merge_cells(f"D{sheet.max_row - 2}:D{sheet.max_row}")
    sheet.append(["TOTAL", len(things)])
    path = folder / "Inventory FINAL.xlsx"
    book.save(path)
    return Newcomer(str(path), things)


def greek_workbook(folder: Path) -> Newcomer:
    """A catalogue of a Greek municipal museum: titles above the head, sizes as texts in three styles."""
    things = tuple(
        replace(one, title="", mass=None, height=one.height if one.height is not None else 9.5)
        for one in _things(
            "ΑΜΔ ",
            [("Εικόνα", "Αυγοτέμπερα σε ξύλο"), ("Αμφορέας", "Πηλός"), ("Προτομή", "Μάρμαρο")],
            ["Αίθουσα 1, Προθήκη 2", "Αίθουσα 3", "Αίθριο"],
            "Αποθήκη Β",
        )
    )
    book = openpyxl.Workbook()
    sheet = book.worksheets[0]
    sheet.append(["ΔΗΜΟΤΙΚΟ ΜΟΥΣΕΙΟ"])
    sheet.append(["Κατάλογος εκθεμάτων"])
    sheet.append([])
    sheet.append(["Α/Α", "Αρ. Ευρετηρίου", "Είδος", "Υλικό", "Διαστάσεις", "Θέση", "Σε έκθεση"])
    for at, one in enumerate(things):
        sizes = [f"{size:g}".replace(".", ",") for size in (one.height, one.width, one.depth) if size is not None]
        labels = (("Ύψος:", "Πλάτος:", "Βάθος:"), ("Υ.", "Π.", "Β."), ("ύψ.", "πλ.", "πάχ."))[at % 3]
        text = ", ".join(f"{label} {size} εκ." for label, size in zip(labels, sizes, strict=False))
        sheet.append([at + 1, one.number, one.name, one.medium, text, one.place, "Ναι" if one.shown else "Όχι"])
    path = folder / "katalogos.xlsx"
    book.save(path)
    return Newcomer(str(path), things)


BY_HAND: tuple[Callable[[Path], Newcomer], ...] = (feet_and_inches, by_hand, greek_workbook)
