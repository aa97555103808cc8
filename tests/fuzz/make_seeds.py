#!/usr/bin/env python3
"""Writes invented recordings and documents of every kind, to begin fuzzing with: make_seeds.py FOLDER.

Each target gets a folder of its name. Nothing here was recorded by anyone.
"""
import datetime
import pathlib
import struct
import sys

FOLDER = pathlib.Path(sys.argv[1])
TESTS = pathlib.Path(__file__).resolve().parent.parent


def save(target, name, content):
    folder = FOLDER / target
    folder.mkdir(parents=True, exist_ok=True)
    data = content if isinstance(content, bytes) else content.encode("latin-1")
    (folder / name).write_bytes(data)
    if target in FORMATS:
        (FOLDER / "auto").mkdir(parents=True, exist_ok=True)
        (FOLDER / "auto" / f"{target}-{name}").write_bytes(data)


FORMATS = ["rtklib-pos", "nmea", "ubx", "vbo", "flysight", "oao", "sbp", "sbn", "gpx", "igc", "novatel", "septentrio", "fit",
           "racechrono", "racebox", "trackaddict", "columbus", "aim"]


def rtklib_pos():
    for file in sorted((TESTS / "unit/data/import").glob("*.pos")):
        save("rtklib-pos", file.stem, file.read_bytes())


def sentence(body):
    total = 0
    for c in body.encode("latin-1"):
        total ^= c
    return f"${body}*{total:02X}\r\n"


def nmea():
    text = ""
    for i in range(4):
        t = f"23595{7 + i}.20" if i < 3 else "000000.20"
        text += sentence(f"GNGGA,{t},4530.123456{i},N,00915.7654321,E,4,10,0.9,120.5,M,47.25,M,1.5,0001")
        text += sentence(f"GNRMC,{t},A,4530.123456{i},N,00915.7654321,E,10.00,90.0,{11 + i // 3}0723,,,A")
        text += sentence("GNVTG,90.0,T,,M,10.00,N,18.52,K,D")
        text += sentence(f"GNGST,{t},1.5,0.03,0.02,45.0,0.025,0.026,0.04")
        text += sentence("GNGSA,A,3,01,02,03,04,,,,,,,,,1.5,0.9,1.2,1")
        text += sentence(f"GNZDA,{t},{11 + i // 3},07,2023,00,00")
    save("nmea", "all", text)
    save("nmea", "gga", "".join(sentence(f"GPGGA,1200{i:02},4530.1,S,00915.7,W,1,5,1.1,12.0,M,,M,,") for i in range(5)))
    save("nmea", "no_checksum", "$GPGGA,120000,4530.1,N,00915.7,E,1,5,1.1,12.0,M,40.0,M,,\n" * 3)
    save("nmea", "without_fix", sentence("GPRMC,120000.00,V,,,,,,,110723,,,N") + sentence("GPGGA,120000.00,,,,,0,00,99.9,,M,,M,,"))


def ubx_frame(group, number, payload):
    body = struct.pack("<BBH", group, number, len(payload)) + payload
    a = b = 0
    for c in body:
        a = (a + c) & 255
        b = (b + a) & 255
    return b"\xb5\x62" + body + bytes([a, b])


def ubx():
    tow0 = ((2 * 24 + 6) * 60 + 4) * 60000 + 48000
    log = old = solutions = b""
    for i in range(4):
        tow = tow0 + 200 * i
        pvt = struct.pack("<IHBBBBBBIiBBBBiiiiIIiiiiiIIHHi", tow, 2023, 7, 11, 6, 4, 30, 0x37, 25,
                          200000000 * i - 400, 3, 1, 0, 14, 92500000, 455000000 + i, 167750, 120000,
                          1500, 2000, 3000, -4000, 500, 5000, 30688000, 300, 1000000, 120, 0, 0).ljust(92, b"\0")
        log += ubx_frame(1, 7, pvt)
        log += ubx_frame(1, 0x14, struct.pack("<BxxBIiiiibbbbII", 0, 0, tow, 92500001, 455000002, 167751, 120001, -37, 42, -9, 0, 141, 255))
        log += ubx_frame(1, 0x36, struct.pack("<IBBB9x12f", tow, 0, 1, 1, 4, 1, -.5, 9, 2, 16, .04, .01, -.005, .09, .02, .16))
        log += ubx_frame(1, 4, struct.pack("<IHHHHHHH", tow, 150, 120, 100, 90, 80, 70, 60))
        if i == 1:
            log += sentence("GNGGA,060430.20,0915.0,N,04530.0,E,1,14,0.9,120.0,M,47.0,M,,").encode()
            log += b"\xd3\x00\x02\x01\x02abc"
        log += ubx_frame(1, 0x61, struct.pack("<I", tow))
        place = ubx_frame(1, 2, struct.pack("<IiiiiII", tow, 92500000, 455000000 + i, 167750, 120000, 1500, 2000))
        solution = ubx_frame(1, 6, struct.pack("<IihBBiiiIiiiIHBBI", tow, -400, 2270, 3, 13, 444000000 + i, 71300000, 450700000,
                                               350, 300, -400, 50, 30, 120, 0, 9, 0))
        old += place + ubx_frame(1, 3, struct.pack("<IBBBBII", tow, 3, 13, 0, 0, 25000, 90000)) + solution
        old += ubx_frame(1, 0x12, struct.pack("<IiiiIIiII", tow, 300, -400, 50, 503, 500, 30688000, 30, 1000000))
        old += ubx_frame(1, 0x20, struct.pack("<IihbBI", tow, -400, 2270, 18, 7, 25))
        solutions += solution
    save("ubx", "all", log)
    save("ubx", "old", old)
    save("ubx", "solutions", solutions)
    save("ubx", "cut", log[7:-9])
    save("ubx", "damaged", log[:20] + b"?" + log[21:])


def vbo():
    head = ("File created on 31/07/2006 at 17:55:20\r\n\r\n[header]\r\nsatellites\r\ntime\r\nlatitude\r\nlongitude\r\n"
            "velocity kmh\r\nheading\r\nheight\r\nvertical velocity m/s\r\n\r\n[channel units]\r\n\r\n[comments]\r\n"
            "VBox II Version 4.5a\r\nSt\xe4be\r\n\r\n[column names]\r\nsats time lat long velocity heading height vert-vel\r\n\r\n[data]\r\n")
    rows = "".join(f"137 16223{5 + i // 10}.{i % 10}0 +03119.0{9973 - i * 11} +00058.49277 072.000 150.00 +00152.58 -001.250\r\n" for i in range(4))
    save("vbo", "full", head + rows)
    save("vbo", "local", head.replace("17:55", "02:10") + "8 71500.1 -3119.09 -58.4 10 20 30 1\n8 71500.2 -3119.08 -58.4 10 20 30 1\n")
    degrees = "".join(f"10000{i}.00 {52.1 + i * 1.8e-4:.6f} 5.100000 72.0 0.0 3.0 16 9\n" for i in range(30))
    save("vbo", "degrees", "[column names]\ntime lat lng speed course alt sats\n[data]\n" + degrees)
    save("vbo", "few", "[header]\ntime\nlatitude\nlongitude\n[column names]\ntime lat long\n[data]\n235959.9 +3100.0 -0050.0\n000000.1 +3100.0 -0050.1\n")


def flysight():
    one = ("time,lat,lon,hMSL,velN,velE,velD,hAcc,vAcc,sAcc,heading,cAcc,gpsFix,numSV\r\n"
           ",(deg),(deg),(m),(m/s),(m/s),(m/s),(m),(m),(m/s),(deg),(deg),,\r\n")
    two = ("$FLYS,1\r\n$VAR,FIRMWARE_VER,v2024.01.02\r\n$VAR,DEVICE_ID,00112233\r\n"
           "$COL,GNSS,time,lat,lon,hMSL,velN,velE,velD,hAcc,vAcc,sAcc,numSV\r\n"
           "$UNIT,GNSS,,deg,deg,m,m/s,m/s,m/s,m,m,m/s,\r\n$DATA\r\n")
    for i in range(4):
        one += f"2023-05-17T10:11:12.{i * 20:02}Z,37.5{i}0123,-121.4567890,7.309,3.00,-4.00,12.50,2.000,3.500,0.30,0.0,180.0,3,10\r\n"
        two += f"$GNSS,2023-05-17T10:11:12.{i * 200:03}Z,37.5{i}0123,-121.4567890,7.309,3.00,-4.00,12.50,2.000,3.500,0.30,10\r\n"
        if i == 2:
            two += "$IMU,12.5,0.1,0.2,0.3\r\n"
    save("flysight", "one", one)
    save("flysight", "two", two)


def novatel():
    def sealed(name, tow, fields):
        body = f"{name},COM1,0,85.0,FINESTEERING,2200,{tow:.3f},02000020,cdba,32768;{fields}"
        value = 0
        for c in body.encode():
            value ^= c
            for _ in range(8):
                value = value >> 1 ^ (0xEDB88320 if value & 1 else 0)
        return f"#{body}*{value:08x}\r\n"

    log = ins = ""
    for i in range(4):
        tow = 194670 + i / 5
        log += sealed("BESTPOSA", tow, f"SOL_COMPUTED,NARROW_INT,45.25{i}00000000,9.12500000000,120.0000,47.2500,WGS84,"
                      '0.0200,0.0100,0.0300,"AAAA",1.500,0.000,20,18,18,0,00,00,00,11')
        log += sealed("BESTVELA", tow, "SOL_COMPUTED,DOPPLER_VELOCITY,0.150,0.000,10.0000,90.000000,-0.5000,0.0")
        ins += sealed("INSPVAXA", tow, f"INS_SOLUTION_GOOD,INS_RTKFIXED,45.25{i},9.125,120.0,47.25,3.0,4.0,0.5,0.1,0.2,90.0,"
                      "0.02,0.01,0.03,0.006,0.005,0.007,0.1,0.1,0.2,0,1")
    save("novatel", "best", log)
    save("novatel", "inertial", ins)


def septentrio():
    geodetic = cartesian = ""
    for i in range(4):
        time = 1400000000 + i / 10
        geodetic += ("%-2i %13.2f %14.11f %15.11f %14.5f %14.5f %10.5f %10.5f %10.5f %15.8e %13.6e %3i %3i %3i %3i %10.3f\n"
                     % (-1, time, 0.78976 + i * 1e-7, 0.15926, 167.25, 47.25, 3.0, -4.0, 0.5, 1e-5, 1e-7, 14, 4, 150, 0, 306.87))
        geodetic += "%-2i %13.2f %14.3f %14.3f %14.3f %14.3f 0 0 0 0 0 0 0 0\n" % (-2, time, 0.1, 0.1, 0.1, 0.1)
        cartesian += ("%-2i %13.2f %14.3f %14.3f %14.3f %10.3f %10.3f %10.3f %15.8e %13.6e %3i %3i %3i %3i %10.3f\n"
                      % (0, time, 4440000.0 + i, 713000.0, 4507000.0, -3.0, 4.0, 0.5, -2e10, -2e10, 9, 1, 65535, 0, 90.0))
    save("septentrio", "geodetic", geodetic)
    save("septentrio", "cartesian", cartesian)


def fit():
    def crc(data):
        value = 0
        for c in data:
            value ^= c
            for _ in range(8):
                value = value >> 1 ^ (0xA001 if value & 1 else 0)
        return struct.pack("<H", value)

    def closed(records):
        return struct.pack("<BBHI4sH", 14, 16, 2134, len(records), b".FIT", 0) + records + crc(records)

    def layout(local, number, fields, head=0x40):
        return struct.pack("<BBBHB", head | local, 0, 0, number, len(fields)) + b"".join(bytes([n, s, 0]) for n, s in fields)

    start = 1020545188
    plain = layout(0, 0, [(0, 1), (1, 2), (2, 2)]) + struct.pack("<BBHH", 0, 4, 1, 1561)
    plain += layout(1, 20, [(253, 4), (0, 4), (1, 4), (2, 2), (6, 2)]) + layout(2, 20, [(0, 4), (1, 4)])
    camera = layout(0, 160, [(253, 4), (0, 2), (1, 4), (2, 4), (3, 4), (4, 4), (5, 2), (7, 6)])
    for i in range(4):
        plain += struct.pack("<BIiiHH", 1, start + 10 * i, 549060544 + i * 800, -1419059712, 3100, 10000)
        plain += struct.pack("<Bii", 0xC0 | (start + 10 * i + 3) & 31, 549060544 + i * 800 + 240, -1419059712)
        camera += struct.pack("<BIHiiIIHhhh", 0, start, 100 * i, 549060544 + i, -1419059712, 3100, 5000, 9000, 300, -400, 10)
    save("fit", "compressed", closed(plain))
    save("fit", "camera", closed(camera))
    save("fit", "chained", closed(plain) + closed(camera))
    save("fit", "open", struct.pack("<BBHI4sH", 14, 16, 2134, 0, b".FIT", 0) + plain[:-5])


def tables():
    chrono = ("This file is created using RaceChrono Pro v9.1.3 ( http://racechrono.com/ ).\nFormat,3\nNote,\n\n"
              "timestamp,lap_number,accuracy,altitude,bearing,latitude,longitude,satellites,speed,speed\n"
              "unix time,,m,m,deg,deg,deg,sats,m/s,m/s\n,,100: gps,100: gps,100: gps,100: gps,100: gps,100: gps,100: gps,calc\n")
    box = "Format,RaceBox CSV\nTrack,Test\n\nRecord,Time,Latitude,Longitude,Altitude (m),Speed (m/s),GForceX (g),Lap,Heading\n"
    addict = ("# RaceRender Data: TrackAddict 4.3.5 on Android 9\n# GPS: Android\n"
              '"Time","UTC Time","GPS_Update","Latitude","Longitude","Altitude (ft)","Speed (Km/h)","Heading","Accuracy (m)"\n')
    aim = ('"Format","AiM CSV File"\n"Session","Test"\n\n"Time","GPS Speed","GPS Nsat","GPS Altitude","GPS Latitude","GPS Longitude"\n'
           '"s","km/h","#","m","deg","deg"\n\n')
    for i in range(4):
        at = f"45.25{i}0123,9.1250000"
        chrono += f"176715079{i}.5,1,3.0,12{i}.0,90.{i},{at},12.0,1{i}.0,99\n"
        box += f"{i},2026-07-10T13:16:19.{i}00Z,{at},12{i}.0,1{i}.0,0.1,1,90.0\n"
        addict += f"{i}.000,172759762{i}.000,1,{at},39{i},3{i}.0,90.0,3.8\n{i}.500,172759762{i}.500,0,{at},39{i},3{i}.0,90.0,3.8\n"
        aim += f'"0.{i}","3{i}.0","9","120.0",{at}\n'
    save("racechrono", "three", chrono)
    save("racebox", "units", box)
    save("trackaddict", "four", addict + "# Session End\n")
    save("aim", "three", aim)
    columbus = "INDEX,TAG,DATE,TIME,LATITUDE N/S,LONGITUDE E/W,HEIGHT,SPEED,HEADING,VOX\r\n"
    for i in range(4):
        columbus += f"{i}\0\0\0\0\0,T,140613,10111{i},45.25{i}012N,009.125000E,12{i}\0\0,3{i}\0\0,90\0,\0\0\0\0\0\0\0\0\0\r\n"
    save("columbus", "padded", columbus)
    save("auto", "utf16", chrono.encode("utf-16"))


def oao():
    def sealed(frame, length):
        frame = bytearray(frame.ljust(length, b"\0"))
        a = b = 0
        for i, c in enumerate(frame):
            if i in (2, 3):
                continue
            a = (a + c) & 255
            b = (b + a) & 255
        frame[2:4] = bytes([a, b])
        return bytes(frame)

    log = sealed(struct.pack("<HHH10s", 0x0AD0, 0, 987, b"boom"), 512)
    for i in range(5):
        ms = 1634000000800 + 100 * i
        log += sealed(struct.pack("<HHiiiIIQBBIIIIH", 0x0AD4 if ms % 1000 == 0 else 0x0AD5, 0, -331122334,
                                  1512345678 + i, -1234, 17750, 15000000, ms, 3, 11, 85, 300, 400, 54699, 101), 52)
    save("oao", "log", log)
    save("oao", "damaged", log[:530] + b"?" + log[531:])
    save("oao", "without_header", log[512:])


def sbp():
    text = b"GT-31,30003117,1,V1.4"
    message = b"\xa0\xa2\x00" + bytes([len(text) + 1]) + b"\xfd" + text
    log = (struct.pack("<H", len(message) + 2) + message).ljust(64, b"\xff")
    for i in range(5):
        packed = ((21 * 12 + 5) << 5 | 17) << 17 | (0 << 12 | 39 << 6 | 56 + i // 2)
        log += struct.pack("<BBHIIiiiHHhBB", 5, 9, 56000 + i * 500, packed, 0x1ff, -451234567,
                           1701234567 + 1290 * i, 1420, 2000, 9000, -7, 31 if i != 2 else 255, 55)
    save("sbp", "log", log)
    save("sbp", "cut", log[:-5])


def sbn():
    def frame(payload):
        return b"\xa0\xa2" + struct.pack(">H", len(payload)) + payload + struct.pack(">H", sum(payload) & 0x7fff) + b"\xb0\xb3"

    log = frame(b"\xfdROD,30003117,1,V1.4(B1)")
    for i in range(4):
        tow = 3600000 + 1000 * i
        t = datetime.datetime(2012, 7, 15, 0, 59, 44) + datetime.timedelta(seconds=i)
        payload = struct.pack(">BHHHIHBBBBHIiiiiBHHhhhIIIHHIIIBBB", 41, 0, 4, 1697, tow, t.year, t.month, t.day, t.hour,
                              t.minute, t.second * 1000, 0x1ff, 543210000, -13579000 - 2300 * i, 6012, 1234, 21, 1500,
                              27000, 0, 12, 0, 280, 450, 0, 0, 0, 0, 0, 0, 9, 6, 0)
        payload = payload[:88].ljust(88, b"\0") + payload[-3:]
        log += frame(payload + struct.pack(">IBB", 0, 40, 70))
    save("sbn", "log", log)
    save("sbn", "damaged", log[:60] + b"?" + log[61:])


def gpx():
    one = '<?xml version="1.0"?>\n<gpx version="1.1" creator="a &amp; b" xmlns="http://www.topografix.com/GPX/1/1"><trk><name>run</name><trkseg>'
    for i in range(4):
        one += (f'<trkpt lat="54.32{i}" lon="-1.3579"><ele>12.5</ele><time>2023-07-11T06:04:30.{i}Z</time><fix>dgps</fix><sat>9</sat>'
                '<hdop>0.9</hdop><extensions><x:TrackPointExtension xmlns:x="u"><x:speed>10.5</x:speed><x:course>90</x:course>'
                '</x:TrackPointExtension></extensions></trkpt>')
    save("gpx", "one_one", one + "</trkseg></trk></gpx>")
    save("gpx", "one_zero", '<gpx version="1.0"><!-- c --><trk><trkseg><trkpt lat="1" lon="2"><ele>1</ele>'
         '<time>2023-07-11T06:04:30+02:00</time><course>1</course><speed>2</speed></trkpt><trkpt lat=\'1.0001\' lon="2">'
         '<time>2023-07-11T06:04:31Z</time><![CDATA[x]]></trkpt></trkseg></trk></gpx>')
    save("gpx", "entities", '<?xml version="1.0"?><!DOCTYPE gpx [<!ENTITY a "aaa"><!ENTITY b "&a;&a;">]><gpx><trk><trkseg>'
         '<trkpt lat="1" lon="2"><time>&b;</time></trkpt></trkseg></trk></gpx>')


def igc():
    text = "AXXX001 logger\r\nHFDTE110723\r\nHFFXA035\r\nHFDTMGPSDATUM:WGS84\r\nHFALGALTGPS:ELL\r\nI053638FXA3940SIU4143VXA4446GSP4749TRT\r\n"
    for i in range(4):
        text += f"B23595{6 + i}4530123N00915765EA0012000125" + f"0050901010{i}0090" + "\r\n"
    save("igc", "full", text + "LXXX comment\r\nGABCDEF0123456789\r\n")
    save("igc", "plain", "AXXX\nHFDTEDATE:110723,01\nB1200004530123S00915765WV0012000000\nB1200014530124S00915765WA0012000130\n")
    save("igc", "without_date", "AXXX\nB1200004530123S00915765WA0012000130\n")


def csv():
    save("csv", "geodetic", "gtime,lat,lon,h\n0.0,45.1,9.2,120.5\n0.1,45.10001,9.2,120.4\n0.2,45.10002,9.2,120.3\n")
    save("csv", "all", "adate;time;lat;lon;h;sigma_east;sigma_north;sigma_up;velocity_east;velocity_north;velocity_up;fix;satellites\n"
         + "".join(f"2023-07-11;23:59:59.{i};45.1;9.2;120.5;0.01;0.01;0.02;1.5;2.5;0.1;4;10\n" for i in range(3)))
    save("csv", "iso", "itime,lat,lon\n2023-07-11T06:04:30.5Z,45.1,9.2\n2023-07-11T06:04:31.0Z,45.2,9.2\n")
    save("csv", "unix", "xtime\tlat\tlon\th\tCQ2D\tCQ1D\n1689055470.25\t45.1\t9.2\t1\t0.02\t0.03\n1689055470.50\t45.1\t9.3\t1\t0.02\t0.03\n")
    save("csv", "ecef", "e2270,194688.0,4430000.0,715000.0,4510000.0\n2270,194688.1,4430001.0,715000.0,4510000.0\n")
    save("csv", "utm", "ut,e,n,u\n0,500000,6000000,10\n1,500010,6000000,10\n")
    save("csv", "plane", 'pt,e,n\n0,0,0\n0.1,1.5,"2.5"\n# comment\n0.2,3,5\n')


def shortened(text, rows=2, notes=True):
    """A table's header and its first rows, without descriptions."""
    lines = [line for line in text.splitlines() if not line.startswith("#     description:")]
    head = [line for line in lines if line.startswith("#")]
    return "\n".join(head + lines[len(head):len(head) + 1 + rows]) + "\n"


def golden():
    for folder in sorted((TESTS / "golden").glob("v1.*")):
        for table, name in (("1-observations", "observations"), ("3-screened", "screened"), ("4-trajectory", "trajectory")):
            file = folder / f"{table}.ecsv"
            if file.exists():
                save(name, folder.name, file.read_text().encode("utf-8"))
                save(name, folder.name + "-short", shortened(file.read_text()).encode("utf-8"))
        for name in ("attempt", "profile", "simulation", "5-windows", "6-verdict"):
            file = folder / f"{name}.yaml"
            if file.exists():
                save("document", f"{folder.name}-{name}", file.read_bytes())


def documents():
    save("document", "attempt", "schema: attempt/1.0\nid: a\ncraft: {name: y, class: land-yacht}\nreceivers:\n"
         "  - {id: primary, recording: r.pos}\nprofiles: [nalsa]\n")
    save("document", "values", 'a: [1, -2.5e3, "text", true, null, ~]\nb:\n  - c: {d: e}\n  - "\\u00e9 \\n"\n# comment\nf: |\n  lines\n  more\n')


def signatures():
    # RFC 8032, section 7.1, test 1: the seed and the public key; ids and comments invented.
    import base64
    public = bytes.fromhex("d75a980182b10ab7d54bfed3c964073a0ee172f3daa62325af021a68f707511a")
    seed = bytes.fromhex("9d61b19deffd5a60ba844af492ec2cc44449c5697b326919703bac031cae7f60")
    b64 = lambda data: base64.b64encode(data).decode()
    save("signature", "public", f"untrusted comment: minisign public key\n{b64(b'Ed' + bytes(8) + public)}\n")
    save("signature", "public_line", b64(b"Ed" + bytes(8) + public))
    save("signature", "signature", f"untrusted comment: signature\n{b64(b'ED' + bytes(8) + bytes(64))}\ntrusted comment: role\n{b64(bytes(64))}\n")
    save("signature", "legacy", f"untrusted comment: signature\r\n{b64(b'Ed' + bytes(8) + bytes(64))}\r\ntrusted comment: t\r\n{b64(bytes(64))}\r\n")
    import hashlib
    checksum = hashlib.blake2b(b"Ed" + bytes(8) + seed + public, digest_size=32).digest()
    for name, kdf in (("plain", bytes(2)), ("encrypted", b"Sc")):
        save("signature", f"secret_{name}", "untrusted comment: minisign secret key\n"
             + b64(b"Ed" + kdf + b"B2" + bytes(48) + bytes(8) + seed + public + checksum) + "\n")


def flows():
    save("flow", "utc", "time,speed_kn,direction_deg\n2026-10-20T11:00:30Z,27.5,188\n2026-10-20T11:00:31.5Z,29.1,191\n")
    save("flow", "gps", "# anemometer\ntime_gps,direction_deg,speed_m_s\n2026-10-20T11:00:30.000,5,0\n\n2026-10-20T11:00:32.250,360,12.25\n")
    save("flow", "seconds", "time_s,speed_km_h,direction_deg\r\n-1.5,36,0\r\n0,40,10\r\n2.5,1e1,359.9\r\n")


def edits():
    # What `edit` of run_fuzz.cpp takes: file, kind, place (3 bytes), length, bytes.
    import struct
    def one(file, kind, at, piece=b"", length=None):
        return struct.pack(">BBBHB", file, kind, at >> 16, at & 0xffff, len(piece) if length is None else length) + piece
    for name in ("run", "report", "page"):
        save(name, "unchanged", b"")
        save(name, "overwrite", one(0, 0, 500, b"x") + one(4, 0, 5000, b"\0"))
        save(name, "insert", one(1, 1, 40, b"[[[") + one(5, 1, 900, b"- {a: b}\n"))
        save(name, "erase", one(2, 2, 1000, length=9))
        save(name, "cut", one(3, 3, 3000, length=0))
        save(name, "values", one(0, 4, 2000, b"-1e400") + one(6, 4, 300, b"null") + one(7, 4, 60000, b"\"\\u0000\""))
        save(name, "repeat", one(8, 5, 100, length=200))


def tars():
    import io, subprocess, tarfile
    def tar(entries, format=tarfile.USTAR_FORMAT):
        out = io.BytesIO()
        with tarfile.open(fileobj=out, mode="w", format=format) as file:
            for name, text, kind in entries:
                info = tarfile.TarInfo(name)
                info.size, info.type, info.linkname = len(text) if kind == tarfile.REGTYPE else 0, kind, "report.json"
                file.addfile(info, io.BytesIO(text) if kind == tarfile.REGTYPE else None)
        return out.getvalue()
    plain = [("run/report.json", b"{}\n", tarfile.REGTYPE), ("run/keys/0.pub", b"key", tarfile.REGTYPE)]
    save("bundle", "plain", tar(plain))
    save("bundle", "packed", subprocess.run(["zstd", "-q", "-c"], input=tar(plain), stdout=subprocess.PIPE, check=True).stdout)
    for name, entry in (("link", tarfile.SYMTYPE), ("hard", tarfile.LNKTYPE), ("pipe", tarfile.FIFOTYPE), ("folder", tarfile.DIRTYPE)):
        save("bundle", name, tar(plain + [("run/x", b"", entry)]))
    save("bundle", "outside", tar([("../x", b"x", tarfile.REGTYPE)]))
    save("bundle", "pax", tar([("run/" + "a" * 150, b"x", tarfile.REGTYPE)], tarfile.PAX_FORMAT))
    save("bundle", "gnu", tar([("run/" + "a" * 150, b"x", tarfile.REGTYPE)], tarfile.GNU_FORMAT))
    save("bundle", "sums", tar([("SHA256SUMS", b"0" * 64 + b"  a\n", tarfile.REGTYPE), ("a", b"a", tarfile.REGTYPE)]))


def stamps():
    dump = "".join(f"    {row * 16:04x} - " + "e7 c2 55 19 80 01 aa d9-cf 2b 48 11 22 33 44 55   ..U.....+H.\"3DU\n" for row in range(4))
    text = (f"Version: 1\nPolicy OID: 1.2.3.4.1\nHash Algorithm: sha512\nMessage data:\n{dump}Serial number: 0x04\n"
            "Time stamp: Nov 21 20:59:25 2026 GMT\nAccuracy: unspecified\nOrdering: no\nNonce: 0x9A0E\nTSA: unspecified\nExtensions:\n")
    save("time_stamp", "token", text)
    save("time_stamp", "fraction", text.replace("25 2026", "25.123 2026").replace("Nov 21", "Nov  1"))
    save("time_stamp", "error", "40B7A:error:1780067:time stamp routines:ts_check_imprints:message imprint mismatch:../crypto/ts/ts_rsp_verify.c:661:a: b\n")
    save("time_stamp", "seal", "Digital Signature Info of: report.pdf\nSignature #1:\n  - Signature Field Name: runcert\n"
         "  - Signer Certificate Common Name: A\n  - Signer full Distinguished Name: CN=A\n  - Signing Time: Jan 01 2026 00:00:00\n"
         "  - Signing Hash Algorithm: SHA-256\n  - Signature Type: ETSI.CAdES.detached\n  - Signed Ranges: [0 - 100], [200 - 1000]\n"
         "  - Total document signed\n  - Signature Validation: Signature is Valid.\n")


def rosters():
    import base64, struct
    wire = lambda *parts: b"".join(struct.pack(">I", len(part)) + part for part in parts)
    public = bytes.fromhex("d75a980182b10ab7d54bfed3c964073a0ee172f3daa62325af021a68f707511a")
    key = "ssh-ed25519 " + base64.b64encode(wire(b"ssh-ed25519", public)).decode()
    save("roster", "plain", f"measurer {key} A. Person\n")
    save("roster", "options", f'# two\nmeasurer,!judge,obs*r?er namespaces="*@runcert,file",valid-after="20260101Z",valid-before="202801010000" {key} w\n\n"a b" {key}\n')
    save("roster", "authority", f"judge cert-authority {key}\n")


def label(text, name):
    return text.ljust(60) + name + "\n"


def rinex():
    """Observations of satellites of examples/phase/broadcast.nav, and pieces of that file."""
    head = (label("     3.03           OBSERVATION DATA    M: Mixed", "RINEX VERSION / TYPE")
            + label(" -3911427.5048  3777221.6349 -3322793.5814", "APPROX POSITION XYZ")
            + label("G    8 C1C L1C D1C S1C C2W L2W D2W S2W", "SYS / # / OBS TYPES")
            + label("E    4 C1C L1C D1C S1C", "SYS / # / OBS TYPES")
            + label("  2026    03    14    03    20   18.0000000     GPS", "TIME OF FIRST OBS")
            + label("", "END OF HEADER"))
    ranges = {"G01": 21795111.526, "G08": 22844969.343, "G12": 21970672.67, "G20": 23714693.525, "G22": 20376064.881,
              "E05": 25942848.763, "E06": 25207379.04, "E09": 25450672.33}
    body = ""
    for epoch in range(6):
        body += f"> 2026 03 14 03 20 {18 + epoch:2}.0000000  0  8\n"
        for satellite, metres in ranges.items():
            cycles = metres / 0.19029367
            line = f"{satellite}{metres:14.3f} 7{cycles + (5 if epoch == 3 and satellite == 'G12' else 0):14.3f}{'1' if epoch == 4 else ' '}7{-527.25:14.3f}  {45.5:14.3f}  "
            if satellite[0] == "G":
                line += f"{metres + 2:14.3f} 6{cycles * 1227.6 / 1575.42:14.3f} 6{-410.8:14.3f}  {40.0:14.3f}  "
            body += line.rstrip() + "\n"
    save("rinex_observation", "three", head + body)
    save("rinex_observation", "events", head + body + ">                              4  1\n" + label("E    3 C1X L1X D1X", "SYS / # / OBS TYPES")
         + "> 2026 03 14 03 21 18.0000000  5  1\nanything\n" + body.replace("03 20", "03 22"))
    two = (label("     2.11           OBSERVATION DATA    G (GPS)", "RINEX VERSION / TYPE") + label("     2     1", "WAVELENGTH FACT L1/2")
           + label("     6    C1    P2    L1    L2    S1    D1", "# / TYPES OF OBSERV")
           + label("  2026     3    14     3    20   18.0000000     GPS", "TIME OF FIRST OBS") + label("", "END OF HEADER"))
    for epoch in range(3):
        two += f" 26  3 14  3 20 {18 + epoch:2}.0000000  0  5G01G08G12G20G22\n"
        for satellite, metres in list(ranges.items())[:5]:
            two += f"{metres:14.3f} 8{metres + 2:14.3f} 7{metres / .19029367:14.3f}28{metres / .24421021:14.3f} 7{51:14.3f} 8\n{-527.25:14.3f}\n"
    save("rinex_observation", "two", two)
    broadcast = (TESTS.parent / "examples/phase/broadcast.nav").read_text().splitlines(keepends=True)
    save("rinex_navigation", "three", "".join(broadcast[:12 + 8] + broadcast[4 + 24 * 8:4 + 25 * 8]))
    old = label("     2.10           N: GPS NAV DATA", "RINEX VERSION / TYPE") + label("", "END OF HEADER")
    record = [line.rstrip("\n") for line in broadcast[4:12]]
    old += " 1 26  3 14  4  0  0.0" + record[0][23:] + "\n" + "".join(line[1:] + "\n" for line in record[1:])
    save("rinex_navigation", "two", old)


def crc24q(data):
    value = 0
    for c in data:
        value ^= c << 16
        for _ in range(8):
            value = (value << 1) ^ (0x1864CFB if value & 0x800000 else 0)
    return value & 0xFFFFFF


def raw():
    def measurement(range_m, system, number, signal, lock, state):
        return struct.pack("<ddfBBBBHBBBBBB", range_m, range_m / .19029367, -527.25, system, number, signal, 0, lock, 45, 4, 1, 6, state, 0)

    log = b""
    for i in range(4):
        rows = [measurement(2.2e7 + 1e5 * n + 30 * i, 0, n, 0, 64500 if n != 3 or i < 2 else 10, 7) for n in range(1, 8)]
        rows += [measurement(2.5e7, 2, 11, 8, 300 + 250 * i, 3), measurement(2.1e7, 6, 2, 0, 64500, 7), measurement(2.1e7, 2, 11, 30, 1, 7)]
        log += ubx_frame(2, 0x15, struct.pack("<dHbBBBxx", 530418.25 + .25 * i, 2409, 18, len(rows), 1, 1) + b"".join(rows))
    save("rawx", "all", log)
    save("rawx", "cut", log[:-40])
    words = [0x8b << 22, 1 << 8] + [0x155555 << 6] * 8
    messages = b""
    for subframe in (1, 2, 3):
        words[1] = subframe << 8
        messages += struct.pack("<BBBBBBBB10I", 0, 7, 0, 0, 10, 1, 2, 0, *words)
    for kind in (1, 2, 3, 4, 5):
        data = (kind << 122) | (77 << 112) | (0x1234567 << 30)
        even, odd = data >> 16, data & 0xFFFF
        first = even << 6
        checked = (even << 82) | (1 << 81) | (odd << 64)
        crc = crc24q(checked.to_bytes(25, "big"))
        second = (1 << 127) | (odd << 110) | (crc << 22)
        both = first.to_bytes(15, "big") + b"\0" + second.to_bytes(16, "big")
        messages += struct.pack("<BBBBBBBB", 2, 11, 1, 0, 8, 1, 2, 0) + b"".join(
            struct.pack("<I", int.from_bytes(both[4 * i:4 * i + 4], "big")) for i in range(8)) + b"\0" * 8
    save("sfrbx", "all", messages)


def imus():
    def sealed(body):
        value = 0
        for c in body.encode():
            value ^= c
            for _ in range(8):
                value = value >> 1 ^ (0xEDB88320 if value & 1 else 0)
        return f"%{body}*{value:08x}\r\n"

    table = logger = kf_gins = rawimu = ""
    for i in range(40):
        shake = .001 * (i * 7 % 13)
        table += f"{100001 + .01 * i:.3f},{.01 + shake:.6f},-0.02,0.03,{.1 + shake:.6f},-0.2,-9.79\n"
        logger += f"0.12 {.027 + shake:.3f} 1.01 -0.67 {3 + shake:.3f} 0.2 {261906 + 10 * i + i % 2}\n"
        kf_gins += f"{100001 + .005 * i:.6f} 0.00005 -0.0001 {.00015 + shake / 1e4:.8f} 0.0005 -0.001 {-.04895 + shake / 1e3:.6f}\n"
        rawimu += sealed(f"RAWIMUSA,2400,{100001 + .01 * i:.3f};2400,{100001 + .01 * i:.9f},00000077,{63811 + i},-6290,6253,7,-31,14")
    save("imu", "table", table)
    save("imu", "table_named", "t,gx,gy,gz,ax,ay,az\n" + table)
    save("imu", "logger", logger)
    save("imu", "kf_gins", kf_gins)
    save("imu", "rawimu", rawimu)


def surfaces():
    corners = [(0, 0, 5), (10, 0, 5), (10, 10, 6), (0, 10, 6)]
    save("surface", "landxml", '<?xml version="1.0"?>\n<LandXML version="1.2"><Units><Metric linearUnit="meter"/></Units>'
         '<Surfaces><Surface name="a"><Definition surfType="TIN"><Pnts>'
         + "".join(f'<P id="{7 + i}">{y} {x} {z}</P>' for i, (x, y, z) in enumerate(corners))
         + '</Pnts><Faces><F>7 8 9</F><F>7 9 10</F><F i="1">8 9 10</F></Faces></Definition></Surface></Surfaces></LandXML>\n')
    vertices = "vertex,x,y,z\n" + "".join(f"{i + 1},{x},{y},{z}\n" for i, (x, y, z) in enumerate(corners))
    own = (TESTS / "golden/v1.0/1-surface.ecsv").read_text().split("vertex,4,")
    save("surface", "own", own[0] + "vertex,4,35.13480948300,136.97757427500,105.0000,,,,,,,\n" + own[1].split("\n", 1)[1])
    save("surface", "tables", vertices + "\nvertex_1,vertex_2,vertex_3\n1,2,3\n1,3,4\n")


for make in (rtklib_pos, nmea, ubx, vbo, flysight, oao, sbp, sbn, gpx, igc, novatel, septentrio, fit, tables, csv, golden, documents, signatures, flows, edits,
             tars, stamps, rosters, rinex, raw, imus, surfaces):
    make()
