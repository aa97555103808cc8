#include "stages/window/counted_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/failure.h"
#include "core/statistics.h"

namespace runcert {
namespace {

/// A usable epoch: its height as the recording counts heights, and how fast it moves upwards.
struct HeightSample {
    std::int64_t epoch = 0;
    ElapsedTime time;
    Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< east, north, up (m)
    std::optional<double> height_m;
    std::optional<double> up_m_s;
    std::optional<double> speed_m_s;  ///< smoothed, in space
};

/// The usable epochs; where none is usable, all that have a position.
std::vector<HeightSample> samples_of(const ScreenedTable& screened,
                                     const TrajectoryTable& trajectory) {
    const bool any_usable = std::ranges::any_of(screened.rows, &ScreenedEpoch::usable);
    std::optional<PlaceFrames> frames;
    if (screened.origin) frames.emplace(*screened.origin);
    std::vector<HeightSample> samples;
    for (std::size_t i = 0; i < screened.rows.size(); ++i) {
        const ScreenedEpoch& row = screened.rows[i];
        const TrajectoryEpoch& smoothed = trajectory.rows[i];
        if ((any_usable && !row.usable) || !row.east_m || !row.north_m) continue;
        HeightSample& sample = samples.emplace_back();
        sample.epoch = row.epoch;
        sample.time = row.time;
        sample.position = {*row.east_m, *row.north_m, row.up_m.value_or(0.0)};
        if (row.up_m)
            sample.height_m =
                frames ? frames->geodetic(row.time, sample.position).height_m : *row.up_m;
        if (row.recorded_velocity_up_m_s)
            sample.up_m_s = *row.recorded_velocity_up_m_s;
        else if (smoothed.velocity_up_m_s)
            sample.up_m_s = *smoothed.velocity_up_m_s;
        if (smoothed.speed_m_s)
            sample.speed_m_s =
                std::hypot(*smoothed.speed_m_s, smoothed.velocity_up_m_s.value_or(0.0));
    }
    return samples;
}

/// The height (m) of the ground: where the craft stood longest among samples, near the lowest of
/// all, as a balloon may stand, too.
std::optional<double> standing_height_m(const std::vector<HeightSample>& samples, std::size_t from,
                                        std::size_t to) {
    constexpr double standing_m_s = 1.0;     // what smoothed code positions wander by
    constexpr double least_s = 10.0;         // longer than a fall or a flare is so slow
    constexpr double above_lowest_m = 50.0;  // the ground of one drop zone, and no balloon
    double lowest_m = std::numeric_limits<double>::infinity();
    for (const HeightSample& sample : samples)
        lowest_m = std::min(lowest_m, sample.height_m.value_or(lowest_m));
    const auto stands = [&](const HeightSample& sample) {
        return sample.height_m && *sample.height_m <= lowest_m + above_lowest_m &&
               sample.speed_m_s && *sample.speed_m_s <= standing_m_s;
    };
    double longest_s = least_s;
    std::vector<double> heights, longest;
    ElapsedTime begin;
    for (std::size_t i = from; i < to; ++i) {
        const HeightSample& sample = samples[i];
        if (!stands(sample)) {
            heights.clear();
            continue;
        }
        if (heights.empty()) begin = sample.time;
        heights.push_back(*sample.height_m);
        const double lasted_s = sample.time.seconds() - begin.seconds();
        if (lasted_s < longest_s) continue;
        longest_s = lasted_s;
        longest = heights;
    }
    if (longest.empty()) return std::nullopt;
    return median(longest);
}

/// Looks for the ends of a rule's part among the samples.
class PartSearch {
  public:
    PartSearch(const std::vector<HeightSample>& samples, const RecordingFacts& facts,
               const PartStatements& stated, const std::optional<SurveyedCourse>& gates,
               const std::string& profile)
        : samples_(samples), facts_(facts), stated_(stated), gates_(gates), profile_(profile) {}

    WindowPart find(const RulePart& rule, double duration_s, const ScreenedTable& screened) {
        const bool counts_heights =
            is_above_ground(rule.from) || std::ranges::any_of(rule.to, is_above_ground);
        if (is_above_ground(rule.from)) set_ground(0);
        const auto from = sample_at(rule.from, 0, true);
        if (from) {
            part_.from = found(rule.from.event, *from);
            if (counts_heights || rule.from.event == WindowEvent::exit) set_ground(*from);
            find_end(rule, *from);
            if (rule.validation_m) validate(*rule.validation_m, duration_s, screened);
        }
        if (counts_heights && !part_.ground_height_m)
            miss(
                "nothing tells how high the ground lies: the attempt does not state "
                "ground_height_m, and the craft stood nowhere in the recording");
        return part_;
    }

  private:
    static bool is_above_ground(const PartEnd& end) {
        return end.event == WindowEvent::above_ground;
    }

    /// The first of the rule's ends that the recording reaches.
    void find_end(const RulePart& rule, std::size_t from) {
        std::optional<std::size_t> to;
        for (const PartEnd& end : rule.to) {
            const auto one = sample_at(end, from, false);
            if (!one || *one < from || (to && *one >= *to)) continue;
            to = one;
            part_.to = found(end.event, *one);
        }
        if (!to)
            for (std::string& sentence : not_reached_)
                miss(std::move(sentence));
    }

    FoundEvent found(WindowEvent event, std::size_t i) const {
        return {.event = event,
                .time_s = samples_[i].time.seconds(),
                .epoch = samples_[i].epoch,
                .height_m = samples_[i].height_m};
    }

    void miss(std::string sentence) { part_.missing.push_back(std::move(sentence)); }

    void set_ground(std::size_t from) {
        part_.ground_height_m = stated_.ground_height_m;
        part_.ground = GroundSource::attempt;
        if (part_.ground_height_m) return;
        part_.ground_height_m = standing_height_m(samples_, from, samples_.size());
        if (!part_.ground_height_m) part_.ground_height_m = standing_height_m(samples_, 0, from);
        part_.ground = GroundSource::recording;
        if (!part_.ground_height_m) part_.ground = std::nullopt;
    }

    std::optional<std::size_t> exit(double speed_m_s) {
        const auto highest = std::ranges::max_element(
            samples_, {}, [](const HeightSample& one) { return one.height_m.value_or(-1e9); });
        if (highest == samples_.end() || !highest->height_m) {
            miss("no exit can be found, because the recording has no heights");
            return std::nullopt;
        }
        for (auto one = highest; one != samples_.end(); ++one)
            if (one->up_m_s && -*one->up_m_s >= speed_m_s)
                return static_cast<std::size_t>(one - samples_.begin());
        miss(
            fmt::format("no exit was found: after its highest point, {:.0f} m, the recording "
                        "nowhere falls by {:g} m/s",
                        *highest->height_m, speed_m_s));
        return std::nullopt;
    }

    /// The last sample that is not yet lower. Where the part begins, it may be the first of all.
    std::optional<std::size_t> above(double height_m, std::size_t from, const std::string& what) {
        for (std::size_t i = from; i < samples_.size(); ++i)
            if (samples_[i].height_m && *samples_[i].height_m < height_m)
                return i > from ? i - 1 : from;
        not_reached_.push_back(fmt::format("the recording ends before it is lower than {}", what));
        return std::nullopt;
    }

    /// The first sample from a time on, or the last up to it.
    std::optional<std::size_t> at(ElapsedTime time, bool begins, const std::string& what) {
        const auto after = std::ranges::lower_bound(samples_, time, {}, &HeightSample::time);
        const auto i = after - samples_.begin();
        if (begins && after != samples_.end()) return static_cast<std::size_t>(i);
        if (!begins && after != samples_.end() && after->time == time)
            return static_cast<std::size_t>(i);
        if (!begins && i > 0) return static_cast<std::size_t>(i - 1);
        miss(fmt::format("the recording does not reach {}", what));
        return std::nullopt;
    }

    std::optional<std::size_t> stated_instant(bool begins) {
        if (!stated_.part)
            throw Failure("attempt",
                          fmt::format("the rule {} counts a part of the recording that the attempt "
                                      "does not state",
                                      profile_),
                          "Add part: {from_utc, to_utc, source}");
        if (!facts_.first_epoch) {
            miss(
                "the part that the attempt states has no place in a recording whose time is "
                "relative: give the receiver start_gps");
            return std::nullopt;
        }
        const GpsTime instant = begins ? stated_.part->from : stated_.part->to;
        return at(
            {instant.nanoseconds() - facts_.first_epoch->nanoseconds()}, begins,
            begins ? "the beginning that the attempt states" : "the end that the attempt states");
    }

    /// The first forward crossing of a line of the course, from a sample on.
    std::optional<std::size_t> crossing(bool first_line, std::size_t from, bool begins) {
        if (!gates_)
            throw Failure("attempt", fmt::format("the rule {} needs a course", profile_),
                          "Add course: with its two lines");
        SampleSeries track;
        for (std::size_t i = from; i < samples_.size(); ++i) {
            track.times.push_back(samples_[i].time);
            track.positions.push_back(samples_[i].position);
        }
        if (!track.times.empty())
            for (const Crossing& one :
                 crossings({track}, first_line ? gates_->start : gates_->finish))
                if (one.forward) return at(one.time, begins, "the course");
        miss(fmt::format("the track nowhere crosses the course's {} line in its direction",
                         first_line ? "first" : "second"));
        return std::nullopt;
    }

    std::optional<std::size_t> sample_at(const PartEnd& end, std::size_t from, bool begins) {
        switch (end.event) {
            case WindowEvent::exit:
                return exit(end.speed_m_s);
            case WindowEvent::below_start: {
                if (!part_.from->height_m) {
                    miss("the part begins where no height was recorded");
                    return std::nullopt;
                }
                return above(*part_.from->height_m - *end.height_m, from,
                             fmt::format("{:g} m below where its part begins", *end.height_m));
            }
            case WindowEvent::above_ground:
                if (!part_.ground_height_m) return std::nullopt;
                return above(*part_.ground_height_m + *end.height_m, from,
                             fmt::format("{:g} m above the ground", *end.height_m));
            case WindowEvent::at_height:
                return above(*end.height_m, from, fmt::format("{:g} m", *end.height_m));
            case WindowEvent::course_start:
                return crossing(true, from, begins);
            case WindowEvent::course_finish:
                return crossing(false, from, begins);
            case WindowEvent::stated:
                return stated_instant(begins);
        }
        return std::nullopt;
    }

    /// The samples of the part's last `validation_m` of height, whether screening uses them or not.
    void validate(double validation_m, double duration_s, const ScreenedTable& screened) {
        const double last_s = part_.to ? part_.to->time_s : samples_.back().time.seconds();
        const auto last = std::ranges::find(
            samples_, part_.to ? part_.to->epoch : samples_.back().epoch, &HeightSample::epoch);
        if (last == samples_.end() || !last->height_m) return;
        auto first = std::ranges::find(samples_, part_.from->epoch, &HeightSample::epoch);
        for (auto one = first; one != last; ++one)
            if (one->height_m && *one->height_m > *last->height_m + validation_m) first = one + 1;
        const double from_s = first->time.seconds();
        ValidatedSamples validated{.from_s = from_s, .epochs = 0, .worst_m_s = 0.0};
        for (const ScreenedEpoch& row : screened.rows) {
            if (row.time.seconds() < from_s || row.time.seconds() > last_s) continue;
            ++validated.epochs;
            if (!row.sigma_up_m) {
                validated.worst_m_s = std::nullopt;
                validated.worst_epoch = row.epoch;
                break;
            }
            const double accuracy_m_s = std::numbers::sqrt2 * *row.sigma_up_m / duration_s;
            if (accuracy_m_s <= *validated.worst_m_s) continue;
            validated.worst_m_s = accuracy_m_s;
            validated.worst_epoch = row.epoch;
        }
        part_.validated = validated;
    }

    std::vector<std::string> not_reached_;
    const std::vector<HeightSample>& samples_;
    const RecordingFacts& facts_;
    const PartStatements& stated_;
    const std::optional<SurveyedCourse>& gates_;
    const std::string& profile_;
    WindowPart part_;
};

ElapsedTime elapsed(double seconds) {
    return {std::llround(seconds * 1e9)};
}

}  // namespace

std::optional<WindowPart> counted_part(const ScreenedTable& screened,
                                       const TrajectoryTable& trajectory, const Profile& profile,
                                       const PartStatements& stated,
                                       const std::optional<SurveyedCourse>& gates) {
    if (!profile.within) return std::nullopt;
    const std::vector<HeightSample> samples = samples_of(screened, trajectory);
    if (samples.empty()) {
        WindowPart nothing;
        nothing.missing.emplace_back("the recording has no position");
        return nothing;
    }
    return PartSearch(samples, screened.facts, stated, gates, profile.id)
        .find(*profile.within, profile.duration_s, screened);
}

bool lies_in(const std::optional<WindowPart>& part, ElapsedTime time) {
    if (!part) return true;
    if (!part->from || time < elapsed(part->from->time_s)) return false;
    return !part->to || time <= elapsed(part->to->time_s);
}

void restrict_to(const std::optional<WindowPart>& part, const std::vector<ElapsedTime>& times,
                 SampleSeries& series) {
    if (!part) return;
    if (series.bounds.empty()) series.bounds.assign(series.times.size(), true);
    for (std::size_t i = 0; i < times.size(); ++i)
        series.bounds[i] = series.bounds[i] && lies_in(part, times[i]);
}

}  // namespace runcert
