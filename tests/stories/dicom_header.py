"""A small reader of DICOM headers, independent of the program's own: enough to check it against.

Reads the native transfer syntaxes and the headers of compressed ones. What is damaged ends the
reading; what was read until there stays.
"""

import struct
import zlib

LONG_VR = {b"OB", b"OD", b"OF", b"OL", b"OV", b"OW", b"SQ", b"SV", b"UC", b"UN", b"UR", b"UT", b"UV"}
SHORT_VR = {b"AE", b"AS", b"AT", b"CS", b"DA", b"DS", b"DT", b"FL", b"FD", b"IS", b"LO", b"LT", b"PN",
            b"SH", b"SL", b"SS", b"ST", b"TM", b"UI", b"UL", b"US"}
# Sequences of functional groups, so that those of defined length open without a dictionary.
SEQUENCES = {(0x5200, 0x9229), (0x5200, 0x9230), (0x0020, 0x9113), (0x0020, 0x9116),
             (0x0028, 0x9110), (0x0028, 0x9145), (0x0004, 0x1220)}
UNDEFINED = 0xFFFFFFFF
ITEM, ITEM_END, SEQUENCE_END = (0xFFFE, 0xE000), (0xFFFE, 0xE00D), (0xFFFE, 0xE0DD)
PIXEL_DATA = (0x7FE0, 0x0010)
PATIENT_NAME, PATIENT_ID, CHARSET = (0x0010, 0x0010), (0x0010, 0x0020), (0x0008, 0x0005)
SERIES_UID = (0x0020, 0x000E)
POSITION, ORIENTATION, PIXEL_SPACING = (0x0020, 0x0032), (0x0020, 0x0037), (0x0028, 0x0030)
INTERCEPT, SLOPE = (0x0028, 0x1052), (0x0028, 0x1053)
ROWS, COLUMNS = (0x0028, 0x0010), (0x0028, 0x0011)


class Reader:
    """Goes through one data set. Elements: tag to bytes, or to a list of items (each a dict)."""

    def __init__(self, data, explicit, big):
        self.data, self.at, self.explicit = data, 0, explicit
        self.end = ">" if big else "<"

    def unpack(self, kind, size):
        value = struct.unpack_from(self.end + kind, self.data, self.at)[0]
        self.at += size
        return value

    def head(self):
        """The next element's tag, VR and length."""
        tag = (self.unpack("H", 2), self.unpack("H", 2))
        if tag[0] == 0xFFFE or not self.explicit:
            return tag, b"", self.unpack("I", 4)
        vr = self.data[self.at:self.at + 2]
        self.at += 2
        if vr in LONG_VR:
            self.at += 2
            return tag, vr, self.unpack("I", 4)
        if vr not in SHORT_VR:  # An implicit element among explicit ones.
            self.at -= 2
            return tag, b"", self.unpack("I", 4)
        return tag, vr, self.unpack("H", 2)

    def dataset(self, stop):
        found = {}
        try:
            while self.at < stop:
                tag, vr, length = self.head()
                if tag in (ITEM_END, SEQUENCE_END):
                    break
                found[tag] = self.value(tag, vr, length)
        except struct.error:
            pass  # Cut short.
        return found

    def value(self, tag, vr, length):
        if tag == PIXEL_DATA and length == UNDEFINED:  # Compressed.
            value, self.at = self.data[self.at:], len(self.data)
            return value
        if length == UNDEFINED or vr == b"SQ" or tag in SEQUENCES:
            return self.items(len(self.data) if length == UNDEFINED else self.at + length)
        value = self.data[self.at:self.at + length]
        self.at += length
        return value

    def items(self, stop):
        found = []
        while self.at < stop:
            tag, _, length = self.head()
            if tag != ITEM:
                break
            end = len(self.data) if length == UNDEFINED else self.at + length
            found.append(self.dataset(end))
        return found


def read(data):
    """The elements of a file's bytes; empty where it is no DICOM."""
    meta, at, syntax = {}, 0, b""
    if data[128:132] == b"DICM":
        reader = Reader(data, True, False)
        reader.at = 132
        while data[reader.at:reader.at + 2] == b"\x02\x00":
            tag, vr, length = reader.head()
            meta[tag] = reader.value(tag, vr, length)
        at, syntax = reader.at, meta.get((2, 0x10), b"").strip(b"\0 ")
    body = data[at:]
    if syntax == b"1.2.840.10008.1.2.1.99":
        body = zlib.decompress(body, -15)
    reader = Reader(body, body[4:6].isalpha() and body[4:6].isupper(),
                    syntax == b"1.2.840.10008.1.2.2")
    return {**meta, **reader.dataset(len(body))}


def text(elements, tag):
    return elements.get(tag, b"").decode("ascii", "replace").strip("\0 ")


def numbers(elements, tag):
    return [float(part) for part in text(elements, tag).split("\\") if part.strip()]


def integer(elements, tag):
    return struct.unpack("<H", elements[tag][:2])[0]
