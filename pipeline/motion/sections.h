#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "motion/kalman.h"

namespace runcert {

/// A section of a stretch: the epochs that it tests or smooths, and the neighbouring epochs
/// included because they affect these.
struct ArcSection {
    std::size_t first = 0;  ///< decides epochs first to end - 1
    std::size_t end = 0;
    std::size_t used_first = 0;  ///< includes these; the first and the last have a measurement
    std::size_t used_end = 0;
};

/// Longer stretches are tested in sections of this many epochs, to bound the memory (about 2 kB per
/// epoch).
inline constexpr std::size_t epochs_of_section = 200'000;

/// The sections of a stretch that begins and ends with a measurement. A stretch up to one and a
/// half times `section_epochs` is a single section. Each section includes what lies within
/// `memory_s` of its own epochs, and at least as many epochs as the local medians and spans use. It
/// begins at a multiple of ten, as the local medians do.
template <int Axes>
std::vector<ArcSection> sections_of(std::span<const ArcEpoch<Axes>> epochs, double memory_s,
                                    std::size_t section_epochs);

}  // namespace runcert
