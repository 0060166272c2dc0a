"""Reads a frame's .exr or .npz file with OpenEXR's and NumPy's own readers.

For each text it prints `NAME: TEXT`, for each channel of 32-bit floats `NAME TYPE HEIGHTxWIDTH CRC`, the CRC-32 of its
values as little-endian 32-bit floats. The channels of an array with three numbers a pixel are NAME.0, NAME.1, NAME.2.
"""

import sys
import zlib

import numpy


def show(name, values):
    if values.ndim == 3:
        for channel in range(values.shape[2]):
            show(f"{name}.{channel}", values[..., channel])
        return
    checksum = zlib.crc32(numpy.ascontiguousarray(values.astype("<f4")).tobytes())
    print(name, values.dtype, "x".join(map(str, values.shape)), f"{checksum:08x}")


path = sys.argv[1]
if path.endswith(".npz"):
    with numpy.load(path) as arrays:
        for name, values in arrays.items():
            if values.ndim == 0:
                for line in str(values).splitlines():
                    print(line.replace("=", ": ", 1))
            else:
                show(name, values)
else:
    import OpenEXR

    with OpenEXR.File(path, separate_channels=True) as file:
        assert len(file.parts) == 1
        for name, value in file.header().items():
            if isinstance(value, str):
                print(f"{name}: {value}")
        for name, channel in file.channels().items():
            show(name, channel.pixels)
