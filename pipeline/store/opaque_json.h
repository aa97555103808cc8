#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace runcert {

/// A JSON value, a map unless set otherwise, for structs in headers that must not include the whole
/// library, which takes two seconds to compile wherever it is included.
class OpaqueJson {
  public:
    OpaqueJson();
    OpaqueJson(nlohmann::ordered_json value);
    OpaqueJson(const OpaqueJson& other);
    OpaqueJson(OpaqueJson&& other) noexcept;
    OpaqueJson& operator=(OpaqueJson other) noexcept;
    ~OpaqueJson();

    operator const nlohmann::ordered_json&() const { return *value_; }
    const nlohmann::ordered_json& operator*() const { return *value_; }
    const nlohmann::ordered_json* operator->() const { return value_.get(); }

    /// The member of that name; the first throws where there is none, the second makes one.
    const nlohmann::ordered_json& at(const std::string& name) const;
    nlohmann::ordered_json& operator[](const std::string& name);

    friend bool operator==(const OpaqueJson& a, const OpaqueJson& b);

  private:
    std::unique_ptr<nlohmann::ordered_json> value_;
};

}  // namespace runcert
