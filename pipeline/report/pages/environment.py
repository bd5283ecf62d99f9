"""Templates filled in: everything escaped, nothing undefined, phrases in the reader's language."""

import hashlib
from base64 import b64encode
from collections.abc import Callable, Hashable, Mapping
from functools import cache, lru_cache
from gettext import NullTranslations
from html import unescape
from typing import Any

from jinja2 import BytecodeCache, Environment, FileSystemLoader, StrictUndefined, nodes
from jinja2.bccache import Bucket
from jinja2.compiler import CodeGenerator, Frame
from jinja2.visitor import NodeTransformer
from markupsafe import Markup, escape

from pipeline.report.errors import ReportError
from pipeline.report.language import Language, moment
from pipeline.report.text import cased, clean, count, escaped, plain
from pipeline.resources import resource


def _shown(value: object) -> str:
    """Return what a template prints, escaped once.

    Raises
    ------
    ReportError
        For None.
    """
    kind = type(value)
    if kind is str:
        return escaped(value)  # type: ignore[arg-type]
    if kind is Markup:
        return value  # type: ignore[return-value]
    if value is None:
        raise ReportError("a template prints None; give the view a text for what is not known")
    return escape(value)


class _Compiled(BytecodeCache):
    """The templates of a language as they were compiled: a night asks for several environments of the same ones."""

    def __init__(self) -> None:
        self._code: dict[str, bytes] = {}

    def load_bytecode(self, bucket: Bucket) -> None:
        """Give a template's code, if it is known; that it is of this very text, jinja2 sees to."""
        if bucket.key in self._code:
            bucket.bytecode_from_string(self._code[bucket.key])

    def dump_bytecode(self, bucket: Bucket) -> None:
        """Take down a template's code."""
        self._code[bucket.key] = bucket.bytecode_to_string()


@cache
def _compiled(_digest: str) -> _Compiled:
    """Return what keeps the templates in a language, by the digest of its catalogues."""
    return _Compiled()


class _Told(NodeTransformer):
    """Puts the phrases of a language into a template in place of what looks them up each time a page is filled in."""

    def __init__(self, phrases: NullTranslations) -> None:
        self._phrases = phrases

    def visit_Call(self, node: nodes.Call) -> nodes.Node:  # noqa: N802 - as jinja2 calls it
        """Put a phrase in place of ``_("phrase")``."""
        self.generic_visit(node)
        match node:
            case nodes.Call(node=nodes.Name(name="_"), args=[nodes.Const(value=str(phrase))], kwargs=[]):
                return nodes.TemplateData(self._phrases.gettext(phrase), lineno=node.lineno)
        return node


_DESK = "desk/"
"""Folder of the desk's templates."""


class _Plainer(CodeGenerator):
    """Compiles templates to what asks an object itself for its attributes, and makes no Markup of what is printed.

    There are hundreds of both to an object of the museum.  A name that an object lacks is an AttributeError.  Pages of
    the desk alone are given mappings besides objects.
    """

    def visit_Getattr(self, node: nodes.Getattr, frame: Frame) -> None:  # noqa: N802 - as jinja2 calls it
        """Write ``object.name``."""
        if (self.name or "").startswith(_DESK):
            super().visit_Getattr(node, frame)
            return
        self.write("(")
        self.visit(node.node, frame)
        self.write(f").{node.attr}")

    def visit_Call(self, node: nodes.Call, frame: Frame, forward_caller: bool = False) -> None:  # noqa: N802
        """Write ``macros.name(...)``: what is had by its name of something wants no context."""
        if forward_caller or node.dyn_args or node.dyn_kwargs or not isinstance(node.node, nodes.Getattr):
            super().visit_Call(node, frame, forward_caller=forward_caller)
            return
        self.visit(node.node, frame)
        self.write("(")
        for one in (*node.args, *node.kwargs):
            self.visit(one, frame)
            self.write(", ")
        self.write(")")

    def _output_child_pre(self, *_: Any) -> None:
        self.write("environment.shown(")

    def _output_child_post(self, *_: Any) -> None:
        self.write(")")


class _Spoken(Environment):
    """An environment whose templates are compiled with the phrases of a language."""

    code_generator_class = _Plainer
    shown = staticmethod(_shown)
    spoken = Language()

    def _parse(self, source: str, name: str | None, filename: str | None) -> nodes.Template:
        tree = super()._parse(source, name, filename)
        told: nodes.Template = _Told(self.spoken.phrases).visit(tree)
        return told


def environment(language: Language | None = None) -> Environment:
    """Return the templates' environment: everything escaped, nothing undefined, phrases in the language."""
    spoken = language or Language()
    phrases = spoken.phrases
    shared = bool(spoken.digest) or type(phrases) is NullTranslations
    env = _Spoken(
        loader=FileSystemLoader(resource("templates")),
        autoescape=True,
        # Templates do not change while a report is written: nobody need look.
        auto_reload=False,
        bytecode_cache=_compiled(spoken.digest) if shared else None,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        extensions=["jinja2.ext.i18n"],
    )
    env.spoken = spoken
    env.install_gettext_translations(phrases, newstyle=True)  # type: ignore[attr-defined]
    # What is looked up while a page is filled in: phrases that a template computes.
    env.globals["_"] = lru_cache(maxsize=1024)(lambda text: Markup(phrases.gettext(text)))  # noqa: S704
    env.globals["language"] = spoken
    env.filters["plain"] = plain
    env.filters["cased"] = cased
    env.filters["squeezed"] = _squeezed
    env.filters["thousands"] = count
    env.filters["moment"] = moment
    env.filters["css"] = _css
    return env


def fragments(env: Environment, template: str) -> Callable[..., Markup]:
    """Return what gives pieces that many pages have in common, by the template's macro and what that is given."""
    macros = env.get_template(template).module

    @lru_cache(maxsize=4096)
    def fragment(macro: str, *given: Hashable) -> Markup:
        return Markup(getattr(macros, macro)(*given))  # noqa: S704 - the macro has escaped what it was given

    return fragment


def _css(text: str) -> Markup:
    """Return a text as a string of a style sheet, which knows no entities."""
    told = "".join(c if c.isalnum() or c == " " else f"\\{ord(c):x} " for c in unescape(text))
    return Markup(f'"{told}"')  # noqa: S704 - only letters, digits and escapes


def _squeezed(text: Markup) -> Markup:
    """Return a piece of a page on one line."""
    return Markup(" ".join(str.split(text)))  # noqa: S704 - of what is a Markup already


@cache
def script_of(name: str) -> Mapping[str, Any]:
    """Return what a template needs to run a script of ours: the script, and the hash by which it alone may run."""
    script = resource("templates", f"{name}.js").read_text(encoding="utf-8").strip()
    allowed = b64encode(hashlib.sha256(script.encode()).digest()).decode()
    return {"script": Markup(script), "script_hash": allowed}  # noqa: S704 - our own


def fill(env: Environment, template: str, context: Mapping[str, Any]) -> str:
    """Return a page: a template filled in, with nothing in it that no page may carry."""
    # Once more over the whole page, because a template may print a text that no view has cleaned.
    return clean(env.get_template(template).render(context))
