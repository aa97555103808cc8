#include "draft/draft.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>

#include "core/text.h"
#include "schemas/attempt/attempt.h"
#include "schemas/recognition/proposed.h"
#include "store/yaml_output.h"

namespace runcert {

using Json = nlohmann::ordered_json;

namespace {

Json receiver_of(const ArrangedReceiver& arranged, const std::vector<HandedIn>& files) {
    const auto path = [&](std::size_t i) { return files[i].path; };
    Json receiver{{"id", arranged.id}};
    if (arranged.recordings.size() == 1) {
        receiver["recording"] = path(arranged.recordings.front());
    } else {
        for (const std::size_t i : arranged.recordings)
            receiver["recording"].push_back(path(i));
    }
    receiver.update(proposed_keys(files[arranged.recordings.front()].is));
    if (arranged.base) receiver["base"] = path(*arranged.base);
    if (arranged.phase) receiver["phase"] = path(*arranged.phase);
    if (arranged.navigation.size() == 1)
        receiver["navigation"] = path(arranged.navigation.front());
    else
        for (const std::size_t i : arranged.navigation)
            receiver["navigation"].push_back(path(i));
    if (arranged.imu) {
        receiver["imu"]["file"] = path(*arranged.imu);
        receiver.update(proposed_keys(files[*arranged.imu].is), true);
    }
    if (arranged.surface) receiver["surface"]["file"] = path(*arranged.surface);
    if (arranged.triangles) receiver["surface"]["triangles"] = path(*arranged.triangles);
    return receiver;
}

}  // namespace

std::string id_of(const std::string& path, const std::optional<GpsTime>& first) {
    constexpr std::size_t longest = 60;
    std::string id = std::filesystem::path(path).stem().string().substr(0, longest);
    std::ranges::replace_if(
        id,
        [](char c) {
            return !is_digit(c) && !(c >= 'a' && c <= 'z') && !(c >= 'A' && c <= 'Z') && c != '_';
        },
        '-');
    while (id.starts_with('-'))
        id.erase(0, 1);
    if (id.empty()) id = "attempt";
    if (!first) return id;
    std::string date;
    std::ranges::copy_if(to_utc_iso(*first, 0), std::back_inserter(date), is_digit);
    constexpr std::size_t date_length = 8, time_end = 12;
    std::string digits;
    std::ranges::copy_if(id, std::back_inserter(digits), is_digit);
    if (digits.find(date.substr(0, date_length)) == std::string::npos)
        id += "-" + date.substr(0, date_length);
    return id + "-" + date.substr(date_length, time_end - date_length);
}

Draft::Draft(std::vector<HandedIn> files, Arrangement arrangement)
    : files_(std::move(files)), arrangement_(std::move(arrangement)) {
    keys_["id"] = id_of(files_.front().path, files_.front().is.first);
    keys_["receivers"] = Json::array();
    for (const ArrangedReceiver& arranged : arrangement_.receivers)
        keys_["receivers"].push_back(receiver_of(arranged, files_));
    for (const auto& [key, file] : arrangement_.series)
        keys_[key] = {{"file", files_[file].path}};
}

Draft Draft::of_day(std::vector<HandedIn> files, const std::string& id) {
    Draft day(std::move(files), {.receivers = {{.id = "primary", .recordings = {0}}}, .said = {}});
    day.of_day_ = true;
    day.keys_["id"] = id_of(id, std::nullopt);
    // How each file is read stands with it; what is answered holds for all.
    day.keys_["receivers"] =
        Json::array({Json{{"id", "primary"}, {"recording", day.files_.front().path}}});
    return day;
}

Json* Draft::find_receiver(const std::string& id) {
    for (Json& receiver : keys_["receivers"])
        if (receiver["id"] == id) return &receiver;
    return nullptr;
}

std::vector<std::string> Draft::profiles() const {
    std::vector<std::string> all;
    if (keys_.contains("profiles"))
        for (const Json& one : keys_["profiles"])
            for (const std::string& profile : claimed_by(one.get<std::string>()))
                all.push_back(profile_name(profile));
    return all;
}

Json Draft::receiver(const std::string& id) const {
    for (const Json& receiver : keys_["receivers"])
        if (receiver["id"] == id) return reading_of({yaml_node_of(receiver), "receiver"});
    return Json::object();
}

const std::vector<std::string>& Draft::take_proposals() {
    for (bool taken = true; taken;) {
        taken = false;
        for (const Gap& gap : gaps()) {
            if (gap.proposal.empty()) continue;
            set(gap.key, gap.proposal);
            taken_.push_back(fmt::format("{}: {}. {}", gap.key, gap.proposal, gap.why));
            taken = true;
            break;
        }
    }
    return taken_;
}

}  // namespace runcert
