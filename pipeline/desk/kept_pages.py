"""Pages that were filled in already, for as long as nothing changes that they show."""

from collections import OrderedDict
from collections.abc import Hashable
from threading import Lock


class KeptPages:
    """The pages that were asked for last, all of one state of the museum.

    Parameters
    ----------
    most : int
        Characters of all pages together that are kept.
    """

    def __init__(self, most: int) -> None:
        self._most = most
        self._state: Hashable = None
        self._pages: OrderedDict[Hashable, str] = OrderedDict()
        self._length = 0
        self._lock = Lock()

    def get(self, state: Hashable, key: Hashable) -> str | None:
        """Return a page as it is in a state; None where nobody asked for it since that began."""
        with self._lock:
            if state != self._state or key not in self._pages:
                return None
            self._pages.move_to_end(key)
            return self._pages[key]

    def keep(self, state: Hashable, key: Hashable, page: str) -> None:
        """Keep a page.

        state : as it was before anything of the page was looked up, so that what changed meanwhile is shown next time
        """
        with self._lock:
            if state != self._state:
                self._state, self._length = state, 0
                self._pages.clear()
            self._length += len(page) - len(self._pages.pop(key, ""))
            self._pages[key] = page
            while self._length > self._most:
                self._length -= len(self._pages.popitem(last=False)[1])
