"""The text of `kouros init`: made of the models, it says what they say."""

import re
import tomllib
from datetime import date

import pytest
from pydantic import BaseModel

from pipeline.analysis.house.rule import Span
from pipeline.records import Hanging
from pipeline.settings import Settings, template

PLAIN = template(museum="", source="", mapping="kouros", site="site_motions/site")

TABLES = {name: field.default for name, field in Settings.model_fields.items() if isinstance(field.default, BaseModel)}


def test_it_reads_back_as_exactly_the_defaults() -> None:
    assert Settings(**tomllib.loads(PLAIN)) == Settings()


def test_every_setting_is_there_with_its_default_and_its_description() -> None:
    assert {"museum", "analysis", "hooks", "retention"} < set(TABLES)
    data = tomllib.loads(PLAIN)
    assert list(data) == list(TABLES)
    words = " ".join(re.sub(r"^# ?", "", line) for line in PLAIN.splitlines()).casefold()
    for name, table in TABLES.items():
        for key, field in type(table).model_fields.items():
            if key == "root":
                continue
            assert field.description, (name, key)
            assert " ".join(field.description.split()).casefold() in " ".join(words.split()), (name, key)
            default = getattr(table, key)
            # TOML has lists only.
            written = list(default) if isinstance(default, tuple) else default
            assert field.examples or data[name][key] == written, (name, key)


def test_its_examples_can_be_uncommented() -> None:
    """Lines behind # that are TOML: the floors, the house rules and the hooks."""
    examples = re.sub(r'^# (?=\[\[hooks\.|\[\[house\]\]|[a-z_]+ = |"?2"? = )', "", PLAIN, flags=re.M)
    settings = Settings(**tomllib.loads(examples))
    assert settings.floors.of("Gallery 12") == "2"
    (rule,) = settings.house
    assert (rule.object_class, rule.hanging, rule.said_on) == (("framed",), Hanging.TWO_HOOKS, date(2031, 5, 1))
    assert rule.clearance_m == Span(low=0.1, best=0.2, high=0.3)
    assert [len(hooks) for hooks in (settings.hooks.command, settings.hooks.webhook, settings.hooks.email)] == [1, 1, 1]
    assert settings.hooks.variables == ("KOUROS_WEBHOOK_TOKEN", "KOUROS_SMTP_PASSWORD")


@pytest.mark.parametrize("name", ['"]\n[hooks]', "Ürün 'a' \\ \"b\"", "\x00\x1b[2J\x7f", "a\r\nb", "# no comment"])
def test_no_name_of_a_museum_breaks_out_of_its_place(name: str) -> None:
    settings = Settings(**tomllib.loads(template(museum=name, source=name, mapping="kouros", site="site")))
    assert (settings.museum.name, settings.collection.source) == (name, name)
    assert settings.hooks == Settings().hooks


def test_lines_are_no_longer_than_a_screen_is_wide() -> None:
    assert max(map(len, PLAIN.splitlines())) <= 120
