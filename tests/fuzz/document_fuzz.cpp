// The readers of YAML documents, each where its schema is named in the text, else the parser alone.

#include "core/failure.h"
#include "fuzz_target.h"
#include "schemas/attempt/attempt.h"
#include "schemas/profile/profile.h"
#include "schemas/simulation/simulation.h"
#include "schemas/verdict/declared.h"
#include "schemas/windows/windows.h"
#include "store/yaml_input.h"

namespace runcert::fuzz {
namespace {

/// Reads every value of a tree as every type.
void read_values(const YamlValue& value) {
    for (const auto read : {+[](const YamlValue& one) { (void)one.text(); },
                            +[](const YamlValue& one) { (void)one.real(); },
                            +[](const YamlValue& one) { (void)one.integer(); },
                            +[](const YamlValue& one) { (void)one.boolean(); }})
        try {
            read(value);
        } catch (const Failure&) {
        }
    for (const std::string& key : value.keys())
        read_values(value[key]);
    if (value.is_list())
        for (const YamlValue& item : value.list())
            read_values(item);
}

}  // namespace

void read_input(std::string_view bytes) {
    const auto names = [&](std::string_view schema) {
        return bytes.find(schema) != std::string_view::npos;
    };
    if (names("attempt/1"))
        (void)read_attempt(bytes, "document");
    else if (names("profile/1"))
        (void)read_profile(bytes, "document");
    else if (names("simulation/1"))
        (void)read_simulation(bytes, "document");
    else if (names("name: windows"))
        read_and_write(bytes, read_windows, write_windows);
    else if (names("name: verdict"))
        read_and_write(bytes, read_verdict, write_verdict);
    else
        read_values(YamlValue(parse_yaml(bytes, "document"), "document"));
}

}  // namespace runcert::fuzz
