"""A case fitted to what was measured: free keys, what the data determine of them, and how well."""
