#include "recognised.h"

#include "store/yaml_input.h"

namespace runcert {

Recognised recognise(const std::string& file, const std::string& keys,
                     const std::optional<std::string>& navigation) {
    Recognised result;
    std::vector<std::string> command{(program_folder() / "runcert-import").string(), "--describe",
                                     file, keys};
    if (navigation) command.push_back(*navigation);
    result.said = run_process(command);
    if (!result.said.output.empty())
        result.is = read_members<Recognition>(
            YamlValue(parse_yaml(result.said.output, "runcert-import"), "runcert-import"));
    return result;
}

}  // namespace runcert
