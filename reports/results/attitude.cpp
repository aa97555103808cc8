#include <fmt/format.h>

#include "core/prose.h"
#include "core/rounding.h"
#include "core/text.h"
#include "reports/results/results.h"

namespace runcert {
std::vector<Block> attitude_facts(const AttitudeTable& attitude) {
    const InertialConsistency& found = attitude.consistency;
    const bool agree = found.standing == InertialStanding::consistent;
    Block list = facts({});
    add_fact(list, "Agreement",
             agree ? std::string(words_of(found.standing))
                   : found.reason + " Nothing rests on this solution.");
    add_fact(list, "Positions that took part", counted(found.epochs));
    if (found.epochs > 0) {
        add_fact(list, "Normalised innovations",
                 fmt::format("mean square {}, 0.3 to 2 is accepted; {} % beyond the 99.9 % point",
                             format_fixed(found.normalised_innovations, 2),
                             format_fixed(100.0 * found.beyond_share, 1)));
        add_fact(list, "Start of the attitude", std::string(words_of(found.start)));
    }
    add_fact(list, "Added to the IMU's times",
             fmt::format("{} s, {} s stated", format_fixed(attitude.time_offset.used_s, 4),
                         format_fixed(attitude.time_offset.declared_s, 4)));
    const EstimatedArm& arm = attitude.antenna;
    add_fact(list, "From the IMU to the antenna",
             arm_text(arm.declared) + (arm.used == arm.declared ? "" : ", stated and not used"));
    if (arm.estimated && arm.sigma)
        add_fact(list, "The same as the motion shows it",
                 arm_text(*arm.estimated, arm.sigma) +
                     (arm.used == arm.declared ? "" : "; the solution rests on it"));
    add_fact(list, "Stretches that only the IMU bridges", counted(std::ssize(attitude.bridged)));
    std::vector<Block> blocks{std::move(list)};
    if (!attitude.mount.judgement.empty()) blocks.push_back(paragraph(attitude.mount.judgement));
    if (attitude.baseline) blocks.push_back(paragraph(attitude.baseline->judgement));
    if (!attitude.notes.empty()) blocks.push_back(list_of(attitude.notes));
    return blocks;
}

}  // namespace runcert
