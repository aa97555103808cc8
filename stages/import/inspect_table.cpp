#include "stages/import/inspect_table.h"

#include <fmt/format.h>

#include "core/failure.h"
#include "core/plain_text.h"
#include "core/text.h"
#include "stages/import/csv/propose.h"
#include "stages/import/csv/unit.h"
#include "stages/import/import.h"
#include "stages/import/inspect.h"
#include "stages/import/written_by.h"

namespace runcert {
namespace {

/// Reads the recording as it is proposed. A speed unit that nobody names is the one by which the
/// fastest speed recorded is that of the positions.
Inspection read_as(csv::Proposal& proposal, const RecordingBytes& recording) {
    const auto read = [&] {
        Observations observations = import_recording(proposal.receiver, recording);
        note_written_by(recording, false, observations);
        return inspect(observations);
    };
    const Inspection first = read();
    if (!proposal.speed_unit_unknown || !first.best_by_position || !first.best_by_velocity)
        return first;
    const auto unit = csv::speed_unit_of_ratio(first.best_by_velocity->speed_m_s /
                                               first.best_by_position->speed_m_s);
    if (!unit) {
        proposal.unsure.emplace_back(
            "The unit of speeds is not named, and none fits the positions: write speed_unit.");
        return first;
    }
    proposal.receiver.speed_unit = unit->name;
    proposal.unsure.push_back(
        fmt::format("The unit of speeds is not named: {} fits the positions.", unit->name));
    return read();
}

std::string read_text(csv::Proposal& proposal, const RecordingBytes& recording) {
    for (const std::string& key : proposal.missing)
        proposal.unsure.push_back(
            fmt::format("No column's name says which holds the {}: write it in place of ...", key));
    if (!proposal.missing.empty()) return {};
    try {
        return "\nSo described:\n" + inspection_text(read_as(proposal, recording), recording.name);
    } catch (const Failure& failure) {
        proposal.unsure.push_back(fmt::format("So described, it cannot be read. {}: {}. {}",
                                              failure.where(), failure.problem(),
                                              failure.remedy()));
        return {};
    }
}

}  // namespace

std::optional<std::string> table_text(const RecordingBytes& recording) {
    auto proposal = csv::propose(recording);
    if (!proposal) return std::nullopt;
    proposal->receiver.id = "inspected";
    proposal->receiver.place = recording.name;
    const std::string read = read_text(*proposal, recording);
    std::string text =
        fmt::format("{}: a table that no format recognises. An attempt's receiver may say:\n\n",
                    plain_text(recording.name));
    const std::string lines = proposal->yaml();
    for (std::size_t at = 0; at < lines.size();) {
        const std::size_t end = lines.find('\n', at);
        text += "    " + lines.substr(at, end + 1 - at);
        at = end + 1;
    }
    text += fmt::format("\n  {:<10}{}\n", "First row", plain_text(proposal->first_row));
    for (const std::string& unsure : proposal->unsure)
        text += "  - " + plain_text(unsure) + "\n";
    return text + read;
}

}  // namespace runcert
