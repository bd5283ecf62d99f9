"""Eighty objects of four museums beside what was written down of each before any was run.

One who had not written the rules took them for an engineer, a mount-maker and a collections manager: what such a thing
weighs, the state at 0.40 g and at 0.12 g, which measures are right, acceptable or harmful, and forces by hand
(tests/data/collections/four_museums/expected.csv).  What was written stays; where it is Kouros that is right, or nobody
can say, that is named here with the reason.
"""

from __future__ import annotations

import csv
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import pytest

from pipeline.analysis.assess import assess
from pipeline.analysis.classify import classify
from pipeline.analysis.context import Context
from pipeline.analysis.likelihood.sampling import likelihoods
from pipeline.analysis.verdicts import LevelMotions
from pipeline.collection.guess import guess
from pipeline.collection.reading import read_items
from pipeline.execute import Threads
from pipeline.mitigate import advise
from pipeline.mitigate.installed import Placed, stood_of
from pipeline.mitigate.trials import HarmAim
from pipeline.motions import read_motion
from pipeline.records import Origin, Recommendation, Sampling, Scene
from pipeline.resources import resource

pytestmark = pytest.mark.slow_file

FOLDER = Path(__file__).parents[1] / "data" / "collections" / "four_museums"
MUSEUMS = ("archaeology", "contemporary", "history", "nature")
WEAK = 0.3
"""The weak shaking over the strong one."""
HAND = 1.5
"""Times by which a force may exceed that by hand: it is for the most that a thing may weigh, in any furniture."""
ROUNDED = 0.02
"""By which a mass may be outside what was written: both were rounded, and pounds were made kilograms."""
