"""Prints the positions of a FIT file's record messages: seconds since 1989-12-31 UTC, semicircles.

Written from the protocol alone, apart from the program's reader: python3 fit_positions.py FILE
"""
import struct
import sys

data = open(sys.argv[1], "rb").read()
begin = 0
while begin < len(data):
    at = begin + data[begin]
    end = at + struct.unpack_from("<I", data, begin + 4)[0]
    layouts, clock = {}, None
    while at < end:
        head = data[at]
        at += 1
        if head & 0xC0 == 0x40:
            order = "<>"[data[at + 1]]
            number, count = struct.unpack_from(order + "HB", data, at + 2)
            at += 5
            fields = [data[at + 3 * i:at + 3 * i + 2] for i in range(count)]
            at += 3 * count
            if head & 0x20:
                extra = data[at]
                fields += [bytes([255, data[at + 2 + 3 * i]]) for i in range(extra)]
                at += 1 + 3 * extra
            layouts[head & 15] = (order, number, fields)
            continue
        order, number, fields = layouts[(head >> 5) & 3 if head & 0x80 else head & 15]
        values = {}
        for name, size in fields:
            values.setdefault(name, data[at:at + size])
            at += size
        stamp = None
        if len(values.get(253, b"")) == 4:
            stamp = struct.unpack(order + "I", values[253])[0]
        elif head & 0x80 and clock is not None:
            stamp = (clock & ~31) + (head & 31)
            if stamp < clock:
                stamp += 32
        if stamp is not None:
            clock = stamp
        if number == 20 and 0 in values and 1 in values:
            place = [struct.unpack(order + "i", values[i])[0] for i in (0, 1)]
            if 0x7FFFFFFF not in place:
                print(stamp, *place)
    begin = end + 2
