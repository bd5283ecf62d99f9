"""What stands on a chart is told in the reader's language and units: of every picture that a model draws."""

from __future__ import annotations

import numpy as np
import pytest

from pipeline.models import MODELS
from pipeline.records import ChartFigure, Figure, Motion
from pipeline.report.assumed import pictured
from pipeline.report.language import language, speaking
from pipeline.report.units import Units

DT = 0.01
SHAKING = 3.0 * np.sin(2.0 * np.pi * 1.5 * DT * np.arange(800))
MOTION = Motion(dt=DT, acceleration=np.array([SHAKING, 0.5 * SHAKING, 0.0 * SHAKING]), name="sine")


def texts() -> set[str]:
    """All words on the pictures of all models, as a run stores them; signs of formulas are none."""
    found: set[str] = set()
    for model in MODELS:
        for one in model.pictures:
            if isinstance(one, ChartFigure):
                found |= {one.title, one.caption, one.x.label, one.y.label, *one.curves}
            elif isinstance(one, Figure):
                chart = one.draw("k", MOTION)
                found |= {chart.title, chart.caption, chart.x.label, chart.y.label}
                found |= {each.label for each in (*chart.curves, *chart.zones)}
    return {text for text in found if text and "=" not in text.partition(". ")[0]}


@pytest.mark.parametrize("code", ["it", "es", "el", "ja"])
def test_every_word_on_a_chart_is_in_the_language(code: str) -> None:
    assert len(texts()) > 20
    with speaking(language(code, None)):
        assert [text for text in sorted(texts()) if pictured(text, Units()) == text] == []


@pytest.mark.parametrize(
    ("stored", "told"),
    [
        ("Seen from above, from where it stood (0, 0). It gets 89.8 cm away.", "It gets 35.4\u202fin away."),
        ("damping 0.05", "damping 0.05"),
        (
            "Largest swing. Drawn from 1,169 analyses, closest together where the response turns. Error measured at "
            "points held out: at most 0.42 % (damping 0.1) of the value, or of a hundredth of the largest value where "
            "that is more.",
            "Largest swing. Drawn from 1,169 analyses",
        ),
        ("what no phrase wrote, 3 cm", "what no phrase wrote, 3 cm"),
    ],
)
def test_a_number_under_a_chart_is_in_the_reader_s_unit(stored: str, told: str) -> None:
    assert told in pictured(stored, Units("in"))
