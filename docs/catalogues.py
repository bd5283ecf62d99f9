"""The catalogues that travel with Kouros, brought up to date: new phrases come in without a translation, old ones go.

``make catalogues`` runs it; a test fails as long as any phrase has no translation.
"""

from io import BytesIO
from pathlib import Path

from babel.messages.catalog import Catalog
from babel.messages.extract import extract_from_dir
from babel.messages.frontend import parse_mapping_cfg
from babel.messages.pofile import read_po, write_po

ROOT = Path(__file__).parents[1]


def phrases() -> Catalog:
    """Return all phrases of the pages, of the desk too."""
    with (ROOT / "templates" / "babel.cfg").open(encoding="utf-8") as file:
        methods, options = parse_mapping_cfg(file)
    found = Catalog()
    for _file, _line, message, _comments, context in extract_from_dir(ROOT, methods, options):
        found.add(message, context=context)
    return found


def updated(text: bytes, found: Catalog) -> str:
    """Return a catalogue with just the phrases that there are; its head stays as somebody wrote or signed it.

    Parameters
    ----------
    text : bytes
        The file.
    found : Catalog
        All phrases.
    """
    head = text.decode().partition("\n\n")[0]
    made = read_po(BytesIO(text))
    made.update(found, no_fuzzy_matching=True)
    made.obsolete.clear()
    out = BytesIO()
    write_po(out, made, width=118, omit_header=True, sort_output=True, no_location=True)
    return f"{head}\n\n{out.getvalue().decode().strip()}\n"


def main() -> None:
    """Write every catalogue anew, and say how many phrases are to be translated."""
    found = phrases()
    for file in sorted((ROOT / "templates" / "catalogues").glob("*/LC_MESSAGES/kouros.po")):
        text = updated(file.read_bytes(), found)
        file.write_text(text, encoding="utf-8")
        left = sum(
            one.fuzzy or not all([one.string] if isinstance(one.string, str) else one.string)
            for one in read_po(BytesIO(text.encode()))
        )
        print(f"{file.relative_to(ROOT)}: {len(found)} phrases, {left} to translate")


if __name__ == "__main__":
    main()
