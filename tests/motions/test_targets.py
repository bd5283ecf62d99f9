"""Target spectra as they are saved, and every way in which they are not one."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pipeline.errors import InputError
from pipeline.motions.errors import MotionError
from pipeline.motions.targets import read_target


def answer(**data: Any) -> dict[str, Any]:
    """The form of the answer that the design web service of the USGS documents for asce7-22.json."""
    return {
        "request": {
            "date": "2022-06-07T14:27:29.712Z",
            "referenceDocument": "ASCE7-22",
            "status": "success",
            "url": "https://earthquake.usgs.gov/ws/designmaps/asce7-22.json?latitude=34&longitude=-118",
            "parameters": {"latitude": 34, "longitude": -118, "riskCategory": "III", "siteClass": "C", "title": "T"},
        },
        "response": {"data": {"pgam": 0.9, "sds": 1.46, "cv": None, **data}, "metadata": {"vs30": 530}},
    }


DESIGN = {"periods": [0, 0.01, 0.1, 1, 10], "ordinates": [0.65, 0.66, 1.33, 0.7, 0.042]}
MCER = {"periods": [0, 0.01, 0.1, 1, 10], "ordinates": [0.98, 0.99, 2.0, 1.05, 0.063]}


def saved(folder: Path, content: Any, name: str = "asce7-22.json") -> Path:
    file = folder / name
    file.write_text(content if isinstance(content, str) else json.dumps(content), encoding="utf-8")
    return file


def test_the_service_answers_with_the_maximum_direction(tmp_path: Path) -> None:
    two = {"periods": [0, 0.1, 0.5, 2], "ordinates": [0.5, 1.4, 1.4, 0.4]}
    whole = answer(multiPeriodDesignSpectrum=DESIGN, multiPeriodMCErSpectrum=MCER, twoPeriodDesignSpectrum=two)
    file = saved(tmp_path, whole)
    found = read_target(file)
    # The first ordinate, at 0 s, is the peak ground acceleration and no oscillator's.
    assert found.periods.tolist() == [0.01, 0.1, 1.0, 10.0]
    assert found.psa_g.tolist() == [0.66, 1.33, 0.7, 0.042]
    assert (found.ln_sd, found.component, found.place) == (None, "rotd100", (34.0, -118.0))
    assert "multiPeriodDesignSpectrum" in found.name
    assert "maximum direction" in found.why_component
    assert read_target(file, "mcer").psa_g.tolist() == [0.99, 2.0, 1.05, 0.063]
    assert read_target(file, component="rotd50").component == "rotd50"
    # A straight line in log-log between two of its points, by hand.
    mean, spread = found.at(np.array([0.1, np.sqrt(0.1)]))
    assert spread is None
    np.testing.assert_allclose(np.exp(mean), [1.33, np.sqrt(1.33 * 0.7)], rtol=1e-12)
    with pytest.raises(InputError, match=r"spans 0\.01 to 10 s, but 0\.1 to 20 s"):
        found.at(np.array([0.1, 20.0]))


def test_older_editions_have_other_fields(tmp_path: Path) -> None:
    two = {"periods": [0, 0.1, 0.5, 2], "ordinates": [0.5, 1.4, 1.4, 0.4]}
    old = answer(twoPeriodDesignSpectrum=two)
    old["request"]["referenceDocument"] = "ASCE7-16"
    found = read_target(saved(tmp_path, old))
    assert "ASCE7-16, twoPeriodDesignSpectrum" in found.name
    assert found.component == "rotd100"
    older = answer(sdSpectrum=[[0.0, 0.4], [0.2, 1.0], [1.0, 0.6]])
    older["request"]["referenceDocument"] = "ASCE7-05"
    found = read_target(saved(tmp_path, older))
    assert found.periods.tolist() == [0.2, 1.0]
    assert found.component == "rotd50"


@pytest.mark.parametrize(
    ("content", "told"),
    [
        ('{"request": ', r"asce7-22\.json: JSON: .*save the service's answer again"),
        ({"request": {"status": "error"}, "response": "site class unknown"}, "status: .*site class unknown"),
        (answer(), r"response\.data: has none of multiPeriodDesignSpectrum, .*it has none"),
        (answer(multiPeriodMCErSpectrum=MCER), "it has multiPeriodMCErSpectrum; .*--spectrum"),
        (answer(multiPeriodDesignSpectrum={"periods": [0.1, 1], "ordinates": [1]}), "2 periods and 1 ordinates"),
        (answer(multiPeriodDesignSpectrum=[1, 2]), "neither {periods, ordinates} nor a list of pairs"),
        (
            answer(multiPeriodDesignSpectrum=DESIGN | {"periods": [0, 1, 0.1, 2, 3]}),
            "periods, entry 3: 0.1 s follows 1",
        ),
        (answer(multiPeriodDesignSpectrum=DESIGN | {"ordinates": [1, 1, None, 1, 1]}), "entry 3: None is no number"),
    ],
)
def test_a_damaged_answer_is_refused_with_its_field(tmp_path: Path, content: Any, told: str) -> None:
    with pytest.raises(MotionError, match=told):
        read_target(saved(tmp_path, content))


def test_tables(tmp_path: Path) -> None:
    plain = read_target(saved(tmp_path, "# 475 years, Rome\nperiod_s,sa_g\n0.1,0.5\n1,0.2\n", "uhs.csv"))
    assert (plain.component, plain.ln_sd, plain.place, plain.conditioned_at) == ("rotd50", None, None, None)
    assert "475 years, Rome" in plain.name
    text = "\ufeffperiod_s, median_sa_g, ln_sd, note\n0.1,0.5,0.4,a\n\n0.5,0.4,1e-9,b\n1,0.2,0.3,c\n"
    conditional = read_target(saved(tmp_path, text, "cs.csv"))
    assert conditional.conditioned_at == 0.5
    mean, sd = conditional.at(np.array([np.sqrt(0.05), 0.5]))
    # Half way between 0.1 and 0.5 s in the logarithm.
    np.testing.assert_allclose(np.exp(mean), [np.sqrt(0.2), 0.4], rtol=1e-12)
    assert sd is not None
    np.testing.assert_allclose(sd, [0.2, 0.0], atol=1e-8)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "file: the columns are none; name them: period_s,sa_g"),
        ("T;Sa\n0.1;0.5\n", "row 1: the columns are t;sa"),
        ("period_s,sa_g\n0.1,0.5\n0.2,\n", "row 3, sa_g: is empty"),
        ("# words\nperiod_s,sa_g\n0.1,0.5\n0.2,high\n", "row 4, sa_g: 'high' is no number"),
        ("period_s,sa_g\n0.1,0.5\n0.2\n", "row 3, sa_g: is empty"),
        ("period_s,sa_g\n0.1,nan\n0.2,1\n", "row 2, sa_g: nan is no number"),
        ("period_s,sa_g\n0.1,0.5\n0.1,0.4\n", "row 3, period_s: 0.1 s follows 0.1 s"),
        ("period_s,sa_g\n-0.1,0.5\n0.1,0.4\n", "row 2, period_s: -0.1 is below 0"),
        ("period_s,sa_g\n0.1,0\n0.2,0.4\n", "row 2, sa_g: 0 is not above 0"),
        ("period_s,sa_g\n0.1,490\n0.2,500\n", "row 2, sa_g: 490 g is no spectral acceleration"),
        ("period_s,sa_g,ln_sd\n0.1,0.5,-1\n0.2,0.4,0.1\n", "row 2, ln_sd: -1 is none"),
        ("period_s,sa_g\n0,0.5\n0.2,0.4\n", "has 1 periods above 0 s"),
    ],
)
def test_a_damaged_table_is_refused_with_its_row(tmp_path: Path, text: str, told: str) -> None:
    file = saved(tmp_path, text, "target.csv")
    with pytest.raises(MotionError) as refused:
        read_target(file)
    assert str(refused.value).startswith(f"{file}: ")
    assert told in str(refused.value)


def test_a_file_that_is_absent_or_no_text(tmp_path: Path) -> None:
    with pytest.raises(MotionError, match="cannot be read"):
        read_target(tmp_path / "absent.csv")
    (tmp_path / "picture.csv").write_bytes(b"\xff\xd8\xff\xe0")
    with pytest.raises(MotionError, match="is no text in UTF-8"):
        read_target(tmp_path / "picture.csv")
