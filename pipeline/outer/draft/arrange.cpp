#include "draft/arrange.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "core/failure.h"
#include "core/geodesy.h"
#include "core/prose.h"
#include "core/text.h"

namespace runcert {
namespace {

constexpr double one_day_s = 86'400.0;
/// Receivers on one craft begin to record so near to each other; another craft may, too.
constexpr double same_place_m = 5000.0;

std::string name_of_file(const HandedIn& file) {
    return plain_text(std::filesystem::path(file.path).filename().string());
}

bool has_base_name(const HandedIn& file) {
    const std::string name = lower_case(std::filesystem::path(file.path).filename().string());
    constexpr std::array<std::string_view, 4> words{"base", "master", "reference", "station"};
    return std::ranges::any_of(words,
                               [&](std::string_view word) { return name.find(word) != name.npos; });
}

bool overlap(const Recognition& a, const Recognition& b) {
    return *a.first < *b.last && *b.first < *a.last;
}

/// From the end of the earlier to the beginning of the later.
double pause_s(const Recognition& a, const Recognition& b) {
    return *a.first < *b.first ? b.first->seconds_since(*a.last) : a.first->seconds_since(*b.last);
}

/// Between the first positions; nothing where one has no place on the Earth.
std::optional<double> distance_m(const Recognition& a, const Recognition& b) {
    const auto point = [](const Recognition& of) {
        return ecef_from_geodetic({.latitude = Angle::from_degrees(*of.latitude_deg),
                                   .longitude = Angle::from_degrees(*of.longitude_deg),
                                   .height_m = 0.0})
            .m;
    };
    if (!a.latitude_deg || !b.latitude_deg || !a.longitude_deg || !b.longitude_deg)
        return std::nullopt;
    return (point(a) - point(b)).norm();
}

class Arranging {
  public:
    explicit Arranging(const std::vector<HandedIn>& files) : files_(files) {}

    Arrangement made() {
        std::vector<std::size_t> positions, signals;
        for (std::size_t i = 0; i < files_.size(); ++i) {
            if (files_[i].is.kind == RecordingKind::positions)
                positions.push_back(i);
            else if (files_[i].is.kind == RecordingKind::signals)
                signals.push_back(i);
            else if (files_[i].is.kind == RecordingKind::series)
                take_series(i);
            else if (files_[i].is.kind == RecordingKind::imu)
                imus_.push_back(i);
            else if (files_[i].is.kind == RecordingKind::surface)
                surfaces_.push_back(i);
            else if (files_[i].is.kind == RecordingKind::triangles)
                triangles_.push_back(i);
            else
                orbits_.push_back(i);
        }
        if (positions.empty() && signals.empty()) refuse_no_recording();
        if (positions.empty())
            arrange_signals(signals);
        else
            arrange_positions(positions, signals);
        take_imus();
        take_surfaces();
        return std::move(result_);
    }

  private:
    void say(std::string sentence) { result_.said.push_back(std::move(sentence)); }

    [[noreturn]] void refuse_no_recording() const {
        const bool ground = !surfaces_.empty() || !triangles_.empty();
        const char* const held = !imus_.empty()    ? "the samples of an IMU"
                                 : ground          ? "the surface of a course"
                                 : orbits_.empty() ? "a series"
                                                   : "orbits";
        throw Failure(files_.front().path, fmt::format("the file holds {}, and no recording", held),
                      !orbits_.empty() ? "Name the rover's recording, too: runcert new ROVER.obs "
                                         "BASE.obs ORBITS"
                      : ground && imus_.empty()
                          ? "Name the recording of a run over it, too"
                          : "Name the recording that it bears witness of, too");
    }

    /// Wind and current have the same columns, and are told by the file's name.
    void take_series(std::size_t file) {
        const std::vector<std::string>& keys = files_[file].is.series;
        const std::string name = lower_case(name_of_file(files_[file]));
        const auto named = std::ranges::find_if(
            keys, [&](const std::string& key) { return name.find(key) != std::string::npos; });
        const std::string key = named != keys.end() ? *named : keys.front();
        if (!result_.series.emplace(key, file).second)
            throw Failure(files_[file].path,
                          fmt::format("this is a second series for the key {}", key),
                          "Name one of them");
        say(fmt::format("{} is the series of the key {}, by its {}.", name_of_file(files_[file]),
                        key,
                        keys.size() == 1      ? "columns"
                        : named != keys.end() ? "columns and name"
                                              : "columns; it might be another of " + listed(keys)));
    }

    void take_imus() {
        for (std::size_t k = 0; k < imus_.size(); ++k) {
            const std::string name = name_of_file(files_[imus_[k]]);
            if (k > 0) {
                say(fmt::format("{} is left out: one IMU is used.", name));
                continue;
            }
            result_.receivers.front().imu = imus_[k];
            say(
                fmt::format("{} holds the samples of an IMU. It is taken for one on the craft of "
                            "the {} receiver.",
                            name, result_.receivers.front().id));
        }
    }

    /// A file without triangles is the table of the vertices.
    void take_surfaces() {
        for (std::size_t k = 1; k < surfaces_.size(); ++k)
            say(fmt::format("{} is left out: one surface is used.",
                            name_of_file(files_[surfaces_[k]])));
        if (surfaces_.empty() && triangles_.empty()) return;
        if (surfaces_.empty())
            throw Failure(files_[triangles_.front()].path,
                          "the triangles of a surface are named without its vertices",
                          "Name the table of the vertices, too: vertex,x,y,z");
        const HandedIn& file = files_[surfaces_.front()];
        if (!file.is.problem.empty())
            throw Failure(file.path, "the surface has points, and no triangles",
                          "Export it with its faces; points alone do not say what lies between "
                          "them");
        ArrangedReceiver& receiver = result_.receivers.front();
        receiver.surface = surfaces_.front();
        say(
            fmt::format("{} holds the surface of a course. It is taken for the one that the craft "
                        "of the {} receiver ran on.",
                        name_of_file(file), receiver.id));
        const std::size_t used = file.is.triangles > 0 ? 0 : 1;
        for (std::size_t k = used; k < triangles_.size(); ++k)
            say(fmt::format("{} is left out: the surface has triangles already.",
                            name_of_file(files_[triangles_[k]])));
        if (used == 0) return;
        if (triangles_.empty())
            throw Failure(file.path, "the vertices of a surface are named without its triangles",
                          "Name the table of the triangles, too: vertex_1,vertex_2,vertex_3");
        receiver.triangles = triangles_.front();
        say(fmt::format("{} holds its triangles.", name_of_file(files_[triangles_.front()])));
    }

    void take_orbits(ArrangedReceiver& receiver) {
        receiver.navigation = orbits_;
        for (const std::size_t i : orbits_)
            say(fmt::format("{} holds the satellites' orbits.", name_of_file(files_[i])));
    }

    /// A rover, and a base where a second one is given.
    void arrange_signals(const std::vector<std::size_t>& signals) {
        if (signals.size() > 2)
            throw Failure(files_[signals[2]].path,
                          "this is a third file of raw signals; an attempt has one of the rover "
                          "and one of the base",
                          "Name two of them");
        ArrangedReceiver receiver{.id = "primary", .recordings = {signals.front()}};
        if (signals.size() == 2) {
            const bool swapped =
                has_base_name(files_[signals[0]]) && !has_base_name(files_[signals[1]]);
            receiver.recordings = {signals[swapped ? 1 : 0]};
            receiver.base = signals[swapped ? 0 : 1];
            say(fmt::format("{} is taken for the base station, {}.",
                            name_of_file(files_[*receiver.base]),
                            has_base_name(files_[*receiver.base]) ? "by its name"
                                                                  : "as the second file named"));
        }
        take_orbits(receiver);
        result_.receivers.push_back(std::move(receiver));
    }

    void require_times(const std::vector<std::size_t>& positions) const {
        for (const std::size_t i : positions)
            if (!files_[i].is.first || !files_[i].is.last)
                throw Failure(files_[i].path,
                              "this file has no times of its own, so that what it is beside the "
                              "others cannot be told",
                              fmt::format("Make an attempt of it alone: runcert new {}",
                                          shell_word(plain_text(files_[i].path))));
    }

    void arrange_positions(std::vector<std::size_t> positions,
                           const std::vector<std::size_t>& signals) {
        if (positions.size() > 1) require_times(positions);
        std::stable_sort(positions.begin(), positions.end(), [&](std::size_t a, std::size_t b) {
            return files_[a].is.first < files_[b].is.first;
        });
        for (const std::size_t i : positions)
            place(i);
        // The receiver of the file that was named first is the one that is judged.
        std::stable_sort(groups_.begin(), groups_.end(), [](const auto& a, const auto& b) {
            return std::ranges::min(a.recordings) < std::ranges::min(b.recordings);
        });
        take_signals_behind();
        for (std::size_t i = 0; i < groups_.size(); ++i)
            take_group(i);
        if (!signals.empty()) take_signals(signals);
        for (const std::size_t i : orbits_)
            if (signals.empty())
                say(fmt::format("{} is left out: orbits are of use with raw signals alone.",
                                name_of_file(files_[i])));
    }

    /// Puts a file, which begins no earlier than those placed, to those it follows.
    void place(std::size_t file) {
        const Recognition& is = files_[file].is;
        for (ArrangedReceiver& group : groups_) {
            const Recognition& last = files_[group.recordings.back()].is;
            if (last.format != is.format || overlap(last, is)) continue;
            if (pause_s(last, is) > one_day_s) continue;
            group.recordings.push_back(file);
            return;
        }
        if (!groups_.empty()) require_same_time_and_place(file);
        groups_.push_back({.id = {}, .recordings = {file}});
    }

    /// What begins another receiver was recorded beside one that is placed.
    void require_same_time_and_place(std::size_t file) const {
        const HandedIn& it = files_[file];
        const HandedIn* beside = nullptr;
        for (const ArrangedReceiver& group : groups_)
            for (const std::size_t other : group.recordings)
                if (overlap(files_[other].is, it.is)) beside = &files_[other];
        const std::string each = fmt::format(
            "Make an attempt of each: runcert new {}, or a day of "
            "them: runcert new --day FOLDER",
            shell_word(plain_text(it.path)));
        const HandedIn& first = files_[groups_.front().recordings.front()];
        if (!beside)
            throw Failure(it.path,
                          fmt::format("this was recorded at another time than {} ({} and {} UTC)",
                                      name_of_file(first), to_utc_iso(*it.is.first, 0),
                                      to_utc_iso(*first.is.first, 0)),
                          each);
        const auto apart_m = distance_m(beside->is, it.is);
        if (apart_m && *apart_m > same_place_m)
            throw Failure(it.path,
                          fmt::format("this was recorded at the time of {}, and {} km away from it",
                                      name_of_file(*beside), format_fixed(*apart_m / 1000.0, 1)),
                          each);
    }

    /// A log with raw signals, beside a solution of the same time: what the solution was made from.
    void take_signals_behind() {
        for (ArrangedReceiver& solved : groups_) {
            if (files_[solved.recordings.front()].is.format != "rtklib-pos" || solved.phase)
                continue;
            const auto behind = std::ranges::find_if(groups_, [&](const ArrangedReceiver& other) {
                return other.recordings.size() == 1 &&
                       files_[other.recordings.front()].is.raw_signals;
            });
            if (behind == groups_.end()) continue;
            const std::size_t raw = behind->recordings.front();
            solved.phase = raw;
            say(fmt::format(
                "{} holds raw signals of the same time and place. It is taken for what "
                "{} was solved from, and bears witness by its phases.",
                name_of_file(files_[raw]), name_of_file(files_[solved.recordings.front()])));
            groups_.erase(behind);
            return;
        }
    }

    void take_group(std::size_t index) {
        ArrangedReceiver group = groups_[index];
        const std::string first = name_of_file(files_[group.recordings.front()]);
        if (index > 1) {
            say(fmt::format("{} is left out: an attempt has a primary and a secondary receiver.",
                            first));
            return;
        }
        group.id = index == 0 ? "primary" : "secondary";
        if (index == 1)
            say(
                fmt::format("{} was recorded at the same time and place: it is the secondary "
                            "receiver, which bears witness of the primary one.",
                            first));
        for (std::size_t i = 1; i < group.recordings.size(); ++i)
            say(fmt::format("{} follows {}: they are one recording.",
                            name_of_file(files_[group.recordings[i]]),
                            name_of_file(files_[group.recordings[i - 1]])));
        if (!group.phase && group.recordings.size() == 1 &&
            files_[group.recordings.front()].is.raw_signals) {
            group.phase = group.recordings.front();
            say(fmt::format("{} holds raw signals, too, whose phases bear witness.", first));
        }
        result_.receivers.push_back(std::move(group));
    }

    /// Raw signals in RINEX beside positions: those of the primary receiver.
    void take_signals(const std::vector<std::size_t>& signals) {
        ArrangedReceiver& primary = result_.receivers.front();
        primary.phase = signals.front();
        say(fmt::format(
            "{} is taken for the raw signals of the primary receiver, whose phases bear "
            "witness.",
            name_of_file(files_[signals.front()])));
        for (std::size_t i = 1; i < signals.size(); ++i)
            say(fmt::format("{} is left out: one file of raw signals is used.",
                            name_of_file(files_[signals[i]])));
        take_orbits(primary);
    }

    const std::vector<HandedIn>& files_;
    std::vector<std::size_t> orbits_, imus_, surfaces_, triangles_;
    std::vector<ArrangedReceiver> groups_;
    Arrangement result_;
};

}  // namespace

Arrangement arrange(const std::vector<HandedIn>& files) {
    return Arranging(files).made();
}

}  // namespace runcert
