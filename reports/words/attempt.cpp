#include "reports/words/attempt.h"

#include <fmt/format.h>

#include "core/claimed_text.h"
#include "core/figures.h"
#include "core/text.h"
#include "schemas/verdict/figures.h"

namespace runcert {

std::string agreement_text(const std::optional<DecisionRuleAgreement>& agreed,
                           const std::optional<WindowSpan>& window) {
    if (!agreed) return "No agreement on the decision rule is stated.";
    std::string text = sentence(
        fmt::format("The decision rule was agreed on {} by {}", agreed->date, claimed(agreed->by)));
    if (window && window->start_gps && begins_after(agreed->date, *window->start_gps))
        text += " That is after the window, and ISO/IEC 17025 (7.1.3) asks for it before.";
    return text;
}

std::string calibration_text(const Calibration& calibration) {
    std::string text = fmt::format("certificate {} of {} by {}", claimed(calibration.certificate),
                                   calibration.date, claimed(calibration.laboratory));
    if (calibration.expanded_uncertainty)
        text += fmt::format("; expanded uncertainty of {} {} (k = 2)", calibration.quantity,
                            number_text(*calibration.expanded_uncertainty, calibration.unit));
    return text;
}

std::string officials_text(const std::vector<Official>& officials) {
    std::string text;
    for (const Official& official : officials)
        text += fmt::format("{}{}{}{}", text.empty() ? "" : ", ", official.role,
                            official.name.empty() ? "" : ": ", claimed(official.name));
    return text;
}

}  // namespace runcert
