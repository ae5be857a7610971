"""One self-contained page per run, the numbers of its figures, and pictures of measured surfaces."""
