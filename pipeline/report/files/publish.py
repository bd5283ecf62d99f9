"""Showing the newest whole report under one lasting name, without a moment in which there is none."""

from html import escape
from pathlib import Path
from urllib.parse import quote

from pipeline.report.errors import ReportError
from pipeline.resources import aside_of, replacing

LINK, PAGE = "latest", "latest.html"

_POLICY = "default-src 'none'; base-uri 'none'; form-action 'none'"


def publish(folder: Path, root: Path) -> Path:
    """Point ``root/latest`` at a whole report, atomically; earlier reports stay where they are.

    folder  : a rendered report inside root
    root    : the folder that holds all reports
    returns : root/latest, or root/latest.html on a file system without symbolic links
    raises  : FileNotFoundError if the folder holds no report; ReportError if it lies outside root or the name
              "latest" is taken by something that Kouros did not make
    """
    folder, root = folder.resolve(), root.resolve()
    if not (folder / "index.html").is_file():
        raise FileNotFoundError(f"{folder} holds no index.html; render the report first")
    if not folder.is_relative_to(root) or folder == root:
        raise ReportError(f"{folder} is not inside {root}; render reports into a folder below it")
    link = root / LINK
    if link.exists() and not link.is_symlink():
        raise ReportError(f"{link} is not a link that Kouros made; move it away, then publish again")
    target = folder.relative_to(root)
    page = root / PAGE
    if lasting_name(root) == page:
        return _redirect(target, page)
    with replacing(link) as aside:
        aside.symlink_to(target, target_is_directory=True)
    if page.exists():
        _redirect(target, page)  # A page left by an earlier system would go on showing an old report.
    return link


def lasting_name(root: Path) -> Path:
    """Return what `publish` gives, before it is done: a report tells it, and is whole before it is shown.

    root : the folder that holds all reports, which exists
    """
    link = root / LINK
    if link.is_symlink():
        return link
    aside = aside_of(link)
    try:
        aside.symlink_to(PAGE)
    except (OSError, NotImplementedError):
        # Windows without the privilege, and some network drives, refuse symbolic links; a page can be replaced instead.
        return root / PAGE
    aside.unlink()
    return link


def _redirect(target: Path, page: Path) -> Path:
    address = escape(quote(target.as_posix()) + "/index.html", quote=True)
    with replacing(page) as aside:
        aside.write_text(
            '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"/>'
            f'<meta http-equiv="Content-Security-Policy" content="{_POLICY}"/><title>Latest report</title>'
            f'<meta http-equiv="refresh" content="0; url={address}"/></head>'
            f'<body><p><a href="{address}">The latest report</a></p></body></html>\n',
            encoding="utf-8",
        )
    return page
