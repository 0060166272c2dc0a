"""Reads a table as its documentation (src/table/format.rs) draws it, with nothing but the standard library.

Usage: python3 read_table.py FILE. Prints the name, the measured error, the nodes of each chart, and how many numbers.
"""
import math
import struct
import sys
import zlib


class Metadata:
    """bincode 2, standard configuration: little-endian, integers of variable length."""

    def __init__(self, data):
        self.data, self.at = data, 0

    def take(self, count):
        self.at += count
        return self.data[self.at - count:self.at]

    def integer(self):
        first = self.take(1)[0]
        size = {251: 2, 252: 4, 253: 8}.get(first)
        return int.from_bytes(self.take(size), "little") if size else first

    def text(self):
        return self.take(self.integer()).decode()

    def number(self):
        return struct.unpack("<d", self.take(8))[0]


with open(sys.argv[1], "rb") as file:
    table = file.read()
magic, version, length, metadata_crc, numbers_crc, numbers_length, preamble_crc = struct.unpack("<8sIIIIQI", table[:36])
assert magic == b"\x89DRK\r\n\x1a\n" and version == 1
assert zlib.crc32(table[:32]) == preamble_crc
assert zlib.crc32(table[36:36 + length]) == metadata_crc
start = -(-(36 + length) // 64) * 64
assert not any(table[36 + length:start])
assert len(table) == start + numbers_length and zlib.crc32(table[start:]) == numbers_crc
numbers = struct.unpack(f"<{numbers_length // 8}d", table[start:])
assert all(map(math.isfinite, numbers))

metadata = Metadata(table[36:36 + length])
conventions = metadata.text()
name, tolerance = metadata.text(), metadata.number()
nodes = [f"{metadata.integer()}x{metadata.integer()}" for chart in ("critical", "weak", "trapped", "radial")]
error, angles = metadata.number(), metadata.integer()
assert metadata.at == length and conventions.startswith("d2u/dphi2 = 3/2 u^2 - u")
print(name, f"{tolerance:e}", f"{error:.2e}", angles, *nodes, len(numbers))
