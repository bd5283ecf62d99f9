"""LIDO files for the tests: whole records in the shapes that German, Dutch, Finnish and French exports have."""

from __future__ import annotations

from xml.sax.saxutils import escape, quoteattr

HEAD = (
    '<lido:lidoWrap xmlns:lido="http://www.lido-schema.org" xmlns:skos="http://www.w3.org/2004/02/skos/core#" '
    'xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" '
    'xsi:schemaLocation="http://www.lido-schema.org http://www.lido-schema.org/schema/v{version}/lido-v{version}.xsd">'
)


def wrap(*records: str, version: str = "1.0") -> bytes:
    """A file of these records."""
    lines = '<?xml version="1.0" encoding="UTF-8"?>', HEAD.format(version=version), *records, "</lido:lidoWrap>"
    return "\n".join(lines).encode()


def element(name: str, *inner: str, **attributes: str) -> str:
    """<lido:name lido:attribute="...">inner</lido:name>; the attribute "lang" is xml:lang."""
    said = "".join(f" {'xml' if a == 'lang' else 'lido'}:{a}={quoteattr(v)}" for a, v in attributes.items())
    return f"<lido:{name}{said}>{''.join(inner)}</lido:{name}>"


def concept(name: str, *terms: str, identifier: str = "", source: str = "", **attributes: str) -> str:
    """An element with a conceptID and with terms, each as "word" or "de:word"."""
    identifiers = element("conceptID", escape(identifier), **({"source": source} if source else {}))
    return element(name, identifiers if identifier else "", *map(_term, terms), **attributes)


def _term(term: str) -> str:
    language, _, word = term.rpartition(":")
    return element("term", escape(word), **({"lang": language} if language else {}))


def measured(kind: str, value: str, unit: str = "cm") -> str:
    """A measurementsSet as in LIDO 1.0, with plain texts."""
    return element(
        "measurementsSet",
        element("measurementType", kind),
        element("measurementUnit", unit),
        element("measurementValue", value),
    )


def measurements(*sets: str, extent: str = "", display: str = "") -> str:
    """An objectMeasurementsSet."""
    return element(
        "objectMeasurementsSet",
        element("displayObjectMeasurements", display) if display else "",
        element("objectMeasurements", *sets, element("extentMeasurements", extent) if extent else ""),
    )


def record(
    *,
    number: str = "A 1",
    identifier: str = "DE-MUS-1/lido/1",
    title: str = "Bust",
    place: str = "Hall 2",
    classes: str = "",
    sizes: str = "",
    more: str = "",
    events: str = "",
    language: str = "en",
) -> str:
    """One lido:lido with the parts that every export has, and others as XML."""
    repository = element(
        "repositorySet",
        element("repositoryName", element("legalBodyName", element("appellationValue", "Museum"))),
        element("workID", escape(number), type="inventory number") if number else "",
        element("repositoryLocation", element("namePlaceSet", element("appellationValue", escape(place)))),
        type="current",
    )
    return element(
        "lido",
        element("lidoRecID", escape(identifier), type="local"),
        element(
            "descriptiveMetadata",
            element("objectClassificationWrap", classes),
            element(
                "objectIdentificationWrap",
                element("titleWrap", element("titleSet", element("appellationValue", escape(title)))),
                element("repositoryWrap", repository),
                element("objectMeasurementsWrap", sizes),
                more,
            ),
            element("eventWrap", events),
            lang=language,
        ),
        element("administrativeMetadata", lang=language),
    )
