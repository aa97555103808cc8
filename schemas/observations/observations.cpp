#include <fmt/format.h>
#include <fmt/ranges.h>

#include "schemas/observations/stated_covariance.h"

namespace runcert {

static_assert(sizeof(Observation) <= 208, "recordings of millions of epochs are held whole");

template <int Axes>
Eigen::Matrix<double, Axes, Axes> stated_covariance(const StatedAccuracy& accuracy) {
    const Eigen::Vector3d sigma(accuracy.sigma_east_m.value_or(0.0),
                                accuracy.sigma_north_m.value_or(0.0),
                                accuracy.sigma_up_m.value_or(0.0));
    Eigen::Matrix3d correlation = Eigen::Matrix3d::Identity();
    correlation(0, 1) = correlation(1, 0) = accuracy.correlation_east_north.value_or(0.0);
    correlation(0, 2) = correlation(2, 0) = accuracy.correlation_east_up.value_or(0.0);
    correlation(1, 2) = correlation(2, 1) = accuracy.correlation_north_up.value_or(0.0);
    const Eigen::Matrix3d covariance = sigma.asDiagonal() * correlation * sigma.asDiagonal();
    if constexpr (Axes == 1)
        return covariance.bottomRightCorner<1, 1>();
    else
        return covariance.topLeftCorner<Axes, Axes>();
}
template Eigen::Matrix<double, 1, 1> stated_covariance<1>(const StatedAccuracy&);
template Eigen::Matrix2d stated_covariance<2>(const StatedAccuracy&);
template Eigen::Matrix3d stated_covariance<3>(const StatedAccuracy&);

std::string RecordingFacts::first_epoch_utc() const {
    return first_epoch ? to_utc_iso(*first_epoch, 9) : std::string();
}

std::string SignedNavigation::text() const {
    std::string words = fmt::format("Galileo's signature (OSNMA): {}", words_of(result));
    if (!reason.empty()) words += fmt::format(" ({})", reason);
    if (test) words += "; the service says that it is in test";
    if (tags + other_tags > 0 && first && last)
        words +=
            fmt::format("; orbit and clock of {} from {} to {} GPS time, {} of {} tags",
                        fmt::join(satellites, ", "), to_iso(*first, 0),
                        to_iso(last->plus_nanoseconds(30 * GpsTime::nanoseconds_per_second), 0),
                        tags, tags + other_tags);
    if (public_key && root_time)
        words += fmt::format("; {} keys that lead to a root key of {}, under public key {}{}", keys,
                             to_iso(*root_time, 0), *public_key,
                             key_given ? " as the attempt gives it, which is to be compared with "
                                         "the published one"
                                       : "");
    return words;
}

WindowSpan window_span(const RecordingFacts& facts, std::int64_t first_epoch,
                       std::int64_t last_epoch, ElapsedTime first, ElapsedTime last) {
    WindowSpan span{.first_epoch = first_epoch,
                    .last_epoch = last_epoch,
                    .start = first,
                    .duration = {last.nanoseconds - first.nanoseconds},
                    .start_gps = std::nullopt};
    if (facts.first_epoch) span.start_gps = facts.first_epoch->plus_nanoseconds(first.nanoseconds);
    return span;
}

std::string processing_text(const Processing& processing) {
    std::string text = "solved";
    if (!processing.program.empty()) text += " by " + processing.program;
    if (!processing.files.empty())
        text += fmt::format(" from {}", fmt::join(processing.files, ", "));
    return text + ", as the recording's header says";
}

}  // namespace runcert
