#pragma once

#include <kainjow/mustache.hpp>
#include <map>
#include <string>

#include "reports/day/picture.h"
#include "schemas/day_results/day_results.h"

namespace runcert {

using TemplateData = kainjow::mustache::data;

/// Attempts by their id; of equal ids the one that is done.
using AttemptsById = std::map<std::string_view, const AttemptResult*>;
AttemptsById attempts_by_id(const DayResults& results);

/// A map for a template, and a list with its `has_NAME` beside it.
TemplateData template_map();
TemplateData template_list();
void set_list(TemplateData& map, const std::string& name, TemplateData list, bool any);
void set_text(TemplateData& map, const std::string& name, const std::string& text);
/// Maps whose `text` is one of them each.
TemplateData texts_of(const std::vector<std::string>& texts);

/// One rule: its counts, its picture and its ranking.
TemplateData profile_data(const DayProfile& profile, const AttemptsById& attempts,
                          std::size_t number);

/// The speeds of a ranking, its first `at_most` places that have one.
Picture picture_of(const DayProfile& profile, const AttemptsById& attempts, std::size_t at_most);

}  // namespace runcert
