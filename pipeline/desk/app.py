"""The site: which page answers which address, who may, and what every page has in common."""

import logging
import secrets
from asyncio import get_running_loop
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.datastructures import UploadFile
from starlette.formparsers import MultiPartException
from starlette.requests import Request
from starlette.responses import FileResponse, HTMLResponse, RedirectResponse, Response
from starlette.routing import Route

from pipeline.desk import looking, saying, shaken
from pipeline.desk.accounts import Attempts, digest, signed_in
from pipeline.desk.asking import Asked, DeskAnswer
from pipeline.desk.guard import (
    FORM_BYTES,
    FORM_COOKIE,
    NAME_COOKIE,
    REPORT_POLICY,
    SESSION_COOKIE,
    BodyTooLongError,
    Guard,
    NotThereError,
    Person,
    form_seed,
    form_token,
    is_form_token,
    named_cookie,
    person,
)
from pipeline.desk.site import AT_ONCE, DeskSite, DeskState, KeptPages
from pipeline.errors import KourosError
from pipeline.operations.event_log import note
from pipeline.report.language import speaking
from pipeline.report.pages.environment import environment, fill
from pipeline.resources import resource
from pipeline.settings.operations import ServeSettings
from pipeline.store.desk import end_session, picture_image

logger = logging.getLogger(__name__)

HTMX = "sha384-2OatzQy1H+Zd/IIrjr1TcuDGqLXeHhbooAyJY1KdQMKnr4LZ22k31GBLdYKHmVjg"
"""Of htmx 2.0.11 as npm has it (dist/htmx.min.js): a browser runs nothing else under its name."""

STATIC = {
    "htmx.min.js": "text/javascript",
    "desk.js": "text/javascript",
    "desk.css": "text/css",
    "style.css": "text/css",
}
"""Files that the pages name, with what they are; nothing else is given out."""

_YEAR = 365 * 86_400
"""Seconds for which a browser keeps the name of who uses it."""

_REPORT_KINDS = {".html": "text/html", ".pdf": "application/pdf", ".csv": "text/csv", ".xlsx": None}
"""Endings of the report's files that are given out; a workbook and a table are saved, not shown."""

Page = Callable[[Asked], DeskAnswer]

_LOOKED: Mapping[str, Page] = {
    "/": looking.search,
    "/object": looking.object_page,
    "/object/measure": looking.measure_fields,
    "/galleries": looking.galleries,
    "/survey": looking.survey,
    "/errands": looking.errands,
    "/errand": looking.errand_page,
    "/event": shaken.event_page,
    "/event/gallery": shaken.gallery_page,
    "/house": looking.house,
    "/house/fields": looking.house_fields,
}
_KEPT = frozenset(
    {
        looking.search, looking.object_page, looking.galleries, looking.survey, looking.errands, looking.errand_page,
    }
)  # fmt: skip
"""Pages that rest on nothing but `DeskSite.state`, who asks, and what for."""

_KEPT_CHARACTERS = 20_000_000
"""Of pages that are kept: some thousand of them."""

_TOKEN = secrets.token_hex(32)
"""What stands in a page for the token of whoever asks for it."""

_SAID: Mapping[str, Page] = {
    "/object/decide": saying.say_decision,
    "/object/measured": saying.say_measured,
    "/object/picture": saying.say_picture,
    "/house/rule": saying.say_rule,
    "/house/back": saying.say_back,
    "/errand/say": saying.say_errand,
    "/event/found": shaken.say_found,
    "/event/again": shaken.say_again,
}


def desk_app(config: Path, serving: ServeSettings | None = None) -> Guard:
    """Return the site of a museum (ASGI).

    Parameters
    ----------
    config : Path
        The settings' file.
    serving : ServeSettings, optional
        In place of those of the file.
    """
    pages = _Pages(DeskSite(config, serving))
    routes = [Route(path, pages.looking(page), methods=["GET"]) for path, page in _LOOKED.items()]
    routes += [Route(path, pages.saying(page), methods=["POST"]) for path, page in _SAID.items()]
    routes += [
        Route("/static/{name}", pages.static),
        Route("/report/{name}", pages.report),
        Route("/picture", pages.picture),
        Route("/here", pages.here),
        Route("/sign-in", pages.sign_in, methods=["GET", "POST"]),
        Route("/sign-out", pages.sign_out, methods=["POST"]),
    ]
    handlers: Any = {404: pages.lost, 405: pages.lost, BodyTooLongError: pages.too_long, Exception: pages.broken}
    return Guard(Starlette(routes=routes, exception_handlers=handlers), pages.site.serving, pages.close)


class _Pages:
    """The pages as Starlette asks for them."""

    def __init__(self, site: DeskSite) -> None:
        self.site = site
        self._attempts = Attempts()
        # Of its own, and by asyncio itself: what Starlette waits by costs a tenth of a page that is kept.
        self._fillers = ThreadPoolExecutor(AT_ONCE, "page")
        self._kept = KeptPages(_KEPT_CHARACTERS)

    def close(self) -> None:
        """End what is filled in, and close the connections of the site."""
        self._fillers.shutdown(wait=False, cancel_futures=True)
        self.site.close()

    def looking(self, page: Page) -> Callable[[Request], Any]:
        """Return what answers with a page that only shows."""

        def answer(request: Request) -> Response:
            who = person(request, self.site.serving, self.site.workspace.engine)
            if who is None:
                return self._unknown(request)
            query = {name: text[:2_000] for name, text in request.query_params.items()}
            asked = Asked(self.site, who, query, fragment="hx-request" in request.headers)
            return self._answered(request, asked, page, kept=page in _KEPT)

        async def waiting(request: Request) -> Response:
            return await get_running_loop().run_in_executor(self._fillers, answer, request)

        return waiting

    def saying(self, page: Page) -> Callable[[Request], Any]:
        """Return what takes a form."""

        async def answer(request: Request) -> Response:
            site = self.site
            who = await run_in_threadpool(person, request, site.serving, site.workspace.engine)
            if who is None:
                return self._unknown(request)
            if not who.editor:
                return await run_in_threadpool(
                    self._told, request, who, "You may read here, and not write: ask for the role of an editor.", 403
                )
            form = await _form(request)
            if form is None:
                return await run_in_threadpool(self._told, request, who, "The form cannot be read.", 400)
            fields, lists, upload = form
            seed, fresh = form_seed(request, who)
            if fresh or not is_form_token(fields.get("token", ""), seed):
                words = "The form is too old, or came from elsewhere. Nothing was saved: go back, load it again, send."
                return await run_in_threadpool(self._told, request, who, words, 403)
            asked = Asked(site, who, {}, fields, lists, upload)
            return await run_in_threadpool(self._answered, request, asked, page)

        return answer

    def _answered(self, request: Request, asked: Asked, page: Page, *, kept: bool = False) -> Response:
        try:
            state = self.site.state if kept else None
            if state is None:
                self.site.look()
            key = (page, tuple(asked.query.items()), asked.fragment, asked.who)
            known = self._kept.get(state, key) if kept else None
            if known is not None:
                return self._with_token(request, asked.who, known, 200)
            if state is not None:
                asked = replace(asked, newest=state.newest)
            with speaking(self.site.run.language):
                answer = page(asked)
                if answer.to:
                    note("desk", who=asked.name, path=request.url.path, object=asked.form.get("number", ""))
                    return self._remembered(RedirectResponse(answer.to, 303), asked)
                text = self._filled_in(request, asked.who, answer, state)
            if kept:
                self._kept.keep(state, key, text)
            return self._with_token(request, asked.who, text, answer.status)
        except NotThereError as problem:
            return self._told(request, asked.who, str(problem), 404)
        except KourosError as problem:
            logger.warning("the desk: %s", problem)
            return self._told(request, asked.who, str(problem), 503)

    def _page(self, request: Request, who: Person | None, answer: DeskAnswer) -> Response:
        return self._with_token(request, who, self._filled_in(request, who, answer), answer.status)

    def _filled_in(
        self, request: Request, who: Person | None, answer: DeskAnswer, state: DeskState | None = None
    ) -> str:
        site = self.site
        env = getattr(site, "environment", None) or environment()
        context: dict[str, Any] = {
            "who": who, "token": _TOKEN, "htmx": HTMX, "here": request.url.path,
            "museum": site.workspace.settings.museum.name, "identity": site.serving.identity, "problem": "",
            "saved": "", "run": None, "shaken": False,
        }  # fmt: skip
        if answer.template not in ("sign_in.html", "told.html"):
            context |= {"run": site.run, "shaken": site.events.there if state is None else state.shaken}
        return fill(env, f"desk/{answer.template}", context | dict(answer.context))

    def _with_token(self, request: Request, who: Person | None, text: str, status: int) -> Response:
        """Return a page with the token of the browser that it goes to."""
        seed, fresh = form_seed(request, who)
        response = HTMLResponse(text.replace(_TOKEN, form_token(seed)), status)
        if fresh:
            self._cookie(response, FORM_COOKIE, seed)
        return response

    def _remembered(self, response: Response, asked: Asked) -> Response:
        """Have the browser keep the name that was typed, so that it is typed once."""
        if asked.form.get("who", "").strip() and not asked.who.known:
            self._cookie(response, NAME_COOKIE, named_cookie(asked.name), _YEAR)
        return response

    def _cookie(self, response: Response, name: str, value: str, seconds: int | None = None) -> None:
        secure = any(one.startswith("https:") for one in self.site.serving.addresses)
        response.set_cookie(name, value, max_age=seconds, path="/", secure=secure, httponly=True, samesite="strict")

    def _told(self, request: Request, who: Person | None, words: str, status: int) -> Response:
        return self._page(request, who, DeskAnswer("told.html", {"words": words}, status))

    def here(self, request: Request) -> Response:
        """Say that the desk answers who asks, by the token that the browser's forms are to carry."""
        who = person(request, self.site.serving, self.site.workspace.engine)
        return self._unknown(request) if who is None else self._with_token(request, who, _TOKEN, 200)

    def _unknown(self, request: Request) -> Response:
        if request.url.path == "/here" or "hx-request" in request.headers:
            # A page's own script asks: it says so there, and what was typed stays.
            return Response(status_code=401)
        if self.site.serving.identity == "accounts":
            return RedirectResponse("/sign-in", 303)
        return self._told(request, None, "The proxy did not say who you are: sign in there.", 401)

    def lost(self, request: Request, _problem: Exception) -> Response:
        """Answer where there is no such page."""
        who = person(request, self.site.serving, self.site.workspace.engine)
        if who is None:
            return self._unknown(request)
        return self._told(request, who, "There is no such page.", 404)

    def too_long(self, _request: Request, _problem: Exception) -> Response:
        """Answer where more is sent than is taken."""
        return HTMLResponse("That is more than is taken at once.", 413)

    def broken(self, request: Request, problem: Exception) -> Response:
        """Answer where Kouros itself is at fault: without its innards, which go to the log."""
        logger.error("the desk failed on %s", request.url.path, exc_info=problem)
        return HTMLResponse("Kouros failed on this page; its log says more. What was saved before is safe.", 500)

    def static(self, request: Request) -> Response:
        """Give out a file that the pages name."""
        name = request.path_params["name"]
        if name not in STATIC:
            return self.lost(request, Exception())
        folder = ("templates",) if name == "style.css" else ("templates", "desk", "static")
        headers = {"Cache-Control": "max-age=3600"}
        return FileResponse(resource(*folder, name), media_type=STATIC[name], headers=headers)

    def report(self, request: Request) -> Response:
        """Give out a file of the newest report."""
        who = person(request, self.site.serving, self.site.workspace.engine)
        if who is None:
            return self._unknown(request)
        name, folder = request.path_params["name"], self.site.look().folder
        ending = Path(name).suffix
        # Only names that the folder itself has: none with a slash, none that leads elsewhere, none that is hidden.
        if ending not in _REPORT_KINDS or name.startswith(".") or name not in {f.name for f in folder.iterdir()}:
            return self._told(request, who, "There is no such page.", 404)
        shown = ending in (".html", ".pdf")
        headers = {"Content-Security-Policy": REPORT_POLICY}
        return FileResponse(
            folder / name, media_type=_REPORT_KINDS[ending], headers=headers, filename=None if shown else name
        )

    def picture(self, request: Request) -> Response:
        """Give out a photograph of a mount, as Kouros wrote it."""
        who = person(request, self.site.serving, self.site.workspace.engine)
        if who is None:
            return self._unknown(request)
        number = request.query_params.get("id", "")
        plain = number.isascii() and number.isdigit() and len(number) < 10
        image = picture_image(self.site.workspace.engine, int(number)) if plain else None
        if image is None:
            return self._told(request, who, "There is no such picture.", 404)
        return Response(image, media_type="image/jpeg")

    async def sign_in(self, request: Request) -> Response:
        """Show the form to sign in, or take it."""
        site = self.site
        if site.serving.identity != "accounts":
            return RedirectResponse("/", 303)
        if request.method == "GET":
            return await run_in_threadpool(self._page, request, None, DeskAnswer("sign_in.html", {"name": ""}))
        form = await _form(request)
        fields = {} if form is None else form[0]
        seed, fresh = form_seed(request, None)
        name = fields.get("name", "")
        if fresh or not is_form_token(fields.get("token", ""), seed):
            again = DeskAnswer("sign_in.html", {"name": name, "problem": "The form was too old: try again."}, 403)
            return await run_in_threadpool(self._page, request, None, again)
        # One who guesses at many names comes from one place; one who guesses from many places at one name.
        whose = (f"name {name[:100].casefold()}", f"from {request.client.host if request.client else ''}")
        wait = self._attempts.wait(*whose)
        if wait:
            words = f"Too many attempts: try again in {wait / 60.0:.0f}\u00a0min."
            again = DeskAnswer("sign_in.html", {"name": name, "problem": words}, 429)
            return await run_in_threadpool(self._page, request, None, again)
        token = await run_in_threadpool(
            signed_in, site.workspace.engine, name, fields.get("password", ""), site.serving.session_hours
        )
        if token is None:
            self._attempts.failed(*whose)
            again = DeskAnswer("sign_in.html", {"name": name, "problem": "Name and password do not fit."}, 403)
            return await run_in_threadpool(self._page, request, None, again)
        self._attempts.succeeded(whose[0])
        response = RedirectResponse("/", 303)
        self._cookie(response, SESSION_COOKIE, token, round(3600.0 * site.serving.session_hours))
        return response

    async def sign_out(self, request: Request) -> Response:
        """End a session."""
        site = self.site
        who = await run_in_threadpool(person, request, site.serving, site.workspace.engine)
        form = await _form(request)
        if who is not None and who.session and form is not None:
            seed, _ = form_seed(request, who)
            if is_form_token(form[0].get("token", ""), seed):
                await run_in_threadpool(end_session, site.workspace.engine, digest(who.session))
        response = RedirectResponse("/", 303)
        response.delete_cookie(SESSION_COOKIE, path="/")
        return response


_Form = tuple[dict[str, str], dict[str, tuple[str, ...]], bytes]


async def _form(request: Request) -> _Form | None:
    """Return the fields of a form, all values of each, and the photograph; None for what is no form."""
    try:
        form = await request.form(max_files=1, max_fields=2_000, max_part_size=FORM_BYTES)
    except (MultiPartException, BodyTooLongError, UnicodeDecodeError) as problem:
        if isinstance(problem, BodyTooLongError):
            raise
        return None
    except Exception:  # noqa: BLE001 - whatever a form stumbles over was sent by somebody
        return None
    fields: dict[str, str] = {}
    lists: dict[str, tuple[str, ...]] = {}
    upload = b""
    for name, value in form.multi_items():
        if isinstance(value, UploadFile):
            upload = await value.read()
            continue
        # As a browser sends the lines of a text, and without what no database holds.
        text = value.replace("\r\n", "\n").replace("\0", "").encode("utf-8", "replace").decode()
        fields[name] = text
        lists[name] = (*lists.get(name, ()), text)
    return fields, lists, upload
