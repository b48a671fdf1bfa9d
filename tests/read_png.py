"""A reader for the pictures of `projdyn render`."""
import struct
import zlib

PREDICT = [lambda a, b, c: 0, lambda a, b, c: a, lambda a, b, c: b, lambda a, b, c: (a + b) // 2,
           lambda a, b, c: min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]]


def read_png(path):
    """Pixels of a PNG with 8 bits a channel: a list of (red, green, blue)."""
    data = path.read_bytes()
    at, packed = 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        if kind == b"IHDR":
            width, height, depth, colour = struct.unpack(">IIBB", data[at + 8:at + 18])
        if kind == b"IDAT":
            packed += data[at + 8:at + 8 + size]
        at += 12 + size
    assert depth == 8 and colour in (2, 6), f"{path}: unexpected kind of PNG"
    channels = 3 if colour == 2 else 4
    stride = width * channels
    raw, row, pixels = zlib.decompress(packed), bytearray(stride), []
    for y in range(height):
        line = raw[y * (stride + 1):(y + 1) * (stride + 1)]
        above, row, guess = row, bytearray(line[1:]), PREDICT[line[0]]
        for i in range(stride):
            left, corner = (row[i - channels], above[i - channels]) if i >= channels else (0, 0)
            row[i] = (row[i] + guess(left, above[i], corner)) & 255
        pixels += [tuple(row[i:i + 3]) for i in range(0, stride, channels)]
    return pixels
