"""Words that say how the name of a thing is to be read: what it is made of, a part of it, or no more than a kind."""

from __future__ import annotations

import re

ANY_LIGHT = frozenset({"lamp", "light", "lampe", "lampada", "lampara", "lampa", "luminaire", "leuchte", "leuchter"})
"""Words that name a light of any kind, folded."""
LIDS = frozenset({"lid", "cover", "deckel", "couvercle", "coperchio", "tapa", "deksel", "capac", "tampa"})
"""Words of what a thing may have and be no other kind for it, folded."""
FRAGMENTS = frozenset(
    {
        "fragment",
        "fragments",
        "sherd",
        "sherds",
        "frammento",
        "fragmento",
        "fragmente",
        "scherbe",
        "bruchstuck",
        "tesson",
    }
)
"""Words of what is left of a thing, folded: a title that says so goes before an object name that does not."""
OF_STUFF = re.compile(
    r"(?:bronze|brass|copper|pewter|marble|limestone|alabaster|terracotta|clay|ceramic|earthenware|stoneware|porcelain"
    r"|faience|ivory|jade|bronzene|tonerne|holzerne|silberne|glaserne|irdene|marmorne|zinnerne|drewnian|glinian|brazow"
    r"|srebrn|szklan|marmurow|porcelanow|dreven|hlinen|bronzov|stribrn|sklenen|mramorov|глинян|бронзов|серебрян|стеклян"
    r"|мраморн|деревянн|фарфоров|πηλιν|μαρμαριν|χαλκιν|ασημενι|γυαλιν|ξυλιν|λιθιν|ορειχαλκιν)\w*\s"
    r"|.*\s(?:in|di|en|de|em|din|aus|van|of|z|ze)\s(?:bronzo|bronze|bronce|brons|bronz|brazu|marmo|marbre|marmol|marmore"
    r"|marmer|marmura|marmuru|terracotta|terre cuite|terracota|barro|lut|gliny|porcellana|porcelaine|porcelana"
    r"|porzellan|legno|bois|madera|madeira|holz|lemn|drewna|argento|argent|plata|prata|silber|zilver|argint|srebra|vetro"
    r"|verre|vidrio|vidro|ottone|laiton|laton|latao|messing|avorio|ivoire|marfil|marfim|alabastro|albatre|gesso|platre|yeso)$"
)
"""How a title begins, or ends, folded, that says what its thing is made of, as the name of a body does."""
SCULPTURES = frozenset(
    {
        *(
            "sculpture",
            "sculptures",
            "skulptur",
            "skulpturen",
            "plastik",
            "scultura",
            "sculture",
            "escultura",
            "esculturas",
        ),
        *(
            "beeldhouwwerk",
            "plastiek",
            "sculptura",
            "rzezba",
            "plastika",
            "彫刻",
            "γλυπτο",
            "γλυπτικη",
            "veistos",
            "statue",
        ),
    }
)
"""Object names, folded, of which a title may name a kind: a sculpture that is called mask, bust or relief."""
KINDS_ONLY = frozenset(
    {
        *(
            "artwork",
            "work of art",
            "kunstwerk",
            "opera",
            "oeuvre",
            "obra",
            "ceramic",
            "ceramics",
            "keramik",
            "ceramique",
        ),
        *("ceramica", "keramiek", "ceramika", "keramika", "陶磁", "furniture", "mobel", "mobilier", "mobili"),
        *("mueble", "muebles", "meubel", "meubels", "mebel", "meble", "nabytek", "mobiliario"),
        *("cast", "casts", "plaster cast", "plaster casts", "abguss", "gipsabguss", "moulage", "moulage en platre"),
        *(
            "textile",
            "textiles",
            "textil",
            "textilien",
            "textilies",
            "tessile",
            "tessili",
            "tessuti",
            "textiel",
            "tekstil",
        ),
        *("tekstylia", "carving", "carvings", "woodwork", "woodcarving"),
        *("calco", "calco in gesso", "vaciado", "vaciado en yeso", "gipsafgietsel", "odlew gipsowy", "sadrovy odlitek"),
    }
)
"""Object names, folded, that say no more than a classification does, and leave the title its say.

A cast is what it was cast from: David is a statue, and the portal of Saint-Gilles part of a building.
"""

NAMED_AFTER = frozenset({"plato"})
"""Words for things that in a title beside an object name are rather names of persons: a teapot called Plato."""
