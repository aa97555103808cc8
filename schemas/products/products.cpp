#include "schemas/products/products.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

#include "core/failure.h"
#include "core/text.h"
#include "schemas/attitude/declared.h"
#include "schemas/common/product_files.h"
#include "schemas/common/table.h"
#include "schemas/enu/declared.h"
#include "schemas/imu/declared.h"
#include "schemas/observations/observations.h"
#include "schemas/phase/declared.h"
#include "schemas/screened/screened.h"
#include "schemas/screened_phase/declared.h"
#include "schemas/surface/declared.h"
#include "schemas/trajectory/declared.h"
#include "schemas/verdict/declared.h"
#include "schemas/windows/windows.h"
#include "store/ecsv.h"
#include "store/yaml_input.h"

namespace runcert {

YamlNode observations_field_table_node();
YamlNode phase_field_table_node();
YamlNode imu_field_table_node();
YamlNode surface_field_table_node();
YamlNode enu_field_table_node();
YamlNode screened_field_table_node();
YamlNode screened_phase_field_table_node();
YamlNode trajectory_field_table_node();
YamlNode attitude_field_table_node();
YamlNode windows_field_table_node();
YamlNode verdict_field_table_node();
YamlNode report_field_table_node();

namespace {

/// One product: its file, its field table, and its reader.
struct Product {
    ProductFile file;
    YamlNode (*field_table)();
    void (*read)(std::string_view, const std::string&);
};

/// Each row is checked, and none kept.
template <auto open>
void read_table(std::string_view text, const std::string& where) {
    auto table = open(text, where);
    for (typename decltype(table)::Row row; table.rows.next(row);) {
    }
}

template <auto read>
void read_whole(std::string_view text, const std::string& where) {
    (void)read(text, where);
}

using namespace products;
constexpr std::array<Product, 11> known_products{{
    {observations, observations_field_table_node, read_table<open_observations>},
    {phase, phase_field_table_node, read_table<open_phase>},
    {imu, imu_field_table_node, read_table<open_imu>},
    {surface, surface_field_table_node, read_table<open_surface>},
    {enu, enu_field_table_node, read_table<open_enu>},
    {screened, screened_field_table_node, read_table<open_screened>},
    {screened_phase, screened_phase_field_table_node, read_table<open_screened_phase>},
    {trajectory, trajectory_field_table_node, read_table<open_trajectory>},
    {attitude, attitude_field_table_node, read_table<open_attitude>},
    {windows, windows_field_table_node, read_whole<read_windows>},
    {verdict, verdict_field_table_node, read_whole<read_verdict>},
}};

const Product& product_of(std::string_view file, const std::string& where) {
    const std::string_view stem = file.substr(0, file.find('.'));
    const auto found =
        std::ranges::find(known_products, stem, [](const Product& one) { return one.file.stem; });
    if (found == known_products.end())
        throw Failure(where,
                      fmt::format("\"{}\" is no product of a stage that this program knows",
                                  escape_for_message(file)),
                      "Certify the recording again with this program");
    return *found;
}

YamlValue header_of(std::string_view text, std::string_view file, const std::string& where) {
    if (file.ends_with(".ecsv")) return YamlValue(EcsvReader(text, where).meta(), where);
    return YamlValue(parse_yaml(text, where), where);
}

}  // namespace

bool is_product_name(std::string_view file) {
    return file.size() > 2 && file[0] >= '1' && file[0] <= '9' && file[1] == '-';
}

Header read_product_header(std::string_view text, std::string_view file, const std::string& where) {
    return read_header(header_of(text, file, where));
}

void require_known_version(std::string_view text, std::string_view file, const std::string& where) {
    check_version(header_of(text, file, where), product_fields(file));
}

void check_product(std::string_view text, std::string_view file, const std::string& where) {
    product_of(file, where).read(text, where);
}

const DocumentSchema& product_fields(std::string_view file) {
    static const auto all = [] {
        std::map<std::string_view, DocumentSchema> fields;
        for (const Product& product : known_products) {
            const std::string where(product.file.stem);
            fields.emplace(product.file.stem,
                           DocumentSchema::read(product.field_table(), where, &header_schema()));
        }
        return fields;
    }();
    return all.at(product_of(file, std::string(file)).file.stem);
}

const DocumentSchema& report_field_table() {
    static const DocumentSchema schema =
        DocumentSchema::read(report_field_table_node(), "reports/certificate/v1.yaml");
    return schema;
}

}  // namespace runcert
