#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/prose.h"
#include "stages/check/requirements.h"

namespace runcert {
namespace {

std::string_view event_words(WindowEvent event) {
    constexpr std::pair<WindowEvent, std::string_view> words[] = {
        {WindowEvent::exit, "exit"},
        {WindowEvent::below_start, "the stated height below its beginning"},
        {WindowEvent::above_ground, "the stated height above the ground"},
        {WindowEvent::at_height, "the stated height"},
        {WindowEvent::course_start, "the course's first line"},
        {WindowEvent::course_finish, "the course's second line"},
        {WindowEvent::stated, "the stated instant"}};
    return std::ranges::find(words, event, &std::pair<WindowEvent, std::string_view>::first)
        ->second;
}

std::string end_text(const FoundEvent& end, const ClauseContext& context) {
    const ElapsedTime time{std::llround(end.time_s * 1e9)};
    return fmt::format("{} (epoch {}{}, {})", event_words(end.event), end.epoch,
                       end.height_m ? fmt::format(", {:.0f} m", *end.height_m) : std::string(),
                       instant_text(context.input.judged.facts.first_epoch, time));
}

std::string ground_text(const WindowPart& part) {
    if (!part.ground_height_m) return {};
    return fmt::format("ground at {:.0f} m by {}", *part.ground_height_m,
                       part.ground == GroundSource::attempt ? "the attempt" : "the recording");
}

}  // namespace

Finding computation::counted_part(const Clause&, const ClauseContext& context) {
    const auto& part = context.windows.part;
    if (!part) return unknown("no part of the recording was looked for");
    if (!part->from) return not_met("{}", fmt::join(part->missing, "; "));
    std::string evidence = fmt::format(
        "it begins at {} and ends at {}", end_text(*part->from, context),
        part->to ? end_text(*part->to, context) : std::string("the end of the recording"));
    if (const std::string ground = ground_text(*part); !ground.empty()) evidence += "; " + ground;
    for (const std::string& missing : part->missing)
        evidence += "; " + missing;
    const bool whole = part->to && part->missing.empty();
    return {whole ? RequirementStatus::met : RequirementStatus::attest, std::move(evidence)};
}

Finding computation::start_height(const Clause& clause, const ClauseContext& context) {
    const auto& part = context.windows.part;
    if (!part || !part->from) return unknown("where the part that counts begins was not found");
    if (!part->from->height_m) return unknown("no height was recorded where the part begins");
    if (!part->ground_height_m)
        return unknown(
            "it begins at {:.0f} m as recorded, and nothing tells how high the ground lies",
            *part->from->height_m);
    return against_limit({.name = "height above the ground where the part begins",
                          .value = *part->from->height_m - *part->ground_height_m,
                          .note = ground_text(*part)},
                         clause);
}

Finding computation::validation_accuracy(const Clause& clause, const ClauseContext& context) {
    const auto& part = context.windows.part;
    if (!part || !part->validated) return unknown("the samples to be validated were not found");
    const ValidatedSamples& samples = *part->validated;
    const std::int64_t worst = samples.worst_epoch.value_or(0);
    if (!samples.worst_m_s)
        return unknown("epoch {} does not state how accurate its height is", worst);
    return against_limit(
        {.name = "worst accuracy of a sample in the validation window",
         .value = *samples.worst_m_s,
         .note = fmt::format("epoch {} of {}", worst, counted(samples.epochs, "sample"))},
        clause);
}

}  // namespace runcert
