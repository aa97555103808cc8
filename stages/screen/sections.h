#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "estimation/kalman.h"

namespace runcert {

/// A section of a stretch: the epochs that it is to answer for, and those that are taken in with
/// them because they count there.
struct Section {
    std::size_t first = 0;  ///< answers for epochs first to end - 1
    std::size_t end = 0;
    std::size_t taken_first = 0;  ///< takes in these; the first and the last have a measurement
    std::size_t taken_end = 0;
};

/// Longer stretches are tested in sections of so many epochs, so that memory is bounded (some
/// 2 kB an epoch).
inline constexpr std::size_t epochs_of_section = 200'000;

/// The sections of a stretch that begins and ends with a measurement: all of it in one up to one
/// and a half times `section_epochs`. Each takes in what lies within `memory_s` of its own epochs,
/// and at least as many epochs as the local medians and spans reach over, beginning with a multiple
/// of ten, as the local medians do.
template <int Axes>
std::vector<Section> sections_of(std::span<const ArcEpoch<Axes>> epochs, double memory_s,
                                 std::size_t section_epochs);

}  // namespace runcert
