"""Many small records on their way from one who found them to others who need some of them."""

import zlib
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pipeline.store import codec
from pipeline.store.codec import StoreError

_WINDOW = 32_768
"""Bytes that zlib looks back at most."""


@dataclass(frozen=True)
class Parcel:
    """Records by key, each compressed by itself: like ones share a dictionary, which makes them three times as small.

    hint : the type of a record, see `codec.adapter`
    same : keys of which the record is that of another key
    """

    hint: Any
    dictionary: bytes
    records: Mapping[str, bytes]
    same: Mapping[str, str]

    @classmethod
    def of(cls, hint: Any, records: Mapping[str, Any], same: Mapping[str, str] | None = None) -> "Parcel":
        """Pack records.

        same   : further keys, each with the key whose record is theirs too
        raises : StoreError for a value of the wrong type, or text that is not Unicode
        """
        texts = {key: codec.to_json(hint, record).encode() for key, record in records.items()}
        dictionary = b"".join(_some(list(texts.values())))[-_WINDOW:]
        packed = {key: _compressed(text, dictionary) for key, text in texts.items()}
        return cls(hint, dictionary, packed, same or {})

    def only(self, keys: Collection[str]) -> "Parcel":
        """Return a parcel with those of its records that are wanted, each once."""
        wanted = {self.same.get(key, key): None for key in keys}
        return Parcel(self.hint, self.dictionary, {k: self.records[k] for k in wanted if k in self.records}, {})

    def opened(self) -> list[Any]:
        """Return its records.

        raises : StoreError where it is damaged
        """
        return [codec.of_json(self.hint, _text(packed, self.dictionary)) for packed in self.records.values()]


def _some(texts: Sequence[bytes]) -> list[bytes]:
    # A few from all over, the shorter the better: what they have in common is what counts.
    return sorted(texts[:: max(1, len(texts) // 64)], key=len)[:16]


def _compressed(text: bytes, dictionary: bytes) -> bytes:
    packer = zlib.compressobj(1, zdict=dictionary)
    return packer.compress(text) + packer.flush()


def _text(packed: bytes, dictionary: bytes) -> str:
    unpacker = zlib.decompressobj(zdict=dictionary)
    try:
        text = unpacker.decompress(packed)
        if not unpacker.eof:
            raise zlib.error("it ends too early")
        return text.decode()
    except (zlib.error, UnicodeDecodeError) as error:
        raise StoreError(f"what another worker found arrived damaged: {error}; run again with --resume") from error
