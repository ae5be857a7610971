"""The bodies that vibrate: the rigid ball and the beam."""
