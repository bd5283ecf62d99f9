"""A small museum in which anything may change from night to night: its records, motions, settings, tables, decisions.

All of its files are written from what it holds, so that a museum of the same state can be made from nothing beside it.
"""

import csv
import io
import shutil
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from random import Random

import pytest
from sqlalchemy import insert, select

from pipeline import tables
from pipeline.cache import CHARTS
from pipeline.collection.inventory import latest_import
from pipeline.motions.manifest import SiteTable
from pipeline.motions.synthesis import half_sine_pulse
from pipeline.motions.writing import write_site
from pipeline.night.importing import go_back, import_collection
from pipeline.night.run import Selection, run
from pipeline.operations.workspace import open_workspace
from pipeline.quantities import G
from pipeline.records import DecisionKind
from pipeline.report.files import exports, page_renderer, report_writer
from pipeline.report.files.manifest import read_manifest
from pipeline.settings import Settings, load_settings, template
from pipeline.store.decisions import decisions_in_force
from pipeline.store.tables import DECISION
from pipeline.tools.decisions import Wish, decide
from pipeline.tools.sheet_answers import take_sheet
from tests.images.conftest import photograph
from tests.museum import DATABASE, SILENT, in_common, small, with_tables

COLUMNS = (
    "object_number", "title", "object_name", "gallery", "case", "on_display", "medium", "height_m", "width_m",
    "depth_m", "friction", "mass_kg", "clearance_m", "position_x_m", "position_y_m", "value_class", "support",
    "furniture", "furniture_anchorage", "value", "irreplaceable", "on_loan", "image",
)  # fmt: skip
EXPORTS = ("findings.csv", "objects.csv", "recommendations.csv")
NAMES = ("Vase", "Vase", "Bowl", "Plate", "Painting", "Figurine")
FLOOR = '\n[[floor]]\nname = "2"\nheight_ratio = 0.5\nperiod_s = 0.4\n'
RULES = "rule,class,aat,classification,words,medium,shape,why\nours,{},,,{},,,ours\n"
ISOLATORS = "name,kind,frequency,damping,friction,stroke,source\nours,friction_isolator,,,{},,the maker\n"
FURNITURE = (
    "furniture,title,frequency,frequency_low,frequency_high,damping,damping_low,damping_high,level_error,source\n"
    "showcase,a showcase,{0},{0},{0},0.05,0.05,0.05,0,hammer tests\n"
)
FRICTION = "object_material,surface_material,value,low,high,source\nMarble,Formica,{0},{0},{0},tilt tests\n"


def leave_out_pages(patch: pytest.MonkeyPatch) -> None:
    """Leave out what costs much of a report and is read by people alone: HTML, sheets, the workbook."""
    for module in (page_renderer, report_writer):
        patch.setattr(module, "fill", lambda *_: "")
    patch.setattr(page_renderer, "sheet_pdf", lambda *_: b"")
    patch.setattr(exports, "WORKBOOK_ROWS", 0)


def vessels(clearance: float) -> str:
    """A museum's own row of classes.csv: Kouros's of vessels with another clearance."""
    header, *rows = Path(tables.__file__).with_name("classes.csv").read_text(encoding="utf-8").splitlines()
    (row,) = (row for row in rows if row.startswith("vessel,"))
    before, after = ",0.10,0.05,0.30,", f",{clearance},0.05,0.30,"
    assert before in row
    return f"{header}\n{row.replace(before, after)}\n"


def measures(limit: float) -> str:
    """Kouros's table of measures with another limit of the clearance that a display can spare."""
    text = Path(tables.__file__).with_name("measures.csv").read_text(encoding="utf-8")
    before, after = "clearance,10,Keep clear,0.30,", f"clearance,10,Keep clear,{limit},"
    assert before in text
    return text.replace(before, after)


@dataclass
class Changing:
    """A museum that changes.

    held : the export that the inventory was made of, where a person went back to it and the one there is not read
    """

    home: Path
    random: Random
    rows: list[dict[str, str]] = field(default_factory=list)
    columns: list[str] = field(default_factory=lambda: list(COLUMNS))
    newline: str = "\n"
    values: dict[str, dict[str, str]] = field(default_factory=dict)
    tables: dict[str, str] = field(default_factory=dict)
    scale: float = 1.0
    v_max: float | None = None
    upstairs: list[str] = field(default_factory=list)
    house: str = ""
    pictures: dict[str, str] = field(default_factory=lambda: {"a.png": "red", "b.png": "blue"})
    sheets: list[str] = field(default_factory=list)
    held: bytes | None = None
    imports: list[tuple[int, bytes, int]] = field(default_factory=list)
    made: int = 0

    # -----------------------------------------------------------------------------------------------------------------
    # Its files

    @classmethod
    def of(cls, home: Path, seed: int, objects: int = 12) -> "Changing":
        """A museum of some objects in three galleries under one short pulse."""
        museum = cls(home, Random(seed))
        home.mkdir(parents=True)
        site = SiteTable(name="Test", latitude=0.0, longitude=0.0)
        pulse = half_sine_pulse(0.45 * G, 0.3, dt=0.01).called("pulse")
        manifest = write_site(home / "site", [("rare", pulse)], site, licence="none", why="a test")
        (home / "manifest.txt").write_text(manifest.read_text(encoding="utf-8") + FLOOR, encoding="utf-8")
        for _ in range(objects):
            museum.rows.append(museum.object())
        museum.rows[1] = museum.rows[0] | {"object_number": museum.rows[1]["object_number"]}
        museum.write()
        return museum

    def object(self) -> dict[str, str]:
        """A new object; many are alike, some stand in a case, some are not on display, some have a place."""
        choice, self.made = self.random.choice, self.made + 1
        name, gallery = choice(NAMES), choice(("A", "B", "C"))
        row = dict.fromkeys(COLUMNS, "") | {
            "object_number": f"{self.made:03d}",
            "title": choice((name, name, f"{name} with a bird")),
            "object_name": name.lower(),
            "gallery": gallery,
            "case": choice(("", "", "", "I")),
            "on_display": choice(("yes", "yes", "yes", "no")),
            "medium": "oil on canvas" if name == "Painting" else "earthenware",
            "height_m": choice(("0.1", "0.3", "0.5", "")),
            "width_m": choice(("0.1", "0.2")),
            "depth_m": "0.02" if name == "Painting" else "0.1",
            "image": choice(("", "a.png", "b.png", "none.png")),
        }
        if gallery == "A" and self.random.random() < 0.7:
            row |= {"position_x_m": choice(("0", "0.15", "0.4")), "position_y_m": choice(("0", "0.2"))}
        return row

    @property
    def export(self) -> bytes:
        """The museum's export as its file holds it."""
        stream = io.StringIO()
        writer = csv.DictWriter(stream, self.columns, lineterminator=self.newline)
        writer.writeheader()
        writer.writerows(self.rows)
        return stream.getvalue().encode()

    def write(self) -> None:
        """Write all files as they are now."""
        text = (self.home / "manifest.txt").read_text(encoding="utf-8")
        more = f"processed = true\nscale = {self.scale}"
        if self.v_max is not None:
            more += f"\nv_max_cm_s = {self.v_max}"
        (self.home / "site" / "manifest.toml").write_text(text.replace("processed = true", more), encoding="utf-8")
        (self.home / "collection.csv").write_bytes(self.export)
        for name, content in self.tables.items():
            (self.home / name).write_text(content, encoding="utf-8")
        for name, colour in self.pictures.items():
            file = self.home / "pictures" / name
            file.parent.mkdir(exist_ok=True)
            content = photograph((20, 10), colour, "PNG")
            if not file.exists() or file.read_bytes() != content:
                file.write_bytes(content)
        for at, sheet in enumerate(self.sheets):
            (self.home / f"sheet-{at}.csv").write_text(sheet, encoding="utf-8")
        said = small(template(museum="Test", source="collection.csv", mapping="kouros", site="site"))
        given = {"shrink_limit": "0.99", "fragility": "false", "survey": "false"} | self.values.get("any", {})
        for name, value in given.items():
            lines = said.split("\n")
            (at,) = [n for n, line in enumerate(lines) if line.startswith(f"{name} = ")]
            lines[at] = f"{name} = {value}"
            said = "\n".join(lines)
        floors = f'[floors]\n"2" = {self.upstairs!r}'.replace("'", '"') if self.upstairs else "[floors]"
        said = said.replace("[images]", '[images]\nfolder = "pictures"').replace('folder = ""\n', "")
        text = f"{said.replace('[floors]', floors)}\n{self.house}"
        (self.home / "kouros.toml").write_text(text, encoding="utf-8")

    @property
    def settings(self) -> Settings:
        """As its file says now."""
        return load_settings(self.home / "kouros.toml")

    def set(self, name: str, value: str) -> None:
        """Give a setting another value, as TOML."""
        self.values.setdefault("any", {})[name] = value

    # -----------------------------------------------------------------------------------------------------------------
    # Its nights

    def night(self, **how: bool) -> Path:
        """Run a night, and return the folder of its report."""
        in_common(self.home)
        with_tables(self.home / DATABASE)
        self.write()
        if self.held is not None and self.export != self.imports[-1][1]:
            self.held = None
        summary = run(self.settings, SILENT, **how)
        info = latest_import(open_workspace(self.settings).engine)
        assert info is not None
        if self.held is None and (not self.imports or info.id != self.imports[-1][0]):
            self.imports.append((info.id, self.export, len(self.sheets)))
        assert summary.report is not None
        assert summary.faults == 0
        return summary.report.parent

    def from_nothing(self, folder: Path) -> Path:
        """Run a first night of a museum of the same state, and return the folder of its report."""
        left = shutil.ignore_patterns("kouros.sqlite*", "reports", ".kouros*", "imports")
        shutil.copytree(self.home, folder, ignore=left)
        # Motions are processed anew: a change that what is kept of them does not know of would else be in both.
        in_common(folder, (CHARTS,))
        with_tables(folder / DATABASE)
        if self.held is not None:
            (folder / "collection.csv").write_bytes(self.held)
        settings = load_settings(folder / "kouros.toml")
        mine, new = open_workspace(self.settings), open_workspace(settings)
        import_collection(new, folder / "collection.csv", "kouros", shrink_limit=1.0)
        for at, _ in enumerate(self.sheets):
            take_sheet(new, folder / "kouros.toml", folder / f"sheet-{at}.csv")
        with mine.engine.connect() as source, new.engine.begin() as target:
            rows = [dict(row) for row in source.execute(select(DECISION)).mappings()]
            if rows:
                target.execute(insert(DECISION), rows)
        summary = run(settings, SILENT)
        assert summary.report is not None
        return summary.report.parent

    # -----------------------------------------------------------------------------------------------------------------
    # What may change

    def any_row(self) -> dict[str, str]:
        return self.random.choice(self.rows)

    def swap_rows(self) -> None:
        self.random.shuffle(self.rows)

    def add_row(self) -> None:
        self.rows.insert(self.random.randrange(len(self.rows)), self.object())

    def remove_row(self) -> None:
        if len(self.rows) > 8:
            self.rows.remove(self.any_row())

    def change_row(self) -> None:
        row, other = self.any_row(), self.object()
        name = self.random.choice([*COLUMNS[1:], "friction", "mass_kg", "clearance_m"])
        more = {"friction": "0.3", "mass_kg": "2.5", "clearance_m": "0.02", "value_class": "A", "support": "fastened"}
        more |= {"value": "40000", "irreplaceable": "yes", "on_loan": "yes"}
        row[name] = other[name] or ("" if row[name] else more.get(name, ""))

    def other_picture(self) -> None:
        self.pictures[self.random.choice(("a.png", "b.png"))] = self.random.choice(("red", "blue", "green", "black"))

    def make_alike(self) -> None:
        row, other = self.any_row(), self.any_row()
        row |= other | {"object_number": row["object_number"], "gallery": row["gallery"]}

    def exchange_numbers(self) -> None:
        one, other = self.any_row(), self.any_row()
        one["object_number"], other["object_number"] = other["object_number"], one["object_number"]

    def reorder_columns(self) -> None:
        self.random.shuffle(self.columns)

    def other_line_ends(self) -> None:
        self.newline = "\r\n" if self.newline == "\n" else "\n"

    def rename_gallery(self) -> None:
        before = self.any_row()["gallery"]
        after = self.random.choice(("A", "B", "C", "D", "E"))
        for row in self.rows:
            if row["gallery"] == before:
                row["gallery"] = after

    def lay_sheet_over(self) -> None:
        if self.held is not None:
            self.other_line_ends()
        row = self.any_row()
        name, value = self.random.choice((("height_m", "0.42"), ("mass_kg", "1.7"), ("friction", "0.25")))
        # As the sheet of a survey, or with what the export says already: then only where it comes from is another.
        value = row[name] or value if self.random.random() < 0.4 else value
        self.night()
        self.sheets.append(f"object_number,gallery,{name}\n{row['object_number']},,{value}\n")
        self.write()
        sheet = self.home / f"sheet-{len(self.sheets) - 1}.csv"
        take_sheet(open_workspace(self.settings), self.home / "kouros.toml", sheet)

    def other_v_max(self) -> None:
        self.v_max = self.random.choice((None, 20.0, 60.0))

    def other_scale(self) -> None:
        self.scale = self.random.choice((0.7, 1.0, 1.3))

    def other_settings(self) -> None:
        name, values = self.random.choice((
            ("azimuth_step", ("10.0", "30.0")), ("fragility", ("true", "false")), ("survey", ("true", "false")),
            ("fidelity", ('"auto"', '"history"', '"chart"')), ("length", ('"cm"', '"in"')),
        ))  # fmt: skip
        self.set(name, self.random.choice(values))

    def stores(self) -> None:
        self.set("stores", self.random.choice(("true", "false")))

    def own_rules(self) -> None:
        self.set("rules", self.random.choice(('"rules.csv"', '""')))
        self.tables["rules.csv"] = RULES.format(*self.random.choice((("bust", "vase"), ("figurine", "bowl"))))

    def own_measures(self) -> None:
        self.set("measures", self.random.choice(('"measures.csv"', '""')))
        self.tables["measures.csv"] = measures(self.random.choice((0.05, 0.2, 0.5)))

    def own_isolators(self) -> None:
        self.set("catalogue", self.random.choice(('"isolators.csv"', '""')))
        self.tables["isolators.csv"] = ISOLATORS.format(self.random.choice(("0.05", "0.15")))

    def own_rows(self) -> None:
        self.set("classes", self.random.choice(('"classes.csv"', '""')))
        self.tables["classes.csv"] = vessels(self.random.choice((0.06, 0.2)))
        self.set("friction", self.random.choice(('"friction.csv"', '""')))
        self.tables["friction.csv"] = FRICTION.format(self.random.choice((0.1, 0.4)))
        self.set("furniture", self.random.choice(('"furniture.csv"', '""')))
        self.tables["furniture.csv"] = FURNITURE.format(self.random.choice((5, 9)))

    def other_house_rules(self) -> None:
        what, states = self.random.choice((
            ('gallery = "A"', "clearance_m = 0.02"), ('class = "vessel"', "friction = 0.3"),
            ('medium = "oil"', "damping = 0.1"), ('number = "00*"', 'furniture = "showcase"'),
            ('number = "01*"', 'furniture_anchorage = "unanchored"'),
            ('gallery = "Z"', "friction = 0.2"),
        ))  # fmt: skip
        one = f'[[house]]\n{what}\n{states}\nsaid_by = "Ann"\nsaid_on = 2031-05-01\n'
        self.house = self.random.choice(("", one, one + self.house if what not in self.house else one))

    def other_floors(self) -> None:
        self.upstairs = self.random.choice(([], ["A"], ["B"], ["A", "C"]))

    def decide(self) -> None:
        self.night()
        row = self.any_row()
        kind, words = self.random.choice((
            (DecisionKind.CLASS, ["figurine"]), (DecisionKind.CLASS, ["vessel"]),
            (DecisionKind.INSTALLED, ["clearance", "clearance_m=0.6"]), (DecisionKind.INSTALLED, ["fasten"]),
            (DecisionKind.INSTALLED, ["grip_pad", "friction=0.5"]), (DecisionKind.ACCEPT, []),
        ))  # fmt: skip
        decide(open_workspace(self.settings), Wish(row["object_number"], kind, words, "so it is", "Ann"))

    def withdraw(self) -> None:
        self.night()
        workspace = open_workspace(self.settings)
        there = {row["object_number"] for row in self.rows}
        standing = [d for mine in decisions_in_force(workspace.engine).values() for d in mine]
        standing = sorted((d for d in standing if d.object_number in there), key=lambda d: d.id)
        if standing:
            one = self.random.choice(standing)
            wish = Wish(one.object_number, DecisionKind.WITHDRAW, [str(one.id)], "no more", "Ann")
            decide(workspace, wish)

    def run_a_part(self) -> None:
        self.change_row()
        self.write()
        run(self.settings, SILENT, Selection(galleries=(self.any_row()["gallery"],)) if self.held is None else None)

    def go_back(self) -> None:
        self.night()
        earlier = [v for v in self.imports[:-1] if v[1] != self.export and v[2] == len(self.sheets)]
        if earlier and self.held is None and self.imports[-1][1] == self.export:
            version, content, _ = self.random.choice(earlier)
            go_back(open_workspace(self.settings), version)
            self.held = content

    def edits(self) -> list[Callable[[], None]]:
        """Everything that may change, but for a night that is cut off."""
        return [
            self.swap_rows, self.add_row, self.remove_row, self.change_row, self.change_row, self.make_alike,
            self.exchange_numbers, self.reorder_columns, self.other_line_ends, self.rename_gallery, self.lay_sheet_over,
            self.other_v_max, self.other_scale, self.other_settings, self.stores, self.own_rules, self.own_measures,
            self.own_isolators, self.own_rows, self.other_house_rules, self.other_floors, self.decide, self.withdraw,
            self.run_a_part, self.other_picture,
            self.go_back,
        ]  # fmt: skip


def exported(report: Path) -> dict[str, list[dict[str, str]]]:
    """The rows of the tables of a report, without the run that is named in them."""
    out = {}
    for name in EXPORTS:
        with (report / name).open(encoding="utf-8", newline="") as stream:
            out[name] = [row | {"run": ""} for row in csv.DictReader(stream)]
    pictures = {page.entry.page.file: page.images for page in read_manifest(report).pages}
    out["pictures"] = [{"page": page, "files": " ".join(sorted(files))} for page, files in sorted(pictures.items())]
    return out
