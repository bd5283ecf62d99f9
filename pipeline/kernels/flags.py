"""Bits by which a kernel says what its numbers do not."""

CONTACT_LOST = 1
"""The vertical acceleration went below -g: no weight, no friction; flight and landing are not modelled."""
CUT = 2
"""Still moving when the tail or its cap ended."""
EVENT_CAP = 4
"""More events in one sample interval than are followed: the body was put to rest until the next sample."""
SENSITIVE = 8
"""An event that hangs on less than the error of the integration: a body that just stops, or just does not."""
UNRESOLVED = 128
"""More steps than are taken: not followed.  Without a cap a body too fast for its motion would be followed for ever."""
