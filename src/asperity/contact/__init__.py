"""Three-dimensional contact: the half-space solver and Hertz's closed forms."""

from asperity.contact.halfspace import Contact, HalfSpace
from asperity.contact.hertz import Hertz

__all__ = ["Contact", "HalfSpace", "Hertz"]
