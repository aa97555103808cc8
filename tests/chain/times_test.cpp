#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "chain_support.h"
#include "draws.h"
#include "recorded_run.h"
#include "schemas/verdict/declared.h"

// Recordings whose times leap, fall back, repeat, or stand in another order: what their figure is.

namespace runcert::chain::RUNCERT_FILE {
namespace {

/// How a format writes a recording, and what an attempt on it says beside.
struct Written {
    std::string name;
    std::string (*bytes)(const RecordedRun&);
    std::string of_receiver;
    double interval_s = 0.1;
    bool dated = true;  ///< its epochs have dates of their own
    std::string profile = "nalsa";
};

void PrintTo(const Written& format, std::ostream* out) {
    *out << format.name;
}

const std::string accuracy = ", solution: fixed, accuracy: {horizontal_m: 0.02, vertical_m: 0.04}";

const std::vector<Written>& formats() {
    static const std::vector<Written> all{
        {"run.pos", [](const RecordedRun& run) { return run.pos(); }, ""},
        {"run.nmea", [](const RecordedRun& run) { return run.nmea(); }, accuracy},
        {"run.ubx", [](const RecordedRun& run) { return run.ubx(); }, ""},
        {"run.csv", [](const RecordedRun& run) { return run.csv(); },
         ", format: csv, frame: geodetic, time_format: iso, columns: {time: time, latitude: lat, "
         "longitude: lon, height: h, speed: v}" +
             accuracy},
        {"run.gpx", [](const RecordedRun& run) { return run.gpx(); }, accuracy},
        {"run.fit", [](const RecordedRun& run) { return run.fit(); }, accuracy, 1.0},
        {"run.igc", [](const RecordedRun& run) { return run.igc(); },
         ", accuracy: {horizontal_m: 0.02, vertical_m: 0.04}", 1.0, true, "fisly"},
        {"run.vbo", [](const RecordedRun& run) { return run.vbo(); }, accuracy, 0.1, false}};
    return all;
}

/// A run that is fastest in its middle.
RecordedRun good(const Written& format) {
    const double step_s = format.interval_s;
    const int epochs = step_s < 1.0 ? 500 : 400;
    const double middle_s = 0.6 * epochs * step_s, width_s = 0.15 * epochs * step_s;
    RecordedRun run;
    run.places = RecordedRun::along(epochs, step_s, [&](double t_s) {
        return 5.0 + 25.0 * std::exp(-std::pow((t_s - middle_s) / width_s, 2));
    });
    for (int k = 0; k < epochs; ++k)
        run.stamps_s.push_back(k * step_s);
    return run;
}

/// The records in another order, or some of them again.
RecordedRun in_order(const RecordedRun& run, const std::vector<int>& records) {
    RecordedRun other;
    for (const int k : records) {
        other.places.push_back(run.place(k));
        other.stamps_s.push_back(run.stamps_s[static_cast<std::size_t>(k)]);
    }
    return other;
}

class Times : public testing::TestWithParam<Written> {
  protected:
    /// The verdict on a recording, by a rule of 3 or 2 s.
    ProfileVerdict judged(const RecordedRun& run, double record_kmh) const {
        const Written& format = GetParam();
        write_file_atomically(folder_.path() / format.name, format.bytes(run));
        write_file_atomically(
            folder_.path() / "attempt.yaml",
            fmt::format(
                "schema: attempt/1.0\nid: times\ncraft: {{name: yacht, class: land-yacht}}\n"
                "receivers:\n  - {{id: primary, recording: {}{}}}\nprofiles: [{}]\n"
                "record: {{speed: {}, unit: km/h, source: a test}}\n"
                "parameters: {{screen: {{allowed_fixes: [fixed, single]}}}}\n",
                format.name, format.of_receiver, format.profile, record_kmh));
        const fs::path out = folder_.path() / "run";
        fs::remove_all(out);
        const ProcessResult result = certify(folder_.path() / "attempt.yaml", out, {"--no-render"});
        const bool in_future = result.errors.find("later than tomorrow") != std::string::npos;
        EXPECT_TRUE(result.exit_status != 2 || in_future) << result.errors;
        if (result.exit_status == 2) return {.reason = result.errors};
        return read_verdict(read_file(out / "6-verdict.yaml"), "6-verdict.yaml").profiles.at(0);
    }

    enum class Stays { all, part };

    /// The figure of the good recording within a fifth of its uncertainty, or, where only a part of
    /// it stays whole, one that is less; or no proof, and the speed named. Never a record that was
    /// not beaten, of 95 % of that figure.
    void expect_right(const RecordedRun& run, const ProfileVerdict& right, const std::string& what,
                      Stays stays = Stays::all) const {
        SCOPED_TRACE(what);
        const double kmh = *right.speed_m_s * 3.6;
        const ProfileVerdict verdict = judged(run, 0.95 * kmh);
        if (verdict.profile.empty()) return;  // refused: a recording of the future
        ASSERT_NE(verdict.outcome, Outcome::not_beaten) << verdict.reason;
        if (verdict.outcome != Outcome::beaten) {
            const std::string names = "he recording shows ";
            const auto at = verdict.reason.find(names);
            const double named_kmh = at == std::string::npos
                                         ? verdict.speed_m_s.value_or(0.0) * 3.6
                                         : std::stod(verdict.reason.substr(at + names.size()));
            EXPECT_GT(named_kmh, 0.97 * kmh) << verdict.reason;
            return;
        }
        const double tolerance_m_s = *right.expanded_uncertainty_m_s / 5.0;
        EXPECT_LT(*verdict.speed_m_s, *right.speed_m_s + tolerance_m_s) << verdict.reason;
        if (stays == Stays::all) {
            EXPECT_GT(*verdict.speed_m_s, *right.speed_m_s - tolerance_m_s) << verdict.reason;
        }
    }

    TemporaryFolder folder_;
};

TEST_P(Times, StampsThatLeapAheadOrFallBack) {
    const Written& format = GetParam();
    const RecordedRun run = good(format);
    const ProfileVerdict right = judged(run, 50.0);
    ASSERT_EQ(right.outcome, Outcome::beaten) << right.reason;
    constexpr double day_s = 86'400.0;
    std::vector<double> shifts_s{format.interval_s, 3.0, 1'200.0};
    if (format.dated) shifts_s.insert(shifts_s.end(), {day_s, 1024 * 7 * day_s});
    const int half = run.size() / 2;
    // In the daily set a few, others in each format.
    int turn = static_cast<int>(format.name.size() + static_cast<std::size_t>(format.name.back()));
    for (const int count : {1, 2, 3, 30, half})
        for (const double by_s : shifts_s)
            for (const double sign : {1.0, -1.0})
                for (const int from :
                     {0, run.size() / 5, 6 * run.size() / 10, run.size() - count}) {
                    if (!is_study() && ++turn % 50 != 0) continue;
                    RecordedRun moved = run;
                    for (int k = from; k < std::min(from + count, run.size()); ++k)
                        moved.stamps_s[static_cast<std::size_t>(k)] += sign * by_s;
                    expect_right(
                        moved, right,
                        fmt::format("{} records from {} by {} s", count, from, sign * by_s),
                        count == half || format.interval_s >= 1.0 ? Stays::part : Stays::all);
                }
}

TEST_P(Times, BlocksInAnyOrderAndAgain) {
    const Written& format = GetParam();
    const RecordedRun run = good(format);
    const ProfileVerdict right = judged(run, 50.0);
    ASSERT_EQ(right.outcome, Outcome::beaten) << right.reason;
    RandomGenerator random(20261126);
    const auto below = [&](int bound) { return static_cast<int>(random.uniform() * bound); };
    const int tries = draws({.daily = 4, .study = 200});
    for (int i = 0; i < tries; ++i) {
        RecordedRun base = run;
        // A quarter in two sessions, the later one of them first or not.
        const bool sessions = i % 4 == 0;
        const int cut = run.size() / 4;
        if (sessions)
            for (int k = 0; k < cut; ++k)
                base.stamps_s[static_cast<std::size_t>(k)] -= 7'200.0;
        std::vector<int> cuts{0, run.size()};
        if (sessions) cuts.push_back(cut);
        for (int k = 1 + below(5); k > 0; --k)
            cuts.push_back(below(run.size()));
        std::ranges::sort(cuts);
        std::vector<std::vector<int>> blocks;
        for (std::size_t k = 1; k < cuts.size(); ++k) {
            blocks.emplace_back(static_cast<std::size_t>(cuts[k] - cuts[k - 1]));
            std::iota(blocks.back().begin(), blocks.back().end(), cuts[k - 1]);
        }
        for (std::size_t k = blocks.size(); k > 1; --k)
            if (random.uniform() < 0.7)
                std::swap(blocks[k - 1],
                          blocks[static_cast<std::size_t>(below(static_cast<int>(k)))]);
        if (random.uniform() < 0.4) {
            const auto again =
                blocks[static_cast<std::size_t>(below(static_cast<int>(blocks.size())))];
            blocks.insert(blocks.begin() + below(static_cast<int>(blocks.size())), again);
        }
        std::vector<int> order;
        for (const std::vector<int>& block : blocks)
            order.insert(order.end(), block.begin(), block.end());
        RecordedRun shuffled = in_order(base, order);
        if (random.uniform() < 0.4) {
            const int from = below(shuffled.size() - 4);
            const double by_s = format.interval_s *
                                std::round((random.uniform() - 0.5) * 2'000.0 / format.interval_s);
            for (int k = from; k < from + 1 + below(3); ++k)
                if (std::abs(by_s) >= format.interval_s)
                    shuffled.stamps_s[static_cast<std::size_t>(k)] += by_s;
        }
        if (!format
                 .dated)  // its times of day alone cannot say that an earlier one is a later day's
            for (double& stamp_s : shuffled.stamps_s)
                stamp_s += 7'300.0;
        expect_right(shuffled, right, fmt::format("draw {}", i));
    }
}

INSTANTIATE_TEST_SUITE_P(Formats, Times, testing::ValuesIn(formats()),
                         [](const auto& one) { return one.param.name.substr(4); });

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
