"""A realistic run's record, built by hand: every kind of finding, every kind of trouble, hostile texts."""

from dataclasses import replace
from math import inf

from pipeline.records import (
    Assessment,
    Check,
    Doubt,
    Estimate,
    Finding,
    Item,
    Mark,
    MeasurementRequest,
    Origin,
    Problem,
    Recommendation,
    RunRecord,
    Scene,
    Spacing,
    Support,
    Verdict,
)
from pipeline.records.run import CHOICE, DOUBTFUL, REFUSED, SHEET, SOURCE

from .pictures import HASH, charts, motion

__all__ = ["HASH", "HOSTILE", "charts", "crowd", "doubts", "motion", "record"]

HOSTILE = {
    "H.1": "<script>alert(1)</script>",
    "H.2": "\"double\" & 'single' </title></desc></svg><img src=x onerror=alert(1)>",
    "H.3": '=HYPERLINK("http://example.org","click")',
    "H.4": "\u202eright to left\u202c \u200fשלום\u200e, control \x07 and surrogate \ud800",
    "H.5": "A title without end " + "and on " * 70,
    "H.6": "{{7*7}} {% raw %} ${7*7}",
    "H.7": "{demand} {0.__class__} %s %(x)s",
    "H.8": "x" * 500,
}

GREEK, PAINT = "Gallery 101: Greek & Roman “Antiquities”", "Salon <b>East</b>"


def finding(item: Item, model: str, title: str, **values: object) -> Finding:
    base = Finding(
        object_number=item.object_number,
        gallery=item.gallery,
        level="design",
        model=model,
        title=title,
        demand_name="uplift_ratio",
        demand=1.4,
        unit="-",
        low=1.3,
        high=1.6,
        capacity=1.0,
        capacity_origin=Origin.DERIVED,
        utilisation=1.4,
        verdict=Verdict.FAIL,
        fidelity="history",
        error=0.004,
        decided_by="history",
        motion="Malibu design motion",
        motion_hash=HASH,
        sentence="The shaking is {demand} times what lifts an edge ({low} to {high}); {capacity} is the limit.",
        screen="A_max/g = 0.70 > B/H′ = 0.50: rocking is expected.",
        assumptions=("rocking itself counts as damage (paper, section 4)",),
        version="0.1.0",
    )
    return replace(base, **values)  # type: ignore[arg-type]


def recommend(item: Item, measure: str, title: str, sentence: str, **values: object) -> Recommendation:
    base = Recommendation(
        object_number=item.object_number,
        gallery=item.gallery,
        level="design",
        measure=measure,
        title=title,
        sentence=sentence,
        parameters={},
        units={},
        checks=(Check("stress", "Stress at the base", 3.1e6, "Pa", 7.0e6, 0.443, True),),
        rejected=("More clearance: the object overturns before it slides.",),
        source="Agbabian et al. 1991, section 2.3",
    )
    return replace(base, **values)  # type: ignore[arg-type]


def scene(item: Item, kind: str = "sculpture", **values: object) -> Scene:
    base = Scene(
        item=item,
        object_class=kind,
        rule="By its classification and its height to width ratio.",
        support=item.support or Support.FREESTANDING,
        models=("rocking", "sliding"),
        parameters={
            "half_width": Estimate(0.15, "m", Origin.DERIVED, 0.14, 0.15, "half of base_width_m"),
            "cg_height": Estimate(0.44, "m", Origin.ASSUMED, 0.38, 0.50, "0.5 of the height", "uniform body"),
            "friction_static": Estimate(0.15, "-", Origin.ASSUMED, 0.10, 0.20, "marble on terrazzo", "paper, Table 3"),
        },
        assumptions=("centre of gravity at half of the height (uniform body)", "base of marble (by the medium)"),
        skipped={"swing": "it stands and does not hang", "flexible_stress": "its period is below 0.06 s (ASCE 7)"},
    )
    return replace(base, **values)  # type: ignore[arg-type]


def rocking(item: Item, utilisation: float = 1.82, outcome: str = "overturns", width: float = 0.12) -> Assessment:
    mark = Mark(f"stability:{HASH}", 0.9, width)
    return Assessment(
        scene(item),
        (
            finding(
                item,
                "rocking",
                "Rocking",
                demand=utilisation,
                low=0.9 * utilisation,
                high=1.1 * utilisation,
                utilisation=utilisation,
                outcome=outcome,
                mark=mark,
            ),
            finding(
                item,
                "sliding",
                "Sliding",
                demand=0.041,
                unit="m",
                low=0.03,
                high=0.05,
                capacity=inf,
                utilisation=0.0,
                verdict=Verdict.PASS,
                sentence="It slides {demand}; nothing stands near: {capacity}.",
                screen="",
                fidelity="bound",
                decided_by="certificate",
                error=None,
            ),
        ),
        (
            recommend(
                item,
                "fasten",
                "Fasten the object to its base",
                "Fasten it so that each of the mounts bears {force}.",
                parameters={"force": 640.0},
                units={"force": "N"},
            ),
        ),
    )


def sliding(item: Item) -> Assessment:
    return Assessment(
        scene(item, "vessel"),
        (
            finding(
                item,
                "sliding",
                "Sliding",
                demand_name="displacement",
                demand=0.118,
                unit="m",
                low=0.09,
                high=0.131,
                capacity=0.06,
                utilisation=1.967,
                outcome="strikes its neighbour",
                sentence="It slides {demand} and has {capacity} of room.",
                screen="",
                fidelity="chart",
                decided_by="chart",
                error=0.003,
                mark=Mark(f"friction:{HASH}", 0.125, 0.118, "as it stands"),
            ),
            finding(
                item,
                "sliding",
                "Path",
                demand=0.118,
                unit="m",
                low=None,
                high=None,
                capacity=0.06,
                utilisation=1.967,
                outcome="strikes its neighbour",
                sentence="The farthest point of its path is {demand} away.",
                screen="",
                mark=Mark(f"path:0.05:{HASH}", 0.108, -0.02, "farthest point"),
            ),
        ),
        (
            recommend(
                item,
                "clear",
                "Keep clear around it",
                "Keep {clearance_m} clear on all sides.",
                parameters={"clearance_m": 0.14},
                units={"clearance_m": "m"},
                checks=(Check("sliding", "Sliding", 0.131, "m", 0.14, 0.936, True),),
                rejected=(),
                mark=Mark(f"friction:{HASH}", 0.25, 0.056, "on rubber feet"),
            ),
        ),
    )


def painting(item: Item) -> Assessment:
    return Assessment(
        scene(item, "painting", support=Support.HUNG),
        (
            finding(
                item,
                "swing",
                "Swinging",
                demand=0.231,
                unit="m",
                low=0.19,
                high=0.26,
                capacity=0.15,
                utilisation=1.54,
                outcome="strikes the frame beside it",
                sentence="It swings {demand} along the wall and has {capacity} of room.",
                screen="",
                mark=Mark(f"swing:{HASH}", 1.1, 0.231),
            ),
        ),
        (
            recommend(
                item,
                "shorten",
                "Shorten the wires",
                "Hang it on wires of at most {length_m}, on rubber pads.",
                parameters={"length_m": 0.4},
                units={"length_m": "m"},
                checks=(Check("swing", "Swinging", 0.11, "m", 0.15, 0.73, True),),
                mark=Mark(f"swing:{HASH}", 0.4, 0.11, "after"),
            ),
        ),
    )


def isolated(item: Item) -> Assessment:
    return Assessment(
        scene(item, support=Support.ISOLATED),
        (
            finding(
                item,
                "stress",
                "Stress at the ankles",
                demand=11.4e6,
                unit="Pa",
                low=9.8e6,
                high=13.0e6,
                capacity=7.0e6,
                utilisation=1.63,
                outcome="breaks",
                sentence="The bending at the ankles is {demand}; marble in this condition bears {capacity}.",
                screen="Tilt test: 44.4°.",
                mark=Mark(f"isolator:{HASH}", 9.0, 9.5, "fixed"),
            ),
        ),
        (
            recommend(
                item,
                "isolate",
                "Mount on a horizontal isolator",
                "An isolator of {frequency} with a stroke of {stroke} brings the object down to {acceleration}.",
                parameters={"frequency": 0.5, "stroke": 0.21, "acceleration": 1.9},
                units={"frequency": "Hz", "stroke": "m", "acceleration": "m/s2"},
                checks=(
                    Check("stress", "Stress at the ankles", 3.2e6, "Pa", 7.0e6, 0.457, True),
                    Check("horizontal_isolator", "Stroke", 0.19, "m", 0.21, 0.905, True),
                ),
                rejected=("Fastening: the stress at the ankles stays above what marble bears.",),
                mark=Mark(f"isolator:{HASH}", 0.5, 1.9, "isolated"),
            ),
        ),
    )


def passing(item: Item) -> Assessment:
    return Assessment(
        scene(item),
        (
            finding(
                item,
                "rocking",
                "Rocking",
                demand=0.71,
                low=0.66,
                high=0.78,
                utilisation=0.71,
                verdict=Verdict.PASS,
                fidelity="bound",
                decided_by="certificate",
                mark=Mark(f"stability:{HASH}", 0.3, 0.4),
            ),
        ),
        (),
    )


def undetermined(item: Item) -> Assessment:
    return Assessment(
        scene(item, "bust"),
        (
            finding(
                item,
                "rocking",
                "Rocking",
                demand=1.02,
                low=0.82,
                high=1.31,
                utilisation=1.02,
                verdict=Verdict.UNDETERMINED,
                note="The height of the centre of gravity is assumed.",
                mark=Mark(f"stability:{HASH}", 0.6, 0.42),
            ),
        ),
        (),
    )


def unknown(item: Item) -> Assessment:
    return Assessment(scene(item, "object", missing=("base_width_m", "base_depth_m")), (), ())


def endless(item: Item) -> Assessment:
    """No measure helps and no number is finite: it stands against the wall."""
    return Assessment(
        scene(item),
        (
            finding(
                item,
                "sliding",
                "Sliding",
                demand=0.05,
                unit="m",
                low=0.05,
                high=inf,
                capacity=0.0,
                utilisation=inf,
                outcome="strikes the wall",
                sentence="It slides {demand} and has {capacity} of room.",
                screen="",
                mark=Mark(f"friction:{HASH}", 0.9, inf),
            ),
        ),
        (),
    )


PLACES = {
    "79.AA.143": (1.0, 1.0, 0.0),
    "82.AB.7": (2.2, 1.1, 30.0),
    "83.AC.10": (3.5, 1.0, -45.0),
    "70.AA.2": (1.1, 3.0, None),
    "85.AA.40": (4.0, 3.2, 90.0),
    "73.AA.33": (2.5, 4.4, None),
    "96.AC.77": (5.0, 4.5, None),
}
"""Where objects of the first gallery stand: metres east, metres north, degrees; one of them stands nowhere."""


def gap(first: str, second: str, verdict: Verdict, level: str = "design") -> Spacing:
    """Return the gap of 5 cm between two objects of the first gallery, with any verdict."""
    return Spacing(GREEK, level, first, second, 0.05, 0.06, 0.02, 0.08, 0.06, 0.2, verdict, "history", "quake")


def request(number: str, gallery: str, field: str, **values: object) -> MeasurementRequest:
    base = MeasurementRequest(number, gallery, "", field, "-", 0.1, 0.15, 0.2, "marble on terrazzo", 1, 2 / 3, 0)
    return replace(base, **values)  # type: ignore[arg-type]


def wishes() -> tuple[MeasurementRequest, ...]:
    """Return one measurement request of each kind: one that unlocks, one that settles, one that settles nothing."""
    span = {"unit": "m", "low": 0.38, "best": 0.44, "high": 0.50}
    return (
        request("96.AC.77", GREEK, "base_width_m", low=None, best=None, high=None, open=0, settles=0.0, unlocks=2),
        request("73.AA.33", GREEK, "cg_height_m", **span),
        request("79.AA.143", GREEK, "friction", open=2, settles=1.5),
        request("73.AA.33", GREEK, "friction", settles=0.0),
    )


def record(*extra: Assessment) -> RunRecord:
    """Return a run of 20 objects in two galleries and in store; their states are known by construction."""

    def item(number: str, gallery: str, title: str, **more: object) -> Item:
        x, y, turn = PLACES.get(number, (None, None, None))
        size = {"base_width_m": 0.5, "base_depth_m": 0.4} if number != "73.AA.33" else {}
        place = {"position_x_m": x, "position_y_m": y, "orientation_deg": turn}
        return replace(Item(number, gallery, title), **(place | size | more))  # type: ignore[arg-type]

    objects = (
        rocking(item("79.AA.143", GREEK, "Kylix with warriors", case="12", value_class="A")),
        rocking(item("82.AB.7", GREEK, "Head of a youth"), 1.82, "overturns", 0.015),
        rocking(item("83.AC.10", GREEK, "Statuette of a dancer"), 2.6, "rocks", 0.45),
        sliding(item("70.AA.2", GREEK, "Amphora with the labours of Herakles")),
        isolated(item("85.AA.40", GREEK, "Kouros", value_class="A", mass_kg=860.0)),
        undetermined(item("73.AA.33", GREEK, "Bust of a senator")),
        passing(item("71.AB.9", GREEK, "Low altar")),
        unknown(item("96.AC.77", GREEK, "Relief fragment", problems=(Problem("height_m", "“ca.” is no number"),))),
        painting(item("90.PA.20", PAINT, "Irises in a blue jug")),
        endless(item("91.DA.4", PAINT, "Mantel clock")),
        passing(item("92.DA.5", PAINT, "Commode")),
        passing(item("64.ST.1", "ignored", "Stored torso", on_display=False)),
        rocking(item("64.ST.2", "", "Stored lekythos", on_display=False), 1.2, "rocks", 0.5),
        *(passing(item(n, PAINT, t)) for n, t in list(HOSTILE.items())[:3]),
        *(rocking(item(n, PAINT, t), 1.31, "rocks", 0.5) for n, t in list(HOSTILE.items())[3:]),
        *extra,
    )
    return RunRecord(
        run_id="2026-03-01T020000Z-4f1c",
        started="2026-03-01T02:00:00Z",
        finished="2026-03-01T02:04:11Z",
        version="0.1.0",
        site="malibu",
        museum="Museum of the Shore",
        level_notes=("The design level returns once in 475 years.",),
        settings={"fidelity": "auto", "kernels": "0123456789ab", "numerics": self_test(), "reading": reading()},
        assessments=objects,
        charts=charts(),
        motions=(motion(),),
        demonstration=True,
        wishes=wishes(),
    )


def reading() -> dict[str, object]:
    """Return what a run keeps of a reading that refused and doubted something; `doubts` are what."""
    doubt = {"field": "height_m", "message": HOSTILE["H.2"], "remedy": HOSTILE["H.1"]}
    counts = {"rows": 24, "refused": 2, "doubtful": 3, "sheets": 1, "unsaid": 20}
    return {"source": HOSTILE["H.1"], **counts, "suspicions": [doubt], "choices": [doubt]}


def doubts() -> list[Doubt]:
    """Return doubts of every kind, with hostile texts; not in the order of the page."""
    return [
        Doubt(DOUBTFUL, None, None, HOSTILE["H.3"], "mass_kg", HOSTILE["H.2"], HOSTILE["H.4"]),
        Doubt(DOUBTFUL, 7, 9, "79.AA.143", "height_m", HOSTILE["H.1"], HOSTILE["H.6"]),
        Doubt(DOUBTFUL, 8, 10, "79.AA.1", "on_display", HOSTILE["H.1"], HOSTILE["H.6"], HOSTILE["H.2"], "on display"),
        Doubt(CHOICE, None, None, "", "on_display", HOSTILE["H.2"], HOSTILE["H.1"], HOSTILE["H.3"], HOSTILE["H.4"]),
        Doubt(REFUSED, 3, 4, "", "object_number", HOSTILE["H.8"], ""),
        Doubt(SHEET, 2, 3, "82.AB.7", "friction", HOSTILE["H.7"], "-2+3"),
        Doubt(SOURCE, None, None, "", "height_m", HOSTILE["H.2"], HOSTILE["H.1"]),
    ]


def self_test(kernels: str = "0123456789ab", **wrong: object) -> dict[str, object]:
    """Return what a run keeps of a self-test of three cases; ``wrong`` goes into the last."""
    good = {"limit": 1e-9, "ok": True, "seconds": 0.1, "problem": ""}
    cases = [
        {"what": "friction 0", "truth": "it stays in space", "result": 2.4e-16, **good},
        {"what": "friction 5", "truth": "does not move", "result": 0.0, **good, "limit": 0.0},
        {"what": HOSTILE["H.2"], "truth": HOSTILE["H.1"], "result": 3e-12, **good, **wrong},
    ]
    when, machine = "2026-02-28T12:00:00+00:00", "Linux x86_64, 2 cores, Python 3.11.2"
    return {"when": when, "version": "0.1.0", "kernels": kernels, "machine": machine, "cases": cases}


def crowd(count: int) -> RunRecord:
    """Return a run whose one gallery holds that many objects, four in five of them failing: the heaviest page."""
    kinds = (rocking, sliding, painting, isolated, passing)
    items = [
        Item(f"2026.{i:04d}", "Study collection", f"Object number {i} of the study collection") for i in range(count)
    ]
    assessments = tuple(kinds[i % len(kinds)](item) for i, item in enumerate(items))
    return replace(record(), assessments=assessments)
