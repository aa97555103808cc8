#include <gtest/gtest.h>
#include <stdlib.h>
#include <time.h>

#include "store/utc_second.h"

namespace runcert::RUNCERT_FILE {
namespace {

using std::chrono::seconds;

// Seconds as `date -u -d TIME +%s` prints them.
TEST(UtcSecond, IsTheInstantThatDatePrints) {
    struct Case {
        const char* iso;
        const char* compact;
        long long unix_seconds;
    };
    for (const Case& one : {Case{"2026-11-21T20:41:50Z", "20261121204150Z", 1795293710},
                            Case{"2024-02-29T23:59:59Z", "20240229235959Z", 1709251199},
                            Case{"1970-01-02T00:00:00Z", "19700102000000Z", 86400},
                            Case{"2100-03-01T00:00:00Z", "21000301000000Z", 4107542400}}) {
        const UtcSecond time{seconds(one.unix_seconds)};
        EXPECT_EQ(iso_text(time), one.iso);
        EXPECT_EQ(compact_text(time), one.compact);
        EXPECT_EQ(parse_iso_utc(one.iso), time);
        EXPECT_EQ(parse_ssh_time(one.compact), time);
    }
}

TEST(UtcSecond, SshFormsFillUpWithZeros) {
    EXPECT_EQ(parse_ssh_time("20261121Z"), parse_iso_utc("2026-11-21T00:00:00Z"));
    EXPECT_EQ(parse_ssh_time("202611212041Z"), parse_iso_utc("2026-11-21T20:41:00Z"));
    EXPECT_EQ(parse_ssh_time("20261121UTC"), parse_iso_utc("2026-11-21T00:00:00Z"));
}

TEST(UtcSecond, WithoutAZTheTimeIsLocal) {
    const char* before = getenv("TZ");
    const std::string old = before == nullptr ? "" : before;
    setenv("TZ", "XST-9:30", 1);  // 9.5 h ahead of UTC
    tzset();
    EXPECT_EQ(parse_ssh_time("20261121"), parse_iso_utc("2026-11-20T14:30:00Z"));
    before == nullptr ? unsetenv("TZ") : setenv("TZ", old.c_str(), 1);
    tzset();
}

TEST(UtcSecond, OtherTextsAreNoTimes) {
    for (const char* text : {"", "2026-11-21", "2026-11-21T20:41:50", "2026-02-29T00:00:00Z",
                             "2026-11-21T24:00:00Z", "2026-11-21T20:60:50Z", "2026-11-21T20:41:60Z",
                             "2026-13-01T00:00:00Z", "2026-11-21t20:41:50Z", "+026-11-21T20:41:50Z",
                             "2026-11-21T20:41:50Z ", "2026-11-21T20:41:50.0Z"})
        EXPECT_FALSE(parse_iso_utc(text)) << text;
    for (const char* text : {"", "Z", "2026", "20261121T", "2026112120Z", "20260229Z", "20261301Z",
                             "20261121 Z", "2026112120415Z", "19700101Z", "2026-11-21Z"})
        EXPECT_FALSE(parse_ssh_time(text)) << text;
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
