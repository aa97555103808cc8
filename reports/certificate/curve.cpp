#include "reports/certificate/curve.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/rounding.h"

namespace runcert {

using Json = nlohmann::ordered_json;

Curve::Curve(const CurveStyle& style)
    : json_{{"curve_name", style.name},
            {"curve_kind", style.kind},
            {"colour", style.colour},
            {"x", Json::array()},
            {"y", Json::array()}},
      style_(style) {}

void Curve::add(double x, double y) {
    if (interrupted_) {
        json_["x"].push_back(rounded(x, style_.x_decimals));
        for (const char* values : {"y", "lower", "upper"})
            if (json_.contains(values)) json_[values].push_back(nullptr);
    }
    interrupted_ = false;
    json_["x"].push_back(rounded(x, style_.x_decimals));
    json_["y"].push_back(rounded(y, style_.y_decimals));
}

void Curve::add(double x, double y, double lower, double upper) {
    if (empty()) json_["lower"] = json_["upper"] = Json::array();
    add(x, y);
    json_["lower"].push_back(rounded(lower, style_.y_decimals));
    json_["upper"].push_back(rounded(upper, style_.y_decimals));
}

void Curve::interrupt() {
    interrupted_ = !empty();
}

void Range::widen(double value) {
    least = least ? std::min(*least, value) : value;
    most = most ? std::max(*most, value) : value;
}

}  // namespace runcert
