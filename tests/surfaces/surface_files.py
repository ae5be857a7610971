"""Writers of SDF and X3P files, from the definitions of the formats (ISO 25178-71 and -72)."""

import hashlib
import struct
import zipfile

import numpy as np

SDF_TYPES = {0: "u1", 1: "<u2", 2: "<u4", 3: "<f4", 4: "i1", 5: "<i2", 6: "<i4", 7: "<f8"}
X3P_TYPES = {"I": "<i2", "L": "<i4", "F": "<f4", "D": "<f8"}


def sdf_binary(stored, code, *, steps=(2e-6, 3e-6), unit=1e-9, points=None, profiles=None, compression=0):
    """Binary SDF; `stored` (profiles, points) in the data type of the code."""
    stored = np.asarray(stored, SDF_TYPES[code])
    rows, columns = stored.shape
    return (
        b"bISO-1.0"
        + b"maker".ljust(10)
        + b"010120251200" * 2
        + struct.pack("<HH", columns if points is None else points, rows if profiles is None else profiles)
        + struct.pack("<dddd", *steps, unit, -1.0)
        + bytes([compression, code, 0])
        + stored.tobytes()
    )


def sdf_ascii(words, *, steps=(2e-6, 3e-6), unit=1e-9, code=5, **changes):
    """ASCII SDF; `words` (profiles, points) as strings. A change of None leaves a field out."""
    fields = {
        "ManufacID": "maker",
        "CreateDate": "010120251200",
        "ModDate": "010120251200",
        "NumPoints": len(words[0]),
        "NumProfiles": len(words),
        "Xscale": steps[0],
        "Yscale": steps[1],
        "Zscale": unit,
        "Zresolution": -1,
        "Compression": 0,
        "DataType": code,
        "CheckType": 0,
    } | changes
    header = "".join(f"{name:12} = {value}\n" for name, value in fields.items() if value is not None)
    body = "\n".join(" ".join(row) for row in words)
    return f"aISO-1.0\n{header}*\n{body}\n*\nSerial = 7\n*\n".encode()


def x3p_xml(
    sizes,
    *,
    kind="D",
    steps=("2e-06", "3e-06"),
    height=("", ""),
    axes=("I", "I"),
    link=True,
    points_md5="",
    valid_md5=None,
    datums=None,
    dimension=None,
    rotation="",
    preamble="",
    feature="SUR",
):
    """main.xml of an X3P file; `sizes` (SizeX, SizeY, SizeZ)."""

    def axis(name, absolute, increment, offset, data="D"):
        inner = f"<AxisType>{absolute}</AxisType><DataType>{data}</DataType>"
        inner += f"<Increment>{increment}</Increment>" if increment else ""
        inner += f"<Offset>{offset}</Offset>" if offset else ""
        return f"<{name}>{inner}</{name}>"

    matrix = dimension or "<MatrixDimension>{}</MatrixDimension>".format(
        "".join(f"<Size{a}>{n}</Size{a}>" for a, n in zip("XYZ", sizes, strict=True))
    )
    data = ""
    if link:
        data = "<DataLink><PointDataLink>bindata/data.bin</PointDataLink>"
        data += f"<MD5ChecksumPointData>{points_md5}</MD5ChecksumPointData>"
        if valid_md5 is not None:
            data += "<ValidPointsLink>bindata/valid.bin</ValidPointsLink>"
            data += f"<MD5ChecksumValidPoints>{valid_md5}</MD5ChecksumValidPoints>"
        data += "</DataLink>"
    if datums is not None:
        data += "<DataList>" + "".join(f"<Datum>{d}</Datum>" for d in datums) + "</DataList>"
    return (
        f'<?xml version="1.0" encoding="UTF-8"?>{preamble}'
        '<p:ISO5436_2 xmlns:p="http://www.opengps.eu/2008/ISO5436_2">'
        f"<Record1><Revision>ISO5436 - 2000</Revision><FeatureType>{feature}</FeatureType><Axes>"
        f"{axis('CX', axes[0], steps[0], '')}{axis('CY', axes[1], steps[1], '')}"
        f"{axis('CZ', 'A', *height, kind)}{rotation}</Axes></Record1>"
        f"<Record3>{matrix}{data}</Record3>"
        "<Record4><ChecksumFile>md5checksum.hex</ChecksumFile></Record4></p:ISO5436_2>"
    )


def x3p(path, stored, *, kind="D", sizes=None, valid=None, data=None, compress=True, extra=(), **xml):
    """Write an X3P archive; `stored` (SizeZ, SizeY, SizeX) in the data type of the letter."""
    stored = np.asarray(stored, X3P_TYPES[kind])
    data = stored.tobytes() if data is None else data
    sizes = tuple(reversed(stored.shape)) if sizes is None else sizes
    md5 = {"points_md5": hashlib.md5(data).hexdigest().upper()}
    members = {"bindata/data.bin": data}
    if valid is not None:
        members["bindata/valid.bin"] = np.packbits(np.ravel(valid), bitorder="little").tobytes()
        md5["valid_md5"] = hashlib.md5(members["bindata/valid.bin"]).hexdigest()
    main = x3p_xml(sizes, kind=kind, **(md5 | xml)).encode()
    members = {"main.xml": main} | members | dict(extra)
    members.setdefault("md5checksum.hex", f"{hashlib.md5(main).hexdigest()} *main.xml".encode())
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED if compress else zipfile.ZIP_STORED) as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    return path
