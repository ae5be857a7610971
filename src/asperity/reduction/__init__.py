"""The reduction: scans of the contact, and the state functions made of them."""
