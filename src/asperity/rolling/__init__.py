"""Rolling in time: structures coupled through a contact law."""
