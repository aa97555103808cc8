#include <sys/stat.h>

#include "core/random.h"
#include "hostile_support.h"

// Recordings that are wrong, odd or meant to harm.

namespace runcert::chain::RUNCERT_FILE {
namespace {

/// What a file holds, unfolded only when it is written: the memory of this program counts in that
/// of those it starts.
struct Content {
    Content(std::string whole) : head(std::move(whole)) {}
    Content(const char* whole) : head(whole) {}
    Content(std::string begin, std::string again, std::size_t count)
        : head(std::move(begin)), repeated(std::move(again)), times(count) {}

    void write(const fs::path& file) const {
        std::ofstream out(file, std::ios::binary);
        out << head;
        for (std::size_t i = 0; i < times; ++i)
            out << repeated;
    }

    std::string head, repeated;
    std::size_t times = 0;
};

/// The recording's bytes.
HostileCase recording(const std::string& name, const Content& bytes,
                      std::vector<std::string> said) {
    return {.name = name,
            .prepare = [bytes](const fs::path& folder) { bytes.write(folder / "recording.pos"); },
            .said = std::move(said)};
}

/// The same, of a format that the attempt names.
HostileCase named(const std::string& name, const std::string& format, const Content& bytes,
                  std::vector<std::string> said) {
    return {.name = name,
            .prepare =
                [format, bytes](const fs::path& folder) {
                    bytes.write(folder / "recording.pos");
                    write_plainly(folder / "attempt.yaml",
                                  replaced(good_attempt, "recording.pos}",
                                           "recording.pos, format: " + format + "}"));
                },
            .said = std::move(said)};
}

/// A recording of 21 lines, one of which is replaced: too few are bad for the whole to be refused,
/// so the damage is done to all rows.
HostileCase all_rows(const std::string& name, const std::string& what, const std::string& by,
                     std::vector<std::string> said) {
    std::string text = good_recording();
    for (std::size_t at = text.find('\n'); (at = text.find(what, at)) != std::string::npos;
         at += by.size())
        text.replace(at, what.size(), by);
    return recording(name, text, std::move(said));
}

/// What lies where the recording should.
HostileCase in_place(const std::string& name, std::function<void(const fs::path& file)> make,
                     std::vector<std::string> said) {
    return {.name = name,
            .prepare =
                [make](const fs::path& folder) {
                    fs::remove(folder / "recording.pos");
                    make(folder / "recording.pos");
                },
            .said = std::move(said)};
}

/// The attempt names this as its recording.
HostileCase path_of(const std::string& name, const std::string& path,
                    std::vector<std::string> said) {
    return {.name = name,
            .prepare =
                [path](const fs::path& folder) {
                    write_plainly(folder / "attempt.yaml",
                                  replaced(good_attempt, "recording.pos", path));
                },
            .said = std::move(said)};
}

std::string random_bytes(std::size_t count) {
    RandomGenerator random(17);
    std::string bytes;
    for (std::size_t i = 0; i < count; ++i)
        bytes += static_cast<char>(random.next() % 256);
    return bytes;
}

std::string listed(std::size_t count) {
    std::string list = "[";
    for (std::size_t i = 0; i < count; ++i)
        list += fmt::format("r{}.pos, ", i);
    return list + "r0.pos]";
}

const std::string laughs =
    "<?xml version=\"1.0\"?>\n<!DOCTYPE gpx [<!ENTITY a \"haha\">"
    "<!ENTITY b \"&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;\"><!ENTITY c \"&b;&b;&b;&b;&b;&b;&b;&b;&b;&b;\">"
    "<!ENTITY d \"&c;&c;&c;&c;&c;&c;&c;&c;&c;&c;\"><!ENTITY e "
    "\"&d;&d;&d;&d;&d;&d;&d;&d;&d;&d;\">]>\n"
    "<gpx version=\"1.1\"><trk><trkseg><trkpt lat=\"1\" lon=\"2\"><time>&e;</time></trkpt>"
    "</trkseg></trk></gpx>\n";

std::vector<HostileCase> contents() {
    return {
        recording("empty", "", {"recording.pos", "empty"}),
        recording("header alone", good_recording().substr(0, good_recording().find('\n') + 1),
                  {"recording.pos", "epochs"}),
        recording("random bytes", random_bytes(100'000), {"recording.pos:"}),
        recording("a zip", "PK\x03\x04" + random_bytes(1000), {"recording.pos:", "ZIP"}),
        recording("a gzip", "\x1f\x8b\x08" + random_bytes(1000), {"recording.pos:", "gzip"}),
        recording("UTF-16, cut", utf16(good_recording()) + "%", {"recording.pos:", "UTF-16"}),
        recording("half a surrogate pair", utf16(good_recording()) + "\x3d\xd8",
                  {"recording.pos:", "surrogate"}),
        recording("a program",
                  "\x7f"
                  "ELF" +
                      random_bytes(1000),
                  {"recording.pos:"}),
        recording("a web page", "<html><body>not found</body></html>\n",
                  {"recording.pos:1", "web page"}),
        recording("carriage returns alone", good_recording("\r"), {"recording.pos:"}),
        recording("10 million empty lines", Content("", "\n", 10'000'000), {"recording.pos:"}),
        named("10 million empty lines, said to be a .pos", "rtklib-pos",
              Content("", "\n", 10'000'000), {"recording.pos:", "header"}),
        named("10 million empty lines, said to be NMEA", "nmea", Content("", "\n", 10'000'000),
              {"recording.pos:"}),
        recording(
            "10 million empty lines after the header",
            Content(good_recording().substr(0, good_recording().find('\n') + 1), "\n", 10'000'000),
            {"recording.pos:", "epochs"}),
        in_place("1 GiB of one line",
                 [](const fs::path& file) { write_plainly(file, std::string(1 << 20, 'a'), 1024); },
                 {"recording.pos:1"}),
        in_place("1 GiB of NUL",
                 [](const fs::path& file) {
                     write_plainly(file, "");
                     fs::resize_file(file, std::uintmax_t{1} << 30);
                 },
                 {"recording.pos:1:1", "NUL"}),
        in_place("1 GiB of NUL after a good beginning",
                 [](const fs::path& file) {
                     write_plainly(file, good_recording());
                     fs::resize_file(file, std::uintmax_t{1} << 30);
                 },
                 {"recording.pos:22", "NUL"}),
        all_rows("1e400", "10.000 1", "1e400 1", {"recording.pos:2:", "1e400"}),
        all_rows("0x10", "10.000 1", "0x10 1", {"recording.pos:2:", "0x10"}),
        all_rows("1,5", "10.000 1", "1,5 1", {"recording.pos:2:", "1,5"}),
        all_rows("nan", "10.000 1", "nan 1", {"recording.pos:2:", "nan"}),
        all_rows("-inf", "10.000 1", "-inf 1", {"recording.pos:2:", "-inf"}),
        all_rows("a figure left out", "  10.000 1", " 1", {"recording.pos:2:", "fields"}),
        all_rows("negative deviations", " 0.01 0.01", " -0.01 -0.01",
                 {"recording.pos:2:", "-0.01"}),
        all_rows("month 13", "2022/03/", "2022/13/", {"recording.pos:2:", "13"}),
        all_rows("second 61", "08:51:", "08:51:61;", {"recording.pos:2:"}),
        all_rows("latitude 91", " 35.1", " 91.1", {"recording.pos:2:", "91.1"}),
        all_rows("year 9999", "2022/03/18", "9999/03/18", {"recording.pos:2:", "9999"}),
        named("32 MiB of beginnings of frames, OAO", "oao", Content("", "\xd0\x0a", 16 << 20),
              {"recording.pos:byte 0", "checksum"}),
        named("32 MiB of beginnings of frames, UBX", "ubx",
              Content("", "\xb5\x62\x01\x07\xff\xff", 5 << 20), {"recording.pos:byte 0"}),
        named("32 MiB of beginnings of frames, SBN", "sbn",
              Content("", std::string("\xa0\xa2\x03\xff", 4), 8 << 20), {"recording.pos:byte 0"}),
        named("32 MiB of beginnings of sentences", "nmea", Content("", "$\n", 16 << 20),
              {"recording.pos:"}),
        named("32 MiB of beginnings of elements", "gpx", Content("<gpx>", "<trkpt ", 5 << 20),
              {"recording.pos"}),
        recording("billion laughs", laughs, {"recording.pos"}),
        recording("a GPX of 100 000 levels",
                  [] {
                      std::string text = "<gpx>";
                      for (int i = 0; i < 100'000; ++i)
                          text += "<trk>";
                      return text;
                  }(),
                  {"recording.pos"}),
        recording("IGC without a date", "AXXX001\nB1200004530123N00915765EA0012000125\n",
                  {"recording.pos", "date"}),
        recording(
            "RINEX without base and navigation",
            "     3.03           OBSERVATION DATA    M                   RINEX VERSION / TYPE\n",
            {"base"}),
    };
}

std::vector<HostileCase> other_formats() {
    std::vector<HostileCase> all;
    for (const char* format : {"nmea", "ubx", "vbo", "flysight", "oao", "sbp", "sbn", "gpx", "igc",
                               "csv", "rinex", "novatel", "septentrio", "fit", "racechrono",
                               "racebox", "trackaddict", "columbus", "aim"})
        all.push_back(named(
            fmt::format("a .pos said to be {}", format), format, good_recording(),
            {std::string(format) == "csv" || std::string(format) == "rinex" ? "attempt.yaml:5:"
                                                                            : "recording.pos:"}));
    all.push_back(named("NMEA said to be .pos", "rtklib-pos",
                        "$GPGGA,120000,4530.1,N,00915.7,E,1,5,1.1,12.0,M,40.0,M,,\n",
                        {"recording.pos:1"}));
    all.push_back(named("a format that is not known", "garmin", good_recording(),
                        {"attempt.yaml:5:", "garmin"}));
    return all;
}

std::vector<HostileCase> places() {
    return {
        in_place("a folder", [](const fs::path& file) { fs::create_directory(file); },
                 {"recording.pos", "folder"}),
        in_place("a pipe", [](const fs::path& file) { mkfifo(file.c_str(), 0600); },
                 {"recording.pos", "pipe"}),
        in_place("a link to a device",
                 [](const fs::path& file) { fs::create_symlink("/dev/zero", file); },
                 {"attempt.yaml:5:", "symbolic link"}),
        in_place("a link to a file outside",
                 [](const fs::path& file) { fs::create_symlink("/etc/passwd", file); },
                 {"attempt.yaml:5:", "symbolic link"}),
        in_place("a link to itself",
                 [](const fs::path& file) { fs::create_symlink("recording.pos", file); },
                 {"recording.pos"}),
        in_place("a link to nothing",
                 [](const fs::path& file) { fs::create_symlink("absent.pos", file); },
                 {"attempt.yaml:5:", "does not exist"}),
        in_place("nothing", [](const fs::path&) {}, {"attempt.yaml:5:", "does not exist"}),
        path_of("a path that climbs out", "../../../../../../etc/passwd",
                {"attempt.yaml:5:", "outside"}),
        path_of("an absolute path", "/etc/passwd", {"attempt.yaml:5:", "outside"}),
        path_of("a path through a file", "attempt.yaml/recording.pos", {"attempt.yaml"}),
        path_of("the folder itself", "\".\"", {"folder"}),
        path_of("an empty path", "\"\"", {"attempt.yaml:5:"}),
        path_of("a path with a NUL", "\"recording.pos\\0.txt\"", {"attempt.yaml:5:"}),
        path_of("a path of 10 000 letters", std::string(10'000, 'p'), {"ppp"}),
        path_of("no file in a list", "[]", {"attempt.yaml:5:"}),
        path_of("a recording twice", "[recording.pos, recording.pos]", {"recording.pos", "twice"}),
        {.name = "200 files",
         .prepare =
             [](const fs::path& folder) {
                 for (int i = 0; i < 200; ++i)
                     write_plainly(folder / fmt::format("r{}.pos", i), good_recording());
                 write_plainly(folder / "attempt.yaml",
                               replaced(good_attempt, "recording.pos", listed(199)));
             },
         .said = {"files"}},
    };
}

TEST(Hostile, Recordings) {
    for (const HostileCase& one : contents())
        expect_hostile_refused(one);
}

TEST(Hostile, RecordingsOfOtherFormats) {
    for (const HostileCase& one : other_formats())
        expect_hostile_refused(one);
}

TEST(Hostile, RecordingsInOddPlaces) {
    for (const HostileCase& one : places())
        expect_hostile_refused(one);
}

TEST(Hostile, ARecordingThatMayNotBeRead) {
    if (geteuid() == 0) GTEST_SKIP() << "permissions do not bind the superuser";
    expect_hostile_refused(in_place("unreadable",
                                    [](const fs::path& file) {
                                        write_plainly(file, good_recording());
                                        fs::permissions(file, fs::perms::none);
                                    },
                                    {"recording.pos", "cannot open"}));
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
