"""The page of ``asperity serve``: cases set, rolled, looked at, compared and heard in a browser."""
