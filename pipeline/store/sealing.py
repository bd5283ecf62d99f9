"""What is kept carries a seal, so that what a disk or a person changed is noticed when it is read again."""

from hashlib import blake2b


def seal(*parts: str | bytes) -> str:
    """Return the seal of what a row holds.

    Parameters
    ----------
    *parts
        What is sealed, in an order that is always the same.

    Returns
    -------
    str
        BLAKE2b of all parts and of where each of them ends, 128 bits in hexadecimal digits.
    """
    digest = blake2b(digest_size=16)
    for part in parts:
        content = part.encode("utf-8", "surrogatepass") if isinstance(part, str) else part
        digest.update(len(content).to_bytes(8, "little"))
        digest.update(content)
    return digest.hexdigest()
