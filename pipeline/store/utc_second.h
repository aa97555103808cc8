#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>

namespace runcert {

/// An instant of civil time in whole seconds, as signatures, keys and time stamps state it: POSIX
/// seconds, which count no leap seconds.
using UtcSecond = std::chrono::sys_seconds;

/// "2026-11-21T20:41:50Z".
std::string iso_text(UtcSecond time);

/// "20261121204150Z", as OpenSSH writes times.
std::string compact_text(UtcSecond time);

/// The instant written "YYYY-MM-DDTHH:MM:SSZ"; nothing for any other text, and for a day that is
/// not in the calendar.
std::optional<UtcSecond> parse_iso_utc(std::string_view text);

/// The instant of a time in OpenSSH's forms: YYYYMMDD, YYYYMMDDHHMM or YYYYMMDDHHMMSS, in UTC with
/// a Z (or UTC) at its end, else in the local time of this computer, as ssh-keygen takes it.
/// Nothing for any other text, and for instants up to 1970-01-01T00:00:00Z.
std::optional<UtcSecond> parse_ssh_time(std::string_view text);

}  // namespace runcert
