"""Contents of files of heights, from the definitions of the formats (ISO 25178-71 and -72, npy, zip)."""

import io
import struct
import warnings
import zipfile

import numpy as np

SDF_TYPES = {0: "u1", 1: "<u2", 2: "<u4", 3: "<f4", 4: "i1", 5: "<i2", 6: "<i4", 7: "<f8"}
X3P_TYPES = {"I": "<i2", "L": "<i4", "F": "<f4", "D": "<f8"}


def npy(array, **options):
    """What `numpy.save` writes."""
    stream = io.BytesIO()
    np.save(stream, array, **options)
    return stream.getvalue()


def zipped(*members, compress=True):
    """A zip archive of (name, content), in which names may stand twice."""
    stream = io.BytesIO()
    kind = zipfile.ZIP_DEFLATED if compress else zipfile.ZIP_STORED
    with warnings.catch_warnings(), zipfile.ZipFile(stream, "w", kind) as archive:
        warnings.simplefilter("ignore")
        for name, content in members:
            archive.writestr(name, content)
    return stream.getvalue()


def sdf_binary(
    stored,
    code,
    *,
    steps=(2e-6, 3e-6),
    unit=1e-9,
    points=None,
    profiles=None,
    compression=0,
    magic=b"bISO-1.0",
    counts="<HH",
):
    """Binary SDF; `stored` (profiles, points) in the data type of the code; ISO-2.0 counts by ``<II``."""
    stored = np.asarray(stored, SDF_TYPES[code])
    rows, columns = stored.shape
    return (
        magic
        + b"maker".ljust(10)
        + b"010120251200" * 2
        + struct.pack(counts, columns if points is None else points, rows if profiles is None else profiles)
        + struct.pack("<dddd", *steps, unit, -1.0)
        + bytes([compression, code, 0])
        + stored.tobytes()
    )


def sdf_ascii(words, *, steps=(2e-6, 3e-6), unit=1e-9, code=5, magic="aISO-1.0", **changes):
    """ASCII SDF; `words` (profiles, points) as strings. A change of None leaves a field out."""
    fields = {"ManufacID": "maker", "NumPoints": len(words[0]), "NumProfiles": len(words)}
    fields |= {"Xscale": steps[0], "Yscale": steps[1], "Zscale": unit, "Zresolution": -1}
    fields |= {"Compression": 0, "DataType": code, "CheckType": 0} | changes
    header = "".join(f"{name:12} = {value}\n" for name, value in fields.items() if value is not None)
    body = "\n".join(" ".join(row) for row in words)
    return f"{magic}\n{header}*\n{body}\n*\nSerial = 7\n*\n".encode()


def _tag(name, content):
    return f"<{name}>{content}</{name}>" if content != "" else ""


def x3p_xml(
    sizes,
    *,
    kind="D",
    steps=("2e-06", "3e-06"),
    height=("", ""),
    axes=("I", "I"),
    link=True,
    mask=False,
    rotation="",
    preamble="",
):
    """main.xml of an X3P file; `sizes` (SizeX, SizeY, SizeZ)."""

    def axis(name, absolute, increment, offset="", data="D"):
        inner = _tag("AxisType", absolute) + _tag("DataType", data)
        return _tag(name, inner + _tag("Increment", increment) + _tag("Offset", offset))

    matrix = "".join(_tag(f"Size{a}", n) for a, n in zip("XYZ", sizes, strict=True))
    data = _tag("PointDataLink", "bindata/data.bin") + _tag("ValidPointsLink", "bindata/valid.bin") * mask
    record = _tag("MatrixDimension", matrix) + _tag("DataLink", data) * link
    drawn = axis("CX", axes[0], steps[0]) + axis("CY", axes[1], steps[1]) + axis("CZ", "A", *height, kind)
    return (
        f'<?xml version="1.0" encoding="UTF-8"?>{preamble}'
        '<p:ISO5436_2 xmlns:p="http://www.opengps.eu/2008/ISO5436_2">'
        f"<Record1><Axes>{drawn}{rotation}</Axes></Record1><Record3>{record}</Record3></p:ISO5436_2>"
    )


def x3p(stored, *, kind="D", sizes=None, valid=None, compress=True, **xml):
    """X3P archive; `stored` (SizeZ, SizeY, SizeX) in the data type of the letter."""
    stored = np.asarray(stored, X3P_TYPES[kind])
    main = x3p_xml(sizes or stored.shape[::-1], kind=kind, mask=valid is not None, **xml).encode()
    members = {"main.xml": main, "bindata/data.bin": stored.tobytes()}
    if valid is not None:
        members["bindata/valid.bin"] = np.packbits(np.ravel(valid), bitorder="little").tobytes()
    return zipped(*members.items(), compress=compress)
