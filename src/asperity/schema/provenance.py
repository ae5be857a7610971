"""What was computed, by what and how: attributes of the root and of the group scenario."""

from functools import partial

from asperity.schema import Attribute

_root, _scenario = partial(Attribute, ""), partial(Attribute, "scenario")

SCHEMA_VERSION = _root("schema_version", "1", "version of the names in the file")
ASPERITY_VERSION = _root("asperity_version", "text", "version of the program that wrote the file")
TITLE = _root("title", "text", "what was rolled")
CREATED = _root("created", "text", "when the run ended, ISO 8601")
CASE = _root("case", "text", "the case, in TOML")
IN_MEMORY = _root(
    "in_memory",
    "JSON",
    "keys that held a surface or a table in memory, which no case file can, and what it was",
    "where some did",
)
SEED = _root("seed", "1", "of all that was drawn at random")
DRAWN = _root(
    "drawn",
    "JSON",
    "by part, what the random numbers of its texture belong to: runs in which it is the same rolled over one "
    "texture, whatever its size, the grid, the load or the laws",
)
CITATIONS = _root("citations", "JSON", "sources of methods and data")
VERDICT = _root("verdict", "text", "what the run says, in a few sentences")
WARNINGS = _root("warnings", "JSON", "warnings on the physics: category, message, grade, count")
RUN = _root(
    "run",
    "text",
    "names the run by case, contents of its files and program, so that none is computed twice",
    "where the command line ran the case",
)

KIND = _scenario("kind", "text", "kind of case")
PARAMETERS = _scenario("parameters", "JSON", "every key of the case, with its value and default")
NUMERICS = _scenario("numerics", "JSON", "numbers of the computation: name, value")
EXPECTED_ERRORS = _scenario(
    "expected_errors",
    "JSON",
    "by the law accuracy map: errors (law, error, low, high: dB from direct), the law taken, whether the "
    "case is off_map, and the error wanted, dB",
    "where the map knows the case",
)
LAWS = _scenario("laws", "JSON", "each contact law: name, meaning, look, whether it may pull, needs, role")
