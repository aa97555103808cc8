#include <nlohmann/json.hpp>

#include "schemas_attempt_support.h"

// Who made an attempt and with what, and by which clock: keys of an attempt that are printed only.

namespace runcert::RUNCERT_FILE {
namespace {

using test::failure_of;

const std::string start = R"(schema: attempt/1.0
id: a
craft: {name: b, class: board}
receivers:
  - {id: primary, recording: r.csv}
profiles: [nalsa]
)";

TEST(UtcOffset, IsReadInMinutes) {
    const std::pair<const char*, int> cases[] = {
        {"Z", 0},          {"\"Z\"", 0},    {"+00:00", 0},   {"+10:30", 630}, {"\"+10:30\"", 630},
        {"-03:30", -210},  {"+05:45", 345}, {"+12:45", 765}, {"+14:00", 840}, {"-12:00", -720},
        {"'-00:15'", -15},
    };
    for (const auto& [text, minutes] : cases)
        EXPECT_EQ(read_attempt(start + "utc_offset: " + text + "\n", "f").utc_offset_minutes,
                  minutes)
            << text;
    EXPECT_FALSE(read_attempt(start, "f").utc_offset_minutes);
    EXPECT_FALSE(read_attempt(start + "utc_offset: null\n", "f").utc_offset_minutes);
}

TEST(UtcOffset, OfAnotherFormIsRefusedWithItsPlaceAndWhatToWrite) {
    const std::pair<const char*, const char*> cases[] = {
        {"10:30", "Write it with its sign: \"+10:30\""},
        {"13:45", "Write it with its sign: \"+13:45\""},
        // What some programs that write YAML make of +10:30, and of 10:30:00; of -3:30.
        {"630", "some programs write +10:30 so, as a number to the base 60"},
        {"630", "Write it in quotes: \"+10:30\""},
        {"37800", "Write it in quotes: \"+10:30\""},
        {"-210", "Write it in quotes: \"-03:30\""},
        {"600", "Write it in quotes: \"+10:00\""},
        {"+10:20", "no local time is +10:20 from UTC"},
        {"+14:15", "from -12:00 to +14:00"},
        {"-12:15", "from -12:00 to +14:00"},
        {"+99:00", "from -12:00 to +14:00"},
        {"+10:60", "\"+10:60\" is not an offset from UTC"},
        {"-00:00", "\"-00:00\" is not an offset from UTC"},
        {"+10", "\"+10\" is not an offset from UTC"},
        {"+1030", "as \"+10:30\", \"-03:00\" or \"Z\""},
        {"+1:30", "is not an offset from UTC"},
        {"z", "is not an offset from UTC"},
        {"UTC", "is not an offset from UTC"},
        {"10.5", "is not an offset from UTC"},
        {"Europe/Berlin", "is not an offset from UTC"},
        {"\"\"", "\"\" is not an offset from UTC"},
        {"\" +10:30\"", "is not an offset from UTC"},
        {"\"+10:30 \"", "is not an offset from UTC"},
        {"\"\u221210:30\"", "is not an offset from UTC"},
        {"99999999999999999999", "is not an offset from UTC"},
    };
    for (const auto& [text, said] : cases) {
        const auto failure = failure_of([&, given = text] {
            read_attempt(start + "utc_offset: " + std::string(given) + "\n", "f");
        });
        EXPECT_EQ(failure.where, "f:7:13") << text;
        EXPECT_TRUE(failure.contains(said)) << text << "\n"
                                            << failure.problem << ". " << failure.remedy;
    }
    const auto list = failure_of([&] { read_attempt(start + "utc_offset: [\"+10:30\"]\n", "f"); });
    EXPECT_EQ(list.where, "f:7:13");
}

TEST(AttemptNames, OfAnyLengthAndWritingAreKept) {
    std::string letters, ideographs;
    for (int i = 0; i < 200; ++i) {
        letters += static_cast<char>('a' + i % 26);
        ideographs += "\u5c71";
    }
    const std::string right_to_left = "\u0634\u064a\u0645\u0627\u0621 \u05d3\u05d5\u05d3";
    for (const std::string& name :
         {letters, ideographs, right_to_left, std::string("O'Neill: a \"sailor\", #1")}) {
        const std::string quoted = nlohmann::json(name).dump();
        std::string text = start;
        text.replace(text.find("class: board"), 12, "class: board, registration: " + quoted);
        text.replace(
            text.find("recording: r.csv"), 16,
            "recording: r.csv, instrument: {make: " + quoted + ", serial: " + quoted + "}");
        for (const char* key : {"pilot", "organisation", "contact"})
            text += std::string(key) + ": " + quoted + "\n";
        const Attempt attempt = read_attempt(text, "f");
        EXPECT_EQ(attempt.pilot, name);
        EXPECT_EQ(attempt.organisation, name);
        EXPECT_EQ(attempt.contact, name);
        EXPECT_EQ(attempt.craft.registration, name);
        EXPECT_EQ(attempt.receivers[0].instrument->make, name);
        EXPECT_EQ(attempt.receivers[0].instrument->serial, name);
    }
}

TEST(AttemptInstrument, NumbersStayAsTheyAreWritten) {
    std::string text = start;
    text.replace(text.find("recording: r.csv"), 16,
                 "recording: r.csv, instrument: {serial: 004711, firmware: 1.10, model: 1e3}");
    const Instrument instrument = read_attempt(text, "f").receivers[0].instrument.value();
    EXPECT_EQ(instrument, (Instrument{.model = "1e3", .serial = "004711", .firmware = "1.10"}));
}

// A recording is not read in another way for what is printed beside it: else `verify` would say of
// every such run that it was not read as the attempt has it.
TEST(AttemptInstrument, AndDeductionAreNoPartOfHowARecordingIsRead) {
    const Attempt plain = read_attempt(start, "f");
    std::string text = start;
    text.replace(text.find("recording: r.csv"), 16,
                 "recording: r.csv, instrument: {make: m}, device_deduction: {speed: 1, unit: kn}");
    const Attempt more = read_attempt(text, "f");
    EXPECT_EQ(*reading_of(more.written("primary")), *reading_of(plain.written("primary")));
    EXPECT_EQ(*reading_of(part_read_by(more, "import").written("primary")), *reading_of(more.written("primary")));
    for (const char* stage : {"import", "enu", "screen", "smooth", "window"})
        EXPECT_EQ(settings_of(more, stage)->dump(), settings_of(plain, stage)->dump()) << stage;
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
