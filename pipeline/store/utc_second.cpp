#include "store/utc_second.h"

#include <fmt/format.h>

#include <algorithm>
#include <ctime>

namespace runcert {
namespace {

namespace chrono = std::chrono;

struct DateAndTime {
    int year = 0;
    int month = 0;
    int day = 0;
    int hour = 0;
    int minute = 0;
    int second = 0;
};

DateAndTime parts_of(UtcSecond time) {
    const auto day = chrono::floor<chrono::days>(time);
    const chrono::year_month_day date(day);
    const chrono::hh_mm_ss clock(time - day);
    return {static_cast<int>(date.year()),
            static_cast<int>(static_cast<unsigned>(date.month())),
            static_cast<int>(static_cast<unsigned>(date.day())),
            static_cast<int>(clock.hours().count()),
            static_cast<int>(clock.minutes().count()),
            static_cast<int>(clock.seconds().count())};
}

std::optional<UtcSecond> instant_of(const DateAndTime& parts) {
    const chrono::year_month_day date{chrono::year(parts.year),
                                      chrono::month(static_cast<unsigned>(parts.month)),
                                      chrono::day(static_cast<unsigned>(parts.day))};
    if (!date.ok() || parts.hour > 23 || parts.minute > 59 || parts.second > 59)
        return std::nullopt;
    return chrono::sys_days(date) + chrono::hours(parts.hour) + chrono::minutes(parts.minute) +
           chrono::seconds(parts.second);
}

/// The same calendar time where this computer is.
std::optional<UtcSecond> local_instant_of(const DateAndTime& parts) {
    if (!instant_of(parts)) return std::nullopt;
    std::tm local{};
    local.tm_year = parts.year - 1900;
    local.tm_mon = parts.month - 1;
    local.tm_mday = parts.day;
    local.tm_hour = parts.hour;
    local.tm_min = parts.minute;
    local.tm_sec = parts.second;
    local.tm_isdst = -1;
    const std::time_t seconds = std::mktime(&local);
    if (seconds == -1) return std::nullopt;
    return UtcSecond(chrono::seconds(seconds));
}

/// The number that digits write; the caller has checked that they are digits.
int number_at(std::string_view text, std::size_t at, std::size_t count) {
    int number = 0;
    for (const char digit : text.substr(at, count))
        number = number * 10 + (digit - '0');
    return number;
}

bool are_digits(std::string_view text) {
    return std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
}

DateAndTime compact_parts(std::string_view digits) {
    DateAndTime parts{.year = number_at(digits, 0, 4),
                      .month = number_at(digits, 4, 2),
                      .day = number_at(digits, 6, 2)};
    if (digits.size() >= 12) {
        parts.hour = number_at(digits, 8, 2);
        parts.minute = number_at(digits, 10, 2);
    }
    if (digits.size() >= 14) parts.second = number_at(digits, 12, 2);
    return parts;
}

}  // namespace

std::string iso_text(UtcSecond time) {
    const DateAndTime p = parts_of(time);
    return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}Z", p.year, p.month, p.day, p.hour,
                       p.minute, p.second);
}

std::string compact_text(UtcSecond time) {
    const DateAndTime p = parts_of(time);
    return fmt::format("{:04}{:02}{:02}{:02}{:02}{:02}Z", p.year, p.month, p.day, p.hour, p.minute,
                       p.second);
}

std::optional<UtcSecond> parse_iso_utc(std::string_view text) {
    constexpr std::string_view form = "dddd-dd-ddTdd:dd:ddZ";
    if (text.size() != form.size()) return std::nullopt;
    std::string digits;
    for (std::size_t i = 0; i < form.size(); ++i) {
        if (form[i] == 'd' ? !are_digits(text.substr(i, 1)) : text[i] != form[i])
            return std::nullopt;
        if (form[i] == 'd') digits += text[i];
    }
    return instant_of(compact_parts(digits));
}

std::optional<UtcSecond> parse_ssh_time(std::string_view text) {
    bool utc = false;
    for (const std::string_view suffix : {"Z", "z", "UTC", "utc"})
        if (!utc && text.size() > suffix.size() && text.ends_with(suffix)) {
            text.remove_suffix(suffix.size());
            utc = true;
        }
    if ((text.size() != 8 && text.size() != 12 && text.size() != 14) || !are_digits(text))
        return std::nullopt;
    const DateAndTime parts = compact_parts(text);
    const auto instant = utc ? instant_of(parts) : local_instant_of(parts);
    if (!instant || instant->time_since_epoch().count() <= 0) return std::nullopt;
    return instant;
}

}  // namespace runcert
