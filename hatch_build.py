"""Addresses of the project in its metadata: those of the repository that builds it, if that is hosted."""

import os
from collections.abc import Mapping

from hatchling.metadata.plugin.interface import MetadataHookInterface


def addresses(environment: Mapping[str, str]) -> dict[str, str]:
    """Return links by name; none outside a hosted build, where nobody knows them."""
    server, repository = environment.get("GITHUB_SERVER_URL"), environment.get("GITHUB_REPOSITORY")
    if not (server and repository):
        return {}
    source = f"{server}/{repository}"
    return {
        "Source": source,
        "Issues": f"{source}/issues",
        "Changelog": f"{source}/blob/main/CHANGELOG.md",
        "Documentation": f"{source}/blob/main/README.md",
    }


class Addresses(MetadataHookInterface):
    """Fills ``project.urls``."""

    def update(self, metadata: dict) -> None:
        """Add the links to what pyproject.toml says."""
        metadata["urls"] = addresses(os.environ)
