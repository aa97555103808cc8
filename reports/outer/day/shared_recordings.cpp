#include "reports/day/shared_recordings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <set>

#include "core/random.h"

namespace runcert {
namespace {

constexpr std::int64_t rows_of_an_overlap = 10;
constexpr std::size_t named_at_most = 5;
/// In coarser steps two runs over one course meet by chance.
constexpr double coarsest_m = 0.05;

std::uint64_t mixed(std::uint64_t hash, std::int64_t value) {
    hash += static_cast<std::uint64_t>(value);
    return splitmix64(hash);
}

/// A position in whole steps of about a centimetre.
struct Place {
    bool on_earth = true;
    std::int64_t first = 0, second = 0;

    std::uint64_t hash() const { return mixed(mixed(on_earth ? 1 : 2, first), second); }
};

std::optional<Place> place_of(const Observation& row) {
    if (row.latitude_deg && row.longitude_deg)
        return Place{true, std::llround(*row.latitude_deg * 1e7),
                     std::llround(*row.longitude_deg * 1e7)};
    if (row.plane_east_m && row.plane_north_m)
        return Place{false, std::llround(*row.plane_east_m * 1e2),
                     std::llround(*row.plane_north_m * 1e2)};
    return std::nullopt;
}

/// Hashes of the distances over each second of 20 s in motion, which no shift, turn or other time
/// changes. Positions are complex numbers in metres, `stride` of them to a second.
std::vector<std::uint64_t> motions_in(const std::vector<std::complex<double>>& at_m,
                                      std::size_t stride) {
    constexpr std::size_t seconds = 20;
    constexpr double least_m = 2.0, step_m = 0.05;
    std::vector<std::uint64_t> hashes;
    for (std::size_t k = 0; k + seconds * stride < at_m.size(); ++k) {
        std::uint64_t hash = 0;
        bool moved = true;
        for (std::size_t at = k; moved && at < k + seconds * stride; at += stride) {
            const double distance_m = std::abs(at_m[at + stride] - at_m[at]);
            moved = distance_m >= least_m;
            hash = mixed(hash, std::llround(distance_m / step_m));
        }
        if (moved) hashes.push_back(hash);
    }
    return hashes;
}

/// A position in metres; `scale` is that of a degree of longitude to one of latitude.
std::complex<double> metres_of(const Observation& row, double scale) {
    constexpr double metres_per_degree = 111'320.0;
    if (!row.latitude_deg) return {row.plane_east_m.value_or(0.0), row.plane_north_m.value_or(0.0)};
    return metres_per_degree *
           std::complex(scale * row.longitude_deg.value_or(0.0), *row.latitude_deg);
}

std::string listed_shortly(const std::vector<std::string>& ids) {
    const std::size_t shown = std::min(ids.size(), named_at_most);
    return fmt::format("{}{}", fmt::join(ids.begin(), ids.begin() + std::ptrdiff_t(shown), ", "),
                       ids.size() > shown ? fmt::format(" and {} more", ids.size() - shown) : "");
}

}  // namespace

void SharedRecordings::add(std::uint32_t attempt, OpenTable<Observations> table) {
    std::string files;
    for (const InputFile& input : table.head.header.inputs)
        if (input.role == "recording") files += input.sha256 + " ";
    const auto known = std::ranges::find(recordings_, files, &Recording::files);
    if (known != recordings_.end()) {
        known->attempts.push_back(attempt);
        return;
    }
    const auto recording = static_cast<std::uint32_t>(recordings_.size());
    recordings_.push_back({std::move(files), {attempt}});
    const RecordingFacts& facts = table.head.facts;
    const bool fine = facts.position_resolution_m.value_or(0.0) <= coarsest_m;
    std::vector<std::complex<double>> at_m;
    std::optional<double> scale;  // where the recording begins
    for (Observation row; table.rows.next(row); row = {}) {
        const std::optional<Place> place = place_of(row);
        if (!place) continue;
        if (facts.first_epoch) {
            const GpsTime time = facts.first_epoch->plus_nanoseconds(row.time.nanoseconds);
            epochs_.push_back(
                {mixed(place->hash(), (time.nanoseconds() + 500'000) / 1'000'000), recording});
        }
        if (!scale) scale = std::cos(row.latitude_deg.value_or(0.0) * std::numbers::pi / 180.0);
        if (fine) at_m.push_back(metres_of(row, *scale));
    }
    const double in_a_second = std::round(1.0 / std::max(1e-3, facts.nominal_interval_s));
    for (const std::uint64_t hash :
         motions_in(at_m, static_cast<std::size_t>(std::max(1.0, in_a_second))))
        motions_.push_back({hash, recording});
}

/// How many entries each attempt has in common with each other one.
SharedRecordings::Shared SharedRecordings::shared_by(std::vector<Entry>& entries) const {
    std::ranges::sort(entries);
    entries.erase(std::unique(entries.begin(), entries.end()), entries.end());
    Shared recordings;
    for (std::size_t first = 0, last = 0; first < entries.size(); first = last) {
        while (last < entries.size() && entries[last].what == entries[first].what)
            ++last;
        for (std::size_t a = first; a < last; ++a)
            for (std::size_t b = first; b < last; ++b)
                if (a != b) ++recordings[entries[a].recording][entries[b].recording];
    }
    Shared attempts;
    for (const auto& [a, others] : recordings)
        for (const auto& [b, count] : others)
            for (const std::uint32_t one : recordings_[a].attempts)
                for (const std::uint32_t other : recordings_[b].attempts)
                    attempts[one][other] = std::max(attempts[one][other], count);
    return attempts;
}

void SharedRecordings::note(std::vector<AttemptResult>& attempts) {
    Shared files, epochs = shared_by(epochs_), motions = shared_by(motions_);
    for (const Recording& recording : recordings_)
        for (const std::uint32_t one : recording.attempts)
            for (const std::uint32_t other : recording.attempts)
                files[one][other] = 1;
    for (std::uint32_t attempt = 0; attempt < attempts.size(); ++attempt) {
        std::set<std::uint32_t> named{attempt};
        // Says of those that share enough what it is, and of each once.
        const auto say = [&](const auto& others, std::int64_t enough, const char* words) {
            std::vector<std::string> ids;
            std::int64_t most = 0;
            for (const auto& [other, count] : others) {
                if (count < enough || !named.insert(other).second) continue;
                ids.push_back(attempts[other].id);
                most = std::max(most, count);
            }
            if (ids.empty()) return;
            attempts[attempt].notes.push_back(fmt::format(
                fmt::runtime(words), fmt::arg("ids", listed_shortly(ids)), fmt::arg("most", most)));
        };
        say(files[attempt], 1, "It rests on the same recording, byte for byte, as {ids}.");
        say(epochs[attempt], rows_of_an_overlap,
            "Its recording overlaps that of {ids}: up to {most} epochs have the same time and "
            "position.");
        say(motions[attempt], rows_of_an_overlap,
            "Its recording repeats that of {ids}, at other times, elsewhere, turned or without a "
            "date: up to {most} stretches of 20 s have the same distances.");
    }
}

}  // namespace runcert
