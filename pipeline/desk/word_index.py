"""Lines of words, found by parts of words without a look at every line."""

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from heapq import merge
from itertools import accumulate

_FEW = 400
"""Different words with a part in them up to which their lines are put together: more words stand in so many lines that
the first ones are found soonest line by line."""


class WordIndex:
    """An index of lines.

    A part of a word is sought among the different words, of which there are far fewer than words.

    Parameters
    ----------
    lines : sequence of str
        Words parted by single spaces.
    """

    def __init__(self, lines: Sequence[str]) -> None:
        self._lines = lines
        places: dict[str, list[int]] = {}
        for at, line in enumerate(lines):
            for word in dict.fromkeys(line.split(" ")):
                places.setdefault(word, []).append(at)
        # Most words of a museum are its numbers: no word with a letter is sought among them.
        words = sorted(places, key=_no_letter)
        self._places = [places[word] for word in words]
        # In bytes, of which most words have fewer than letters take.
        self._text = b"".join(b"\n" + word.encode() for word in words) + b"\n"
        lengths = (len(word.encode()) + 1 for word in words)
        self._starts = list(accumulate(lengths, initial=1))
        self._lettered = self._starts[sum(not _no_letter(word) for word in words)]

    def having(self, parts: Sequence[str]) -> Iterator[int]:
        """Yield the places of the lines that have all parts in their words, in order.

        parts : without spaces, one at least
        """
        rarest = min((self._words_with(part) for part in parts), key=len)
        if len(rarest) > _FEW:
            found: Iterator[int] = iter(range(len(self._lines)))
        else:
            found = merge(*(self._places[word] for word in rarest))
        last = -1
        for at in found:
            # A line may have several of the words.
            if at != last and all(part in self._lines[at] for part in parts):
                yield at
            last = at

    def _words_with(self, part: str) -> list[int]:
        """Return the different words that have a part, or some more than a few of them."""
        text, sought, found = self._text, part.encode("utf-8", "replace"), list[int]()
        end = len(text) if _no_letter(part) else self._lettered
        at = text.find(sought, 0, end)
        while at >= 0 and len(found) <= _FEW:
            word = bisect_right(self._starts, at) - 1
            found.append(word)
            at = text.find(sought, self._starts[word + 1], end)
        return found


def _no_letter(word: str) -> bool:
    return not any(map(str.isalpha, word))
