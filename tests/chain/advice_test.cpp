#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>
#include <regex>

#include "chain_support.h"
#include "core/random.h"
#include "core/text.h"

// What the program advises, written word for word into the attempt, makes the next call succeed, or
// leads to the next true advice. Nobody who follows it is sent in a circle.

namespace runcert::chain::RUNCERT_FILE {
namespace {

using Keys = std::map<std::string, std::string>;

/// What somebody who knows his device puts where the advice has three dots or names a key alone.
const Keys known{{"horizontal_m", "1.5"},
                 {"vertical_m", "3"},
                 {"velocity_mps", "0.2"},
                 {"height_m", "107"},
                 {"time", "time"},
                 {"date", "date"},
                 {"latitude", "lat"},
                 {"longitude", "lon"},
                 {"east", "e"},
                 {"north", "n"},
                 {"columns", "{time: time, latitude: lat, longitude: lon}"},
                 {"frame", "geodetic"},
                 {"start_gps", "\"2026-03-14T01:00:00\""}};

/// "a: 1, b: 2" of a mapping in braces.
Keys fields_of(const std::string& mapping) {
    Keys fields;
    static const std::regex field(R"((\w+): (\.\.\.|[^,}]+))");
    for (std::sregex_iterator at(mapping.begin(), mapping.end(), field), end; at != end; ++at)
        fields[(*at)[1]] = (*at)[2] == "..." ? known.at((*at)[1]) : (*at)[2].str();
    return fields;
}

std::string mapping_of(const Keys& fields) {
    std::string text;
    for (const auto& [key, value] : fields)
        text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", key, value);
    return "{" + text + "}";
}

/// Two mappings in one; of what both hold, the second's.
std::string merged(const std::string& before, const std::string& more) {
    Keys fields = fields_of(more);
    fields.merge(fields_of(before));
    return mapping_of(fields);
}

/// What a text tells to write into the receiver.
Keys advised(const std::string& text) {
    Keys keys;
    const auto each = [&](const char* pattern, const auto& take) {
        const std::regex expression(pattern);
        for (std::sregex_iterator at(text.begin(), text.end(), expression), end; at != end; ++at)
            take(*at);
    };
    const auto as_written = [&](const std::smatch& found) { keys[found[1]] = found[2]; };
    const auto as_known = [&](const std::smatch& found) { keys[found[1]] = known.at(found[1]); };
    each(R"((accuracy): (\{[^}]*\}))",
         [&](const std::smatch& found) { keys[found[1]] = merged(keys[found[1]], found[2]); });
    each(R"([Ww]rite (columns): (\{[^.}]*: \.\.\.\}))",
         [&](const std::smatch& found) { keys[found[1]] = merged("", found[2]); });
    each(R"(name the column of the (\w+))", [&](const std::smatch& found) {
        keys["columns"] = "{" + found[1].str() + ": " + known.at(found[1]) + "}";
    });
    each(R"([Ww]rite (columns): \{time: \.\.\., latitude)", as_known);
    each(R"([Ww]rite (height_m|start_gps)\b)", as_known);
    each(R"((?:[Ww]rite |\()(time_scale|time_source|time_format|format): (\w+))", as_written);
    each(R"([Ww]rite (utc_offset_h): ([\d.]+))", as_written);
    each(R"([Ww]rite (speed_unit): ([\w/]+))", as_written);
    each(R"( and (frame): )", as_known);
    each(R"([Ww]rite (frame): (\{utm: \{[^}]*\}\}))", as_written);
    return keys;
}

/// A minute of somebody who speeds up to 15 m/s, at 5 Hz, by positions with a noise of half a
/// metre.
struct Ride {
    struct Epoch {
        double time_s, latitude_deg, longitude_deg, speed_m_s;
    };
    std::vector<Epoch> epochs;

    Ride() {
        RandomGenerator random(7);
        double along_m = 0.0;
        for (int k = 0; k < 300; ++k) {
            const double time_s = 0.2 * k;
            const double speed_m_s = 15.0 * (1.0 - std::exp(-time_s / 8.0));
            along_m += 0.2 * speed_m_s;
            const double metres_per_degree = 111'200.0;
            epochs.push_back({time_s, 45.0 + (along_m + 0.5 * random.normal()) / metres_per_degree,
                              9.0 + 0.5 * random.normal() / metres_per_degree / 0.7071,
                              std::max(0.0, speed_m_s + 0.1 * random.normal())});
        }
    }
};

std::string clock_text(double time_s) {
    return fmt::format("01:{:02d}:{:04.1f}", static_cast<int>(time_s) / 60,
                       std::fmod(time_s, 60.0));
}

std::string gpx(bool heights, bool speeds) {
    std::string text =
        "<?xml version=\"1.0\"?>\n<gpx version=\"1.0\" creator=\"logger\" "
        "xmlns=\"http://www.topografix.com/GPX/1/0\"><trk><trkseg>\n";
    for (const auto& [time_s, latitude, longitude, speed] : Ride().epochs)
        text += fmt::format(
            "<trkpt lat=\"{:.8f}\" lon=\"{:.8f}\">{}<time>2026-03-14T{}Z</time>{}</trkpt>\n",
            latitude, longitude, heights ? "<ele>107.0</ele>" : "", clock_text(time_s),
            speeds ? fmt::format("<speed>{:.2f}</speed>", speed) : std::string());
    return text + "</trkseg></trk></gpx>\n";
}

std::string plane_table() {
    std::string text = "time,e,n\n";
    for (const auto& [time_s, latitude, longitude, speed] : Ride().epochs)
        text += fmt::format("2026-03-14T{},{:.3f},{:.3f}\n", clock_text(time_s),
                            500'000.0 + 78'600.0 * (longitude - 9.0),
                            5'017'000.0 + 111'200.0 * (latitude - 45.0));
    return text;
}

std::string table_of_days() {
    std::string text = "date,time,lat,lon\n";
    for (const auto& [time_s, latitude, longitude, speed] : Ride().epochs)
        text +=
            fmt::format("2026-03-14,{},{:.8f},{:.8f}\n", clock_text(time_s), latitude, longitude);
    return text;
}

std::string table(const std::string& heading, const std::string& zone) {
    std::string text = heading;
    for (const auto& [time_s, latitude, longitude, speed] : Ride().epochs)
        text += fmt::format("2026-03-14T{}{},{:.8f},{:.8f}\n", clock_text(time_s), zone, latitude,
                            longitude);
    return text;
}

std::string degrees_minutes(double degrees) {
    const int whole = static_cast<int>(degrees);
    return fmt::format("{:02d}{:010.7f}", whole, 60.0 * (degrees - whole));
}

std::string nmea() {
    const auto sentence = [](const std::string& body) {
        int sum = 0;
        for (const char c : body)
            sum ^= c;
        return fmt::format("${}*{:02X}\r\n", body, sum);
    };
    std::string text;
    for (const auto& [time_s, latitude, longitude, speed] : Ride().epochs) {
        std::string time = clock_text(time_s);
        std::erase(time, ':');
        const std::string place =
            fmt::format("{},N,0{},E", degrees_minutes(latitude), degrees_minutes(longitude));
        text += sentence(fmt::format("GPGGA,{},{},1,10,0.9,107.0,M,47.0,M,,", time, place));
        text += sentence(
            fmt::format("GPRMC,{},A,{},{:.2f},0.0,140326,,,A", time, place, speed / 0.514444));
    }
    return text;
}

struct Given {
    const char* name;
    const char* file;  ///< of the real recordings, or of what is made
    std::function<std::string()> recording = {};
    Keys begun = {};  ///< what was written of it before
};

/// As RaceBox exports it, its speeds in km/h without saying so.
std::string racebox(const char* zone) {
    std::string text = "Record,Time,Latitude,Longitude,Altitude,Speed,GForceX,Lap\n";
    int record = 0;
    for (const auto& [time_s, latitude, longitude, speed] : Ride().epochs)
        text += fmt::format("{},2026-03-14T{}00{},{:.8f},{:.8f},107.0,{:.2f},0.1,1\n", ++record,
                            clock_text(time_s), zone, latitude, longitude, 3.6 * speed);
    return text;
}

const std::vector<Given>& all_given() {
    static const std::vector<Given> given{
        {"GpxWithoutHeights", "track.gpx", [] { return gpx(false, false); }},
        {"Gpx", "track.gpx", [] { return gpx(true, false); }},
        {"GpxWithSpeeds", "track.gpx", [] { return gpx(true, true); }},
        {"Nmea", "log.nmea", nmea},
        {"Table", "table.csv", [] { return table("time,lat,lon\n", ""); }},
        {"TableInUtc", "table.csv", [] { return table("time,lat,lon\n", "Z"); }},
        {"TableOfDays",
         "table.csv",
         table_of_days,
         {{"columns", "{time: time, latitude: lat, longitude: lon}"}, {"frame", "geodetic"}}},
        {"TableInLocalTime",
         "table.csv",
         [] { return table("time,lat,lon\n", ""); },
         {{"columns", "{time: time, latitude: lat, longitude: lon}"},
          {"frame", "geodetic"},
          {"time_format", "iso"},
          {"time_scale", "local"}}},
        {"TableWithAColumnNotNamed",
         "table.csv",
         [] { return table("time,lat,lon\n", ""); },
         {{"columns", "{time: time, longitude: lon}"}, {"frame", "geodetic"}}},
        {"RaceBox", "session.csv", [] { return racebox("Z"); }},
        {"RaceBoxInLocalTime", "session.csv", [] { return racebox(""); }},
        {"TableInUtm",
         "table.csv",
         plane_table,
         {{"columns", "{time: time, east: e, north: n}"}, {"frame", "utm"}}},
    };
    return given;
}

void PrintTo(const Given& given, std::ostream* out) {
    *out << given.name;
}

class Advice : public testing::TestWithParam<Given> {
  protected:
    void SetUp() override {
        const auto data = recordings();
        if (!GetParam().recording && !data) GTEST_SKIP() << "RUNCERT_DATA is not set";
        write_file_atomically(folder_.path() / file(), GetParam().recording
                                                           ? GetParam().recording()
                                                           : read_file(*data / GetParam().file));
    }

    /// Takes over what is advised; whether anything was new. Mappings are merged with what was
    /// already written.
    bool follow(const std::string& text) {
        bool is_new = false;
        // Wherever the lines of a terminal end.
        for (auto [key, value] : advised(std::regex_replace(text, std::regex("\\s+"), " "))) {
            if ((key == "accuracy" || key == "columns") && keys_.contains(key))
                value = merged(keys_.at(key), value);
            is_new = is_new || !keys_.contains(key) || keys_.at(key) != value;
            keys_[key] = value;
        }
        return is_new;
    }

    /// Takes over the lines that are proposed for a table; whether there are any.
    bool paste(const std::string& text) {
        bool any = false;
        for (const std::string& line : lines_of(text)) {
            constexpr std::string_view indent = "    ";
            const auto colon = line.find(": ");
            if (!line.starts_with(indent) || colon == std::string::npos ||
                line.find(' ', indent.size()) < colon)
                continue;
            const std::string key = line.substr(indent.size(), colon - indent.size());
            const std::string value = line.substr(colon + 2);
            // What a person knows.
            keys_[key] = value != "..."        ? value
                         : key == "height_m"   ? "0"
                         : key == "time_scale" ? "utc"
                                               : value;
            any = true;
        }
        return any;
    }

    ProcessResult certified() {
        std::string receiver;
        for (const auto& [key, value] : keys_)
            receiver += fmt::format("    {}: {}\n", key, value);
        write_file_atomically(
            folder_.path() / "attempt.yaml",
            fmt::format("schema: attempt/1.0\nid: ride\ncraft: {{name: board, class: board}}\n"
                        "receivers:\n  - id: primary\n    recording: {}\n{}"
                        "record: {{speed: 20, unit: km/h, source: made up}}\nprofiles: [fisly]\n",
                        file(), receiver));
        return certify(folder_.path() / "attempt.yaml", folder_.path() / "run", {"--no-render"});
    }

    /// Whether a speed was measured.
    bool is_measured(const ProcessResult& result) const {
        return result.exit_status != 2 && result.output.find("\nspeed  ") != std::string::npos;
    }

    Keys keys_ = GetParam().begun;
    static std::string file() { return fs::path(GetParam().file).filename().string(); }
    std::string written() const { return mapping_of(keys_); }

    TemporaryFolder folder_;
};

TEST_P(Advice, OfRefusalsLeadsToASpeed) {
    constexpr int most = 8;
    for (int i = 0; i < most; ++i) {
        const ProcessResult result = certified();
        if (is_measured(result)) return;
        ASSERT_TRUE(follow(result.output + result.errors))
            << "nothing new is advised with " << written() << ":\n"
            << result.output << result.errors;
    }
    FAIL() << "it goes on and on: " << written();
}

TEST_P(Advice, OfInspectAloneLeadsToASpeed) {
    const ProcessResult inspected = runcert({"inspect", (folder_.path() / file()).string()});
    const bool is_table = paste(inspected.output);
    follow(inspected.output + inspected.errors);
    if (inspected.exit_status != 0) {
        EXPECT_TRUE(keys_.contains("columns") || keys_.contains("time_scale"))
            << "only a table must be described before";
        return;
    }
    if (keys_.contains("frame") && keys_.at("frame").find("...") != std::string::npos)
        return;  // a grid's zone, which only a person knows
    ProcessResult result = certified();
    // What no table says of itself a refusal asks for.
    for (int i = 0; is_table && i < 4 && !is_measured(result); ++i) {
        ASSERT_TRUE(follow(result.output + result.errors)) << written() << "\n" << result.errors;
        result = certified();
    }
    EXPECT_TRUE(is_measured(result)) << written() << "\n" << result.output << result.errors;
}

INSTANTIATE_TEST_SUITE_P(Made, Advice, testing::ValuesIn(all_given()),
                         [](const auto& each) { return std::string(each.param.name); });

INSTANTIATE_TEST_SUITE_P(Real, Advice,
                         testing::Values(Given{"RaceCar", "race_car_vbo/run_a.vbo"},
                                         Given{"Fit", "other_programs/compressed_stamps.fit"},
                                         Given{"RaceChrono", "other_programs/racechrono_v3.csv"},
                                         Given{"TrackAddict", "other_programs/trackaddict.csv"},
                                         Given{"Attitude", "other_programs/ginav_attitude.pos"},
                                         Given{"Jump", "speed_skydive/flysight1_good.csv"}),
                         [](const auto& each) { return std::string(each.param.name); });

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
