#include <fmt/format.h>

#include <cmath>

#include "import_test_support.h"

// A recording that was cut off, at every byte: what is left of it is read, its epochs as they are
// in the whole one, or it is refused.

namespace runcert::RUNCERT_FILE {
namespace {

using namespace import_test;

bool same(const OptionalReal& a, const OptionalReal& b) {
    return a.has_value() == b.has_value() && (!a || *a == *b);
}

/// Whether an epoch of the cut recording is that of the whole one. Of the last, whose records may
/// have been cut off, only the time must be.
bool is_epoch_of_whole(const Observation& cut, const Observation& whole, bool last) {
    if (cut.epoch != whole.epoch || cut.time != whole.time) return false;
    return last ||
           (same(cut.latitude_deg, whole.latitude_deg) &&
            same(cut.longitude_deg, whole.longitude_deg) && same(cut.height_m, whole.height_m) &&
            same(cut.recorded_velocity_east_m_s, whole.recorded_velocity_east_m_s) &&
            same(cut.sigma_east_m, whole.sigma_east_m) && cut.fix == whole.fix);
}

struct WholeFile {
    const char* format;
    const char* name;  ///< in tests/fuzz/corpus/FORMAT
};

class Truncation : public testing::TestWithParam<WholeFile> {};

TEST_P(Truncation, AtEveryByte) {
    const auto [format, name] = GetParam();
    std::string bytes =
        slurp(fmt::format("{}/tests/fuzz/corpus/{}/{}", RUNCERT_SOURCE_DIR, format, name));
    Receiver receiver = pos_receiver();
    if (format == std::string("csv")) {
        receiver = csv_receiver();
        bytes.erase(0, 1);  // which chooses what the attempt says, in the fuzzing target
    }
    const Observations whole = import_text(receiver, bytes);
    ASSERT_GE(whole.rows.size(), 3u);
    std::size_t read = 0, refused = 0;
    for (std::size_t length = 0; length < bytes.size(); ++length)
        try {
            const Observations cut = import_text(receiver, bytes.substr(0, length));
            ++read;
            ASSERT_LE(cut.rows.size(), whole.rows.size()) << length;
            // Relative where the date was cut off, as in NMEA.
            ASSERT_TRUE(cut.time_scale == whole.time_scale || cut.time_scale == "relative");
            if (cut.facts.first_epoch) {
                ASSERT_EQ(*cut.facts.first_epoch, *whole.facts.first_epoch) << length;
            }
            for (std::size_t i = 0; i < cut.rows.size(); ++i)
                ASSERT_TRUE(is_epoch_of_whole(cut.rows[i], whole.rows[i], i + 1 == cut.rows.size()))
                    << "cut to " << length << " bytes, epoch " << i + 1;
        } catch (const Failure& failure) {
            ++refused;
            ASSERT_FALSE(failure.where().empty() || failure.remedy().empty()) << length;
        }
    // A file cut before the end of its first epoch is refused; one cut later is read.
    EXPECT_GT(refused, 20u);
    EXPECT_GT(read, bytes.size() / 10);
}

INSTANTIATE_TEST_SUITE_P(
    EveryFormat, Truncation,
    testing::Values(WholeFile{"rtklib-pos", "degrees"},
                    WholeFile{"rtklib-pos", "ecef_velocity_week"}, WholeFile{"csv", "geodetic"},
                    WholeFile{"nmea", "all"}, WholeFile{"nmea", "gga"}, WholeFile{"ubx", "all"},
                    WholeFile{"ubx", "old"}, WholeFile{"ubx", "solutions"},
                    WholeFile{"septentrio", "geodetic"}, WholeFile{"septentrio", "cartesian"},
                    WholeFile{"vbo", "full"}, WholeFile{"flysight", "one"},
                    WholeFile{"flysight", "two"}, WholeFile{"oao", "log"}, WholeFile{"sbp", "log"},
                    WholeFile{"sbn", "log"}, WholeFile{"gpx", "one_one"}, WholeFile{"igc", "full"},
                    WholeFile{"novatel", "best"}, WholeFile{"novatel", "inertial"},
                    WholeFile{"racechrono", "three"}, WholeFile{"racebox", "units"},
                    WholeFile{"trackaddict", "four"}, WholeFile{"columbus", "padded"},
                    WholeFile{"aim", "three"}),
    [](const testing::TestParamInfo<WholeFile>& one) {
        std::string name = fmt::format("{}_{}", one.param.format, one.param.name);
        for (char& c : name)
            if (c == '-') c = '_';
        return name;
    });

}  // namespace
}  // namespace runcert::RUNCERT_FILE
