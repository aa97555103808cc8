#include "reports/words/inputs.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <string_view>

#include "core/prose.h"

namespace runcert {
namespace {

/// Inputs of one part of the attempt that are answered for in the same clauses.
struct Group {
    std::string part;  ///< "course", "receivers.primary"
    std::vector<std::string> clauses;
    std::vector<const VerdictInput*> inputs;
};

/// Without its last key.
std::string part_of(const std::string& name) {
    const std::size_t point = name.rfind('.');
    return point == std::string::npos ? name : name.substr(0, point);
}

/// The part that several inputs share: the shorter name where one holds the other.
bool is_within(const std::string& part, const std::string& other) {
    return part == other || part.starts_with(other + ".") || other.starts_with(part + ".");
}

std::vector<Group> groups_of(const std::vector<VerdictInput>& inputs, InputOrigin origin) {
    std::vector<Group> groups;
    for (const VerdictInput& input : inputs) {
        if (input.origin != origin) continue;
        const std::string part = part_of(input.name);
        if (!groups.empty() && groups.back().clauses == input.clauses &&
            is_within(part, groups.back().part)) {
            if (part.size() < groups.back().part.size()) groups.back().part = part;
            groups.back().inputs.push_back(&input);
        } else {
            groups.push_back({.part = part, .clauses = input.clauses, .inputs = {&input}});
        }
    }
    return groups;
}

std::string group_text(const Group& group) {
    constexpr std::size_t each_by_itself = 3;
    std::vector<std::string> said;
    if (group.inputs.size() > each_by_itself)
        said.push_back(
            fmt::format("{} ({})", group.part, counted(std::ssize(group.inputs), "figure")));
    else
        for (const VerdictInput* const one : group.inputs)
            said.push_back(fmt::format("{}: {}", one->name, one->value));
    return fmt::format("{}{}", fmt::join(said, ", "),
                       group.clauses.empty()
                           ? std::string(" (no rule looks at it)")
                           : fmt::format(" [{}]", fmt::join(group.clauses, ", ")));
}

}  // namespace

std::vector<InputsOfOrigin> inputs_by_origin(const std::vector<VerdictInput>& inputs) {
    constexpr std::array<std::pair<InputOrigin, std::string_view>, 3> labels{
        {{InputOrigin::observed, "Observed"},
         {InputOrigin::handed_in, "Handed in"},
         {InputOrigin::claimed, "Claimed"}}};
    std::vector<InputsOfOrigin> said;
    for (const auto& [origin, label] : labels) {
        std::vector<std::string> texts;
        for (const Group& group : groups_of(inputs, origin))
            texts.push_back(group_text(group));
        if (!texts.empty())
            said.push_back({std::string(label), fmt::format("{}", fmt::join(texts, "; "))});
    }
    return said;
}

}  // namespace runcert
