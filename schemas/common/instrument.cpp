#include "schemas/common/instrument.h"

#include <nlohmann/json.hpp>

#include "schemas/common/members.h"

namespace runcert {
namespace {

template <class Each>
void each_part(Each each) {
    each("make", &Instrument::make);
    each("model", &Instrument::model);
    each("serial", &Instrument::serial);
    each("firmware", &Instrument::firmware);
    each("antenna", &Instrument::antenna);
}

}  // namespace

template <>
nlohmann::ordered_json members_json(const Instrument& instrument) {
    auto json = nlohmann::ordered_json::object();
    each_part([&](const char* name, std::string Instrument::*part) {
        member::write(json, name, instrument.*part);
    });
    return json;
}

template <>
Instrument read_members(const YamlValue& map) {
    Instrument instrument;
    each_part([&](const char* name, std::string Instrument::*part) {
        instrument.*part = map[name].text_or("");
    });
    return instrument;
}

}  // namespace runcert
