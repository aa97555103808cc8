#include "reports/day/shared_recordings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/random.h"

namespace runcert {
namespace {

constexpr std::int64_t epochs_of_an_overlap = 10;
constexpr std::size_t named_at_most = 5;

std::uint64_t mixed(std::uint64_t hash, std::int64_t value) {
    hash += static_cast<std::uint64_t>(value);
    return splitmix64(hash);
}

/// The hash of an epoch's time and position; nothing where it has no position.
std::optional<std::uint64_t> epoch_hash(const RecordingFacts& facts, const Observation& row) {
    const bool on_earth = row.latitude_deg && row.longitude_deg;
    if (!on_earth && !(row.plane_east_m && row.plane_north_m)) return std::nullopt;
    const double first = on_earth ? *row.latitude_deg * 1e7 : *row.plane_east_m * 1e2;
    const double second = on_earth ? *row.longitude_deg * 1e7 : *row.plane_north_m * 1e2;
    std::uint64_t hash = mixed(on_earth ? 1 : 2, std::llround(first));
    hash = mixed(hash, std::llround(second));
    if (!facts.first_epoch) return hash;
    const std::int64_t time_ns =
        facts.first_epoch->plus_nanoseconds(row.time.nanoseconds).nanoseconds();
    return mixed(hash, (time_ns + 500'000) / 1'000'000);
}

/// Attempts by pairs, and how much they share: each attempt's others.
using Shared = std::map<std::uint32_t, std::map<std::uint32_t, std::int64_t>>;

template <class Entry>
Shared shared_by(std::vector<Entry>& entries) {
    std::ranges::sort(entries);
    const auto repeated = std::ranges::unique(entries);
    entries.erase(repeated.begin(), repeated.end());
    Shared shared;
    for (std::size_t first = 0, last = 0; first < entries.size(); first = last) {
        while (last < entries.size() && entries[last].what == entries[first].what)
            ++last;
        for (std::size_t a = first; a < last; ++a)
            for (std::size_t b = first; b < last; ++b)
                if (a != b) ++shared[entries[a].attempt][entries[b].attempt];
    }
    return shared;
}

std::string named(const std::vector<std::string>& ids) {
    const std::size_t shown = std::min(ids.size(), named_at_most);
    return fmt::format("{}{}", fmt::join(ids.begin(), ids.begin() + std::ptrdiff_t(shown), ", "),
                       ids.size() > shown ? fmt::format(" and {} more", ids.size() - shown) : "");
}

}  // namespace

void SharedRecordings::add(std::uint32_t attempt, OpenTable<Observations> recording) {
    for (const InputFile& input : recording.head.header.inputs)
        if (input.role == "recording")
            files_.push_back({std::stoull(input.sha256.substr(0, 16), nullptr, 16), attempt});
    for (Observation row; recording.rows.next(row); row = {})
        if (const auto hash = epoch_hash(recording.head.facts, row))
            epochs_.push_back({*hash, attempt});
}

void SharedRecordings::note(std::vector<AttemptResult>& attempts) {
    Shared files = shared_by(files_);
    Shared epochs = shared_by(epochs_);
    for (std::uint32_t attempt = 0; attempt < attempts.size(); ++attempt) {
        std::vector<std::string> same, overlapping;
        for (const auto& [other, count] : files[attempt])
            same.push_back(attempts[other].id);
        std::int64_t most = 0;
        for (const auto& [other, count] : epochs[attempt]) {
            if (count < epochs_of_an_overlap || files[attempt].contains(other)) continue;
            overlapping.push_back(attempts[other].id);
            most = std::max(most, count);
        }
        std::vector<std::string>& notes = attempts[attempt].notes;
        if (!same.empty())
            notes.push_back(
                fmt::format("It rests on the same recording, byte for byte, as {}.", named(same)));
        if (!overlapping.empty())
            notes.push_back(
                fmt::format("Its recording overlaps that of {}: up to {} epochs have "
                            "the same time and position.",
                            named(overlapping), most));
    }
}

}  // namespace runcert
