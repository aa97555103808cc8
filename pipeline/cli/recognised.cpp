#include "recognised.h"

#include "store/yaml_input.h"

namespace runcert {

Recognised recognise(const std::string& file, const std::string& keys) {
    Recognised result;
    result.said =
        run_process({(program_folder() / "runcert-import").string(), "--recognise", file, keys});
    if (result.said.exit_status == 0)
        result.is = read_members<Recognition>(
            YamlValue(parse_yaml(result.said.output, "runcert-import"), "runcert-import"));
    return result;
}

}  // namespace runcert
