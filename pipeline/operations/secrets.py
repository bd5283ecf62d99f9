"""Secrets, which must never be said: passwords and tokens, wherever the environment keeps them."""

import os
import re
from collections.abc import Callable, Mapping

from pipeline.collection.errors import CollectionError
from pipeline.collection.sources.address import expand_secrets, forms, hidden
from pipeline.settings import DATABASE_VARIABLE, Settings

_SECRETIVE = re.compile("PASS|PWD|SECRET|TOKEN|KEY|CREDENTIAL")


def hider(settings: Settings | None, environment: Mapping[str, str] | None = None) -> Callable[[str], str]:
    """Return a function that gives a text with *** in place of every secret of these settings.

    Parameters
    ----------
    settings : Settings or None
        Name the variables whose values are secrets; None where they could not be read.
    environment : mapping of str to str, or None
        Of this process, unless given.  Variables KOUROS_... whose names say that they hold a secret, and the password
        of the database's address, count whatever the settings say.

    Returns
    -------
    callable
        From text to text.
    """
    known = os.environ if environment is None else environment
    values = [value for name, value in known.items() if name.startswith("KOUROS_") and _SECRETIVE.search(name)]
    addresses = [known.get(DATABASE_VARIABLE, "")]
    if settings is not None:
        values += [known[name] for name in settings.hooks.variables if name in known]
        addresses.append(settings.collection.source)
    found = list(forms(values))
    for address in addresses:
        if "://" in address or "${" in address:
            try:
                found += expand_secrets(address, known).secrets
            except CollectionError:
                found.append(address)  # It cannot be opened; which part of it is the secret cannot be told.
    secrets = tuple(sorted(set(found), key=lambda secret: (-len(secret), secret)))
    return lambda text: hidden(text, secrets)
