"""Reads a checkpoint of Meniscus with numpy alone; FORMAT.md tells the layout.

    checkpoint = Checkpoint("runs/drop/checkpoints/step-000001234.meniscus")
    checkpoint.time, checkpoint.columns["density"].values.mean()

As a command it prints what a file holds:

    python3 read_checkpoint.py FILE [--json]

Values are views of the file: nothing is read before it is used. Checksums are compared where the module
`xxhash` is installed; without it, `meniscus inspect verify FILE` does that.
"""

import json
import struct
import sys
from typing import NamedTuple

import numpy

PAGE = 4096
MARK = b"MENISCUS"
VERSION = 1


class Column(NamedTuple):
    name: str
    symbol: str
    unit: str
    about: str
    role: str
    values: numpy.ndarray


class Archive:
    """A section of the file. Places are bytes from its start."""

    def __init__(self, data, start, length):
        if start + length > len(data):
            raise ValueError("the file is shorter than its header says")
        self.data = data[start : start + length]

    def word(self, place, kind="<Q"):
        return struct.unpack_from(kind, self.data, place)[0]

    def items(self, place, size):
        """Places of the items of a list."""
        first, count = place + self.word(place, "<q"), self.word(place + 8)
        if first < 0 or first + count * size > len(self.data):
            raise ValueError("a list reaches out of its section")
        return range(first, first + count * size, size)

    def text(self, place):
        word = self.word(place)
        if word & 0xC0 == 0x80:
            start = place + self.word(place + 8, "<q")
            length = (word & 0x3F) | ((word & ~0xFF) >> 2)
        else:
            start = place
            length = (bytes(self.data[place : place + 16]) + b"\xff").index(b"\xff")
        if start < 0 or start + length > len(self.data):
            raise ValueError("a text reaches out of its section")
        return bytes(self.data[start : start + length]).decode()

    def column(self, place):
        role = ["state", "derived"][self.word(place + 64, "<B")]
        kind = numpy.dtype(["<f8", "<u4"][self.word(place + 72, "<B")])
        items = self.items(place + 80, kind.itemsize)
        values = self.data[items.start : items.stop].view(kind)
        return Column(*(self.text(place + 16 * part) for part in range(4)), role, values)


class Checkpoint:
    def __init__(self, path):
        data = numpy.memmap(path, dtype=numpy.uint8, mode="r")
        if len(data) < PAGE or bytes(data[:8]) != MARK:
            raise ValueError(f"{path}: no checkpoint")
        (version,) = struct.unpack_from("<I", data, 8)
        if version != VERSION:
            raise ValueError(f"{path}: found format version {version}, expected {VERSION}")
        length, *sections = struct.unpack_from("<5Q", data, 16)
        preface_length, preface_checksum, columns_length, columns_checksum = sections
        if length != len(data):
            raise ValueError(f"{path}: found {len(data)} bytes, expected {length}")
        columns_start = PAGE + -(-preface_length // PAGE) * PAGE
        (header_checksum,) = struct.unpack_from("<Q", data, PAGE - 8)
        compare(path, data[: PAGE - 8], header_checksum)
        compare(path, data[PAGE:columns_start], preface_checksum)
        compare(path, data[columns_start:], columns_checksum)

        preface = Archive(data, PAGE, preface_length)
        root = preface_length - 72
        self.step = preface.word(root)
        self.time = preface.word(root + 8, "<d")
        self.step_size = preface.word(root + 16, "<d")
        numbers = preface.items(root + 24, 24)
        self.numbers = {preface.text(place): preface.word(place + 16, "<d") for place in numbers}
        self.scene = preface.text(root + 40)
        self.revision = preface.text(root + 56)

        columns = Archive(data, columns_start, columns_length)
        places = columns.items(columns_length - 16, 96)
        self.columns = {column.name: column for column in map(columns.column, places)}


def compare(path, data, expected):
    try:
        import xxhash
    except ImportError:
        return
    if xxhash.xxh3_64_intdigest(data) != expected:
        raise ValueError(f"{path}: damaged")


def main(arguments):
    checkpoint = Checkpoint(arguments[0])
    told = {name: getattr(checkpoint, name) for name in ["step", "time", "step_size", "numbers", "revision"]}
    told["fields"] = {
        name: {"unit": column.unit, "role": column.role, "particles": len(column.values),
               "minimum": float(column.values.min()), "maximum": float(column.values.max())}
        for name, column in checkpoint.columns.items()
    }
    if "--json" in arguments:
        print(json.dumps(told))
    else:
        print(f"step {told['step']}, time {told['time']:g} s, revision {told['revision']}")
        for name, field in told["fields"].items():
            print(f"{name:26} {field['minimum']:14.6g} {field['maximum']:14.6g} {field['unit']}")


if __name__ == "__main__":
    main(sys.argv[1:])
