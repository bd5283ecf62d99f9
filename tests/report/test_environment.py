"""What templates print: escaped once, whatever it is, and nothing that is not there."""

from collections.abc import Callable
from dataclasses import dataclass, field
from html import unescape

import pytest
from hypothesis import given
from hypothesis import strategies as st
from jinja2 import UndefinedError
from markupsafe import Markup

from pipeline.report.errors import ReportError
from pipeline.report.pages.environment import environment

_SIGNS = "&<>'\""


@dataclass
class _Thing:
    text: object
    inside: list[str] = field(default_factory=list)

    def told(self, before: str, *, behind: str) -> str:
        return f"{before}{self.text}{behind}"


def _filled(template: str, **values: object) -> str:
    return environment().from_string(template).render(values)


@given(st.text(st.one_of(st.sampled_from(_SIGNS), st.characters(codec="utf-8", exclude_characters="\r\n"))))
def test_a_text_is_escaped_once_wherever_it_is_printed(text: str) -> None:
    ways = (
        "{{ o.text }}",
        "{{ o.told('', behind='') }}",
        "{% for one in o.inside %}{{ one }}{% endfor %}",
        "{% macro say(o) %}{{ o.text }}{% endmacro %}{{ say(o) }}",
        "{% if o.inside|length == 1 %}{{ o.inside[0] or o.text }}{% endif %}",
    )
    for way in ways:
        shown = _filled(way, o=_Thing(text, [text]))
        assert unescape(shown) == text, way
        assert not set(shown) & set("<>'\""), way
        assert shown.count("&") == sum(text.count(sign) for sign in _SIGNS), way


@pytest.mark.parametrize(
    ("value", "shown"), [(Markup("<b>&amp;</b>"), "<b>&amp;</b>"), (0, "0"), (False, "False"), ("", "")]
)
def test_what_is_no_plain_text_is_printed_as_it_is(value: object, shown: str) -> None:
    assert _filled("{{ o.text }}", o=_Thing(value)) == shown


def test_an_object_of_another_class_is_escaped_as_it_is_written() -> None:
    class Text(str):
        __slots__ = ()

    assert _filled("{{ o.text }}", o=_Thing(Text("<&>"))) == "&lt;&amp;&gt;"
    assert _filled("{{ o.text }}", o=_Thing(["<"])) == "[&#39;&lt;&#39;]"


def _refused(problem: type[Exception]) -> Callable[[str], None]:
    def look(template: str) -> None:
        with pytest.raises(problem):
            _filled(template, o=_Thing(None))

    return look


def test_nothing_that_is_not_there_is_printed() -> None:
    _refused(ReportError)("{{ o.text }}")
    _refused(AttributeError)("{{ o.lacking }}")
    _refused(AttributeError)("{% if o.lacking %}{% endif %}")
    _refused(AttributeError)("{{ o.lacking() }}")
    _refused(UndefinedError)("{{ nobody }}")
    _refused(UndefinedError)("{{ nobody.text }}")
