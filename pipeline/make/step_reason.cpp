#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <csignal>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "core/text.h"
#include "make/run_record.h"
#include "run/chain.h"

namespace runcert {
namespace {

using Json = nlohmann::ordered_json;
using Hashes = std::map<std::string, std::string>;

constexpr std::size_t most_named = 3;

/// Keys whose values differ, in the order of the keys.
std::vector<std::string> different_keys(const Hashes& a, const Hashes& b) {
    std::set<std::string> keys;
    for (const Hashes* hashes : {&a, &b})
        for (const auto& [key, hash] : *hashes)
            keys.insert(key);
    std::vector<std::string> different;
    for (const std::string& key : keys) {
        const auto in_a = a.find(key);
        const auto in_b = b.find(key);
        if (in_a == a.end() || in_b == b.end() || in_a->second != in_b->second)
            different.push_back(key);
    }
    return different;
}

std::string first_names(std::vector<std::string> names) {
    const std::size_t more = names.size() > most_named ? names.size() - most_named : 0;
    names.resize(names.size() - more);
    return fmt::format("{}{}", fmt::join(names, ", "),
                       more > 0 ? fmt::format(" and {} more", more) : "");
}

std::string value_text(const Json& value) {
    constexpr std::size_t longest = 60;
    return value.is_null()
               ? "nothing"
               : escape_for_message(value.dump(-1, ' ', false, Json::error_handler_t::replace),
                                    longest);
}

/// Whether two values are written the same way: 2 and 2.0 are one number, but a step prints a
/// parameter as it is written.
bool same_text(const Json& a, const Json& b) {
    const auto text = [](const Json& value) {
        return value.dump(-1, ' ', false, Json::error_handler_t::replace);
    };
    return text(a) == text(b);
}

/// "/parameters/seed" as people write it: "parameters.seed".
std::string dotted(const std::string& pointer) {
    std::string text = pointer.substr(pointer.empty() ? 0 : 1);
    for (char& c : text)
        if (c == '/') c = '.';
    return text;
}

/// Values in which two settings differ: "parameters.seed 1 -> 2".
std::vector<std::string> different_settings(const Json& a, const Json& b) {
    const Json flat_a = a.flatten();
    const Json flat_b = b.flatten();
    std::vector<std::string> different;
    for (const auto& [pointer, value] : flat_a.items())
        if (const Json other = flat_b.value(pointer, Json()); !same_text(other, value))
            different.push_back(
                fmt::format("{} {} -> {}", dotted(pointer), value_text(value), value_text(other)));
    for (const auto& [pointer, value] : flat_b.items())
        if (!flat_a.contains(pointer))
            different.push_back(
                fmt::format("{} nothing -> {}", dotted(pointer), value_text(value)));
    return different;
}

std::string how_it_ended(const ProcessResult& result, std::chrono::milliseconds time_limit) {
    if (result.end == ProcessEnd::over_time)
        return fmt::format("did not end within {:g} s, and was ended",
                           std::chrono::duration<double>(time_limit).count());
    if (result.end == ProcessEnd::over_output)
        return fmt::format("wrote more than {} MiB of messages, and was ended",
                           most_output_of_step >> 20);
    if (result.end == ProcessEnd::by_signal)
        return fmt::format("was ended by signal {} ({})", result.signal, strsignal(result.signal));
    return fmt::format("ended with status {}", result.exit_status);
}

std::string remedy_for(const ProcessResult& result) {
    if (result.end == ProcessEnd::over_time)
        return "Give it more time with --time-limit, or cut the recording down to the run";
    if (result.end == ProcessEnd::by_signal && result.signal == SIGKILL)
        return "Where memory ran out, use fewer --jobs; run the batch again";
    return "This is a fault of the program; please report it with the attempt. Run the batch again "
           "to try it once more";
}

}  // namespace

std::string what_changed(const StepRecord& before, const StepRecord& now) {
    if (before.programs != now.programs)
        return "program changed: " + first_names(different_keys(before.programs, now.programs));
    if (!same_text(before.settings, now.settings))
        return "parameters: " + first_names(different_settings(before.settings, now.settings));
    if (before.inputs != now.inputs)
        return "input changed: " + first_names(different_keys(before.inputs, now.inputs));
    return {};
}

RunFailure failure_of_program(const std::string& step, const ProcessResult& result,
                              std::chrono::milliseconds time_limit) {
    const std::string& errors = result.errors;
    if (result.end == ProcessEnd::by_itself && result.exit_status == 2)
        if (const auto words = own_words(errors); !words.empty())
            return {.step = step, .problem = words[0], .where = words[1], .remedy = words[2]};
    const std::string said = errors.empty() ? "" : ": " + escape_for_message(errors, 400);
    return {.step = step,
            .problem = "the program " + how_it_ended(result, time_limit) + plain_text(said),
            .where = "the step " + step,
            .remedy = remedy_for(result)};
}

}  // namespace runcert
