#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "core/failure.h"
#include "core/text.h"
#include "store/atomic_file.h"
#include "store/process.h"

namespace runcert::import_test {

/// Whether gpsbabel, the independent reader and writer, is installed.
inline bool has_gpsbabel() {
    try {
        return run_process({"gpsbabel", "-V"}).exit_status == 0;
    } catch (const Failure&) {
        return false;
    }
}

/// Whether the gpsbabel that is installed reads a format of files: that of Debian 13 reads fewer.
inline bool gpsbabel_reads(const std::string& type) {
    return has_gpsbabel() &&
           run_process({"gpsbabel", "-^3"}).output.find("\t" + type + "\t") != std::string::npos;
}

/// The tracks of a recording, given as gpsbabel's format `from`, as its format `to` (options after
/// commas). A failure of gpsbabel is one of the test.
inline std::string gpsbabel_converted(const std::string& from, std::string_view bytes,
                                      const std::string& to) {
    const TemporaryFolder folder;
    const std::string in = folder.path() / "in", out = folder.path() / "out";
    write_file_atomically(in, bytes);
    const ProcessResult result =
        run_process({"gpsbabel", "-t", "-i", from, "-f", in, "-o", to, "-F", out});
    EXPECT_EQ(result.exit_status, 0) << result.errors;
    return result.exit_status == 0 ? read_file(out) : std::string();
}

/// A track point as gpsbabel reads it, to the precision of its unicsv.
struct ReferencePoint {
    double latitude_deg = 0.0;
    double longitude_deg = 0.0;
    std::optional<double> altitude_m;  ///< as recorded, above sea level or the ellipsoid
    std::optional<double> speed_m_s;
    std::optional<double> course_deg;
    std::string utc;  ///< "2019-04-12T00:39:57", with decimals where there are some
};

/// What gpsbabel reads in a recording.
inline std::vector<ReferencePoint> gpsbabel_points(const std::string& from,
                                                   std::string_view bytes) {
    std::istringstream table(gpsbabel_converted(from, bytes, "unicsv,utc=0,prec=9"));
    const auto split = [](std::string line) {
        while (line.ends_with('\r'))
            line.pop_back();
        std::vector<std::string> cells;
        std::istringstream in(line);
        for (std::string cell; std::getline(in, cell, ',');)
            cells.push_back(cell);
        return cells;
    };
    std::string line;
    std::getline(table, line);
    const std::vector<std::string> names = split(line);
    std::vector<ReferencePoint> points;
    while (std::getline(table, line)) {
        const std::vector<std::string> cells = split(line);
        std::map<std::string, std::string> named;
        for (std::size_t i = 0; i < cells.size() && i < names.size(); ++i)
            named[names[i]] = cells[i];
        std::string date = named["Date"];
        for (char& c : date)
            if (c == '/') c = '-';
        points.push_back({.latitude_deg = parse_double(named["Latitude"]).value_or(999.0),
                          .longitude_deg = parse_double(named["Longitude"]).value_or(999.0),
                          .altitude_m = parse_double(named["Altitude"]),
                          .speed_m_s = parse_double(named["Speed"]),
                          .course_deg = parse_double(named["Course"]),
                          .utc = date + "T" + named["Time"]});
    }
    return points;
}

}  // namespace runcert::import_test
