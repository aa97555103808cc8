#include "core/random.h"
#include "import_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

using namespace import_test;
using std::string_literals::operator""s;

TEST(ImportRecognise, WhatIsNotReadIsNamed) {
    const struct {
        std::string bytes, where, what;
    } cases[] = {
        {"", "f:1:1", "empty, 0 bytes"},
        {"\xff\xfe%\0 \0\n\0"s, "f:1:1", "UTF-16 text. Save as UTF-8"},
        {"\xfe\xff\0%\0 \0\n"s, "f:1:1", "UTF-16 text. Save as UTF-8"},
        {"t\0i\0m\0e\0,\0"s, "f:1:1", "UTF-16 text. Save as UTF-8"},
        {"PK\x03\x04zip", "f:1:1", "ZIP archive"},
        {"\x1f\x8b\x08", "f:1:1", "gzip"},
        {"abc\ndef\0g"s, "f:2:4", "byte 7 is NUL"},
        {"%PDF-1.4\n", "f:1:1", "PDF, which is not read"},
        {"     2.11           OBSERVATION DATA    M (MIXED)           RINEX VERSION / TYPE\n",
         "f:1:1", "RINEX"},
        {"hello\n", "f:1:1", "it begins \"hello\". Formats that are read: RTKLIB"},
        {"hello there, you\nhello to all of you\n", "f:1:1", "is not recognised"},
        {"a,b,c,d\n1,2,3,4\n", "f:1:1", "the attempt names no columns"},
        {"a b  c d\n1 2 3  4\n", "f:1:1", "the attempt names no columns"},
    };
    for (const auto& bad : cases) {
        const std::string message = failure_of(pos_receiver(), bad.bytes);
        EXPECT_EQ(message.rfind(bad.where + ": ", 0), 0u) << message;
        EXPECT_NE(message.find(bad.what), std::string::npos) << message;
    }
}

/// Reads, or throws a Failure that says where: anything else ends the test.
void read_or_refuse(const Receiver& receiver, const std::string& text) {
    try {
        const Observations read = import_text(receiver, text);
        ASSERT_FALSE(read.rows.empty());
        // What is read can be written, and read again.
        const std::string table = write_observations(read);
        ASSERT_EQ(read_observations(table, "table").rows.size(), read.rows.size());
    } catch (const Failure& failure) {
        ASSERT_EQ(failure.where().rfind("f:", 0), 0u) << failure.what();
    }
}

std::string mutated(std::string text, RandomGenerator& random) {
    static const std::string likely = "0123456789.-+,;%#\"\t\n\r eEnaif\xff\0:/"s;
    const std::uint64_t changes = 1 + random.next() % 4;
    for (std::uint64_t i = 0; i < changes && !text.empty(); ++i) {
        const auto at = static_cast<std::size_t>(random.next() % text.size());
        const char byte = likely[static_cast<std::size_t>(random.next() % likely.size())];
        switch (random.next() % 4) {
            case 0:
                text[at] = byte;
                break;
            case 1:
                text.insert(at, 1, byte);
                break;
            case 2:
                text.erase(at, 1 + random.next() % 8);
                break;
            default:
                text.insert(at, text.substr(static_cast<std::size_t>(random.next() % text.size()),
                                            random.next() % 40));
        }
    }
    return text;
}

struct Sample {
    Receiver receiver;
    std::string text;
};

std::vector<Sample> samples() {
    std::vector<Sample> all;
    for (const char* file : {"degrees_velocity_floats.pos", "dms_semicolon.pos",
                             "ecef_velocity_week.pos", "baseline_base_dms.pos"}) {
        Receiver receiver = pos_receiver();
        receiver.format = "rtklib-pos";
        all.push_back({receiver, fixture(file)});
    }
    Receiver receiver = csv_receiver();
    receiver.columns["sigma_east"] = "se";
    receiver.columns["sigma_north"] = "sn";
    receiver.columns["fix"] = "fix";
    receiver.time_format = "iso";
    all.push_back({receiver,
                   "# c\ntime,lat,lon,h,se,sn,fix\n2023-07-11T06:04:30.0,35.5,-137.25,40,0.01,0.02,"
                   "fixed\n2023-07-11T06:04:30.1,35.5,-137.25,40,\"0.01\",,1\n"});
    receiver.frame = CoordinateFrame::utm;
    receiver.utm_zone = UtmZone{.zone = 33, .northern = true};
    receiver.time_format = "seconds";
    receiver.columns = {{"time", "1"},       {"east", "2"},        {"north", "3"}, {"up", "4"},
                        {"sigma_east", "5"}, {"sigma_north", "6"}, {"fix", "7"}};
    all.push_back(
        {receiver, "0.0;500000.5;5500000;40;0.01;0.02;1\n0.1;500001.5;5500000;40;0.01;0;float\n"});
    return all;
}

TEST(ImportFuzz, EveryTruncationReadsOrFails) {
    for (const Sample& sample : samples())
        for (std::size_t size = 0; size <= sample.text.size(); ++size)
            read_or_refuse(sample.receiver, sample.text.substr(0, size));
}

TEST(ImportFuzz, MutationsReadOrFail) {
    RandomGenerator random(20230711);
    for (const Sample& sample : samples())
        for (int i = 0; i < 1500; ++i) {
            const std::string text = mutated(sample.text, random);
            read_or_refuse(sample.receiver, text);
            if (HasFatalFailure()) FAIL() << text;
        }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
