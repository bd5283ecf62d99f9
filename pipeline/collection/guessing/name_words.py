"""Words in the names of columns that say of what something is, or of whom, and not what it is."""

from __future__ import annotations

FORMER = frozenset(
    {
        *("former", "previous", "old", "other", "alt", "alte", "altes", "fruhere", "fruherer", "ancien", "ancienne"),
        *("anciens", "vecchio", "vecchia", "precedente", "anterior", "antiguo", "antigo", "oud", "oude", "vorige"),
        *("vechi", "veche", "lender", "leihgeber", "donor", "loan", "art", "mode", "modo", "status", "source", "value"),
        *("date", "year", "datum", "jahr", "annee", "anno", "data", "fecha", "ano", "jaar", "anul", "method", "type"),
        *("notes", "note", "remarks", "remark", "comment", "comments", "by", "insurance", "bemerkung", "bemerkungen"),
        *(
            "anmerkung",
            "anmerkungen",
            "hinweis",
            "hinweise",
            "notiz",
            "notizen",
            "remarque",
            "remarques",
            "observation",
        ),
        *(
            "observations",
            "commentaire",
            "commentaires",
            "osservazione",
            "osservazioni",
            "nota",
            "notas",
            "observacion",
        ),
        *("observaciones", "observacao", "observacoes", "opmerking", "opmerkingen", "bemærkning", "bemærkninger"),
        *("merknad", "merknader", "anmarkning", "anmarkningar", "uwagi", "poznamka", "poznamky", "примечание"),
        *("примечания", "σημειωσεισ", "not", "notlar", "megjegyzes", "huomautus"),
    }
)
"""Words that say that something else is meant than the object's own number and place now."""

OWNERS = frozenset({
    "lender", "owner", "donor", "leihgeber", "besitzer", "eigentumer", "proprietaire", "preteur", "proprietario",
    "propietario", "prestatore", "prestador", "eigenaar", "bruikleengever", "vendor", "dealer", "institution", "museum",
    "musee", "museo", "museu", "sammlung", "collection", "collezione", "coleccion",
})  # fmt: skip
"""Words, folded, of whose a thing is: such a column names no things."""

ABOUT = frozenset(
    {"measurement", "measurements", "measure", "dimension", "dimensions", "size", "sizes", "maß", "misura"}
)
"""Words before the name of a side that say only that it is one."""

DENOTING = frozenset({"bezeichnung", "benennung", "denomination", "designation", "denominazione", "denominacion"})
"""What is called so is called something, a place too."""

OF_CODES = frozenset({"code", "id", "key", "uri", "url", "no", "since", "date", "from", "until"})
"""Names within a name of what is less than a name."""

OF_KEYS = frozenset({"id", "ids", "key", "uri", "url"})
"""Words that end the name of a column of keys or addresses."""

ELSEWHERE = frozenset({
    "image", "images", "img", "picture", "pictures", "photo", "photos", "photograph", "photographs", "thumbnail",
    "thumbnails", "media", "visuel", "visuels", "bild", "bilder", "abbildungen", "immagini", "imagenes", "imagem",
    "afbeeldingen", "billeder", "iiif", "files", "file", "exhibition", "exhibitions", "exhibit", "ausstellungen",
    "expositions", "mostre", "exposiciones", "exposities", "udstillinger", "related", "parts", "creator",
    "creators", "artist", "artists", "maker", "makers", "people", "person", "agents", "constituents", "production",
    "author", "auteur", "auteurs", "documentation", "references", "bibliography", "publications", "literature",
    "provenance", "inscriptions", "geographies", "geography", "places", "links", "rights", "citations", "children",
    "parent", "label", "colors",
})  # fmt: skip
"""Words of what an object has or what was made of it: a size, number or title within is not the object's."""

HOLDING = frozenset({
    *("name", "value", "text", "label", "term", "content", "preflabel", "displayname", "de", "en", "fr", "keyword"),
    *("summarydata", "summary", "wert", "valeur", "valore", "valor", "previewvrt", "exportclb", "rendered", "raw"),
})  # fmt: skip
"""Names within a name that say only that its value follows: "object_names.name"."""

USUAL = frozenset({"home", "normal", "usual", "default", "permanent", "stamm", "habituel", "abituale", "habitual"})
"""Words of a place where an object mostly is: used where no column tells where it is now."""
