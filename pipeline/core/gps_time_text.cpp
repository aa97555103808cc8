#include <fmt/format.h>

#include <cassert>
#include <cstddef>

#include "core/calendar.h"
#include "core/failure.h"
#include "core/gps_time.h"
#include "core/text.h"

namespace runcert {

namespace {

std::string iso_text(const CalendarTime& time, int decimals) {
    std::string text = fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}", time.year, time.month,
                                   time.day, time.hour, time.minute, time.second);
    if (decimals > 0)
        text += fmt::format(".{:0{}}", time.nanosecond / calendar::power_of_ten(9 - decimals),
                            decimals);
    return text;
}

GpsTime rounded(GpsTime time, int decimals) {
    assert(decimals >= 0 && decimals <= 9);
    const std::int64_t step = calendar::power_of_ten(9 - decimals);
    std::int64_t above = time.nanoseconds() % step;
    if (above < 0) above += step;
    return time.plus_nanoseconds(2 * above >= step ? step - above : -above);
}

/// Reads a text from left to right. Each step fails with the column at which it stands.
class IsoReader {
  public:
    explicit IsoReader(std::string_view text) : text_(text) {}

    int digits(int count, std::string_view name) {
        int value = 0;
        for (int i = 0; i < count; ++i, ++position_) {
            if (!at_digit()) fail(fmt::format("expected {} digits of the {}", count, name));
            value = 10 * value + (text_[position_] - '0');
        }
        return value;
    }

    char one_of(std::string_view characters, std::string_view name) {
        if (at_end() || characters.find(text_[position_]) == std::string_view::npos)
            fail(fmt::format("expected {}", name));
        return text_[position_++];
    }

    std::int64_t fraction_ns() {
        if (at_end()) return 0;
        one_of(".", "a decimal point or the end");
        std::int64_t value = 0;
        int count = 0;
        for (; at_digit(); ++count, ++position_) {
            if (count == 9) fail("expected at most 9 decimals of a second");
            value = 10 * value + (text_[position_] - '0');
        }
        if (count == 0) fail("expected a decimal of the second");
        return value * calendar::power_of_ten(9 - count);
    }

    void end() const {
        if (!at_end()) fail("expected the end: GPS time has no zone and no suffix");
    }

    [[noreturn]] void fail(const std::string& what) const { fail_at(position_, what); }

    [[noreturn]] void fail_at(std::size_t position, const std::string& what) const {
        throw Failure(
            "time",
            fmt::format("\"{}\", column {}: {}", escape_for_message(text_), position + 1, what),
            "Write GPS time as 2022-03-18T08:51:22.300");
    }

  private:
    bool at_end() const { return position_ >= text_.size(); }
    bool at_digit() const {
        return !at_end() && text_[position_] >= '0' && text_[position_] <= '9';
    }

    std::string_view text_;
    std::size_t position_ = 0;
};

}  // namespace

std::string to_iso(GpsTime time, int decimals) {
    return iso_text(rounded(time, decimals).calendar(), decimals);
}

std::string to_utc_iso(GpsTime time, int decimals) {
    // Rounded as an instant, so that 23:59:59.9996 becomes 23:59:60 where there is a leap second.
    return iso_text(utc_from_gps(rounded(time, decimals)).time, decimals) + "Z";
}

GpsTime parse_gps_iso(std::string_view text) {
    IsoReader reader(text);
    CalendarTime time;
    time.year = reader.digits(4, "year");
    const char separator = reader.one_of("-/", "'-' or '/'");
    time.month = reader.digits(2, "month");
    reader.one_of({&separator, 1}, fmt::format("'{}' as before the month", separator));
    time.day = reader.digits(2, "day");
    reader.one_of("T ", "'T' or a blank");
    time.hour = reader.digits(2, "hour");
    reader.one_of(":", "':'");
    time.minute = reader.digits(2, "minute");
    reader.one_of(":", "':'");
    time.second = reader.digits(2, "second");
    time.nanosecond = reader.fraction_ns();
    reader.end();
    if (const auto problem = calendar::find_problem(time, 59)) {
        const std::size_t field_positions[] = {0, 5, 8, 11, 14, 17, 20};
        reader.fail_at(field_positions[problem->field], problem->what);
    }
    return GpsTime::from_calendar(time);
}

}  // namespace runcert
