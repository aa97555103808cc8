#include <fmt/format.h>

#include <algorithm>

#include "core/prose.h"
#include "reports/audit/sections.h"

namespace runcert {
namespace {

std::string found_text(const RunRecord& record, const InputFile& input) {
    return record.files.contains(input.file) ? "yes" : "NO";
}

FactTable inputs_table(const RunRecord& record, const Header& header, bool all) {
    FactTable table{.caption = "Came in",
                    .heads = {"as", "file", "bytes", "SHA-256", "in the folder"},
                    .rows = {}};
    for (const InputFile& input : header.inputs) {
        const std::string handed_in =
            input.original.empty() ? "" : " (handed in as " + input.original + ")";
        table.rows.push_back({input.role, input.file + handed_in,
                              counted(static_cast<std::int64_t>(input.bytes)),
                              hash_text(input.sha256, all), found_text(record, input)});
    }
    return table;
}

std::string named_text(const RunRecord& record, const std::string& file) {
    const auto named = record.named_by.find(file);
    if (named == record.named_by.end() || named->second.empty())
        return "by no file of the folder: nothing shows that it was not changed";
    return "by " + listed(named->second);
}

}  // namespace

std::string hash_text(const std::string& sha256, bool all) {
    constexpr std::size_t enough_to_tell_apart = 12;
    return all || sha256.size() <= enough_to_tell_apart ? sha256
                                                        : sha256.substr(0, enough_to_tell_apart);
}

std::vector<Block> file_blocks(const RunRecord& record, const Header& header,
                               const std::string& file, const std::string& contents, bool all) {
    const InputFile& own = record.files.at(file);
    return {inputs_table(record, header, all),
            Facts{{{"Went out", fmt::format("{}: {}, {} bytes", file, contents,
                                            counted(static_cast<std::int64_t>(own.bytes)))},
                   {"Its SHA-256", hash_text(own.sha256, all)},
                   {"That hash is named", named_text(record, file)},
                   {"Made by", fmt::format("runcert {}, source {}; schema {} {}",
                                           header.program_version, header.source_revision,
                                           header.schema_name, header.schema_version)}}}};
}

Section missing_section(const std::string& title, const std::string& file) {
    return {.title = title,
            .blocks = {Paragraph{fmt::format(
                "{} is MISSING from the folder: what this stage decided cannot be shown. The walk "
                "goes on with what is there.",
                file)}}};
}

std::string stage_title(const std::string& stage, const std::string& receiver) {
    const auto& stages = audited_stages();
    const auto number = std::find(stages.begin(), stages.end(), stage) - stages.begin() + 1;
    return fmt::format("{}. {}{}", number, stage, receiver.empty() ? "" : ", receiver " + receiver);
}

}  // namespace runcert
