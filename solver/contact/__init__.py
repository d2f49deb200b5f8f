"""Through contact without a schedule: forces as variables, complementarity as constraints (000).

A room like ``solver.hybrid``: the problem is rewritten before anything is transcribed.
"""

from solver.contact.dissipation import losses
from solver.contact.expand import Contacts, as_stepped, contacts_of
from solver.contact.guess import with_contacts
from solver.contact.publish import published

__all__ = ["Contacts", "as_stepped", "contacts_of", "losses", "published", "with_contacts"]
