#include "store/held_json.h"

#include <nlohmann/json.hpp>
#include <utility>

namespace runcert {

HeldJson::HeldJson() : HeldJson(nlohmann::ordered_json::object()) {}
HeldJson::HeldJson(nlohmann::ordered_json value)
    : value_(std::make_unique<nlohmann::ordered_json>(std::move(value))) {}
HeldJson::HeldJson(const HeldJson& other) : HeldJson(*other.value_) {}
// What was moved from can only be assigned to or destroyed.
HeldJson::HeldJson(HeldJson&& other) noexcept = default;
HeldJson& HeldJson::operator=(HeldJson other) noexcept {
    value_ = std::move(other.value_);
    return *this;
}
HeldJson::~HeldJson() = default;

const nlohmann::ordered_json& HeldJson::at(const std::string& name) const {
    return value_->at(name);
}

nlohmann::ordered_json& HeldJson::operator[](const std::string& name) {
    return (*value_)[name];
}

bool operator==(const HeldJson& a, const HeldJson& b) {
    return *a.value_ == *b.value_;
}

}  // namespace runcert
