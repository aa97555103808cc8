#include "store/opaque_json.h"

#include <nlohmann/json.hpp>
#include <utility>

namespace runcert {

OpaqueJson::OpaqueJson() : OpaqueJson(nlohmann::ordered_json::object()) {}
OpaqueJson::OpaqueJson(nlohmann::ordered_json value)
    : value_(std::make_unique<nlohmann::ordered_json>(std::move(value))) {}
OpaqueJson::OpaqueJson(const OpaqueJson& other) : OpaqueJson(*other.value_) {}
// What was moved from can only be assigned to or destroyed.
OpaqueJson::OpaqueJson(OpaqueJson&& other) noexcept = default;
OpaqueJson& OpaqueJson::operator=(OpaqueJson other) noexcept {
    value_ = std::move(other.value_);
    return *this;
}
OpaqueJson::~OpaqueJson() = default;

const nlohmann::ordered_json& OpaqueJson::at(const std::string& name) const {
    return value_->at(name);
}

nlohmann::ordered_json& OpaqueJson::operator[](const std::string& name) {
    return (*value_)[name];
}

bool operator==(const OpaqueJson& a, const OpaqueJson& b) {
    return *a.value_ == *b.value_;
}

}  // namespace runcert
