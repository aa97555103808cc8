#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "import_test_support.h"
#include "stages/import/format.h"

// A recording whose rows are not held, against the same held.

namespace runcert::RUNCERT_FILE {
namespace {

using namespace import_test;

/// Read without holding its rows, and put together for comparison.
Observations gathered(const Receiver& receiver, const RecordingBytes& recording) {
    const StreamedRecording by_row = find_format("rtklib-pos")->read_streamed(receiver, recording);
    Observations all = by_row.head;
    EXPECT_TRUE(all.rows.empty());
    by_row.give([&all](const Observation& row) { all.rows.push_back(row); });
    EXPECT_EQ(std::ssize(all.rows), by_row.rows);
    return all;
}

void expect_same(const Receiver& receiver, const std::string& text, const std::string& name) {
    const RecordingBytes recording{.name = name, .bytes = text};
    EXPECT_EQ(write_observations(gathered(receiver, recording)),
              write_observations(find_format("rtklib-pos")->read(receiver, recording)))
        << name;
}

TEST(PosStreamed, SaysWhatTheWholeSays) {
    Receiver other = pos_receiver();
    other.accuracy = AttemptAccuracy{.horizontal_m = 0.02, .vertical_m = 0.05};
    for (const std::string name :
         {"baseline_base_dms.pos", "degrees.pos", "degrees_comma_week_crlf.pos", "degrees_utc.pos",
          "degrees_velocity_floats.pos", "dms.pos", "ecef.pos", "ecef_velocity_week.pos"}) {
        expect_same(pos_receiver(), fixture(name), name);
        expect_same(other, fixture(name), name);
    }
}

/// Ten rows with standard deviations as given, and a line that cannot be read.
std::string short_pos(const std::string& deviations) {
    std::string text =
        "%  GPST                   latitude(deg) longitude(deg)  height(m)   Q  ns   sdn(m)   "
        "sde(m)   sdu(m)  sdne(m)  sdeu(m)  sdun(m) age(s)  ratio\n";
    for (int i = 0; i < 10; ++i) {
        if (i == 5) text += "2026/03/14 03:20:18.000  rubbish\n";
        text += fmt::format(
            "2026/03/14 03:20:{:02}.050  -31.6000000{:02}  136.000000007   109.9838"
            "   1  20   {}   0.0000   0.0000   0.0000   0.00   50.0\n",
            i % 7 == 6 ? 2 : 18 + i, i, deviations);
    }
    return text;
}

TEST(PosStreamed, TheAttemptFillsWhatIsMissing) {
    Receiver receiver = pos_receiver();
    receiver.accuracy = AttemptAccuracy{.horizontal_m = 0.02, .vertical_m = 0.05};
    const std::string silent = short_pos("0.0000   0.0000   0.0000");
    expect_same(receiver, silent, "silent");
    expect_same(receiver, short_pos("0.0067   0.0067   0.0000"), "no heights' accuracy");
    expect_same(receiver, short_pos("0.0067   0.0067   0.0134"), "stated");
    const Observations all = gathered(receiver, {.name = "f", .bytes = silent});
    EXPECT_EQ(all.accuracy_source, "attempt");
    EXPECT_EQ(all.rows.at(3).sigma_east_m, 0.02);
    EXPECT_EQ(all.rows.at(3).time.nanoseconds, 3'000'000'000);
    EXPECT_EQ(all.records.bad, 1);
}

TEST(PosStreamed, FailsAsTheWhole) {
    const std::string text = "% program\n" + short_pos("0.0067   0.0067   0.0134").substr(0, 180);
    const RecordingBytes recording{.name = "f", .bytes = text};
    const auto said = [](auto read) -> std::string {
        try {
            read();
        } catch (const Failure& failure) {
            return failure.where() + failure.problem();
        }
        return "nothing";
    };
    const std::string whole =
        said([&] { (void)find_format("rtklib-pos")->read(pos_receiver(), recording); });
    EXPECT_NE(whole, "nothing");
    EXPECT_EQ(
        said([&] { (void)find_format("rtklib-pos")->read_streamed(pos_receiver(), recording); }),
        whole);
}

TEST(PosStreamed, ShortRecordingsAreHeld) {
    const std::string text = fixture("degrees.pos");
    EXPECT_FALSE(import_streamed(pos_receiver(), {.name = "f", .bytes = text}).has_value());
}

TEST(LineReader, SaysHowFarItHasGone) {
    const std::string line(999, 'x');
    std::string text;
    while (text.size() < std::size_t{40} << 20)
        text += line + "\n";
    std::vector<std::size_t> passed;
    LineReader lines({.name = "f", .bytes = text, .passed = [&](std::size_t bytes) {
                          passed.push_back(bytes);
                      }});
    while (const auto next = lines.next())
        ASSERT_TRUE(passed.empty() || static_cast<std::size_t>(next->byte) >= passed.back());
    ASSERT_EQ(passed.size(), 2U);
    EXPECT_EQ(passed[0] % 1000, 0U);
    EXPECT_GE(passed[1], passed[0] + (std::size_t{15} << 20));
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
