#include "store/utc_second.h"

#include <fmt/chrono.h>
#include <time.h>

#include <algorithm>

#include "core/text.h"

namespace runcert {
namespace {

/// The instant that 14 digits write, YYYYMMDDHHMMSS, in UTC or where this computer is.
std::optional<UtcSecond> instant_of(const std::string& digits, bool utc) {
    std::tm parts{};
    if (digits.size() != 14 || !std::ranges::all_of(digits, is_digit) ||
        strptime(digits.c_str(), "%Y%m%d%H%M%S", &parts) != digits.c_str() + digits.size())
        return std::nullopt;
    const std::tm written = parts;
    std::time_t seconds = timegm(&parts);
    // A day or second that there is none of becomes another.
    if (parts.tm_mday != written.tm_mday || parts.tm_sec != written.tm_sec) return std::nullopt;
    if (!utc) {
        parts = written;
        parts.tm_isdst = -1;
        seconds = mktime(&parts);
        if (seconds == -1) return std::nullopt;
    }
    return UtcSecond(std::chrono::seconds(seconds));
}

}  // namespace

std::string iso_text(UtcSecond time) {
    return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", time);
}

std::string compact_text(UtcSecond time) {
    return fmt::format("{:%Y%m%d%H%M%SZ}", time);
}

std::optional<UtcSecond> parse_iso_utc(std::string_view text) {
    constexpr std::string_view form = "dddd-dd-ddTdd:dd:ddZ";
    std::string digits;
    for (std::size_t i = 0; i < std::min(text.size(), form.size()); ++i)
        if (form[i] == 'd')
            digits += text[i];
        else if (text[i] != form[i])
            return std::nullopt;
    return text.size() == form.size() ? instant_of(digits, true) : std::nullopt;
}

std::optional<UtcSecond> parse_ssh_time(std::string_view text) {
    bool utc = false;
    for (const std::string_view suffix : {"Z", "z", "UTC", "utc"})
        if (!utc && text.size() > suffix.size() && text.ends_with(suffix)) {
            text.remove_suffix(suffix.size());
            utc = true;
        }
    if (text.size() != 8 && text.size() != 12 && text.size() != 14) return std::nullopt;
    const auto instant = instant_of(std::string(text).append(14 - text.size(), '0'), utc);
    if (!instant || instant->time_since_epoch().count() <= 0) return std::nullopt;
    return instant;
}

}  // namespace runcert
